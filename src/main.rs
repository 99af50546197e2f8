//! The program: parse, run, exit code.

#![warn(clippy::disallowed_macros)]

use std::process::ExitCode;
use weekender::batch::{self, info, merge};
use weekender::cli::{self, Command, Request, terminal};
use weekender::comparison::{check, compare, diff};
use weekender::system::failure::Failure;
use weekender::system::{interrupt, journal};

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
    journal::start(cli::log_file(wild::args_os()).as_deref()).map_err(Failure::input)?;
    log::info!("{}", build());
    match cli::parse(wild::args_os())? {
        Request::Version => {
            terminal::print(&(build() + "\n")).map(|()| ExitCode::SUCCESS).map_err(Failure::Run)
        }
        #[cfg(feature = "window")]
        Request::Window(options) => weekender::app::run(*options).map_err(Failure::Input),
        #[cfg(not(feature = "window"))]
        Request::Window(_) => Err(Failure::Input(anyhow::anyhow!(
            "this build of Weekender has no window; add --batch to render to a file, for example: weekender --batch \
             --stage glass-schlick --out glass.png; or build it with its window: cargo build --release"
        ))),
        Request::List => batch::list(),
        Request::SaveScene(recipe, path) => batch::save_scene(&recipe, &path),
        Request::Frames(options) => batch::render_frames(*options),
        Request::Batch(options) => batch::run(*options),
        Request::Command(command) => match command {
            Command::Merge(options) => merge::run(&options),
            Command::Info(options) => info::run(&options),
            Command::Diff(options) => diff::run(&options).map_err(Failure::Input),
            Command::Compare(options) => compare::run(&options).map_err(Failure::Input),
            Command::Check(options) => check::run(&options).map_err(Failure::Input),
            command => run_tool(command),
        },
    }
}

/// Measurements, which a program inside a page leaves out.
#[cfg(not(target_family = "wasm"))]
fn run_tool(command: Command) -> Result<ExitCode, Failure> {
    use weekender::measure::{bench, report, stress};
    match command {
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
