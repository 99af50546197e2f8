//! Where a picture comes from (a built-in scene, a stage, a scene file or a film), with the changes of the flags.

use super::values::{number, parse_size, parse_vector, range, whole};
use crate::job::recipe::{Recipe, file};
use crate::job::render::{DEPTH_LIMIT, RenderJob, SAMPLE_LIMIT, SamplerKind};
use crate::job::saved::open;
use crate::scene::VFOV_LIMITS_DEGREES;
use crate::scene::builtin::BuiltinScene;
use crate::stages::Stage;
use crate::system::files::STANDARD;
use anyhow::Result;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Arg, Args, Command, Error, ValueHint};
use glam::DVec3;
use std::ffi::{OsStr, OsString};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A parser of names. For an unknown one, clap suggests a similar one.
#[derive(Clone)]
pub(super) struct Names {
    known: PossibleValuesParser,
    /// Whether a value is read as something other than a name.
    is_other: fn(&OsStr) -> bool,
}

impl Names {
    pub fn of_scenes() -> Self {
        let known = PossibleValuesParser::new(BuiltinScene::ALL.iter().map(|scene| scene.name));
        let is_field_or_file =
            |name: &OsStr| name.to_string_lossy().starts_with("field:") || scene_file(Some(name)).is_some();
        Names { known, is_other: is_field_or_file }
    }

    /// Other values are the sections of stages.
    pub fn of_stages() -> Self {
        let known = PossibleValuesParser::new(Stage::ALL.iter().map(|stage| stage.id));
        Names { known, is_other: |id| id.to_string_lossy().starts_with(|c: char| c.is_ascii_digit()) }
    }
}

impl TypedValueParser for Names {
    type Value = OsString;

    fn parse_ref(&self, command: &Command, flag: Option<&Arg>, value: &OsStr) -> Result<OsString, Error> {
        if (self.is_other)(value) {
            return Ok(value.to_owned());
        }
        self.known.parse_ref(command, flag, value).map(OsString::from)
    }
}

/// Flags that choose and change the picture.
#[derive(Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Picture")]
pub(super) struct PictureFlags {
    /// A built-in scene, field:N for a field of N spheres, or a scene file [default: three-spheres]
    #[arg(long, value_name = "NAME|FILE.toml", value_hint = ValueHint::FilePath, value_parser = Names::of_scenes(),
          conflicts_with = "stage")]
    pub scene: Option<OsString>,
    /// A stage of the book, by name or section, such as glass-schlick or 11.4; --list shows them
    #[arg(long, value_name = "STAGE", value_parser = Names::of_stages())]
    pub stage: Option<OsString>,
    /// Width and height in pixels, each 1 to 16384 [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<(u32, u32)>,
    /// Maximum number of rays per path, including the camera's, 1 to 10000 [default: the scene's]
    #[arg(long, value_name = "RAYS", value_parser = whole::<u32>(1..=DEPTH_LIMIT.into()))]
    pub depth: Option<u32>,
    /// Source of random numbers: scrambled Sobol points, or independent numbers as in the book
    /// [default: sobol, or the scene's]
    #[arg(long, value_enum)]
    pub sampler: Option<SamplerKind>,
    /// Seed: pictures with different seeds differ only in their noise, 0 to 4294967295 [default: 0, or the scene's]
    #[arg(long, value_name = "NUMBER", value_parser = whole::<u32>(0..=u32::MAX.into()))]
    pub seed: Option<u32>,
    #[command(flatten)]
    pub camera: CameraFlags,
}

#[derive(Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Camera (default: the scene's)")]
pub(super) struct CameraFlags {
    /// Position of the eye, scene units
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vector, allow_hyphen_values = true)]
    look_from: Option<DVec3>,
    /// The point in the centre of the picture, scene units
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vector, allow_hyphen_values = true)]
    look_at: Option<DVec3>,
    /// Up direction of the picture, not parallel to the view; its length does not matter
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vector, allow_hyphen_values = true)]
    vup: Option<DVec3>,
    #[arg(help = format!("Vertical field of view, {} to {} degrees", VFOV_LIMITS_DEGREES[0], VFOV_LIMITS_DEGREES[1]),
          long, value_name = "DEGREES", value_parser = number(.., "a number, such as 20"), allow_hyphen_values = true)]
    vfov: Option<f64>,
    /// Angle of the cone from the focus point to the lens, from 0 (a pinhole) to below 179 degrees
    #[arg(long, value_name = "DEGREES", value_parser = number(.., "a number, such as 0.6"), allow_hyphen_values = true)]
    defocus_angle: Option<f64>,
    /// Distance to the plane in focus, above 0 scene units
    #[arg(long, value_name = "UNITS", value_parser = number(.., "a number, such as 10"), allow_hyphen_values = true)]
    pub focus_distance: Option<f64>,
}

