//! The candidate that renders a curve: a backend, or the plain C89 baseline.

use super::data::{Curve, Measured, Run};
use super::reference::{ReferencePicture, film_means};
use crate::backends;
use crate::baseline::{Baseline, BaselineError};
use crate::cli::ReportBackend;
use crate::film::Film;
use crate::output::{Encoding, read_picture};
use crate::render::{RenderJob, Renderer, SamplerKind};
use anyhow::{Context, Result};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Limits of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Seconds of rendering.
    pub seconds: f64,
    /// Samples per pixel.
    pub samples: u64,
}

/// What renders a curve.
pub enum Candidate {
    /// A backend, which adds samples to the same picture.
    Renderer(Box<dyn Renderer>),
    /// The baseline, which starts again for every number of samples.
    Baseline(Baseline),
}

impl Candidate {
    /// Starts a candidate. `None` for a baseline that is not available and was not asked for.
    ///
    /// # Errors
    /// If it is not available.
    pub fn of(backend: &ReportBackend) -> Result<Option<Self>> {
        Ok(match backend {
            ReportBackend::Renderer(choice) => Some(Candidate::Renderer(backends::create(choice)?)),
            ReportBackend::Baseline { is_asked_for } => match Baseline::compile() {
                Ok(baseline) => Some(Candidate::Baseline(baseline)),
                Err(error) if *is_asked_for => return Err(error.into()),
                Err(_) => None,
            },
        })
    }

    /// Which of the samplers it supports. The baseline only has its own independent numbers.
    pub fn samplers(&self, asked_for: &[SamplerKind]) -> Vec<SamplerKind> {
        match self {
            Candidate::Renderer(_) => asked_for.to_vec(),
            Candidate::Baseline(_) => vec![SamplerKind::Independent],
        }
    }

    /// Renders 1, 2, 4 ... samples and measures each picture. The last one is the last that should be finished within
    /// the limits, but two samples are always rendered. `None` if `go_on` returns false.
    ///
    /// # Errors
    /// If rendering fails.
    pub fn run(
        &mut self,
        curve: &Curve,
        job: &RenderJob,
        reference: &ReferencePicture,
        limits: Limits,
        go_on: &dyn Fn() -> bool,
    ) -> Result<Option<Run>> {
        let begin = Instant::now();
        let (about, prepare_seconds, points) = match self {
            Candidate::Renderer(renderer) => {
                let mut growing = Growing::new(renderer.as_mut(), job)?;
                let prepared = begin.elapsed();
                growing.warm_up()?;
                let points = powers_of_two(limits, go_on, |samples| growing.grow(samples, reference))?;
                (growing.about(), prepared, points)
            }
            Candidate::Baseline(baseline) => {
                let scene = baseline.write_scene(job, "report")?;
                let prepared = begin.elapsed();
                let points = powers_of_two(limits, go_on, |samples| {
                    let measured = by_baseline(baseline, &scene, job, samples, reference, go_on);
                    measured.context("the C89 program")
                })?;
                (baseline.about(), prepared, points)
            }
        };
        Ok(points.map(|points| Run {
            curve: curve.clone(),
            seed: job.settings().seed,
            about,
            prepare_seconds: prepare_seconds.as_secs_f64(),
            points,
        }))
    }
}

fn powers_of_two(
    limits: Limits,
    go_on: &dyn Fn() -> bool,
    mut measure: impl FnMut(u64) -> Result<Option<Measured>>,
) -> Result<Option<Vec<Measured>>> {
    let mut points = Vec::new();
    let mut samples = 1;
    while samples <= limits.samples.max(2) {
        if !go_on() {
            return Ok(None);
        }
        let Some(point) = measure(samples)? else { return Ok(None) };
        points.push(point);
        // Twice the samples are assumed to take twice as long.
        if samples >= 2 && 2.0 * point.wall_seconds > limits.seconds {
            break;
        }
        samples *= 2;
    }
    Ok(Some(points))
}

/// A film to which samples are added.
struct Growing<'a> {
    renderer: &'a mut dyn Renderer,
    job: &'a RenderJob,
    film: Film,
    trace: Duration,
    wall: Duration,
    rejected: u64,
    /// Time on the device's clock when the film was started.
    device_begin: Option<Duration>,
}

impl<'a> Growing<'a> {
    fn new(renderer: &'a mut dyn Renderer, job: &'a RenderJob) -> Result<Self> {
        renderer.prepare(job, &AtomicBool::new(false))?;
        Ok(Growing {
            renderer,
            job,
            film: job.new_film(),
            trace: Duration::ZERO,
            wall: Duration::ZERO,
            rejected: 0,
            device_begin: None,
        })
    }

