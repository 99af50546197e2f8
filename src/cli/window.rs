//! The flags of the window.

use super::render::{DrawWith, RenderFlags, plan};
use super::sources::{self, ChosenRecipe, PictureFlags};
use crate::backends::BackendChoice;
use crate::job::output::{is_named_picture, read_description};
use crate::job::recipe::Recipe;
use crate::job::saved;
use crate::progressive::Stop;
use crate::stages::Stage;
use anyhow::{Result, ensure};
use clap::ArgMatches;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Options of the window.
#[derive(Clone, Debug)]
pub struct WindowOptions {
    /// The picture at the start.
    pub recipe: Recipe,
    /// The picture without the changes of the flags.
    pub unchanged: Recipe,
    /// The stage that it comes from.
    pub stage: Option<&'static Stage>,
    /// The scene file that it comes from.
    pub file: Option<PathBuf>,
    /// Whether a flag set the size of the picture.
    pub is_size_given: bool,
    /// Whether flags chose or changed the picture.
    pub is_picture_given: bool,
    pub backend: BackendChoice,
    /// Whether flags chose the backend.
    pub is_device_given: bool,
    /// When to stop; `None` without such flags.
    pub stop: Option<Stop>,
    /// The film to resume.
    pub resume: Option<PathBuf>,
    /// The picture of another program to check.
    pub mine: Option<PathBuf>,
    /// Whether the picture was read from a film or another picture.
    pub is_saved: bool,
    /// Whether to open the default picture instead of the last one.
    pub is_fresh: bool,
    /// Time between two writes of a film that is traced.
    pub autosave_every: Duration,
    /// The directory for edits and films; without it they end with the window.
    pub state_directory: Option<PathBuf>,
    pub draw_with: DrawWith,
}

/// Whether a file is a picture of another program.
fn is_others(path: &Path) -> bool {
    is_named_picture(path) && path.exists() && read_description(path).is_err()
}

/// `opened` is a picture without a film.
pub(super) fn options(
    flags: RenderFlags,
    opened: Option<PathBuf>,
    matches: &ArgMatches,
) -> Result<WindowOptions> {
    let RenderFlags { picture, samples, stop, files, .. } = &flags;
    ensure!(
        samples.sample_range.is_none(),
        "--sample-range needs --batch: the window renders all samples of its picture"
    );
    let (mine, opened) = match opened {
        Some(path) if is_others(&path) => (Some(path), None),
        other => (None, other),
    };
    let saved = files.resume.as_deref().or(opened.as_deref());
    let file = sources::scene_file(picture.scene.as_deref());
    let chosen = sources::find(picture, saved)?;
    let unchanged = chosen.recipe.clone();
    let (ChosenRecipe { recipe, stage }, job) = sources::changed(chosen, picture, samples)?;
    if let Some(film) = &files.resume {
        saved::open(film)?.check_same(&job)?;
    }
    let has_end = samples.samples.is_some() || stop.time_limit.is_some() || stop.noise_target.is_some();
    Ok(WindowOptions {
        stop: has_end.then(|| plan(&flags, &recipe).stop),
        recipe,
        unchanged,
        stage,
        file: file.map(PathBuf::from),
        is_size_given: picture.size.is_some(),
        is_picture_given: *picture != PictureFlags::default() || saved.is_some(),
        is_device_given: matches.contains_id("BackendFlags"),
        mine,
        is_saved: saved.is_some() && picture.scene.is_none() && picture.stage.is_none(),
        resume: files.resume.clone(),
        is_fresh: flags.window.fresh,
        autosave_every: flags.window.autosave_every,
        state_directory: None,
        draw_with: flags.window.draw_with,
        backend: flags.backend.choice()?,
    })
}
