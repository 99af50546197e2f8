//! The command line, parsed and validated.

mod animation;
mod backend;
mod bench;
mod direct;
mod paths;
mod render;
mod report;
mod sources;
mod values;
#[cfg(feature = "window")]
mod window;

pub use backend::BackendFlags;
pub use bench::{BenchOptions, BenchScene};
pub use direct::{CheckOptions, CompareOptions, StressOptions};
pub use paths::{check_outputs, check_paths};
#[cfg(feature = "window")]
pub use render::DrawWith;
pub use report::ReportOptions;
#[cfg(feature = "window")]
pub use window::WindowOptions;

use crate::batch::info::InfoOptions;
use crate::batch::merge::MergeOptions;
use crate::batch::{BatchOptions, FramesOptions};
use crate::film::checkpoint;
use crate::job::output::OutputFormat;
use crate::job::recipe::Recipe;
use crate::job::render::SAMPLE_LIMIT;
use crate::system::failure::{EXIT_CODES, Failure};
use crate::system::journal;
use crate::system::shell;
use anyhow::Result;
use clap::error::{ContextKind, ContextValue};
use clap::{ArgMatches, CommandFactory, FromArgMatches, Parser, Subcommand};
use render::RenderFlags;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// The action that the command line requests.
#[derive(Debug)]
pub enum Request {
    /// Print the version.
    Version,
    #[cfg(feature = "window")]
    Window(Box<WindowOptions>),
    /// List scenes, stages and devices.
    List,
    /// Write a scene file, whose recipe is valid, and render nothing.
    SaveScene(Box<Recipe>, PathBuf),
    Frames(Box<FramesOptions>),
    Batch(Box<BatchOptions>),
    Command(Command),
}

/// The path tracer of "Ray Tracing in One Weekend", as a viewer and a headless renderer.
#[derive(Debug, Parser)]
#[command(name = "weekender", version, disable_version_flag = true, args_conflicts_with_subcommands = true,
          override_usage = "weekender [OPTIONS] [FILE]\n       weekender <COMMAND> [OPTIONS]", after_help = EXIT_CODES)]
struct Raw {
    /// Print the version, commit and target
    #[arg(short = 'V', long = "version", id = "version")]
    _version: bool,
    /// Write a log of what the program does; RUST_LOG chooses what, such as warn,weekender=trace
    #[arg(long = "log", id = "log", value_name = "FILE.log", value_parser = values::file_ending(".log"), global = true)]
    _log: Option<PathBuf>,
    #[command(flatten)]
    _render: RenderFlags,
    #[command(subcommand)]
    _command: Option<Command>,
}

/// A command with its options, which have been checked.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Measure the speed of this machine, compared with a plain C program: tables and JSON
    ///
    /// Rows take turns, after an untimed warm-up. Medians are shown with minimum and maximum. Reading, preparing and
    /// writing are not timed. The C program is compiled with the compiler that CC names, or with cc.
    Bench(Box<BenchOptions>),
    /// Merge films of the same picture that hold different samples
    ///
    /// With --samples, films that are damaged or do not fit are left out, and what is missing is listed with the commands
    /// that render it; the exit code is then 1. It is 0 if nothing is missing, and 2 if nothing could be merged.
    Merge(MergeOptions),
    /// Show the metadata of a film, picture or scene file
    Info(InfoOptions),
    /// Tell whether two pictures are equal apart from noise, and where they differ
    ///
    /// The exit code is 0 if they are equal, 1 if they differ and 2 if they could not be compared.
    Compare(Box<CompareOptions>),
    /// Measure how the error falls with time, for scenes, backends and samplers, and write tables and plots
    Report(Box<ReportOptions>),
    /// Render stiff and extreme scenes and check the results, compared with the book's own arithmetic
    ///
    /// Each scene is rendered as it is and with 40 distant spheres, which switch the hierarchy on: by a CPU level that
    /// fuses multiply and add, by one that does not, in f64, and by the GPU if available. The exit code is 0 if all
    /// are right, 1 if one is wrong and 2 if nothing could be run.
    Stress(Box<StressOptions>),
    /// Find the mistake in a picture that your own program rendered
    ///
    /// Finds the stage of the book that the picture shows, and the mistake with what to change. The exit code is 0 if all
    /// pictures are right, 1 if there is a mistake, and otherwise 2 if one could not be checked.
    Check(Box<CheckOptions>),
}

