//! `weekender bench`: how fast this machine renders, compared with a plain C program.

mod figures;
mod text;

use super::machine::Machine;
use super::progress::Progress;
use super::table::counted;
use super::{Candidate, write_json};
use crate::backends::BackendChoice;
use crate::cli::{BenchOptions, BenchScene};
use crate::film::HALVES;
use crate::job::render::RenderJob;
use crate::render_cpu::{CpuOptions, Isa};
use crate::system::failure::Failure;
use crate::system::interrupt::Interrupt;
use crate::system::terminal;
use anyhow::Result;
use figures::{BenchFigures, Kind, Row, Run, SceneFigures};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// System load above which the figures are doubtful.
const LOAD_LIMIT: f64 = 0.5;

/// How long to keep a GPU busy before each measured run.
const WAKING: Duration = Duration::from_millis(300);

/// Shortest warm-up with a meaningful speed, seconds.
const WARM_UP_SECONDS: f64 = 0.2;

/// Measures, prints tables and writes files. [`Failure::Input`] if nothing was measured; [`Failure::Run`] otherwise.
pub fn run(options: &BenchOptions) -> Result<ExitCode, Failure> {
    let scenes = options.scenes().map_err(Failure::Input)?;
    let levels = options.levels();
    let json = options.json.as_deref();
    options.check().map_err(Failure::Input)?;
    let interrupt = Interrupt::install().map_err(Failure::Run)?;
    let machine = Machine::look();
    let mut figures = Bench { options, levels, cancel: interrupt.flag() }.scenes(&scenes);
    figures.interrupted = interrupt.is_set();
    figures.warnings.extend(machine.load_at_start.filter(|load| *load > LOAD_LIMIT).map(|load| {
        format!(
            "the machine was busy: load {load:.2} at the start, above {LOAD_LIMIT}; close other programs and measure again"
        )
    }));
    // Write the file even if printing failed.
    let printed = terminal::print_beside(json, &text::text(&machine, &figures));
    json.map_or(Ok(()), |target| write_json(target, &machine, &figures))
        .and(printed)
        .map_err(Failure::Run)?;
    Ok(if figures.interrupted { interrupt.exit_code() } else { ExitCode::SUCCESS })
}

struct Bench<'a> {
    options: &'a BenchOptions,
    /// Never empty; the most capable level is last.
    levels: Vec<Isa>,
    cancel: &'a AtomicBool,
}

