//! The candidates to measure: the baseline, instruction levels and lane counts of the CPU, and a GPU.

use super::figures::{Kind, Row, Run};
use super::machine::counted;
use crate::backends::{self, BackendChoice};
use crate::baseline::{Baseline, BaselineError};
use crate::cli::BenchOptions;
use crate::recipe::plain_name;
use crate::render::{RenderError, RenderJob, Renderer};
use crate::render_cpu::{CpuOptions, Isa};
use crate::render_gpu::{AdapterInfo, GpuOptions, adapters};
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How long a GPU is kept busy before each measured run.
const WAKING: Duration = Duration::from_millis(300);

/// Shortest warm-up run whose speed is meaningful, seconds.
const WARM_UP_SECONDS: f64 = 0.2;

/// A row of a scene's table, ready to run.
pub struct Candidate {
    /// The figures so far.
    pub row: Row,
    runner: Option<Runner>,
}

enum Runner {
    Baseline { baseline: Rc<Baseline>, scene: PathBuf },
    Renderer(Box<dyn Renderer>),
}

/// The run was cancelled.
#[derive(Debug)]
pub struct Cancelled;

/// All candidates for a job, in the order of the table.
pub fn candidates(
    options: &BenchOptions,
    name: &str,
    job: &RenderJob,
    baseline: &Result<Rc<Baseline>, BaselineError>,
) -> Vec<Candidate> {
    let mut found = vec![Candidate::baseline(name, job, baseline)];
    for isa in &options.levels {
        for lanes in isa.lane_counts() {
            let kind = if *lanes == 1 { Kind::Scalar } else { Kind::Packets };
            found.push(Candidate::cpu(*isa, *lanes, 1, kind, job));
        }
    }
    let best = options.levels.last().copied().unwrap_or(Isa::Portable);
    if options.threads > 1 {
        found.push(Candidate::cpu(best, 1, options.threads, Kind::Threads, job));
        if best.native_lanes() > 1 {
            found.push(Candidate::cpu(best, best.native_lanes(), options.threads, Kind::Threads, job));
        }
    }
    if options.adapter.is_some() || adapters().iter().any(AdapterInfo::is_fit) {
        found.push(Candidate::gpu(options, job));
    }
    found
}

impl Candidate {
    fn new(name: String, kind: Kind, lanes: usize, threads: usize, made: Result<Runner, String>) -> Self {
        let (runner, skipped) = match made {
            Ok(runner) => (Some(runner), None),
            Err(reason) => (None, Some(reason)),
        };
        let row = Row {
            name,
            kind,
            lanes,
            threads,
            samples_per_pixel: 0,
            runs: Vec::new(),
            paths_per_second: None,
            rays_per_second: None,
            lanes_in_use: None,
            ratio_to_baseline: None,
            efficiency: None,
            skipped,
        };
        Candidate { row, runner }
    }

    fn baseline(name: &str, job: &RenderJob, baseline: &Result<Rc<Baseline>, BaselineError>) -> Self {
        let made = baseline.as_ref().map_err(ToString::to_string).and_then(|baseline| {
            let scene = baseline.write_scene(job, &plain_name(name));
            let scene = scene.map_err(|error| error.to_string())?;
            Ok(Runner::Baseline { baseline: Rc::clone(baseline), scene })
        });
        let name = match baseline {
            Ok(baseline) => baseline.about(),
            Err(_) => "C89, 1 thread".to_owned(),
        };
        Candidate::new(name, Kind::Baseline, 1, 1, made)
    }

    /// A level of the CPU with this many lanes and threads.
    pub fn cpu(isa: Isa, lanes: usize, threads: usize, kind: Kind, job: &RenderJob) -> Self {
        let options = CpuOptions {
            isa: Some(isa),
            lanes: Some(lanes),
            threads: Some(threads),
            ..CpuOptions::default()
        };
        let name = format!("{isa}, {}, {}", counted(lanes, "lane"), counted(threads, "thread"));
        Candidate::new(name, kind, lanes, threads, prepared(&BackendChoice::Cpu(options), job))
    }

