//! The description of a picture, from its recipe, its film and how it was rendered.

use crate::film::{Description, Film, key};
use crate::job::recipe::{Recipe, file};
use crate::job::render::BackendInfo;
use crate::progressive::{Contribution, Status};
use crate::scene::Camera;
use crate::stages::Stage;

pub use crate::film::SOFTWARE;

/// The description of a film rendered from `recipe`. `seconds_before` is the time that the film's earlier samples
/// took, if known.
pub fn describe(
    recipe: &Recipe,
    stage: Option<&Stage>,
    film: &Film,
    status: &Status,
    seconds_before: Option<f64>,
) -> Description {
    let settings = &recipe.settings;
    let mut description = Description::new(&file::to_picture_toml(recipe));
    description.set(key::SOFTWARE, SOFTWARE);
    description.set(key::SCENE, &recipe.name);
    if let Some(stage) = stage {
        description.set(key::STAGE, stage.id);
    }
    description.set(key::CAMERA, camera_text(&recipe.camera));
    description.set(key::SAMPLER, settings.sampler.name());
    description.set(key::SEED, settings.seed);
    description.set(key::SAMPLES, film.sample_count());
    if let Some(seconds) = seconds_before {
        description.set(key::SECONDS, seconds + status.trace.as_secs_f64());
    }
    if let Some(backends) = backend_text(film, status) {
        description.set(key::BACKEND, backends);
    }
    description
}

/// A number with its noun: `1 sample`, `8 samples`.
pub fn counted(number: u64, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

/// A time such as `3.2 s`, `4 min 05 s` or `2 h 03 min`.
pub fn seconds(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..60 => format!("{seconds:.1} s"),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        3600..864_000 => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
        _ => format!("{} days", whole / 86_400),
    }
}

/// The backend. If there were several, the current one comes first, each with its samples; earlier runs come last.
fn backend_text(film: &Film, status: &Status) -> Option<String> {
    let text =
        |info: &BackendInfo| format!("{} {}, {}", info.name, info.device, counted(info.lanes as u64, "lane"));
    let samples = |count: u64| counted(count, "sample");
    let mut parts: Vec<&Contribution> = status.contributions.iter().collect();
    let earlier = film.sample_count().saturating_sub(status.added());
    match parts.as_slice() {
        [] => return status.backend.as_ref().map(text),
        [only] if earlier == 0 => return Some(text(&only.backend)),
        _ => {}
    }
    parts.sort_by_key(|part| Some(&part.backend) != status.backend.as_ref());
    let listed =
        parts.iter().map(|part| format!("{} ({})", text(&part.backend), samples(part.samples_per_pixel)));
    let before = (earlier > 0).then(|| format!("earlier runs ({})", samples(earlier)));
    Some(listed.chain(before).collect::<Vec<_>>().join("; "))
}

fn camera_text(camera: &Camera) -> String {
    let Camera { vfov_degrees: vfov, defocus_angle_degrees: defocus, .. } = camera;
    let [from, at] = [camera.look_from, camera.look_at].map(|at| format!("{},{},{}", at.x, at.y, at.z));
    let focus = camera.effective_focus_distance();
    format!("from {from} to {at}, vfov {vfov} degrees, defocus {defocus} degrees, focus at {focus}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_film_says_how_many_samples_it_has() {
        let recipe = Recipe::builtin("three-spheres").expect("built in");
        let mut film = Film::new(1, 1);
        film.record(0..10, 0).expect("empty");
        // The status can be that of a later pass.
        let status = Status { samples_per_pixel: 12, ..Status::default() };
        let description = describe(&recipe, None, &film, &status, None);
        assert_eq!((description.get(key::SAMPLES), description.get(key::SECONDS)), (Some("10"), None));
        // Earlier samples took their time, too.
        let status = Status { trace: std::time::Duration::from_millis(1500), ..status };
        let description = describe(&recipe, None, &film, &status, Some(2.5));
        assert_eq!(description.get(key::SECONDS), Some("4"));
    }

    #[test]
    fn all_backends_are_named() {
        let info = |name: &'static str, lanes| BackendInfo { name, device: "x".into(), lanes, threads: 1 };
        let part =
            |name, lanes, samples_per_pixel| Contribution { backend: info(name, lanes), samples_per_pixel };
        let mut film = Film::new(1, 1);
        film.record(0..10, 0).expect("empty");
        let text = |contributions: &[Contribution]| {
            let status = Status {
                backend: Some(info("gpu", 64)),
                contributions: contributions.to_vec(),
                ..Status::default()
            };
            backend_text(&film, &status).expect("a backend")
        };
        assert_eq!(text(&[]), "gpu x, 64 lanes");
        assert_eq!(text(&[part("cpu", 8, 10)]), "cpu x, 8 lanes");
        assert_eq!(text(&[part("cpu", 8, 4)]), "cpu x, 8 lanes (4 samples); earlier runs (6 samples)");
        let two = [part("cpu", 8, 6), part("gpu", 64, 1)];
        assert_eq!(
            text(&two),
            "gpu x, 64 lanes (1 sample); cpu x, 8 lanes (6 samples); earlier runs (3 samples)"
        );
    }
}
