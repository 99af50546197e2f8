//! Measures what leaving out of a kernel what a picture does not need gains: each picture is rendered with its own kernel
//! and with the general one in turn. Both films must be equal to the bit.

use super::candidate::{Cancelled, affordable};
use super::figures::{BenchFigures, DeviceFigures, GainRow, Run};
use super::machine::counted;
use super::progress::Progress;
use crate::backends::{self, BackendChoice, BackendError};
use crate::cli::{BenchOptions, BenchScene};
use crate::film::Film;
use crate::render::{RenderError, RenderJob, Renderer};
use crate::render_cpu::{CpuOptions, Isa};
use crate::render_gpu::{AdapterInfo, GpuOptions, adapters};
use anyhow::Result;
use std::sync::atomic::AtomicBool;

/// A warm-up run whose speed is meaningful takes at least this fraction of the time limit.
const WARM_UP_SHARE: f64 = 0.25;

/// The own and the general kernels of one device.
struct Pair {
    name: String,
    renderers: Result<[Box<dyn Renderer>; 2], BackendError>,
}

/// Why a picture was not measured.
enum Stop {
    Cancelled,
    Failed(String),
}

impl From<RenderError> for Stop {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::Cancelled => Stop::Cancelled,
            error => Stop::Failed(error.to_string()),
        }
    }
}

/// Measures every picture on every device. An interrupt keeps the rows so far.
///
/// # Errors
/// If the films of a picture's own and of the general kernel differ.
pub fn measure(options: &BenchOptions, figures: &mut BenchFigures, cancel: &AtomicBool) -> Result<()> {
    let pairs = pairs(options);
    let steps = pairs.len() * options.scenes.len() * (1 + options.runs);
    let mut progress = Progress::new(options.progress, steps as u64);
    for pair in pairs {
        let (device, outcome) = measure_device(options, pair, &mut progress, cancel);
        figures.features.push(device);
        if outcome.is_err() {
            break;
        }
    }
    progress.clear();
    check(&figures.features)
}

fn check(devices: &[DeviceFigures]) -> Result<()> {
    let rows = devices.iter().flat_map(|device| device.rows.iter().map(move |row| (device, row)));
    let differing: Vec<String> = rows
        .filter(|(_, row)| row.same_bits == Some(false))
        .map(|(device, row)| format!("{} ({})", row.name, device.device))
        .collect();
    if differing.is_empty() {
        return Ok(());
    }
    anyhow::bail!(
        "the scene's own kernel and the general one give different films of {}; please report this with the command",
        differing.join(", ")
    )
}

fn pairs(options: &BenchOptions) -> Vec<Pair> {
    let mut pairs: Vec<Pair> = options.levels.iter().map(|isa| Pair::cpu(*isa)).collect();
    if options.adapter.is_some() || adapters().iter().any(AdapterInfo::is_fit) {
        pairs.push(Pair::gpu(options.adapter.as_deref()));
    }
    pairs
}

impl Pair {
    fn cpu(isa: Isa) -> Self {
        let create = |general| {
            backends::create(&BackendChoice::Cpu(CpuOptions {
                isa: Some(isa),
                threads: Some(1),
                general,
                ..CpuOptions::default()
            }))
        };
        let name = format!("{isa}, {}, 1 thread", counted(isa.native_lanes(), "lane"));
        Pair { name, renderers: both(create) }
    }

    fn gpu(adapter: Option<&str>) -> Self {
        let create = |general: bool| {
            let options = GpuOptions { specialise: !general, ..GpuOptions::of_adapter(adapter) };
            backends::create(&BackendChoice::Gpu(options))
        };
        let renderers = both(create);
        let name = renderers.as_ref().map_or_else(|_| "GPU".to_owned(), |[own, _]| own.info().device);
        Pair { name, renderers }
    }
}

fn both(
    create: impl Fn(bool) -> Result<Box<dyn Renderer>, BackendError>,
) -> Result<[Box<dyn Renderer>; 2], BackendError> {
    Ok([create(false)?, create(true)?])
}

fn measure_device(
    options: &BenchOptions,
    pair: Pair,
    progress: &mut Progress,
    cancel: &AtomicBool,
) -> (DeviceFigures, Result<(), Cancelled>) {
    let mut device = DeviceFigures { device: pair.name, rows: Vec::new(), skipped: None };
    let mut renderers = match pair.renderers {
        Ok(renderers) => renderers,
        Err(error) => {
            device.skipped = Some(error.to_string());
            return (device, Ok(()));
        }
    };
    for scene in &options.scenes {
        let mut row = new_row(scene);
        progress.begin(&format!("{}: {}", scene.name, device.device));
        let outcome = measure_row(options, scene, &mut renderers, &mut row, progress, cancel);
        row.sum_up();
        let is_cancelled = matches!(outcome, Err(Stop::Cancelled));
        if let Err(Stop::Failed(reason)) = outcome {
            row.skipped = Some(reason);
        }
        if !is_cancelled || row.gain.is_some() {
            device.rows.push(row);
        }
        if is_cancelled {
            return (device, Err(Cancelled));
        }
    }
    (device, Ok(()))
}

