//! The flags of `weekender compare` and their validation.

use super::raw::{self, RawPicture};
use super::sources::{self, ChosenRecipe};
use super::values::{JsonTarget, file_ending, whole};
use super::{NamedPath, check_paths};
use crate::backends::BackendChoice;
use crate::job::output::Encoding;
use crate::job::recipe::Recipe;
use crate::job::render::SAMPLE_LIMIT;
use crate::stages::Transfer;
use anyhow::{Result, ensure};
use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(next_help_heading = "Comparison")]
pub(super) struct RawCompare {
    /// A film or picture (.exr, .pfm, .png, .ppm) of any program, or the backend that renders it now: cpu, scalar,
    /// portable (multiply and add rounded separately), reference (f64) or gpu
    #[arg(value_name = "FIRST")]
    first: String,
    /// Like the first; compared with a film, a backend renders the same samples, with a picture, the same size
    #[arg(value_name = "SECOND")]
    second: String,
    /// Samples per pixel to render, 1 to 4294967296 [default: the film's, or 64]
    #[arg(long, alias = "spp", value_name = "COUNT", value_parser = whole(1..=SAMPLE_LIMIT, 100))]
    samples: Option<u64>,
    /// Meaning of integer values in pictures of other programs: square root as in the book, linear, or sRGB
    #[arg(long, value_enum, default_value = "gamma2")]
    encoding: Encoding,
    /// Use the GPU whose name, kind, backend or driver contains this; required for a software adapter
    #[arg(long, value_name = "SUBSTRING")]
    adapter: Option<String>,
    /// Write the differences as a picture, from dark (1e-4) to bright (1), with frames around the worst blocks
    #[arg(long, value_name = "FILE.png", value_parser = file_ending(".png"))]
    heat_map: Option<PathBuf>,
    /// Write the figures as JSON; - for standard output
    #[arg(long, value_name = "FILE|-")]
    json: Option<JsonTarget>,
    #[command(flatten)]
    picture: RawPicture,
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
pub(super) fn compare(raw: RawCompare) -> Result<CompareOptions> {
    let RawCompare { first, second, samples, encoding, adapter, heat_map, json, picture } = raw;
    ensure!(
        adapter.is_none() || first == "gpu" || second == "gpu",
        "--adapter needs gpu as a side: it chooses among GPUs; otherwise leave it out"
    );
    let sides = [first, second].map(|name| match BackendChoice::named(&name, adapter.as_deref()) {
        Some(choice) => CompareSide::Backend { name, choice },
        None => CompareSide::File(PathBuf::from(name)),
    });
    let files = sides.each_ref().map(|side| match side {
        CompareSide::File(path) => Some(path.as_path()),
        CompareSide::Backend { .. } => None,
    });
    let mut inputs: Vec<NamedPath> = files.map(|file| ("a picture of the comparison", file)).to_vec();
    inputs.push(("--scene", sources::scene_file(picture.scene.as_deref())));
    let json_file = json.as_ref().and_then(JsonTarget::file);
    check_paths(&inputs, &[("--heat-map", heat_map.as_deref()), ("--json", json_file)])?;
    // Pictures of other programs do not say what they show.
    let from_file = files.into_iter().flatten().find_map(|file| sources::find(&picture, Some(file)).ok());
    let ChosenRecipe { mut recipe, .. } = from_file.map_or_else(|| sources::find(&picture, None), Ok)?;
    raw::change(&mut recipe, &picture, None);
    sources::narrow(&mut recipe, &picture, COMPARE_WIDTH);
    recipe.samples_per_pixel = COMPARE_SAMPLES;
    recipe.job()?;
    Ok(CompareOptions { sides, recipe, samples, encoding, heat_map, json })
}