impl Bench<'_> {
    fn is_cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }

    fn best_level(&self) -> Isa {
        self.levels.last().copied().unwrap_or(Isa::Portable)
    }

    fn scenes(&self, scenes: &[BenchScene]) -> BenchFigures {
        let mut candidates = self.candidates();
        let runs = scenes.len() * candidates.len() * (1 + self.options.runs);
        let mut progress = Progress::new(self.options.progress, runs as f64);
        let mut figures = BenchFigures::default();
        for scene in scenes.iter().take_while(|_| !self.is_cancelled()) {
            let rows = self.rows(scene, &mut candidates, &mut progress);
            figures.scenes.push(SceneFigures::new(&scene.name, &scene.job, rows));
        }
        progress.display.clear();
        figures
    }

    /// All candidates in the table's order.
    fn candidates(&self) -> Vec<(Kind, Candidate)> {
        let mut c89 = Candidate::new("C89, 1 thread", None);
        if let Ok(renderer) = c89.start() {
            c89.name = format!("C89, {}, 1 thread", renderer.info().device);
        }
        let mut found = vec![(Kind::Baseline, c89)];
        for isa in &self.levels {
            for lanes in isa.lane_counts() {
                let kind = if *lanes == 1 { Kind::Scalar } else { Kind::Packets };
                found.push((kind, cpu(*isa, *lanes, 1)));
            }
        }
        let (best, threads) = (self.best_level(), self.options.threads());
        if threads > 1 {
            found.push((Kind::Threads, cpu(best, 1, threads)));
            if best.native_lanes() > 1 {
                found.push((Kind::Threads, cpu(best, best.native_lanes(), threads)));
            }
        }
        let adapter = self.options.adapter.as_deref();
        found.extend(BackendChoice::gpu_if_present(adapter).map(|choice| (Kind::Gpu, gpu(choice))));
        found
    }

    /// Runs all candidates in turn, so that drift affects all alike.
    fn rows(
        &self,
        BenchScene { name, job, samples, .. }: &BenchScene,
        candidates: &mut [(Kind, Candidate)],
        progress: &mut Progress,
    ) -> Vec<Row> {
        let mut rows: Vec<Row> =
            candidates.iter_mut().map(|(kind, candidate)| Row::new(*kind, candidate)).collect();
        'turns: for turn in 0..=self.options.runs {
            for (row, (_, candidate)) in rows.iter_mut().zip(&mut *candidates) {
                if row.skipped.is_none() {
                    progress.at(&format!("{name}: {}", row.name));
                    let outcome = match turn {
                        0 => self.warm_up(candidate, job, *samples, row),
                        _ => self.run(candidate, job, row),
                    };
                    if self.is_cancelled() {
                        break 'turns;
                    }
                    row.skipped = outcome.err().map(|error| format!("{error:#}"));
                }
                progress.finished(1.0);
            }
        }
        rows.iter_mut().for_each(Row::sum_up);
        rows
    }

    /// Warms up with growing sample counts, up to `samples`, and sets how many fit the time limit.
    fn warm_up(&self, candidate: &mut Candidate, job: &RenderJob, samples: u64, row: &mut Row) -> Result<()> {
        let limit = self.options.run_limit;
        let mut tried = HALVES.min(samples);
        loop {
            let seconds = Run::of(&candidate.trace(job, tried, self.cancel)?).seconds;
            if seconds >= WARM_UP_SECONDS.min(0.25 * limit) || tried >= samples {
                row.samples_per_pixel = affordable(samples, HALVES, seconds / tried as f64, limit);
                return Ok(());
            }
            tried = (4 * tried).min(samples);
        }
    }

    fn run(&self, candidate: &mut Candidate, job: &RenderJob, row: &mut Row) -> Result<()> {
        // An idle GPU lowers its clock and takes a while to raise it.
        let begin = Instant::now();
        while row.kind == Kind::Gpu && begin.elapsed() < WAKING {
            candidate.trace(job, row.samples_per_pixel, self.cancel)?;
        }
        row.runs.push(Run::of(&candidate.trace(job, row.samples_per_pixel, self.cancel)?));
        Ok(())
    }
}

fn cpu(isa: Isa, lanes: usize, threads: usize) -> Candidate {
    let options =
        CpuOptions { isa: Some(isa), lanes: Some(lanes), threads: Some(threads), ..CpuOptions::default() };
    let name = format!("{isa}, {}, {}", counted(lanes, "lane"), counted(threads, "thread"));
    Candidate::new(name, BackendChoice::Cpu(options))
}

fn gpu(choice: BackendChoice) -> Candidate {
    let mut gpu = Candidate::new("GPU", choice);
    if let Ok(renderer) = gpu.start() {
        gpu.name = renderer.info().device;
    }
    gpu
}

/// How many samples fit into `limit_seconds`, between `least` and `samples`.
fn affordable(samples: u64, least: u64, seconds_per_sample: f64, limit_seconds: f64) -> u64 {
    let mut chosen = samples;
    while chosen > least && chosen as f64 * seconds_per_sample > limit_seconds {
        // Both halves of the film get equally many.
        chosen = (chosen / 2).next_multiple_of(least);
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_fit_time_limit() {
        for (seconds_per_sample, expected) in [(0.0, 100), (0.01, 100), (0.011, 50), (0.04, 26), (9.0, 2)] {
            assert_eq!(affordable(100, 2, seconds_per_sample, 1.04), expected, "{seconds_per_sample}");
        }
        assert_eq!(affordable(1, 2, 9.0, 1.0), 1);
    }
}
