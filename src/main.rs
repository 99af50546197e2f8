//! The program: parse, run, exit code.

#![warn(clippy::disallowed_macros)]

use std::process::ExitCode;
use weekender::batch::{self, info, merge};
use weekender::cli::{self, Command, Request};
use weekender::comparison::{check, compare};
use weekender::system::failure::Failure;
use weekender::system::{interrupt, journal, terminal};

/// Here, and not in the library, so that a commit does not compile the library again.
#[cfg(has_repository)]
const COMMIT: &str = git_version::git_version!(
    args = ["--always", "--dirty=+", "--abbrev=12", "--exclude=*"],
    fallback = "commit unknown"
);
#[cfg(not(has_repository))]
const COMMIT: &str = "commit unknown";

/// Version, commit (with a `+` if files were changed) and target.
fn build() -> String {
    let target = current_platform::CURRENT_PLATFORM;
    format!("weekender {} ({COMMIT}, {target})", env!("CARGO_PKG_VERSION"))
}

fn main() -> ExitCode {
    interrupt::survive_file_size_limit();
    journal::watched(build(), || run().unwrap_or_else(|failure| failure.report()))
}

fn run() -> Result<ExitCode, Failure> {
    match cli::parse(wild::args_os())? {
        Request::Version => {
            terminal::print(&(build() + "\n")).map(|()| ExitCode::SUCCESS).map_err(Failure::Run)
        }
        #[cfg(feature = "window")]
        Request::Window(options) => weekender::app::run(*options).map_err(Failure::Input),
        Request::List => batch::list(),
        Request::SaveScene(recipe, path) => batch::save_scene(&recipe, &path),
        Request::Frames(options) => batch::render_frames(*options),
        Request::Batch(options) => batch::run(*options),
        Request::Command(Command::Merge(options)) => merge::run(&options),
        Request::Command(Command::Info(options)) => info::run(&options),
        Request::Command(Command::Compare(options)) => compare::run(&options).map_err(Failure::Input),
        Request::Command(Command::Check(options)) => check::run(&options).map_err(Failure::Input),
        Request::Command(tool) => run_tool(tool),
    }
}

/// Measurements, which a program inside a page leaves out.
#[cfg(not(target_family = "wasm"))]
fn run_tool(tool: Command) -> Result<ExitCode, Failure> {
    use weekender::measure::{bench, report, stress};
    match tool {
        Command::Bench(options) => bench::run(&options),
        Command::Report(options) => report::run(&options),
        Command::Stress(options) => stress::run(&options),
        _ => unreachable!("run() has the others"),
    }
}

#[cfg(target_family = "wasm")]
fn run_tool(_: Command) -> Result<ExitCode, Failure> {
    Err(Failure::Input(anyhow::anyhow!("the program for browsers does not measure")))
}
