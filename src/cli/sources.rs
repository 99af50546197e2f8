//! Where a picture comes from (a built-in scene, a stage, a scene file or a film), with the changes of the flags.

use super::raw::{self, RawPicture};
use super::values::{range, whole};
use crate::job::recipe::{Recipe, file};
use crate::job::render::{RenderJob, RenderSettings, SAMPLE_LIMIT, SIZE_LIMIT};
use crate::job::saved::Saved;
use crate::stages::Stage;
use crate::system::files::STANDARD;
use anyhow::Result;
use clap::Args;
use clap::builder::BoolishValueParser;
use std::ops::Range;
use std::path::Path;

/// The scene that is rendered if none is named.
pub const DEFAULT_SCENE: &str = "three-spheres";

/// The samples of a picture or of a plan.
#[derive(Debug, Args)]
#[command(next_help_heading = "Samples")]
pub(super) struct SampleFlags {
    /// Samples per pixel, 1 to 4294967296 [default: the scene's; unlimited with --time-limit or --noise-target]
    #[arg(long, value_name = "COUNT", value_parser = whole(1..=SAMPLE_LIMIT, 100))]
    pub samples: Option<u64>,
    /// Only samples A to B - 1, for `weekender merge` or to add them to a picture that has the others
    #[arg(long, value_name = "A..B", value_parser = range(SAMPLE_LIMIT, "0..64"),
          conflicts_with = "samples")]
    pub sample_range: Option<Range<u64>>,
    /// Keep samples in two halves, which is needed to estimate the error; off halves the memory
    /// [default: on, or the scene's]
    #[arg(long, value_name = "on|off", value_parser = BoolishValueParser::new())]
    pub estimate_error: Option<bool>,
}

/// A recipe and, if it comes from one, its stage.
#[derive(Clone, Debug)]
pub(super) struct ChosenRecipe {
    pub recipe: Recipe,
    pub stage: Option<&'static Stage>,
}

/// The picture that the flags describe, and its validated job. Without --scene and --stage it comes from the film to
/// `resume`.
pub(super) fn picture(
    raw: &RawPicture,
    samples: &SampleFlags,
    resume: Option<&Path>,
) -> Result<(ChosenRecipe, RenderJob)> {
    let mut chosen = find(raw, resume)?;
    raw::change(&mut chosen.recipe, raw, samples.estimate_error);
    chosen.recipe.samples_per_pixel = samples.samples.unwrap_or(chosen.recipe.samples_per_pixel);
    let job = chosen.recipe.job()?;
    Ok((chosen, job))
}

/// The source that the flags name, before the changes of other flags.
pub(super) fn find(raw: &RawPicture, resume: Option<&Path>) -> Result<ChosenRecipe> {
    match (&raw.stage, &raw.scene, resume) {
        (Some(id), _, _) => {
            let stage = Stage::find(id)?;
            Ok(ChosenRecipe { recipe: stage.recipe(), stage: Some(stage) })
        }
        (None, Some(name), _) => Ok(ChosenRecipe { recipe: scene(name)?, stage: None }),
        (None, None, Some(film)) => {
            let saved = Saved::describe(film)?;
            Ok(ChosenRecipe { recipe: saved.recipe()?, stage: saved.stage() })
        }
        (None, None, None) => Ok(ChosenRecipe { recipe: scene(DEFAULT_SCENE)?, stage: None }),
    }
}

/// The scene with this name or in this file.
pub(super) fn scene(name: &str) -> Result<Recipe> {
    match scene_file(Some(name)) {
        Some(path) => Ok(file::load(path)?),
        None => Recipe::find(name),
    }
}

/// The scene file that `--scene` names, if it is one: standard input, or a name with an extension or a directory.
pub(super) fn scene_file(scene: Option<&str>) -> Option<&Path> {
    let path = Path::new(scene?);
    (scene == Some(STANDARD) || path.extension().is_some() || path.components().count() > 1).then_some(path)
}

/// Makes a picture `width` pixels wide, keeping its shape.
pub(super) fn scale(settings: &mut RenderSettings, width: u32) {
    let height = f64::from(settings.height) * f64::from(width) / f64::from(settings.width);
    (settings.width, settings.height) = (width, (height.round() as u32).clamp(1, SIZE_LIMIT));
}
