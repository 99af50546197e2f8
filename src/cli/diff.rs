//! The flags of `weekender diff` and their validation.

use super::error::CliError;
use super::paths::Paths;
use super::raw::{self, RawPicture, RawSwitch};
use super::sources::{self, ChosenRecipe};
use super::values::{
    JsonTarget, Level, RawSide, parse_isa, parse_pixel, parse_sides, parse_tolerance, whole,
};
use crate::backends::BackendChoice;
use crate::job::render::{RenderJob, SAMPLE_LIMIT};
use crate::render_cpu::{CpuOptions, Isa};
use crate::render_gpu::GpuOptions;
use clap::Args;
use clap::builder::{PathBufValueParser, TypedValueParser};

#[derive(Debug, Args)]
pub(super) struct RawDiff {
    /// The pixel; 0,0 is the upper left one
    #[arg(long, value_name = "X,Y", value_parser = parse_pixel, required_unless_present = "find",
          conflicts_with = "find", help_heading = "Path")]
    pub pixel: Option<[u32; 2]>,
    /// Index of the sample, from 0
    #[arg(long, value_name = "NUMBER", value_parser = whole(0..=SAMPLE_LIMIT - 1, 7),
          allow_hyphen_values = true, default_value = "0", conflicts_with = "find", help_heading = "Path")]
    pub sample: u64,
    /// Search this many samples of every pixel for the one that differs most; without --size, the picture is at most
    /// 200 pixels wide
    #[arg(long, value_name = "SAMPLES", value_parser = whole(1..=SAMPLE_LIMIT, 100),
          num_args = 0..=1, default_missing_value = "4", help_heading = "Path")]
    pub find: Option<u64>,

    /// The two backends to compare: cpu (at the level --isa), portable (multiply and add rounded separately),
    /// reference (f64) or gpu
    #[arg(long, value_name = "A,B", value_parser = parse_sides, default_value = "cpu,gpu",
          help_heading = "Comparison")]
    pub sides: [RawSide; 2],
    /// Largest relative difference that does not count
    #[arg(long, value_name = "SHARE", value_parser = parse_tolerance, allow_hyphen_values = true,
          default_value = "1e-4", help_heading = "Comparison")]
    pub tolerance: f64,
    /// Use the GPU whose name, kind, backend or driver contains this; required for a software adapter
    #[arg(long, value_name = "SUBSTRING", help_heading = "Comparison")]
    pub adapter: Option<String>,
    /// Instruction level of the side cpu: auto, portable, sse4.2, avx2, avx512, neon
    #[arg(long, value_name = "LEVEL", value_parser = parse_isa, default_value = "auto",
          help_heading = "Comparison")]
    pub isa: Level,
    /// Write both paths and the verdict as JSON; - for standard output
    #[arg(long, value_name = "FILE|-", value_parser = PathBufValueParser::new().map(JsonTarget::from),
          help_heading = "Comparison")]
    pub json: Option<JsonTarget>,

    #[command(flatten)]
    pub picture: RawPicture,
    /// Whether samples are kept in two halves, as for rendering; it determines their random numbers
    /// [default: on, or the scene's]
    #[arg(long, value_enum, help_heading = "Picture")]
    pub estimate_error: Option<RawSwitch>,
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
pub(super) fn diff(raw: RawDiff) -> Result<DiffOptions, CliError> {
    if raw.picture.is_every_stage() {
        let reason = "only one path can be compared; choose one stage";
        return Err(CliError::Together { flag: "diff", other: "--stage all", reason });
    }
    for (flag, is_given, side, other) in [
        ("--adapter", raw.adapter.is_some(), RawSide::Gpu, "the side gpu in --sides"),
        ("--isa", raw.isa.0.is_some(), RawSide::Cpu, "the side cpu in --sides"),
    ] {
        if is_given && !raw.sides.contains(&side) {
            return Err(CliError::Needs {
                flag,
                other,
                reason: "it applies only to that side; otherwise leave it out",
            });
        }
    }
    Paths::default()
        .read("--scene", sources::scene_file(raw.picture.scene.as_deref()))
        .write_json(raw.json.as_ref())
        .check(&[])?;
    let ChosenRecipe { mut recipe, stage } = sources::find(&raw.picture, None)?;
    raw::change(&mut recipe, &raw.picture, raw.estimate_error);
    if raw.find.is_some() {
        sources::narrow(&mut recipe, &raw.picture, FIND_WIDTH);
    }
    let (width, height) = (recipe.settings.width, recipe.settings.height);
    let path = match (raw.find, raw.pixel) {
        (Some(samples), _) => PathChoice::Find { samples },
        (None, pixel) => {
            let [x, y] = pixel.unwrap_or_default();
            if x >= width || y >= height {
                return Err(CliError::Pixel { x, y, width, height });
            }
            PathChoice::Given { pixel: [x, y], sample: raw.sample }
        }
    };
    let cpu = |isa| BackendChoice::Cpu(CpuOptions { isa, ..CpuOptions::default() });
    let sides = raw.sides.map(|side| match side {
        RawSide::Cpu => cpu(raw.isa.0),
        RawSide::Portable => cpu(Some(Isa::Portable)),
        RawSide::Reference => BackendChoice::Reference { threads: None },
        RawSide::Gpu => BackendChoice::Gpu(GpuOptions::of_adapter(raw.adapter.as_deref())),
    });
    let job = recipe.job()?;
    job.check_memory(2)?;
    Ok(DiffOptions {
        scene: stage.map_or(recipe.name.clone(), |stage| stage.id.to_owned()),
        job,
        path,
        sides,
        tolerance: raw.tolerance,
        json: raw.json,
    })
}
