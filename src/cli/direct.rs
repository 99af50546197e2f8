//! Commands whose flags are their options: check, compare and stress.

use super::sources::Names;
use super::values::{Auto, parse_levels};
use crate::job::output::Encoding;
use crate::render_cpu::Isa;
use crate::stages::{Stage, Transfer};
use crate::system::terminal::ProgressChoice;
use clap::builder::{PossibleValue, TypedValueParser};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Options of `weekender check`.
#[derive(Clone, Debug, Args)]
pub struct CheckOptions {
    /// The pictures that your own program wrote: PPM (P3 or P6) or PNG, of any shape, from 16 x 9 to 4 million pixels;
    /// for several, one line each
    #[arg(required = true, num_args = 1.., value_name = "PICTURE")]
    pub pictures: Vec<PathBuf>,
    /// The stage of the book that they show, by name or section [default: the one that each looks like]
    #[arg(long, value_name = "STAGE", value_parser = Names::of_stages().try_map(|id| Stage::find(&id.to_string_lossy())))]
    pub stage: Option<&'static Stage>,
    /// Check again after each change, even while the picture is being written, until Ctrl-C
    #[arg(long, conflicts_with = "out")]
    pub watch: bool,
    /// Write mine.png, ours.png and difference.png of a single picture to this directory
    #[arg(long, value_name = "DIRECTORY")]
    pub out: Option<PathBuf>,
    /// Write the finding as JSON; with --watch or several pictures, one line each; - for standard output
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
    /// Show on standard error what is being tried; auto: if it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
}

impl CheckOptions {
    /// The files of `--out`: mine, ours and their difference.
    pub fn outputs(&self) -> Vec<PathBuf> {
        let names = ["mine.png", "ours.png", "difference.png"];
        self.out.iter().flat_map(|out| names.map(|name| out.join(name))).collect()
    }
}

/// Options of `weekender compare`.
#[derive(Clone, Debug, Args)]
pub struct CompareOptions {
    /// A film or picture (.exr, .pfm, .png, .ppm) of any program; FILE:LAYER chooses a layer of an EXR
    #[arg(value_name = "FIRST")]
    pub first: PathBuf,
    /// Like the first
    #[arg(value_name = "SECOND")]
    pub second: PathBuf,
    /// Meaning of integer values in pictures of other programs: square root as in the book, linear, or sRGB
    /// [default: what a PNG says, otherwise gamma2]
    #[arg(long, value_enum)]
    pub encoding: Option<Encoding>,
    /// Write the figures as JSON; - for standard output
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
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
            Encoding::Gamma(_) => return None,
        }))
    }
}

/// Options of `weekender stress`.
#[derive(Clone, Debug, Args)]
pub struct StressOptions {
    /// Run only cases whose id contains this, such as copies or moved/1e5
    #[arg(long, value_name = "TEXT", default_value = "", hide_default_value = true)]
    pub filter: String,
    /// Instruction levels, separated by commas; auto: the best with and the best without fused multiply-add; all: every
    /// one that this processor supports
    #[arg(long, value_name = "LEVEL,...", value_parser = parse_levels, default_value = "auto")]
    isa: Auto<Vec<Isa>>,
    /// Use the GPU whose name, kind, backend or driver contains this; required for a software adapter [default: the
    /// best available]
    #[arg(long, value_name = "SUBSTRING")]
    pub adapter: Option<String>,
    /// Write all figures as JSON; - for standard output
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
    /// Show progress on standard error; auto: if it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
}

impl StressOptions {
    /// Instruction levels of the CPU.
    pub fn levels(&self) -> Vec<Isa> {
        let available = Isa::available();
        let best = |is_fused: bool| available.iter().copied().rfind(|isa| isa.is_fused() == is_fused);
        self.isa.clone().unwrap_or_else(|| best(true).into_iter().chain(best(false)).collect())
    }
}
