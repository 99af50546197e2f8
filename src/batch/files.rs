//! The picture and the film, written with what they say about themselves.

use crate::cli::RenderOptions;
use crate::film::{Description, Film, checkpoint, key};
use crate::output::write_image;
use crate::progressive::Status;
use crate::recipe::file;
use crate::scene::Camera;
use std::path::PathBuf;

/// Files that were written, and what kept the others from being so.
#[derive(Debug, Default)]
pub(super) struct Written {
    pub files: Vec<PathBuf>,
    pub failure: Option<anyhow::Error>,
}

/// Writes picture and film. If one cannot be written, the other still is. `seconds_before` is what the film's
/// earlier samples took, if that is known.
pub(super) fn write(
    render: &RenderOptions,
    film: &Film,
    status: &Status,
    seconds_before: Option<f64>,
) -> Written {
    let description = describe(render, film, status, seconds_before);
    let mut written = Written::default();
    let mut note = |path: &PathBuf, outcome: anyhow::Result<()>| match outcome {
        Ok(()) => written.files.push(path.clone()),
        Err(error) => written.failure = Some(error),
    };
    if let Some(path) = &render.checkpoint {
        note(path, checkpoint::save(path, film, &description).map_err(Into::into));
    }
    let transfer = render.job.rules().transfer;
    note(&render.out, write_image(&render.out, film, transfer, &description).map_err(Into::into));
    written
}

fn describe(
    render: &RenderOptions,
    film: &Film,
    status: &Status,
    seconds_before: Option<f64>,
) -> Description {
    let settings = render.job.settings();
    let mut description = Description::new(&file::to_toml(&render.recipe));
    description.set(key::SOFTWARE, concat!("Weekender ", env!("CARGO_PKG_VERSION")));
    description.set(key::SCENE, &render.recipe.name);
    if let Some(stage) = render.stage {
        description.set(key::STAGE, stage.id);
    }
    description.set(key::CAMERA, camera_words(render.job.camera()));
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
