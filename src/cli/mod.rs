//! The command line, parsed and validated.

mod backend;
mod bench;
mod check;
mod companion;
mod compare;
mod diff;
mod error;
mod frames;
mod gallery;
mod merge;
mod paths;
mod plan;
mod raw;
mod render;
mod report;
mod sources;
mod stress;
mod subcommands;
mod typed;
mod unused;
mod values;

pub use bench::{BenchOptions, BenchScene};
pub use check::CheckOptions;
pub use companion::CompanionOptions;
pub use compare::{CompareOptions, CompareSide};
pub use diff::{DiffOptions, PathChoice};
pub use error::CliError;
pub use frames::FramesOptions;
pub use gallery::GalleryOptions;
pub use merge::{InfoOptions, MergeOptions, MergeSource};
pub use plan::{PartOptions, PlanFormat, PlanOptions, PlannedWork};
pub use raw::{DrawWith, ProgressChoice};
pub use render::CHECKPOINT_INTERVAL;
pub use render::{BatchOptions, RenderOptions, SaveSceneOptions, WindowOptions};
pub use report::{ReferenceChoice, ReportOptions};
pub use sources::DEFAULT_SCENE;
pub use stress::StressOptions;
pub use values::JsonTarget;

use crate::failure::Failure;
use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches};
use paths::Paths;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use subcommands::{Raw, RawCommand};

/// What the program is to do.
#[derive(Debug)]
pub enum Request {
    /// Print the version.
    Version {
        /// Also what the build and the machine are like.
        is_verbose: bool,
    },
    /// Open the window.
    Window(Box<WindowOptions>),
    /// Measure the speed.
    Bench(Box<BenchOptions>),
    /// List scenes, stages and devices.
    List,
    /// Write a scene file and render nothing.
    SaveScene(Box<SaveSceneOptions>),
    /// Divide a picture into parts.
    Plan(Box<PlanOptions>),
    /// Render a part.
    Part(Box<PartOptions>),
    /// Merge films.
    Merge(Box<MergeOptions>),
    /// Say what a file says about itself.
    Info(InfoOptions),
    /// Compare a path on two backends.
    Diff(Box<DiffOptions>),
    /// Compare two pictures.
    Compare(Box<CompareOptions>),
    /// Measure error against time.
    Report(Box<ReportOptions>),
    /// Render stiff scenes and check the results.
    Stress(Box<StressOptions>),
    /// Write the page that accompanies the book.
    Companion(Box<CompanionOptions>),
    /// Render the figures of the book.
    Gallery(Box<GalleryOptions>),
    /// Find the mistake in a picture.
    Check(Box<CheckOptions>),
    /// Render the frames of an animation.
    Frames(Box<FramesOptions>),
    /// Render to files.
    Batch(Box<BatchOptions>),
}

/// All flags and subcommands with their help, from which manual pages and completions are made.
pub fn command() -> clap::Command {
    Raw::command()
}

/// The file of `--log`, which is needed before the flags are validated. A command line that clap does not accept has
/// none; [`parse`] says what is wrong with it.
///
/// # Errors
/// If its name does not end in `.log`, or is that of another file of the command. Other names are refused so that a log
/// never replaces a picture.
pub fn log_file(arguments: impl IntoIterator<Item = OsString>) -> Result<Option<PathBuf>, Failure> {
    let Ok(matches) = command().try_get_matches_from(arguments) else { return Ok(None) };
    let log = Raw::from_arg_matches(&matches).ok().and_then(|raw| raw.log);
    if let Some(path) = &log {
        sources::check_ending("--log", path, "the log", ".log").map_err(Failure::input)?;
        let mut values = Vec::new();
        typed::find_values(&matches, "log", &mut values);
        values
            .iter()
            .fold(Paths::default(), |paths, value| {
                paths.read("another file of this command", Some(Path::new(value)))
            })
            .write("--log", Some(path))
            .check(&[])
            .map_err(Failure::input)?;
    }
    Ok(log)
}

/// Parses the command line; the first argument is the program's name.
///
/// # Errors
/// [`Failure::CommandLine`] or [`Failure::Input`]; nothing has been written in either case.
pub fn parse(arguments: impl IntoIterator<Item = OsString>) -> Result<Request, Failure> {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let program = called(arguments.first());
    let matches = command().try_get_matches_from(&arguments).map_err(|error| refused(error, &arguments))?;
    let typed = typed::without_directories(&arguments, &matches);
    let raw = Raw::from_arg_matches(&matches).map_err(Failure::CommandLine)?;
    if raw.version {
        return Ok(Request::Version { is_verbose: raw.verbose });
    }
    match raw.command {
        Some(RawCommand::Bench(raw)) => {
            raw.check().map(|options| Request::Bench(Box::new(options))).map_err(Failure::input)
        }
        Some(RawCommand::Plan(raw)) => plan::plan(*raw, &program, typed)
            .map(|options| Request::Plan(Box::new(options)))
            .map_err(Failure::input),
        Some(RawCommand::RenderPart(raw)) => {
            plan::part(*raw, typed).map(|options| Request::Part(Box::new(options))).map_err(Failure::input)
        }
        Some(RawCommand::Merge(raw)) => merge::merge(*raw, &program)
            .map(|options| Request::Merge(Box::new(options)))
            .map_err(Failure::input),
        Some(RawCommand::Info(raw)) => Ok(Request::Info(merge::info(raw))),
        Some(RawCommand::Diff(raw)) => {
            diff::diff(*raw).map(|options| Request::Diff(Box::new(options))).map_err(Failure::input)
        }
        Some(RawCommand::Compare(raw)) => {
            compare::compare(*raw).map(|options| Request::Compare(Box::new(options))).map_err(Failure::input)
        }
        Some(RawCommand::Report(raw)) => {
            raw.check(typed).map(|options| Request::Report(Box::new(options))).map_err(Failure::input)
        }
        Some(RawCommand::Stress(raw)) => {
            raw.check().map(|options| Request::Stress(Box::new(options))).map_err(Failure::input)
        }
        Some(RawCommand::Companion(raw)) => companion::companion(*raw)
            .map(|options| Request::Companion(Box::new(options)))
            .map_err(Failure::input),
        Some(RawCommand::Gallery(raw)) => {
            gallery::gallery(*raw).map(|options| Request::Gallery(Box::new(options))).map_err(Failure::input)
        }
        Some(RawCommand::Check(options)) => {
            options.checked().map(|options| Request::Check(Box::new(options))).map_err(Failure::input)
        }
        None if raw.render.list => Ok(Request::List),
        None => render::request(raw.render, typed).map_err(Failure::input),
    }
}

/// Why clap does not accept the command line. If it is because of a word that is not UTF-8, clap does not say which.
fn refused(error: clap::Error, arguments: &[OsString]) -> Failure {
    let strange = arguments.iter().skip(1).filter(|word| word.to_str().is_none());
    let words: Vec<String> = strange.map(|word| format!("{word:?}")).collect();
    if error.kind() == ErrorKind::InvalidUtf8 && !words.is_empty() {
        return Failure::input(CliError::NotUtf8 { words: words.join(", ") });
    }
    Failure::CommandLine(error)
}

/// How commands call this program: by its name if the shell has found it, otherwise with its directory.
fn called(first: Option<&OsString>) -> String {
    const NAME: &str = "weekender";
    let is_path = first.is_some_and(|first| Path::new(first).components().count() > 1);
    let path = if is_path { std::env::current_exe().ok() } else { None };
    path.and_then(|path| path.to_str().map(str::to_owned)).unwrap_or_else(|| NAME.to_owned())
}

#[cfg(test)]
mod tests;