/// All flags and subcommands with their help, from which manual pages and completions are made.
pub fn command() -> clap::Command {
    // A negative number is a wrong value of its flag, not an unknown flag.
    let negative = |arg: clap::Arg| {
        let takes_values = arg.get_action().takes_values();
        if takes_values { arg.allow_negative_numbers(true) } else { arg }
    };
    let samples = |arg: clap::Arg| arg.value_parser(values::whole::<u64>(1..=SAMPLE_LIMIT));
    let command = Raw::command().mut_subcommand("merge", |merge| merge.mut_arg("samples", samples));
    command.mut_args(negative).mut_subcommands(move |command| command.mut_args(negative))
}

/// Parses the command line and starts the log that it asks for. The first argument is the program's name.
///
/// # Errors
/// [`Failure::CommandLine`] or [`Failure::Input`]; nothing but the log has been written in either case.
pub fn parse(arguments: impl IntoIterator<Item = OsString>) -> Result<Request, Failure> {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let matches = matches(arguments.clone()).map_err(|error| Failure::CommandLine(hinted(error)))?;
    journal::start(matches.get_one::<PathBuf>("log").map(PathBuf::as_path)).map_err(Failure::Input)?;
    if matches.get_flag("version") {
        return Ok(Request::Version);
    }
    // The flags of a subcommand alone: reading `--device auto` asks the system for its GPUs.
    if matches.subcommand().is_none() {
        let flags = RenderFlags::from_arg_matches(&matches).map_err(Failure::CommandLine)?;
        let command = recorded(&arguments);
        let request = match flags.animation.is_given() && !flags.list {
            true => animation::frames(flags, command).map(|options| Request::Frames(Box::new(options))),
            false => request(flags, &matches, command),
        };
        return request.map_err(Failure::Input);
    }
    let mut command = Command::from_arg_matches(&matches).map_err(Failure::CommandLine)?;
    match &mut command {
        Command::Merge(options) => {
            (options.program, options.command) = (called(arguments.first()), recorded(&arguments));
            check_merge(options).map_err(Failure::Input)?;
        }
        Command::Report(options) => options.command = recorded(&arguments),
        _ => {}
    }
    Ok(Request::Command(command))
}

fn check_merge(MergeOptions { films, out, .. }: &MergeOptions) -> Result<()> {
    out.iter().try_for_each(|out| OutputFormat::from_path(out).map(drop))?;
    check_outputs(films.iter().map(PathBuf::as_path), out.iter().map(PathBuf::as_path))
}

/// Validates the flags without a subcommand. `command` is the command line.
fn request(mut flags: RenderFlags, matches: &ArgMatches, command: String) -> Result<Request> {
    let mut picture = None;
    match flags.open.take() {
        Some(path) if render::is_scene_file(&path) => flags.picture.scene = Some(path.into()),
        Some(path) if checkpoint::read_head(&path).is_ok() => flags.files.resume = Some(path),
        other => picture = other,
    }
    let files = &mut flags.files;
    let is_film = |film: &PathBuf| film.metadata().is_ok_and(|found| found.len() > 0);
    if files.go_on && files.checkpoint.as_ref().is_some_and(is_film) {
        files.resume.clone_from(&files.checkpoint);
    }
    match (flags.batch, &flags.files.save_scene) {
        _ if flags.list => Ok(Request::List),
        (true, _) => Ok(Request::Batch(Box::new(render::batch(flags, command)?))),
        (false, Some(path)) => {
            render::check_paths(&flags, &[])?;
            let saved = flags.files.resume.as_deref().or(picture.as_deref());
            let (chosen, _) = sources::picture(&flags.picture, &flags.samples, saved)?;
            Ok(Request::SaveScene(Box::new(chosen.recipe), path.clone()))
        }
        #[cfg(feature = "window")]
        (false, None) => Ok(Request::Window(Box::new(window::options(flags, picture, matches)?))),
        #[cfg(not(feature = "window"))]
        (false, None) => {
            let _ = matches;
            anyhow::bail!(
                "this build of Weekender has no window; add --batch to render to a file, for example: weekender --batch \
                 --stage glass-schlick --out glass.png; or build it with its window: cargo build --release"
            )
        }
    }
}