    fn gpu(options: &BenchOptions, job: &RenderJob) -> Self {
        let gpu = GpuOptions::of_adapter(options.adapter.as_deref());
        let made = prepared(&BackendChoice::Gpu(gpu), job);
        let info = match &made {
            Ok(Runner::Renderer(renderer)) => Some(renderer.info()),
            _ => None,
        };
        let name = info.as_ref().map_or_else(|| "GPU".to_owned(), |info| info.device.clone());
        let (lanes, threads) = info.map_or((0, 0), |info| (info.lanes, info.threads));
        Candidate::new(name, Kind::Gpu, lanes, threads, made)
    }

    /// Whether it can still be run.
    pub fn is_ready(&self) -> bool {
        self.runner.is_some()
    }

    /// Runs it without keeping the figures, with more and more samples. From the last run it chooses the number of
    /// samples for the measured runs: as many as `limit_seconds` allows, at most `samples`.
    ///
    /// # Errors
    /// [`Cancelled`]. A candidate that fails is skipped from then on.
    pub fn warm_up(
        &mut self,
        job: &RenderJob,
        samples: u64,
        limit_seconds: f64,
        cancel: &AtomicBool,
    ) -> Result<(), Cancelled> {
        let least = job.settings().half_count() as u64;
        let mut tried = least.min(samples);
        loop {
            let Some(run) = self.run(job, tried, cancel)? else { return Ok(()) };
            if run.seconds >= WARM_UP_SECONDS.min(limit_seconds) || tried >= samples {
                let seconds_per_sample = run.seconds / tried as f64;
                self.row.samples_per_pixel = affordable(samples, least, seconds_per_sample, limit_seconds);
                return Ok(());
            }
            tried = (4 * tried).min(samples);
        }
    }

    /// Runs it once and keeps the figures.
    ///
    /// # Errors
    /// [`Cancelled`]. A candidate that fails is skipped from then on.
    pub fn measure(&mut self, job: &RenderJob, cancel: &AtomicBool) -> Result<(), Cancelled> {
        if self.row.kind == Kind::Gpu {
            self.wake(job, cancel)?;
        }
        let run = self.run(job, self.row.samples_per_pixel, cancel)?;
        self.row.runs.extend(run);
        Ok(())
    }

    /// Keeps a GPU busy for a moment: while it waits for its turn, it lowers its clock, and takes a while to raise it.
    fn wake(&mut self, job: &RenderJob, cancel: &AtomicBool) -> Result<(), Cancelled> {
        let begin = Instant::now();
        while begin.elapsed() < WAKING && self.run(job, self.row.samples_per_pixel, cancel)?.is_some() {}
        Ok(())
    }

    /// `None` if it failed or cannot be run.
    fn run(&mut self, job: &RenderJob, samples: u64, cancel: &AtomicBool) -> Result<Option<Run>, Cancelled> {
        let outcome = match &mut self.runner {
            None => return Ok(None),
            Some(Runner::Baseline { baseline, scene }) => {
                let is_cancelled = || cancel.load(Ordering::Relaxed);
                match baseline.run(Some(scene), job.settings(), samples, 1, None, &is_cancelled) {
                    Ok(run) => Ok(Run {
                        seconds: run.seconds,
                        paths: run.paths,
                        rays: run.rays,
                        busy_lanes: 0,
                        offered_lanes: 0,
                        rmse: None,
                    }),
                    Err(BaselineError::Cancelled) => return Err(Cancelled),
                    Err(error) => Err(error.to_string()),
                }
            }
            Some(Runner::Renderer(renderer)) => {
                let mut film = job.new_film();
                match renderer.accumulate(job, 0..samples, &mut film, cancel) {
                    Ok(stats) => Ok(Run::of(&stats, &film)),
                    Err(RenderError::Cancelled) => return Err(Cancelled),
                    Err(error) => Err(error.to_string()),
                }
            }
        };
        match outcome {
            Ok(run) => Ok(Some(Run { seconds: run.seconds.max(1e-9), ..run })),
            Err(reason) => {
                self.runner = None;
                self.row.skipped = Some(reason);
                Ok(None)
            }
        }
    }
}