impl PictureFlags {
    /// Replaces values of the recipe by those of the flags.
    pub fn change(&self, recipe: &mut Recipe) {
        fn set<T: Copy>(value: &mut T, flag: Option<T>) {
            *value = flag.unwrap_or(*value);
        }
        let (settings, camera, flags) = (&mut recipe.settings, &mut recipe.camera, &self.camera);
        set(&mut settings.width, self.size.map(|(width, _)| width));
        set(&mut settings.height, self.size.map(|(_, height)| height));
        set(&mut settings.max_depth, self.depth);
        set(&mut settings.sampler, self.sampler);
        set(&mut settings.seed, self.seed);
        set(&mut camera.look_from, flags.look_from);
        set(&mut camera.look_at, flags.look_at);
        set(&mut camera.vup, flags.vup);
        set(&mut camera.vfov_degrees, flags.vfov);
        set(&mut camera.defocus_angle_degrees, flags.defocus_angle);
        camera.focus_distance = flags.focus_distance.or(camera.focus_distance);
    }
}

/// The samples of a picture.
#[derive(Debug, Args)]
#[command(next_help_heading = "Samples")]
pub(super) struct SampleFlags {
    /// Samples per pixel, 1 to 4294967296 [default: the scene's; unlimited with --time-limit or --noise-target]
    #[arg(long, value_name = "COUNT", value_parser = whole::<u64>(1..=SAMPLE_LIMIT))]
    pub samples: Option<u64>,
    /// Only samples A to B - 1, for `weekender merge` or to complete a picture that has the others
    #[arg(long, value_name = "A..B", value_parser = range(SAMPLE_LIMIT, "0..64"),
          conflicts_with = "samples")]
    pub sample_range: Option<Range<u64>>,
}

/// A recipe and, if it comes from one, its stage.
#[derive(Clone, Debug)]
pub(super) struct ChosenRecipe {
    pub recipe: Recipe,
    pub stage: Option<&'static Stage>,
}

/// The picture that the flags describe, and its validated job. Without --scene and --stage it comes from the film or
/// picture `saved`.
pub(super) fn picture(
    flags: &PictureFlags,
    samples: &SampleFlags,
    saved: Option<&Path>,
) -> Result<(ChosenRecipe, RenderJob)> {
    changed(find(flags, saved)?, flags, samples)
}

/// The recipe with the changes of the flags, and its validated job.
pub(super) fn changed(
    mut chosen: ChosenRecipe,
    flags: &PictureFlags,
    samples: &SampleFlags,
) -> Result<(ChosenRecipe, RenderJob)> {
    flags.change(&mut chosen.recipe);
    chosen.recipe.samples_per_pixel = samples.samples.unwrap_or(chosen.recipe.samples_per_pixel);
    let job = chosen.recipe.job()?;
    Ok((chosen, job))
}

/// The source that the flags name, before the changes of other flags.
pub(super) fn find(flags: &PictureFlags, saved: Option<&Path>) -> Result<ChosenRecipe> {
    match (&flags.stage, &flags.scene, saved) {
        (Some(id), _, _) => {
            let stage = Stage::find(&id.to_string_lossy())?;
            Ok(ChosenRecipe { recipe: stage.recipe(), stage: Some(stage) })
        }
        (None, Some(name), _) => Ok(ChosenRecipe { recipe: scene(name)?, stage: None }),
        (None, None, Some(path)) => {
            let saved = open(path)?;
            Ok(ChosenRecipe { stage: saved.stage(), recipe: saved.recipe })
        }
        (None, None, None) => Ok(ChosenRecipe { recipe: scene("three-spheres")?, stage: None }),
    }
}

/// The scene with this name or in this file.
pub(super) fn scene(name: impl AsRef<OsStr>) -> Result<Recipe> {
    match scene_file(Some(name.as_ref())) {
        Some(path) => Ok(file::load(path)?),
        None => Recipe::find(&name.as_ref().to_string_lossy()),
    }
}

/// The scene file that `--scene` names, if it is one: standard input, or a name with an extension or a directory.
pub(super) fn scene_file(scene: Option<&OsStr>) -> Option<&Path> {
    let path = Path::new(scene?);
    (path == Path::new(STANDARD) || path.extension().is_some() || path.components().count() > 1)
        .then_some(path)
}

/// The files that `--scene` names, which no output may replace.
pub(super) fn inputs(scene: Option<&OsStr>) -> Vec<PathBuf> {
    scene_file(scene).map(file::inputs).unwrap_or_default()
}
