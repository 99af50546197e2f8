//! The command line: what was typed, checked, as options that can be carried out.

mod bench;
mod options;
mod raw;
mod sources;
mod values;

pub use bench::{BenchOptions, BenchScene};
pub use options::{
    BatchOptions, DiffOptions, JsonTarget, MergeOptions, PathChoice, RenderOptions, SaveSceneOptions,
    SideChoice, WindowOptions,
};
pub use raw::ProgressChoice;
pub use sources::CliError;

use crate::failure::Failure;
use clap::Parser;
use raw::{Raw, RawCommand};
use std::ffi::OsString;

/// What the program is asked to do.
#[derive(Debug)]
pub enum Request {
    /// Open the window.
    Window(Box<WindowOptions>),
    /// Measure speed.
    Bench(Box<BenchOptions>),
    /// List scenes, stages and devices.
    List,
    /// Write a scene file and render nothing.
    SaveScene(Box<SaveSceneOptions>),
    /// Add films.
    Merge(MergeOptions),
    /// Compare a path.
    Diff(Box<DiffOptions>),
    /// Render to files.
    Batch(Box<BatchOptions>),
}

/// Reads the command line; the first argument is the program's name.
///
/// # Errors
/// [`Failure::CommandLine`] or [`Failure::Input`]; nothing has been written then.
pub fn parse(arguments: impl IntoIterator<Item = OsString>) -> Result<Request, Failure> {
    let raw = Raw::try_parse_from(arguments).map_err(Failure::CommandLine)?;
    match raw.command {
        Some(RawCommand::Bench(raw)) => {
            bench::bench(*raw).map(|options| Request::Bench(Box::new(options))).map_err(Failure::input)
        }
        Some(RawCommand::Merge { films, out }) => Ok(Request::Merge(MergeOptions { films, out })),
        Some(RawCommand::Diff(raw)) => {
            options::diff(*raw).map(|options| Request::Diff(Box::new(options))).map_err(Failure::input)
        }
        None if raw.render.list => Ok(Request::List),
        None => options::request(raw.render).map_err(Failure::input),
    }
}
