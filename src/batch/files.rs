//! The picture and the film, written with what they say about themselves.

use crate::cli::RenderOptions;
use crate::describe::describe;
use crate::film::{Film, checkpoint};
use crate::output::write_image;
use crate::progressive::Status;
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
    let description = describe(&render.recipe, render.stage, film, status, seconds_before);
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