/// The arguments as clap reads them. A file in place of a command, as file managers pass it, opens in the window.
fn matches(mut arguments: Vec<OsString>) -> Result<ArgMatches, clap::Error> {
    let error = match command().try_get_matches_from(&arguments) {
        Ok(matches) => return Ok(matches),
        Err(error) => error,
    };
    // A word that is not UTF-8 is shown with replacements.
    let Some(unknown) = error.get(ContextKind::InvalidSubcommand).map(ToString::to_string) else {
        return Err(error);
    };
    let is_file = |word: &OsString| {
        let path = Path::new(word);
        word.to_string_lossy() == unknown && (path.extension().is_some() || path.is_file())
    };
    let Some(place) = arguments.iter().skip(1).position(is_file) else { return Err(error) };
    arguments.insert(place + 1, "--open".into());
    command().try_get_matches_from(arguments)
}

/// Adds a tip if a flag is one of another command, or if its value has a decimal comma, and replaces a long list of values.
fn hinted(mut error: clap::Error) -> clap::Error {
    if let (Some(ContextValue::String(flag)), clap::error::ErrorKind::UnknownArgument) =
        (error.get(ContextKind::InvalidArg).cloned(), error.kind())
    {
        let all = command();
        let has =
            |one: &clap::Command| one.get_arguments().any(|arg| arg.get_long() == flag.strip_prefix("--"));
        let named = |one: &clap::Command| format!("weekender {}", one.get_name());
        let own = has(&all).then(|| "weekender --batch".to_owned());
        let places: Vec<String> =
            own.into_iter().chain(all.get_subcommands().filter(|one| has(one)).map(named)).collect();
        if !places.is_empty() {
            let tip = format!("{flag} is a flag of {}", places.join(" and of "));
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
        }
    }
    let is_long = |values: &ContextValue| matches!(values, ContextValue::Strings(names) if names.len() > 9);
    if error.get(ContextKind::ValidValue).is_some_and(is_long) {
        error.remove(ContextKind::ValidValue);
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec!["--list shows all".into()]));
    }
    let value = error.get(ContextKind::InvalidValue).map(ToString::to_string).unwrap_or_default();
    let with_point = value.replacen(',', ".", 1);
    if value.contains(',') && with_point.parse::<f64>().is_ok() && !error.to_string().contains("commas") {
        let tip = format!("write a point: {with_point}");
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    error
}

/// How commands call this program: by name if the shell found it, otherwise with its directory.
fn called(first: Option<&OsString>) -> String {
    const NAME: &str = "weekender";
    let is_path = first.is_some_and(|first| Path::new(first).components().count() > 1);
    let path = if is_path { std::env::current_exe().ok() } else { None };
    path.and_then(|path| path.to_str().map(str::to_owned)).unwrap_or_else(|| NAME.to_owned())
}

/// The command line quoted for a shell, with file names instead of paths: pictures are shared, and the directories of
/// their authors are private.
fn recorded(arguments: &[OsString]) -> String {
    let shortened = |word: &OsString| {
        let (flag, value) = match word.to_str().and_then(|word| word.split_once('=')) {
            Some((flag, value)) if flag.starts_with("--") => (flag, OsStr::new(value)),
            _ => ("", word.as_os_str()),
        };
        let path = Path::new(value);
        let is_in_directory = path.parent().is_some_and(|at| !at.as_os_str().is_empty() && at.is_dir());
        match path.file_name().filter(|_| path.has_root() || is_in_directory) {
            Some(name) if flag.is_empty() => name.to_owned(),
            Some(name) => [OsStr::new(flag), "=".as_ref(), name].into_iter().collect(),
            None => word.clone(),
        }
    };
    shell::line(std::iter::once("weekender".into()).chain(arguments.iter().skip(1).map(shortened)))
}

#[cfg(test)]
pub(crate) mod tests;
