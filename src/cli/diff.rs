//! The flags of `weekender diff` and their validation.

use super::raw::{self, RawPicture};
use super::sources::{self, ChosenRecipe};
use super::values::{JsonTarget, backend_named, parse_pixel, parse_tolerance, whole};
use crate::backends::BackendChoice;
use crate::job::render::{RenderJob, SAMPLE_LIMIT};
use anyhow::{Result, bail, ensure};
use clap::Args;

#[derive(Debug, Args)]
#[command(next_help_heading = "Comparison")]
pub(super) struct RawDiff {
    /// The pixel; 0,0 is the upper left one
    #[arg(long, value_name = "X,Y", value_parser = parse_pixel, required_unless_present = "find", conflicts_with = "find")]
    pixel: Option<[u32; 2]>,
    /// Index of the sample, from 0
    #[arg(long, value_name = "NUMBER", value_parser = whole(0..=SAMPLE_LIMIT - 1, 7), default_value = "0",
          conflicts_with = "find")]
    sample: u64,
    /// Search this many samples of every pixel for the one that differs most; without --size, the picture is at most
    /// 200 pixels wide
    #[arg(long, value_name = "SAMPLES", value_parser = whole(1..=SAMPLE_LIMIT, 100), num_args = 0..=1,
          default_missing_value = "4")]
    find: Option<u64>,
    /// The two backends to compare: cpu, portable (multiply and add rounded separately), reference (f64) or gpu
    #[arg(long, value_name = "A,B", value_delimiter = ',', default_value = "cpu,gpu")]
    sides: Vec<String>,
    /// Largest relative difference that does not count
    #[arg(long, value_name = "SHARE", value_parser = parse_tolerance, default_value = "1e-4")]
    tolerance: f64,
    /// Use the GPU whose name, kind, backend or driver contains this; required for a software adapter
    #[arg(long, value_name = "SUBSTRING")]
    adapter: Option<String>,
    /// Write both paths and the verdict as JSON; - for standard output
    #[arg(long, value_name = "FILE|-")]
    json: Option<JsonTarget>,
    #[command(flatten)]
    picture: RawPicture,
}

/// Options of `weekender diff`.
#[derive(Clone, Debug)]
pub struct DiffOptions {
    pub scene: String,
    /// The job; for a search, it is small unless a size is given.
    pub job: RenderJob,
    pub path: PathChoice,
    pub sides: [BackendChoice; 2],
    /// Largest relative difference that does not count.
    pub tolerance: f64,
    pub json: Option<JsonTarget>,
}

/// How the path is chosen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PathChoice {
    Given {
        /// Column and row, inside the picture.
        pixel: [u32; 2],
        sample: u64,
    },
    /// The path that differs most among samples `0 .. samples` of all pixels.
    Find { samples: u64 },
}

/// Largest width of a picture that is searched if no size is given, pixels.
const FIND_WIDTH: u32 = 200;

/// Validates the flags of `weekender diff`.
pub(super) fn diff(raw: RawDiff) -> Result<DiffOptions> {
    let sides = sides(&raw)?;
    let scene_file = sources::scene_file(raw.picture.scene.as_deref());
    let json_file = raw.json.as_ref().and_then(JsonTarget::file);
    super::check_paths(&[("--scene", scene_file)], &[("--json", json_file)])?;
    let ChosenRecipe { mut recipe, stage } = sources::find(&raw.picture, None)?;
    raw::change(&mut recipe, &raw.picture, None);
    if raw.find.is_some() && raw.picture.size.is_none() && recipe.settings.width > FIND_WIDTH {
        sources::scale(&mut recipe.settings, FIND_WIDTH);
    }
    let (width, height) = (recipe.settings.width, recipe.settings.height);
    let path = match (raw.find, raw.pixel.unwrap_or_default()) {
        (Some(samples), _) => PathChoice::Find { samples },
        (None, [x, y]) if x >= width || y >= height => bail!(
            "--pixel is {x},{y}, but the picture has {width}x{height} pixels: the last one is {},{}",
            width - 1,
            height - 1
        ),
        (None, pixel) => PathChoice::Given { pixel, sample: raw.sample },
    };
    let job = recipe.job()?;
    job.check_memory(2)?;
    let scene = stage.map_or(recipe.name, |stage| stage.id.to_owned());
    Ok(DiffOptions { scene, job, path, sides, tolerance: raw.tolerance, json: raw.json })
}

fn sides(raw: &RawDiff) -> Result<[BackendChoice; 2]> {
    ensure!(
        raw.adapter.is_none() || raw.sides.iter().any(|name| name == "gpu"),
        "--adapter needs the side gpu in --sides: it applies only to that side; otherwise leave it out"
    );
    let [a, b] = raw.sides.as_slice() else {
        bail!("--sides must be two of {} separated by a comma", BackendChoice::NAMES.join(", "))
    };
    let side = |name: &str| backend_named(name, raw.adapter.as_deref());
    Ok([side(a)?, side(b)?])
}
