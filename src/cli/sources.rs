//! Where a picture comes from (a built-in scene, a stage, a scene file or a film), with the changes of the flags.

use super::error::CliError;
use super::raw::{self, RawPicture, RawSwitch};
use super::values::{range, whole};
use crate::job::recipe::{Recipe, file};
use crate::job::render::{RenderJob, SAMPLE_LIMIT};
use crate::job::saved::Saved;
use crate::stages::Stage;
use clap::Args;
use std::ops::Range;
use std::path::Path;

pub(super) use super::values::check_ending;

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
          conflicts_with_all = ["samples", "AnimationFlags"])]
    pub sample_range: Option<Range<u64>>,
    /// Keep samples in two halves, which is needed to estimate the error; off halves the memory
    /// [default: on, or the scene's]
    #[arg(long, value_enum)]
    pub estimate_error: Option<RawSwitch>,
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
) -> Result<(ChosenRecipe, RenderJob), CliError> {
    changed(find(raw, resume)?, raw, samples)
}

/// The picture with the changes of the flags, and its validated job.
pub(super) fn changed(
    mut chosen: ChosenRecipe,
    raw: &RawPicture,
    samples: &SampleFlags,
) -> Result<(ChosenRecipe, RenderJob), CliError> {
    raw::change(&mut chosen.recipe, raw, samples.estimate_error);
    chosen.recipe.samples_per_pixel = samples.samples.unwrap_or(chosen.recipe.samples_per_pixel);
    let job = chosen.recipe.job()?;
    Ok((chosen, job))
}

/// The source that the flags name, before the changes of other flags.
pub(super) fn find(raw: &RawPicture, resume: Option<&Path>) -> Result<ChosenRecipe, CliError> {
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
pub(super) fn scene(name: &str) -> Result<Recipe, CliError> {
    match scene_file(Some(name)) {
        Some(path) => Ok(file::load(path)?),
        None => Ok(Recipe::find(name)?),
    }
}

/// The example scene `near-glass`, which is part of the program for use in reports.
pub(super) const NEAR_GLASS: &str = "near-glass";

/// A built-in scene, or [`NEAR_GLASS`].
pub(super) fn carried(name: &str) -> Result<Recipe, CliError> {
    if name != NEAR_GLASS {
        return scene(name);
    }
    let recipe = file::parse(include_str!("../../assets/scenes/near-glass.toml"), NEAR_GLASS)?;
    Ok(Recipe { name: name.to_owned(), ..recipe })
}

/// The scene file that `--scene` names, if it is one: the name has an extension or a directory.
pub(super) fn scene_file(scene: Option<&str>) -> Option<&Path> {
    let path = Path::new(scene?);
    (path.extension().is_some() || path.components().count() > 1).then_some(path)
}

/// Reduces the picture to at most `width` pixels across, keeping its shape, unless its size was given.
pub(super) fn narrow(recipe: &mut Recipe, raw: &RawPicture, width: u32) {
    let settings = &mut recipe.settings;
    if raw.size.is_none() && settings.width > width {
        let height = f64::from(settings.height) * f64::from(width) / f64::from(settings.width);
        (settings.width, settings.height) = (width, (height.round() as u32).max(1));
    }
}

/// Warnings that name the flags without effect on the picture, each with the reason.
pub(super) fn notes(
    job: &RenderJob,
    chosen: &ChosenRecipe,
    raw: &RawPicture,
    samples: &SampleFlags,
) -> Vec<String> {
    let (rules, what) = (job.rules(), chosen.stage.map_or("scene", |stage| stage.id));
    let has_rays = rules.has_rays();
    let has_bounces = has_rays && rules.has_bounces() && !job.scene().spheres.is_empty();
    let has_lens = has_rays && job.camera().defocus_angle_degrees > 0.0;
    let is_random =
        has_rays && (rules.antialiasing || has_lens || has_bounces && job.settings().max_depth > 1);
    let mut table: Vec<(&str, bool, &str)> =
        raw.camera.given().into_iter().map(|flag| (flag, has_rays, "it traces no rays")).collect();
    let lens = "its lens is a pinhole; add --defocus-angle";
    let same = "all samples of a pixel are the same";
    for (flag, is_given, has_effect, reason) in [
        ("--focus-distance", raw.camera.focus_distance.is_some(), !has_rays || has_lens, lens),
        ("--depth", raw.depth.is_some(), has_bounces, "its rays end where they first hit"),
        ("--samples above 1", samples.samples.is_some_and(|samples| samples > 1), is_random, same),
        ("--sampler", raw.sampler.is_some(), is_random, same),
        ("--seed", raw.seed.is_some(), is_random, same),
    ] {
        table.extend(is_given.then_some((flag, has_effect, reason)));
    }
    let without = table.into_iter().filter(|(_, has_effect, _)| !has_effect);
    without.map(|(flag, _, reason)| format!("{flag} has no effect on {what}: {reason}")).collect()
}

#[cfg(test)]
mod tests {
    use crate::cli::{Request, parse};

    #[test]
    fn flags_without_effect_are_named_with_the_reason() {
        let notes = |line: &str| match parse(format!("weekender --batch {line}").split(' ').map(Into::into)) {
            Ok(Request::Batch(options)) => {
                options.renders.into_iter().flat_map(|render| render.notes).collect()
            }
            Ok(Request::Frames(options)) => options.notes,
            other => panic!("{other:?}"),
        };
        for (line, flags) in [
            (
                "--stage ppm-tiny --size 9x9 --samples 7 --depth 3 --look-from 1,2,3",
                &["--look-from", "--depth", "--samples above 1"][..],
            ),
            ("--stage ppm-gradient --turntable=2 --vfov 30 --out d", &["--vfov"]),
            ("--stage normals --samples 8 --depth 3 --seed 4", &["--depth", "--samples above 1", "--seed"]),
            ("--stage sky --depth 9", &["--depth"]),
            ("--scene three-spheres --focus-distance 2", &["--focus-distance"]),
            ("--stage ppm-tiny --samples 1", &[]),
            ("--stage sky --look-from 1,2,3 --defocus-angle 2 --focus-distance 3 --samples 9", &[]),
            ("--stage antialiased --samples 9 --seed 3 --sampler independent", &[]),
            ("--stage all --depth 3 --samples 9 --out d", &[]),
        ] {
            let notes: Vec<String> = notes(line);
            assert_eq!(notes.len(), flags.len(), "{line}: {notes:?}");
            for (note, flag) in notes.iter().zip(flags) {
                assert!(note.starts_with(flag) && note.contains(" has no effect on "), "{line}: {note}");
            }
        }
    }
}
