//! The picture and the film, written with what they say about themselves.

use crate::cli::RenderOptions;
use crate::describe::describe;
use crate::film::{Description, Film, checkpoint};
use crate::output::{OutputFormat, write_image};
use crate::progressive::Status;
use crate::recipe::plain_name;
use anyhow::anyhow;
use std::path::PathBuf;

/// Files that were written, and what kept the others from being so.
#[derive(Debug, Default)]
pub(super) struct Written {
    pub files: Vec<PathBuf>,
    pub failure: Option<anyhow::Error>,
}

/// Writes picture and film. If one cannot be written, the other still is, and if that is not the film, then the film
/// among the system's temporary files: its samples may have taken hours. `seconds_before` is what the film's earlier
/// samples took, if that is known.
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
    let is_film =
        |path: &PathBuf| OutputFormat::from_path(path).is_ok_and(|format| format == OutputFormat::Exr);
    if let Some(error) = written.failure.take() {
        let rescued =
            (!written.files.iter().any(is_film)).then(|| rescue(render, film, &description)).flatten();
        written.failure = Some(match &rescued {
            Some(path) => {
                anyhow!("{error}; the samples are in {}: --resume goes on with them", path.display())
            }
            None => error,
        });
        written.files.extend(rescued);
    }
    written
}

/// Keeps the film where there may be room still; `None` if there is none either.
fn rescue(render: &RenderOptions, film: &Film, description: &Description) -> Option<PathBuf> {
    let name = format!("weekender-{}-{}.exr", plain_name(&render.recipe.name), std::process::id());
    let path = std::env::temp_dir().join(name);
    checkpoint::save(&path, film, description).ok()?;
    Some(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Request, parse};

    #[test]
    fn a_film_that_cannot_be_written_is_rescued() {
        let directory = tempfile::tempdir().unwrap();
        let out = directory.path().join("gone/picture.png");
        let words = ["weekender", "--batch", "--size", "4x3", "--out", out.to_str().unwrap()];
        let Request::Batch(options) = parse(words.into_iter().map(Into::into)).unwrap() else { panic!() };
        let render = &options.renders[0];
        let mut film = render.job.new_film();
        film.record(0..2, 0).unwrap();
        let written = write(render, &film, &Status::default(), None);
        let told = written.failure.unwrap().to_string();
        let [path] = written.files.as_slice() else { panic!("{told}") };
        assert!(told.contains("gone") && told.contains(&format!("in {}", path.display())), "{told}");
        let read = checkpoint::load(path);
        std::fs::remove_file(path).unwrap();
        assert!(read.unwrap().film == film);
    }
}