    /// The first use of caches, threads and memory takes longer, so it happens outside the clock.
    fn warm_up(&mut self) -> Result<()> {
        self.renderer.accumulate(self.job, 0..1, &mut self.job.new_film(), &AtomicBool::new(false))?;
        self.device_begin = self.renderer.device_time();
        Ok(())
    }

    fn about(&self) -> String {
        let info = self.renderer.info();
        format!("{} {}, {} lanes, {} threads", info.name, info.device, info.lanes, info.threads)
    }

    fn grow(&mut self, samples: u64, reference: &ReferencePicture) -> Result<Option<Measured>> {
        let range = self.film.sample_count()..samples;
        let begin = Instant::now();
        let stats = self.renderer.accumulate(self.job, range, &mut self.film, &AtomicBool::new(false))?;
        self.wall += begin.elapsed();
        self.trace += stats.trace;
        self.rejected += stats.rejected;
        let device =
            self.renderer.device_time().zip(self.device_begin).map(|(now, begin)| now.saturating_sub(begin));
        let errors = reference.errors(&film_means(&self.film));
        Ok(Some(Measured {
            samples,
            trace_seconds: self.trace.as_secs_f64(),
            wall_seconds: self.wall.as_secs_f64(),
            device_seconds: device.map(|time| time.as_secs_f64()),
            mse: errors.mse,
            rel_mse: errors.rel_mse,
            flip: errors.flip,
            mse_estimate: self.film.error().map(|error| error.rmse.powi(2)),
            rejected: self.rejected,
        }))
    }
}