fn new_row(scene: &BenchScene) -> GainRow {
    let settings = scene.job.settings();
    GainRow {
        name: scene.name.clone(),
        is_stage: scene.is_stage,
        width: settings.width,
        height: settings.height,
        max_depth: settings.max_depth,
        sampler: settings.sampler.name(),
        ..GainRow::default()
    }
}

fn measure_row(
    options: &BenchOptions,
    scene: &BenchScene,
    [own, general]: &mut [Box<dyn Renderer>; 2],
    row: &mut GainRow,
    progress: &mut Progress,
    cancel: &AtomicBool,
) -> Result<(), Stop> {
    let job = &scene.job;
    own.prepare(job, cancel)?;
    general.prepare(job, cancel)?;
    let (contents, never) = (own.kernel_contents(), general.kernel_contents().left_out);
    row.kernel = contents.present;
    row.left_out = contents.left_out.into_iter().filter(|word| !never.contains(word)).collect();
    row.samples_per_pixel = warm_up(own.as_mut(), job, scene.samples, options.run_limit_seconds, cancel)?;
    let samples = row.samples_per_pixel;
    trace(general.as_mut(), job, samples, cancel)?;
    progress.step();
    for turn in 0..options.runs {
        let (of_own, of_general);
        // Neither kernel always follows the other.
        if turn % 2 == 0 {
            of_own = trace(own.as_mut(), job, samples, cancel)?;
            of_general = trace(general.as_mut(), job, samples, cancel)?;
        } else {
            of_general = trace(general.as_mut(), job, samples, cancel)?;
            of_own = trace(own.as_mut(), job, samples, cancel)?;
        }
        row.own_runs.push(of_own.0);
        row.general_runs.push(of_general.0);
        row.same_bits = Some(row.same_bits != Some(false) && of_own.1 == of_general.1);
        progress.step();
    }
    Ok(())
}

/// Traces more and more samples. Returns how many a measured run takes: as many as `limit_seconds` allows, at most
/// `samples`.
fn warm_up(
    renderer: &mut dyn Renderer,
    job: &RenderJob,
    samples: u64,
    limit_seconds: f64,
    cancel: &AtomicBool,
) -> Result<u64, Stop> {
    let least = job.settings().half_count() as u64;
    let mut tried = least.min(samples);
    loop {
        let (run, _) = trace(renderer, job, tried, cancel)?;
        if run.seconds >= WARM_UP_SHARE * limit_seconds || tried >= samples {
            return Ok(affordable(samples, least, run.seconds / tried as f64, limit_seconds));
        }
        tried = (4 * tried).min(samples);
    }
}

fn trace(
    renderer: &mut dyn Renderer,
    job: &RenderJob,
    samples: u64,
    cancel: &AtomicBool,
) -> Result<(Run, Film), Stop> {
    let mut film = job.new_film();
    let stats = renderer.accumulate(job, 0..samples, &mut film, cancel)?;
    Ok((Run::of(&stats, &film), film))
}

#[cfg(test)]
mod tests {
    use super::super::fake::Fake;
    use super::*;
    use crate::cli::{self, Request};
    use std::sync::Arc;
    use std::time::Duration;

    fn options(words: &str) -> BenchOptions {
        let line = format!("weekender bench --features --scene metals --isa portable --size 8x4 {words}");
        match cli::parse(line.split(' ').map(Into::into)).unwrap() {
            Request::Bench(options) => *options,
            other => panic!("{other:?}"),
        }
    }

    /// Measures a scene in two pairs of runs of two samples.
    fn measured(own: Fake, general: Fake) -> (DeviceFigures, Result<(), Cancelled>) {
        measured_with("--samples 2 --runs 2 --progress off", own, general)
    }

    fn measured_with(words: &str, own: Fake, general: Fake) -> (DeviceFigures, Result<(), Cancelled>) {
        let options = options(words);
        let renderers: [Box<dyn Renderer>; 2] = [Box::new(own), Box::new(general)];
        let pair = Pair { name: "fake".to_owned(), renderers: Ok(renderers) };
        let mut progress = Progress::new(options.progress, 3);
        measure_device(&options, pair, &mut progress, &AtomicBool::new(false))
    }

