//! The flags of `weekender compare` and their validation.

use super::error::CliError;
use super::paths::Paths;
use super::raw::{self, RawPicture};
use super::sources::{self, ChosenRecipe};
use super::values::{JsonTarget, whole};
use crate::backends::BackendChoice;
use crate::job::output::Encoding;
use crate::job::recipe::Recipe;
use crate::job::render::SAMPLE_LIMIT;
use crate::stages::Transfer;
use clap::builder::{PathBufValueParser, PossibleValue, TypedValueParser};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct RawCompare {
    /// A film or picture (.exr, .pfm, .png, .ppm) of any program, or the backend that renders it now: cpu, scalar,
    /// portable (multiply and add rounded separately), reference (f64) or gpu
    #[arg(value_name = "FIRST")]
    pub first: String,
    /// Like the first; compared with a film, a backend renders the same samples, with a picture, the same size
    #[arg(value_name = "SECOND")]
    pub second: String,

    /// Samples per pixel to render, 1 to 4294967296 [default: the film's, or 64]
    #[arg(long, alias = "spp", value_name = "COUNT", value_parser = whole(1..=SAMPLE_LIMIT, 100),
          allow_hyphen_values = true, help_heading = "Comparison")]
    pub samples: Option<u64>,
    /// Meaning of integer values in pictures of other programs: square root as in the book, linear, or sRGB
    #[arg(long, value_enum, default_value = "gamma2", help_heading = "Comparison")]
    pub encoding: Encoding,
    /// Use the GPU whose name, kind, backend or driver contains this; required for a software adapter
    #[arg(long, value_name = "SUBSTRING", help_heading = "Comparison")]
    pub adapter: Option<String>,
    /// Write the differences as a picture, from dark (1e-4) to bright (1), with frames around the worst blocks
    #[arg(long, value_name = "FILE.png", help_heading = "Comparison")]
    pub heat_map: Option<PathBuf>,
    /// Write the figures as JSON; - for standard output
    #[arg(long, value_name = "FILE|-", value_parser = PathBufValueParser::new().map(JsonTarget::from),
          help_heading = "Comparison")]
    pub json: Option<JsonTarget>,

    #[command(flatten)]
    pub picture: RawPicture,
}

impl ValueEnum for Encoding {
    fn value_variants<'a>() -> &'a [Self] {
        &[Encoding::Book(Transfer::Gamma2), Encoding::Book(Transfer::Linear), Encoding::Srgb]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(match self {
            Encoding::Book(Transfer::Linear) => "linear",
            Encoding::Book(_) => "gamma2",
            Encoding::Srgb => "srgb",
        }))
    }
}

/// Options of `weekender compare`.
#[derive(Clone, Debug)]
pub struct CompareOptions {
    pub sides: [CompareSide; 2],
    /// What backends render: set by the flags, otherwise by the file on the other side, at that file's size.
    pub recipe: Recipe,
    pub samples: Option<u64>,
    pub encoding: Encoding,
    pub heat_map: Option<PathBuf>,
    pub json: Option<JsonTarget>,
}

/// A picture to compare.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CompareSide {
    File(PathBuf),
    /// A backend that renders it.
    Backend {
        /// One of [`BackendChoice::NAMES`].
        name: String,
        choice: BackendChoice,
    },
}

/// Samples per pixel if none are given.
const COMPARE_SAMPLES: u64 = 64;

/// Largest width of pictures rendered for a comparison if no size is given, pixels.
const COMPARE_WIDTH: u32 = 400;

/// Validates the flags of `weekender compare`.
pub(super) fn compare(raw: RawCompare) -> Result<CompareOptions, CliError> {
    if raw.picture.is_every_stage() {
        let reason = "only two pictures can be compared; choose one stage";
        return Err(CliError::Together { flag: "compare", other: "--stage all", reason });
    }
    if let Some(path) = &raw.heat_map {
        sources::check_ending("--heat-map", path, "a map of differences", ".png")?;
    }
    let adapter = raw.adapter.as_deref();
    let side = |name: String| match BackendChoice::named(&name, adapter) {
        Some(choice) => CompareSide::Backend { name, choice },
        None => CompareSide::File(PathBuf::from(name)),
    };
    let is_gpu = [&raw.first, &raw.second].into_iter().any(|name| name == "gpu");
    if adapter.is_some() && !is_gpu {
        let reason = "it chooses among GPUs; otherwise leave it out";
        return Err(CliError::Needs { flag: "--adapter", other: "gpu as a side", reason });
    }
    let sides = [side(raw.first), side(raw.second)];
    let read = |paths: Paths, side: &CompareSide| match side {
        CompareSide::File(path) => paths.read("a picture of the comparison", Some(path)),
        CompareSide::Backend { .. } => paths,
    };
    sides
        .iter()
        .fold(Paths::default(), read)
        .read("--scene", sources::scene_file(raw.picture.scene.as_deref()))
        .write("--heat-map", raw.heat_map.as_deref())
        .write_json(raw.json.as_ref())
        .check(&[])?;
    // Pictures of other programs do not say what they show.
    let from_file = sides.iter().find_map(|side| match side {
        CompareSide::File(path) => sources::find(&raw.picture, Some(path)).ok(),
        CompareSide::Backend { .. } => None,
    });
    let ChosenRecipe { mut recipe, .. } = match from_file {
        Some(chosen) => chosen,
        None => sources::find(&raw.picture, None)?,
    };
    raw::change(&mut recipe, &raw.picture, None);
    sources::narrow(&mut recipe, &raw.picture, COMPARE_WIDTH);
    recipe.samples_per_pixel = COMPARE_SAMPLES;
    recipe.job()?;
    Ok(CompareOptions {
        sides,
        recipe,
        samples: raw.samples,
        encoding: raw.encoding,
        heat_map: raw.heat_map,
        json: raw.json,
    })
}