/// How many samples a run may take within `limit_seconds`: at most `samples`, at least `least`.
pub fn affordable(samples: u64, least: u64, seconds_per_sample: f64, limit_seconds: f64) -> u64 {
    let mut chosen = samples;
    while chosen > least && chosen as f64 * seconds_per_sample > limit_seconds {
        // Both halves of the film get the same number.
        chosen = (chosen / 2).next_multiple_of(least);
    }
    chosen
}

fn prepared(choice: &BackendChoice, job: &RenderJob) -> Result<Runner, String> {
    let mut renderer = backends::create(choice).map_err(|error| error.to_string())?;
    renderer.prepare(job, &AtomicBool::new(false)).map_err(|error| error.to_string())?;
    Ok(Runner::Renderer(renderer))
}

#[cfg(test)]
mod tests {
    use super::super::fake::Fake;
    use super::*;
    use crate::cli::{self, Request};
    use crate::recipe::Recipe;
    use std::sync::Arc;

    static NEVER: AtomicBool = AtomicBool::new(false);

    fn job() -> RenderJob {
        let mut recipe = Recipe::find("metals").unwrap();
        (recipe.settings.width, recipe.settings.height) = (8, 4);
        recipe.job().unwrap()
    }

    fn candidate(kind: Kind, fake: Fake) -> Candidate {
        Candidate::new("fake".to_owned(), kind, 1, 1, Ok(Runner::Renderer(Box::new(fake))))
    }

    #[test]
    fn a_gpu_is_kept_busy_for_a_moment_before_a_measured_run() {
        // One run is a moment; a third would fail.
        let fake = Fake { pause: WAKING, fails_after: Some(2), ..Fake::default() };
        let runs = Arc::clone(&fake.runs);
        let mut gpu = candidate(Kind::Gpu, fake);
        gpu.measure(&job(), &NEVER).unwrap();
        assert_eq!((runs.load(Ordering::Relaxed), gpu.row.runs.len()), (2, 1));
        assert_eq!(gpu.row.skipped, None);
        // A processor needs no such thing.
        let fake = Fake::default();
        let runs = Arc::clone(&fake.runs);
        let mut cpu = candidate(Kind::Packets, fake);
        cpu.measure(&job(), &NEVER).unwrap();
        assert_eq!((runs.load(Ordering::Relaxed), cpu.row.runs.len()), (1, 1));
    }

    #[test]
    fn a_candidate_that_fails_is_skipped_from_then_on() {
        // It fails while it is kept busy.
        let fake = Fake { fails_after: Some(2), ..Fake::default() };
        let runs = Arc::clone(&fake.runs);
        let mut gpu = candidate(Kind::Gpu, fake);
        for _ in 0..2 {
            gpu.measure(&job(), &NEVER).unwrap();
            assert_eq!((runs.load(Ordering::Relaxed), gpu.row.runs.len()), (3, 0));
            assert_eq!(gpu.row.skipped.as_deref(), Some("fake failed: out of memory"));
            assert!(!gpu.is_ready());
        }
    }

    #[test]
    fn a_gpu_that_was_named_has_a_row_even_if_there_is_none() {
        let line =
            "weekender bench --adapter no-such-GPU --scene metals --isa portable --threads 1 --size 8x4";
        let Request::Bench(options) = cli::parse(line.split(' ').map(Into::into)).unwrap() else {
            panic!("no benchmark")
        };
        let found = candidates(&options, "metals", &job(), &Err(BaselineError::Unfit("not wanted")));
        let rows: Vec<(Kind, bool)> = found.iter().map(|found| (found.row.kind, found.is_ready())).collect();
        assert_eq!(rows, [(Kind::Baseline, false), (Kind::Scalar, true), (Kind::Gpu, false)]);
        assert_eq!(found[0].row.skipped.as_deref(), Some("not wanted"));
        let reason = found[2].row.skipped.as_deref().unwrap();
        assert!(reason.contains("no-such-GPU") || reason.contains("no graphics adapter"), "{reason}");
    }