    #[test]
    fn an_interrupt_keeps_a_row_that_has_a_pair_of_runs() {
        // The first run of each kernel is its warm-up.
        for (runs, rows) in [(0, 0), (1, 0), (2, 1)] {
            let own = Fake { cancelled_after: Some(runs), ..Fake::default() };
            let (device, outcome) = measured(own, Fake::default());
            assert!(outcome.is_err());
            assert_eq!(device.rows.len(), rows, "cancelled after {runs} runs");
            assert!(device.rows.iter().all(|row| row.own_runs.len() == 1 && row.skipped.is_none()));
        }
        let (device, outcome) = measured(Fake::default(), Fake::default());
        assert!(outcome.is_ok());
        assert_eq!(device.rows.iter().map(|row| row.own_runs.len()).collect::<Vec<_>>(), [2]);
    }

    #[test]
    fn a_row_whose_kernel_fails_says_why() {
        let (device, outcome) = measured(Fake::default(), Fake { fails_after: Some(0), ..Fake::default() });
        assert!(outcome.is_ok());
        let reasons: Vec<_> = device.rows.iter().map(|row| row.skipped.as_deref()).collect();
        assert_eq!(reasons, [Some("fake failed: out of memory")]);
    }

    #[test]
    fn a_gpu_that_was_named_is_listed_even_if_there_is_none() {
        let options = options("--adapter no-such-GPU --progress off");
        let mut pairs = pairs(&options);
        assert_eq!(pairs.len(), 2);
        let gpu = pairs.remove(1);
        let mut progress = Progress::new(options.progress, 1);
        let (device, outcome) = measure_device(&options, gpu, &mut progress, &AtomicBool::new(false));
        assert!(outcome.is_ok() && device.rows.is_empty());
        let reason = device.skipped.unwrap();
        assert!(reason.contains("no-such-GPU") || reason.contains("no graphics adapter"), "{reason}");
    }

    #[test]
    fn kernels_take_turns_at_going_first_after_a_warm_up() {
        let per_sample = Duration::from_millis(10);
        for (words, warm_up, samples) in [
            // The third run takes more than a quarter of the second that a run may take.
            ("--samples 64 --run-limit 1 --runs 3 --progress off", &[2_u64, 8, 32][..], 64_u64),
            ("--samples 64 --run-limit 0.3 --runs 3 --progress off", &[2, 8], 16),
            ("--samples 6 --run-limit 1 --runs 3 --progress off", &[2, 6], 6),
        ] {
            let own = Fake { name: "own", per_sample, ..Fake::default() };
            let asked = Arc::clone(&own.asked);
            let general = Fake { name: "general", per_sample: 2 * per_sample, asked, ..Fake::default() };
            let asked = Arc::clone(&own.asked);
            let (device, outcome) = measured_with(words, own, general);
            assert!(outcome.is_ok());
            let turns = ["general", "own", "general", "general", "own", "own", "general"];
            let expected: Vec<_> = warm_up
                .iter()
                .map(|count| ("own", 0..*count))
                .chain(turns.into_iter().map(|name| (name, 0..samples)))
                .collect();
            assert_eq!(*asked.lock().unwrap(), expected, "{words}");
            let row = &device.rows[0];
            assert_eq!((row.samples_per_pixel, row.own_runs.len(), row.general_runs.len()), (samples, 3, 3));
            assert_eq!(row.gain.map(|gain| gain.median), Some(2.0));
            assert_eq!(row.same_bits, Some(true));
        }
    }

    #[test]
    fn films_that_differ_once_are_not_the_same() {
        // Run 0 is the warm-up.
        for rejects_in in [1, 2] {
            let general = Fake { rejects_in: Some(rejects_in), ..Fake::default() };
            let (device, outcome) = measured(Fake::default(), general);
            assert!(outcome.is_ok());
            assert_eq!(device.rows[0].same_bits, Some(false), "run {rejects_in}");
            let told = check(&[device]).unwrap_err().to_string();
            assert!(told.contains("different films of metals (fake); please report"), "{told}");
        }
        let not_compared = measured(Fake { fails_after: Some(0), ..Fake::default() }, Fake::default()).0;
        assert_eq!(not_compared.rows[0].same_bits, None);
        assert!(check(&[not_compared, measured(Fake::default(), Fake::default()).0]).is_ok());
    }

    #[test]
    fn what_no_kernel_has_is_not_left_out() {
        let own = Fake { name: "own", leaves_out: vec!["lens", "glass"], ..Fake::default() };
        let general = Fake { name: "general", leaves_out: vec!["glass"], ..Fake::default() };
        let row = measured(own, general).0.rows.remove(0);
        assert_eq!((row.kernel.as_str(), row.left_out.as_slice()), ("kernel of own", &["lens"][..]));
        assert_eq!((row.name.as_str(), row.width, row.height, row.is_stage), ("metals", 8, 4, false));
    }
}