fn by_baseline(
    baseline: &Baseline,
    scene: &Path,
    job: &RenderJob,
    samples: u64,
    reference: &ReferencePicture,
    go_on: &dyn Fn() -> bool,
) -> Result<Option<Measured>> {
    let out = baseline.scratch("report.pfm");
    let settings = job.settings();
    let ran = baseline.run(Some(scene), settings, samples, settings.seed, Some(&out), &|| !go_on());
    let run = match ran {
        Err(BaselineError::Cancelled) => return Ok(None),
        ran => ran?,
    };
    // The encoding applies only to integers, and a PFM has none.
    let errors = reference.errors(&read_picture(&out, Encoding::Srgb)?.pixels);
    Ok(Some(Measured {
        samples,
        trace_seconds: run.processor_seconds,
        wall_seconds: run.seconds,
        device_seconds: None,
        mse: errors.mse,
        rel_mse: errors.rel_mse,
        flip: errors.flip,
        mse_estimate: None,
        rejected: 0,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backends::BackendChoice;
    use crate::film::PixelSum;
    use crate::recipe::Recipe;
    use crate::render::{BackendInfo, RenderError, Stats};
    use crate::render_cpu::CpuOptions;
    use std::ops::Range;

    /// A measurement without errors that took so long.
    fn measured(samples: u64, seconds: f64) -> Measured {
        Measured {
            samples,
            trace_seconds: seconds,
            wall_seconds: seconds,
            device_seconds: None,
            mse: 0.0,
            rel_mse: 0.0,
            flip: 0.0,
            mse_estimate: None,
            rejected: 0,
        }
    }

    #[test]
    fn the_last_step_should_end_within_the_limits() {
        let steps = |seconds: f64, samples: u64| -> Vec<u64> {
            let measure = |samples| Ok(Some(measured(samples, samples as f64)));
            let points = powers_of_two(Limits { seconds, samples }, &|| true, measure).unwrap().unwrap();
            points.iter().map(|point| point.samples).collect()
        };
        assert_eq!(steps(10.0, 64), [1, 2, 4, 8]);
        assert_eq!(steps(8.0, 64), [1, 2, 4, 8]);
        assert_eq!(steps(7.9, 64), [1, 2, 4]);
        assert_eq!(steps(1e9, 9), [1, 2, 4, 8]);
        assert_eq!(steps(0.1, 1), [1, 2], "two samples are always taken");
    }

    /// A second of the device's clock passes in every call.
    #[derive(Default)]
    struct Clocked {
        is_prepared: bool,
        clock: Duration,
        traced: Vec<Range<u64>>,
    }

    impl Renderer for Clocked {
        fn info(&self) -> BackendInfo {
            BackendInfo { name: "clocked", device: String::new(), lanes: 1, threads: 1 }
        }

        fn device_time(&self) -> Option<Duration> {
            Some(self.clock)
        }

        fn prepare(&mut self, _: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
            self.is_prepared = true;
            Ok(())
        }

        fn accumulate(
            &mut self,
            _: &RenderJob,
            range: Range<u64>,
            film: &mut Film,
            _: &AtomicBool,
        ) -> Result<Stats, RenderError> {
            assert!(self.is_prepared, "the time of preparing is no time of tracing");
            self.clock += Duration::from_secs(1);
            self.traced.push(range.clone());
            film.record(range, 2)?;
            Ok(Stats { rejected: 2, trace: Duration::from_millis(250), ..Stats::default() })
        }
    }

    #[test]
    fn the_warm_up_does_not_count() {
        let mut recipe = Recipe::find("metals").unwrap();
        (recipe.settings.width, recipe.settings.height) = (16, 9);
        let job = recipe.job().unwrap();
        let mut film = job.new_film();
        film.halves_mut()[0][0] = PixelSum([1; 3]);
        film.record(0..2, 0).unwrap();
        let reference = ReferencePicture::of_film("metals", "", &film, recipe.rules.transfer).unwrap();
        let mut clocked = Clocked { clock: Duration::from_secs(60), ..Clocked::default() };
        let mut growing = Growing::new(&mut clocked, &job).unwrap();
        growing.warm_up().unwrap();
        let mut measured = |samples| {
            let found = growing.grow(samples, &reference).unwrap().unwrap();
            (found.samples, found.trace_seconds, found.device_seconds, found.rejected)
        };
        assert_eq!(measured(2), (2, 0.25, Some(1.0), 2));
        assert_eq!(measured(4), (4, 0.5, Some(2.0), 4));
        assert_eq!(clocked.traced, [0..1, 0..2, 2..4]);
    }

    #[test]
    fn each_point_is_measured_on_the_samples_so_far() {
        let cpu = BackendChoice::Cpu(CpuOptions { threads: Some(1), ..CpuOptions::default() });
        let mut recipe = Recipe::find("metals").unwrap();
        (recipe.settings.width, recipe.settings.height, recipe.settings.seed) = (16, 9, 3);
        let job = recipe.job().unwrap();
        let film_of = |samples| {
            let mut film = job.new_film();
            let mut renderer = backends::create(&cpu).unwrap();
            renderer.accumulate(&job, 0..samples, &mut film, &AtomicBool::new(false)).unwrap();
            film
        };
        let transfer = recipe.rules.transfer;
        let reference = ReferencePicture::of_film("metals", "", &film_of(64), transfer).unwrap();
        let [scene, backend, sampler] = ["metals", "cpu", "sobol"].map(str::to_owned);
        let curve = Curve { scene, backend, sampler };
        let limits = Limits { seconds: 1e9, samples: 4 };
        let mut candidate = Candidate::of(&ReportBackend::Renderer(cpu.clone())).unwrap().unwrap();
        let run = candidate.run(&curve, &job, &reference, limits, &|| true).unwrap().unwrap();
        assert_eq!((&run.curve, run.seed, run.points.len()), (&curve, 3, 3));
        let BackendInfo { name, device, lanes, .. } = backends::create(&cpu).unwrap().info();
        assert_eq!(run.about, format!("{name} {device}, {lanes} lanes, 1 threads"));
        for (point, samples) in run.points.iter().zip([1, 2, 4]) {
            let film = film_of(samples);
            let errors = reference.errors(&film_means(&film));
            assert_eq!((point.samples, point.rejected, point.device_seconds), (samples, 0, None));
            assert_eq!((point.mse, point.rel_mse, point.flip), (errors.mse, errors.rel_mse, errors.flip));
            assert_eq!(point.mse_estimate, film.error().map(|error| error.rmse.powi(2)));
            assert!(0.0 < point.trace_seconds && point.trace_seconds <= point.wall_seconds, "{point:?}");
        }
        assert!(run.points.is_sorted_by(|a, b| a.wall_seconds < b.wall_seconds), "{run:?}");
        assert!(candidate.run(&curve, &job, &reference, limits, &|| false).unwrap().is_none());
        let asked = [SamplerKind::Sobol, SamplerKind::Independent];
        assert_eq!(candidate.samplers(&asked), asked);
    }

    #[test]
    fn a_measurement_ends_when_it_is_told_to() {
        let limits = Limits { seconds: 1e9, samples: 64 };
        let asked = std::cell::Cell::new(0);
        let go_on = || asked.replace(asked.get() + 1) < 3;
        let mut taken = Vec::new();
        let points = powers_of_two(limits, &go_on, |samples| {
            taken.push(samples);
            Ok(Some(measured(samples, 1.0)))
        });
        assert!(points.unwrap().is_none());
        assert_eq!(taken, [1, 2, 4]);
        assert!(powers_of_two(limits, &|| true, |_| Ok(None)).unwrap().is_none());
    }
}