    #[test]
    fn a_warm_up_takes_more_and_more_samples_until_its_speed_is_meaningful() {
        let all = |counts: &[u64]| counts.iter().map(|count| ("", 0..*count)).collect::<Vec<_>>();
        for (samples, limit_seconds, asked, chosen) in [
            // A hundredth of a second per sample: the third run takes more than a fifth of a second.
            (64, 10.0, &[2, 8, 32][..], 64),
            (20, 10.0, &[2, 8, 20], 20),
            (8, 10.0, &[2, 8], 8),
            (1, 10.0, &[1], 1),
            // If a run may take less than that, it is enough: here an eighth of a second, into which 8 samples fit.
            (64, 0.125, &[2, 8, 32], 8),
            (64, 0.05, &[2, 8], 4),
        ] {
            let fake = Fake { per_sample: Duration::from_millis(10), ..Fake::default() };
            let found = Arc::clone(&fake.asked);
            let mut cpu = candidate(Kind::Scalar, fake);
            cpu.warm_up(&job(), samples, limit_seconds, &NEVER).unwrap();
            assert_eq!(*found.lock().unwrap(), all(asked), "{samples} in {limit_seconds} s");
            assert_eq!((cpu.row.samples_per_pixel, cpu.row.runs.len()), (chosen, 0));
            cpu.measure(&job(), &NEVER).unwrap();
            assert_eq!(found.lock().unwrap().last(), Some(&("", 0..chosen)));
            let run = cpu.row.runs[0];
            assert_eq!((run.paths, run.seconds), (10 * chosen, 0.01 * chosen as f64));
        }
    }

    #[test]
    fn a_run_has_as_many_samples_as_the_time_allows() {
        for (samples, least, seconds_per_sample, limit_seconds, expected) in [
            (8, 2, 0.5, 4.0, 8),
            (8, 2, 0.5, 3.9, 4),
            (10, 4, 1.0, 7.0, 4),
            (12, 2, 1.0, 7.0, 6),
            (64, 2, 1.0, 0.5, 2),
            (1, 2, 1.0, 0.5, 1),
        ] {
            let found = affordable(samples, least, seconds_per_sample, limit_seconds);
            assert_eq!(found, expected, "{samples} of {seconds_per_sample} s in {limit_seconds} s");
        }
    }

    #[test]
    fn every_level_has_its_lanes_and_the_best_one_all_threads() {
        for isa in Isa::available() {
            let line = format!("weekender bench --scene metals --isa {isa} --threads 2 --size 8x4");
            let Request::Bench(options) = cli::parse(line.split(' ').map(Into::into)).unwrap() else {
                panic!("no benchmark")
            };
            let found = candidates(&options, "metals", &job(), &Err(BaselineError::Unfit("not wanted")));
            let mut expected = vec![(Kind::Baseline, 1, 1)];
            expected.extend(isa.lane_counts().iter().map(|lanes| match lanes {
                1 => (Kind::Scalar, 1, 1),
                lanes => (Kind::Packets, *lanes, 1),
            }));
            expected.push((Kind::Threads, 1, 2));
            if isa != Isa::Portable {
                expected.push((Kind::Threads, isa.native_lanes(), 2));
            }
            let rows = found.iter().map(|found| &found.row).filter(|row| row.kind != Kind::Gpu);
            let rows: Vec<_> = rows.map(|row| (row.kind, row.lanes, row.threads)).collect();
            assert_eq!(rows, expected, "{isa}");
        }
    }
}
