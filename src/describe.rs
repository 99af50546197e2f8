//! What a picture says about itself, from its recipe, its film and how it was rendered.

use crate::film::{Description, Film, key};
use crate::progressive::Status;
use crate::recipe::{Recipe, file};
use crate::scene::Camera;
use crate::stages::Stage;

/// The description of a film that `recipe` gave. `seconds_before` is what the film's earlier samples took, if
/// that is known.
pub fn describe(
    recipe: &Recipe,
    stage: Option<&Stage>,
    film: &Film,
    status: &Status,
    seconds_before: Option<f64>,
) -> Description {
    let settings = &recipe.settings;
    let mut description = Description::new(&file::to_toml(recipe));
    description.set(key::SOFTWARE, concat!("Weekender ", env!("CARGO_PKG_VERSION")));
    description.set(key::SCENE, &recipe.name);
    if let Some(stage) = stage {
        description.set(key::STAGE, stage.id);
    }
    description.set(key::CAMERA, camera_words(&recipe.camera));
    description.set(key::SAMPLER, settings.sampler.name());
    description.set(key::SEED, settings.seed);
    description.set(key::SAMPLES, film.sample_count());
    if let Some(seconds) = seconds_before {
        description.set(key::SECONDS, seconds + status.trace.as_secs_f64());
    }
    if let Some(backend) = &status.backend {
        description
            .set(key::BACKEND, format!("{} {}, {} lanes", backend.name, backend.device, backend.lanes));
    }
    description
}

fn camera_words(camera: &Camera) -> String {
    let (from, at) = (camera.look_from, camera.look_at);
    format!(
        "from {},{},{} to {},{},{}, vfov {} degrees, defocus {} degrees, focus at {}",
        from.x,
        from.y,
        from.z,
        at.x,
        at.y,
        at.z,
        camera.vfov_degrees,
        camera.defocus_angle_degrees,
        camera.effective_focus_distance()
    )
}
