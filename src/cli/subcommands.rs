//! The whole command line as clap parses it: rendering, or a subcommand.

use super::bench::BenchOptions;
use super::check::CheckOptions;
use super::companion::RawCompanion;
use super::compare::RawCompare;
use super::diff::RawDiff;
use super::gallery::RawGallery;
use super::merge::{RawInfo, RawMerge};
use super::plan::{RawPart, RawPlan};
use super::raw::RawRender;
use super::report::ReportOptions;
use super::stress::StressOptions;
use crate::failure::EXIT_CODES;
use clap::{Parser, Subcommand};
use std::path::PathBuf;

/// The path tracer of "Ray Tracing in One Weekend", as a viewer and a headless renderer.
#[derive(Debug, Parser)]
#[command(name = "weekender", version, disable_version_flag = true, args_conflicts_with_subcommands = true,
          after_help = EXIT_CODES)]
pub(super) struct Raw {
    #[command(flatten)]
    pub render: RawRender,
    /// Print the version; with --verbose also commit, target, instruction level, adapters and version of film files
    #[arg(short = 'V', long)]
    pub version: bool,
    /// With --version: print everything that a report of a fault should say
    #[arg(long, requires = "version")]
    pub verbose: bool,
    /// Write a log of what the program does; RUST_LOG chooses what, such as warn,weekender=trace
    #[arg(long, value_name = "FILE.log", global = true)]
    pub log: Option<PathBuf>,
    #[command(subcommand)]
    pub command: Option<RawCommand>,
}

#[derive(Debug, Subcommand)]
pub(super) enum RawCommand {
    /// Measure the speed of this machine, compared with a plain C program: tables, JSON, a chart
    ///
    /// Rows take turns, after a warm-up that does not count. Medians are shown with minimum and maximum. Reading,
    /// preparing and writing are not timed. The C program is compiled with the compiler that CC names, or with cc.
    Bench(Box<BenchOptions>),
    /// Divide the samples of a picture, or the frames of an animation, into parts that many machines render, and make the
    /// commands for them
    ///
    /// Writes plan.json and the scene into the directory --out. A part's command can be repeated at any time: it continues
    /// from the part's last checkpoint or from the existing frames, and ends at once if the part is whole.
    Plan(Box<RawPlan>),
    /// Render a part of a plan, or continue it
    ///
    /// The part's film is its own checkpoint; frames are kept one by one. The exit code is 0 if the part is whole, 143 after
    /// SIGTERM (the checkpoint is written; run it again), 130 after Ctrl-C and 2 if the part cannot be rendered.
    RenderPart(Box<RawPart>),
    /// Merge films of the same picture that hold different samples, or the parts of a plan
    ///
    /// Given a plan, it adds up whatever exists, checkpoints of unfinished parts included; frames become an animated PNG
    /// once all of them exist. The exit code is 0 if nothing is missing, 1 if a part is missing, unfinished or damaged, and
    /// 2 if nothing could be merged.
    Merge(Box<RawMerge>),
    /// Say what a film, picture, scene file or plan says about itself
    Info(RawInfo),
    /// Show a path as two backends trace it, side by side, and where the paths part
    ///
    /// The exit code is 0 if the two agree, 1 if they differ and 2 if they could not be compared.
    Diff(Box<RawDiff>),
    /// Tell whether two pictures are equal apart from noise, and where they are not
    ///
    /// The exit code is 0 if they are equal, 1 if they differ and 2 if they could not be compared.
    Compare(Box<RawCompare>),
    /// Measure how the error falls with time, for scenes, backends and samplers, and write tables and plots
    ///
    /// Continues an interrupted report that has the same settings.
    Report(Box<ReportOptions>),
    /// Render stiff and extreme scenes and check the results, compared with the book's own arithmetic
    ///
    /// Each scene is rendered as it is and with 40 distant spheres, which switch the hierarchy on: by a CPU level that
    /// fuses multiply and add, by one that does not, in f64, and by the GPU, if there is one. The exit code is 0 if all
    /// are right, 1 if one is not and 2 if nothing could be run.
    Stress(Box<StressOptions>),
    /// Write the companion: a web page that goes through the book in pictures, in code and live
    ///
    /// The page is index.html in the directory --out, with its figures beside it. It needs no server and no network.
    /// Only figures that changed are rendered again.
    Companion(Box<RawCompanion>),
    /// Render every figure of the book, with a page that shows them
    ///
    /// Only pictures that are missing, damaged or changed are rendered. After Ctrl-C, the same command continues.
    Gallery(Box<RawGallery>),
    /// Find the mistake in a picture that your own program has rendered
    ///
    /// Finds the stage of the book that the picture shows, and the likeliest mistake with what to change. The exit code
    /// is 0 if the picture is right, 1 if there is a mistake and 2 if it could not be checked.
    Check(Box<CheckOptions>),
}
