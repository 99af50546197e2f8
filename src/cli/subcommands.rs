//! The whole command line as it is typed: rendering, or a subcommand.

use super::bench::RawBench;
use super::compare::RawCompare;
use super::diff::RawDiff;
use super::raw::RawRender;
use super::report::RawReport;
use super::stress::RawStress;
use crate::failure::EXIT_CODES;
use clap::{Parser, Subcommand};
use std::path::PathBuf;

/// The path tracer of "Ray Tracing in One Weekend", as a viewer and a headless renderer.
#[derive(Debug, Parser)]
#[command(name = "weekender", version, args_conflicts_with_subcommands = true, after_help = EXIT_CODES)]
pub(super) struct Raw {
    #[command(flatten)]
    pub render: RawRender,
    #[command(subcommand)]
    pub command: Option<RawCommand>,
}

#[derive(Debug, Subcommand)]
pub(super) enum RawCommand {
    /// Measure how fast this machine renders, beside a plain C program: tables, JSON, a chart
    ///
    /// Rows take turns, after a warm-up that is not counted. Medians are shown with the least and the most. Reading,
    /// preparing and writing are in no figure. The C program is compiled by the compiler that CC names, or cc.
    Bench(Box<RawBench>),
    /// Add film files of one picture that hold different samples
    Merge {
        /// Film files (.exr), as --checkpoint, --out and merge write them
        #[arg(required = true, num_args = 1.., value_name = "FILM")]
        films: Vec<PathBuf>,
        /// Where the sum goes: .exr for the film, .png or .ppm for the picture
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
    },
    /// Show one path as two backends trace it, side by side, and where they part
    ///
    /// The exit code is 0 where the two agree, 1 where they differ and 2 where they could not be compared.
    Diff(Box<RawDiff>),
    /// Say whether two pictures are the same but for their noise, and where they are not
    ///
    /// The exit code is 0 where they are equal, 1 where they differ and 2 where they could not be compared.
    Compare(Box<RawCompare>),
    /// Measure how the error falls with time, for scenes, backends and samplers, and write tables and plots
    ///
    /// Goes on where an interrupted report of the same settings ended.
    Report(Box<RawReport>),
    /// Render stiff and extreme scenes and say whether each is right: a table beside the book's own arithmetic
    ///
    /// Each scene is rendered as it is and with 40 distant spheres, which switch the hierarchy on, by a CPU level
    /// that fuses multiply and add, by one that does not, in f64, and by the GPU that there is. The exit code is 0
    /// where all are right, 1 where one is not and 2 where nothing could be run.
    Stress(Box<RawStress>),
}
