//! `weekender stress`: renders extreme scenes on every backend and checks the results.
//!
//! Each case derives its expected result in a sentence: a closed form (a white world is 1, a closed room 0, a convex
//! ball of albedo 0.5 under a sky of 1 is 0.5), another scene that must give the same samples, or the `f64` reference
//! where `f64` has digits to spare. The window shows the cases worth looking at.

mod case;
mod judge;
mod report;

pub use case::{Case, Claim, Expected, Family, cases, moved, shown_cases, with_far_spheres};
pub use judge::{Difference, Level, Verdict};
pub use report::{CaseReport, Measured, Suite, by_the_book, trace};

use super::machine::Machine;
use super::progress::Progress;
use super::{Candidate, write_json};
use crate::backends::BackendChoice;
use crate::cli::StressOptions;
use crate::render_cpu::{CpuOptions, Isa};
use crate::system::failure::Failure;
use crate::system::files::check_writable;
use crate::system::interrupt::Interrupt;
use crate::system::terminal::print_beside;
use anyhow::{Result, anyhow};
use report::StressReport;
use std::process::ExitCode;
use std::time::Instant;

/// Runs the suite, prints the table and writes the files. [`Failure::Input`] if nothing was run; [`Failure::Run`]
/// otherwise.
pub fn run(options: &StressOptions) -> Result<ExitCode, Failure> {
    options.json.as_deref().map_or(Ok(()), check_writable).map_err(Failure::input)?;
    let chosen: Vec<&Case> = cases().iter().filter(|case| case.id.contains(&options.filter)).collect();
    if chosen.is_empty() {
        let ids: Vec<&str> = case::families().iter().map(|family| family.id.as_str()).collect();
        let error =
            anyhow!("no case id contains {:?}; use one of the families {}", options.filter, ids.join(", "));
        return Err(Failure::Input(error));
    }
    let tracers = tracers(&options.levels(), options.adapter.as_deref()).map_err(Failure::Input)?;
    let interrupt = Interrupt::install().map_err(Failure::Run)?;
    let report = suite(options, &chosen, Suite::new(tracers), &interrupt).map_err(Failure::Run)?;
    Ok(match report.is_right() {
        _ if report.interrupted => interrupt.exit_code(),
        true => ExitCode::SUCCESS,
        false => ExitCode::FAILURE,
    })
}

/// The CPU levels, the GPU if available, and the `f64` reference.
fn tracers(levels: &[Isa], adapter: Option<&str>) -> Result<Vec<Candidate>> {
    let cpu = |isa: &Isa| {
        let options = CpuOptions { isa: Some(*isa), ..CpuOptions::default() };
        Candidate::new(isa.name(), BackendChoice::Cpu(options))
    };
    let mut tracers: Vec<Candidate> = levels.iter().map(cpu).collect();
    if let Some(gpu) = BackendChoice::gpu_if_present(adapter) {
        tracers.push(Candidate::new(adapter.unwrap_or("gpu"), gpu));
    }
    tracers.push(Candidate::new("f64", BackendChoice::Reference { threads: None }));
    // Report unavailable backends before anything runs.
    tracers.iter_mut().try_for_each(|tracer| tracer.start().map(drop))?;
    Ok(tracers)
}

fn suite(
    options: &StressOptions,
    chosen: &[&Case],
    mut suite: Suite,
    interrupt: &Interrupt,
) -> Result<StressReport> {
    let (begin, machine) = (Instant::now(), Machine::look());
    let mut progress = Progress::new(options.progress, chosen.len() as f64);
    let mut report = StressReport { backends: suite.names(), ..StressReport::default() };
    let json = options.json.as_deref();
    // Write the figures even if the table cannot be printed.
    let mut printed = print_beside(json, &report::head());
    for case in chosen {
        progress.at(&case.id);
        let found = suite.run(case, interrupt.flag());
        if interrupt.is_set() {
            report.interrupted = true;
            break;
        }
        printed = printed.and(progress.display.above(|| print_beside(json, &found.text())));
        progress.finished(1.0);
        report.cases.push(found);
    }
    progress.display.clear();
    report.seconds = begin.elapsed().as_secs_f64();
    printed = printed.and(print_beside(json, &report.summary(chosen.len())));
    json.map_or(Ok(()), |target| write_json(target, &machine, &report))?;
    printed.map(|()| report)
}
