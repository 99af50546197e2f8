//! The program: parse, run, exit code.

#![warn(clippy::disallowed_macros)]

use std::process::ExitCode;
use weekender::cli::{self, Request};
use weekender::failure::{self, Failure};
use weekender::{
    app, batch, bench, check, companion, compare, diff, gallery, info, interrupt, merge, report, stress,
};

fn main() -> ExitCode {
    failure::install_panic_hook();
    interrupt::survive_file_size_limit();
    run().unwrap_or_else(|failure| failure.report())
}

fn run() -> Result<ExitCode, Failure> {
    match cli::parse(std::env::args_os())? {
        Request::Window(options) => app::run(*options).map_err(Failure::Input),
        Request::Bench(options) => bench::run(&options),
        Request::List => batch::list(),
        Request::SaveScene(options) => batch::save_scene(&options),
        Request::Plan(options) => batch::plan(&options),
        Request::Part(options) => batch::render_part(*options),
        Request::Merge(options) => merge::run(&options),
        Request::Info(options) => info::run(&options),
        Request::Diff(options) => diff::run(&options),
        Request::Compare(options) => compare::run(&options),
        Request::Report(options) => report::run(&options),
        Request::Stress(options) => stress::run(&options),
        Request::Companion(options) => companion::run(&options),
        Request::Gallery(options) => gallery::run(&options),
        Request::Check(options) => check::run(&options),
        Request::Batch(options) => batch::run(*options),
    }
}
