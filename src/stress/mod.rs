//! `weekender stress`: renders stiff and extreme scenes on every backend and checks the results.
//!
//! Each case states its expected result and derives it in a sentence: a closed form (a white world is 1, a closed room
//! 0, a convex ball of albedo .5 under a sky of 1 is .5), another scene that must give the same samples, or the `f64`
//! reference where `f64` has digits to spare. The window shows the cases that are worth looking at.

mod backend;
mod case;
mod exact;
pub mod families;
mod far;
mod figures;
#[cfg(test)]
mod painted;
mod pictures;
mod report;
mod search;
mod suite;
mod table;
mod verdict;

pub use backend::Backend;
pub use case::{Case, Expected, Family, Form, Watch};
pub use exact::first_hit;
pub use families::{cases, shown_cases};
pub use report::{BookMeasured, CaseReport, FirstHits, Measured, StressReport};
pub use search::random_scene;
pub use suite::{Suite, by_the_book};
pub use verdict::Verdict;

use crate::backends::BackendChoice;
use crate::cli::{JsonTarget, StressOptions};
use crate::failure::Failure;
use crate::files::{check_page, check_writable};
use crate::interrupt::Interrupt;
use crate::render_cpu::CpuOptions;
use crate::terminal::{self, Display};
use anyhow::{Context, Result, anyhow};
use report::SCHEMA;
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Runs the suite and then, if requested, a search; prints the table and writes the files.
///
/// # Errors
/// [`Failure::Input`] if nothing was run; [`Failure::Run`] otherwise.
pub fn run(options: &StressOptions) -> Result<ExitCode, Failure> {
    if let Some(JsonTarget::File(path)) = &options.json {
        check_writable(path).map_err(Failure::input)?;
    }
    if let Some(directory) = &options.out {
        make(directory).map_err(Failure::Input)?;
        check_page(&directory.join("index.html")).map_err(Failure::input)?;
    }
    let chosen: Vec<&Case> = cases().iter().filter(|case| case.id.contains(&options.filter)).collect();
    if chosen.is_empty() {
        let ids: Vec<&str> = families::families().map(|family| family.id).collect();
        let error =
            anyhow!("no case id contains {:?}; use one of the families {}", options.filter, ids.join(", "));
        return Err(Failure::Input(error));
    }
    let backends = backends(options).map_err(Failure::Input)?;
    let interrupt = Interrupt::install().map_err(Failure::Run)?;
    let report = suite(options, &chosen, backends, interrupt.flag()).map_err(Failure::Run)?;
    let mut is_right = report.is_right();
    if let (Some(time), false) = (options.search, report.interrupted) {
        is_right &= search::run(options, time, interrupt.flag()).map_err(Failure::Run)?;
    }
    Ok(match (interrupt.is_set(), is_right) {
        (true, _) => interrupt.exit_code(),
        (false, true) => ExitCode::SUCCESS,
        (false, false) => ExitCode::FAILURE,
    })
}

fn make(directory: &Path) -> Result<()> {
    std::fs::create_dir_all(directory).with_context(|| {
        format!("cannot create the directory {}; choose another with --out", directory.display())
    })
}

/// The CPU levels of the options, and a GPU if there is one.
fn backends(options: &StressOptions) -> Result<Vec<Backend>> {
    let cpu = |isa| BackendChoice::Cpu(CpuOptions { isa: Some(isa), ..CpuOptions::default() });
    let mut backends: Vec<Backend> =
        options.levels.iter().map(|isa| Backend::new(isa.name(), cpu(*isa))).collect();
    let adapter = options.adapter.as_deref();
    if let Some(gpu) = BackendChoice::gpu_if_present(adapter) {
        backends.push(Backend::new(adapter.unwrap_or("gpu"), gpu));
    }
    // A backend that is not available is reported before anything runs.
    backends.iter_mut().try_for_each(Backend::start)?;
    Ok(backends)
}

fn suite(
    options: &StressOptions,
    chosen: &[&Case],
    backends: Vec<Backend>,
    interrupt: &AtomicBool,
) -> Result<StressReport> {
    let begin = Instant::now();
    let template = "[{bar:24}] {pos} of {len} cases, {wide_msg}";
    let mut display = Display::new(options.progress, chosen.len() as u64, template, "", Duration::ZERO);
    let reference = Backend::new("f64", BackendChoice::Reference { threads: None });
    let mut painter = options.levels.first().map(|isa| {
        let cpu = CpuOptions { isa: Some(*isa), ..CpuOptions::default() };
        Backend::new("pictures", BackendChoice::Cpu(cpu))
    });
    let mut suite = Suite::new(backends, reference);
    let mut report = StressReport {
        schema: SCHEMA,
        version: env!("CARGO_PKG_VERSION"),
        backends: suite.names(),
        seconds: 0.0,
        chosen: chosen.len(),
        interrupted: false,
        cases: Vec::new(),
    };
    let json = options.json.as_ref();
    // If the table cannot be printed, the pictures and figures are still written.
    let mut printed = terminal::print_beside(json, &table::head());
    for (index, case) in chosen.iter().enumerate() {
        display.announce(index as u64, || case.id.clone());
        let found = suite.run(case, interrupt);
        if interrupt.load(Ordering::Relaxed) {
            report.interrupted = true;
            break;
        }
        printed = printed.and(display.above(|| terminal::print_beside(json, &table::row(&found))));
        report.cases.push(found);
        if let (Some(directory), Some(painter)) = (&options.out, &mut painter) {
            pictures::write_pictures(directory, case, painter, interrupt)?;
        }
    }
    display.clear();
    report.seconds = begin.elapsed().as_secs_f64();
    printed = printed.and(terminal::print_beside(json, &table::summary(&report)));
    if let Some(directory) = &options.out {
        pictures::write_pages(directory, &report)?;
    }
    if let Some(target) = json {
        terminal::write_json(&report, target)?;
    }
    printed.map(|()| report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::ProgressChoice;

    #[test]
    fn a_suite_that_is_interrupted_says_so_and_leaves_out_the_case_under_way() {
        let options = StressOptions {
            filter: String::new(),
            search: None,
            seed: 0,
            levels: Vec::new(),
            adapter: None,
            json: None,
            out: None,
            progress: ProgressChoice::Off,
        };
        let case = cases().iter().find(|case| case.id == "shells/1").unwrap();
        let report = suite(&options, &[case], Vec::new(), &AtomicBool::new(true)).unwrap();
        assert!(report.interrupted && report.cases.is_empty(), "{report:?}");
        assert_eq!(report.chosen, 1);
    }
}
