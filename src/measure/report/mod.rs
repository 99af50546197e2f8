//! `weekender report`: error against time, for scenes, backends and samplers.

mod data;
mod figure;
mod reference;
mod rounding;
mod summary;
mod text;

pub use data::{Curve, Data, Settings};
pub use summary::{CurvePoint, CurveSummary, curves};

use super::machine::Machine;
use super::progress::Progress;
use super::{Candidate, SCHEMA, Source, Stop, make_directory, write_json};
use crate::backends;
use crate::cli::terminal::print;
use crate::cli::{JsonTarget, ReferenceChoice, ReportOptions};
use crate::denoise;
use crate::film::{Film, SOFTWARE};
use crate::job::recipe::Recipe;
use crate::job::render::{RenderJob, RenderSettings, SamplerKind, Stats};
use crate::numbers::chart;
use crate::system::console;
use crate::system::failure::Failure;
use crate::system::files::{self, check_writable, write_text};
use crate::system::interrupt::Interrupt;
use anyhow::{Result, anyhow};
use data::{Measured, Run};
use reference::{ReferencePicture, film_means};
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use summary::Findings;

/// Samples per pixel of the films that show the effect of rounding.
const ROUNDING_SAMPLES: u64 = 256;

/// Expected seconds for a scene's reference and rounding, for the progress bar.
const EXPECTED_SECONDS: f64 = 40.0;

/// Largest `report.json` read, bytes.
const REPORT_LIMIT: u64 = 64 << 20;

/// Measures everything and writes the report to its directory, reusing results of an interrupted report with the same
/// settings. [`Failure::Input`] if nothing was rendered, [`Failure::Run`] otherwise.
pub fn run(options: &ReportOptions) -> Result<ExitCode, Failure> {
    let mut report = Report::open(options).map_err(Failure::Input)?;
    let outcome = report.measure();
    report.progress.clear();
    // Keep the measured results even if the report failed.
    let written = if report.data.runs.is_empty() { Ok(()) } else { report.write() };
    let is_interrupted = report.interrupt.is_set();
    match outcome {
        Err(Stop::Failed(reason)) => return Err(Failure::Run(anyhow!(reason))),
        Ok(()) | Err(Stop::Cancelled) => written.map_err(Failure::Run)?,
    }
    if is_interrupted {
        console::note("interrupted; run the same command again to continue");
        return Ok(report.interrupt.exit_code());
    }
    Ok(ExitCode::SUCCESS)
}

struct Report<'a> {
    options: &'a ReportOptions,
    scenes: Vec<Recipe>,
    reference: ReferenceChoice,
    machine: Machine,
    data: Data,
    candidates: Vec<Candidate>,
    interrupt: Interrupt,
    progress: Progress,
}

impl<'a> Report<'a> {
    /// Checks everything that could fail later, and reads existing results.
    fn open(options: &'a ReportOptions) -> Result<Self> {
        let (scenes, reference) = (options.scenes()?, options.reference()?);
        let candidates = candidates(options)?;
        let out = &options.out;
        make_directory(out)?;
        check_writable(&out.join("report.json"))?;
        let settings = settings(options, &reference);
        let data = resumed(&out.join("report.json"), &settings).unwrap_or_else(|| Data::new(settings));
        let per_scene: usize = candidates.iter().map(|c| samplers(c, options).len()).sum();
        let per_scene = per_scene as f64 * options.time_limit + 2.0 * EXPECTED_SECONDS;
        let progress = Progress::new(options.progress, scenes.len() as f64 * per_scene);
        let (machine, interrupt) = (Machine::look(), Interrupt::install()?);
        Ok(Report { options, scenes, reference, machine, data, candidates, interrupt, progress })
    }

    fn measure(&mut self) -> Result<(), Stop> {
        let scenes = std::mem::take(&mut self.scenes);
        let references: Vec<ReferencePicture> =
            scenes.iter().map(|recipe| self.reference(recipe)).collect::<Result<_, _>>()?;
        self.data.take_references(references.iter().map(|reference| reference.used.clone()).collect());
        // Loop over seeds on the outside, so that load from other programs affects all curves alike.
        for seed in 0..self.options.seeds {
            for (recipe, reference) in scenes.iter().zip(&references) {
                for candidate in 0..self.candidates.len() {
                    for sampler in samplers(&self.candidates[candidate], self.options) {
                        self.picture(recipe, reference, candidate, sampler, seed)?;
                    }
                }
            }
        }
        scenes.iter().try_for_each(|recipe| self.rounding(recipe))
    }

    fn reference(&mut self, recipe: &Recipe) -> Result<ReferencePicture, Stop> {
        let (interrupt, progress) = (&self.interrupt, &mut self.progress);
        let ReferenceChoice { choice, samples, .. } = &self.reference;
        let path = self.options.reference_path(recipe);
        let what = format!("reference of {}", recipe.name);
        let mut renderer = backends::create(choice).map_err(anyhow::Error::from)?;
        let made = reference::make(renderer.as_mut(), &path, recipe, *samples, |share| {
            progress.at(&what, share * EXPECTED_SECONDS);
            !interrupt.is_set()
        });
        let reference = made?.ok_or(Stop::Cancelled)?;
        self.progress.finished(EXPECTED_SECONDS);
        Ok(reference)
    }

    fn picture(
        &mut self,
        recipe: &Recipe,
        reference: &ReferencePicture,
        candidate: usize,
        sampler: SamplerKind,
        seed: u32,
    ) -> Result<(), Stop> {
        let candidate = &mut self.candidates[candidate];
        let (scene, backend) = (recipe.name.clone(), candidate.name.clone());
        let curve = Curve { scene, backend, sampler: sampler.name().to_owned() };
        let seconds = self.options.time_limit / f64::from(self.options.seeds);
        self.progress.at(&format!("{}, {}, {}, seed {seed}", curve.scene, curve.backend, curve.sampler), 0.0);
        if !self.data.runs.iter().any(|run| run.curve == curve && run.seed == seed) {
            let job = job(recipe, sampler, seed, self.options.estimate_error)?;
            let limits = Limits { seconds, samples: self.options.max_samples };
            let (about, prepare_seconds, [raw, denoised]) =
                measured(candidate, &job, reference, limits, self.interrupt.flag())?;
            let with = |curve, points| Run { curve, seed, about: about.clone(), prepare_seconds, points };
            self.data.runs.push(with(curve.clone(), raw));
            // One denoised curve for each backend suffices.
            if !denoised.is_empty() && self.options.samplers.first() == Some(&sampler) {
                self.data.runs.push(with(curve.denoised(), denoised));
            }
            self.write_json()?;
        }
        self.progress.finished(seconds);
        Ok(())
    }

    /// Renders the same samples in `f64` and on every other backend.
    fn rounding(&mut self, recipe: &Recipe) -> Result<(), Stop> {
        let Report { data, candidates, interrupt, progress, options, .. } = self;
        let is_there = |name: &str| {
            data.rounding.iter().any(|row| row.scene == recipe.name && row.backend == name)
                || name == "reference"
        };
        let missing: Vec<&mut Candidate> =
            candidates.iter_mut().filter(|c| !c.is_baseline() && !is_there(&c.name)).collect();
        if missing.is_empty() {
            return Ok(());
        }
        progress.at(&format!("rounding of {}", recipe.name), 0.0);
        let job = job(recipe, SamplerKind::Sobol, 0, true)?;
        let samples = options.max_samples.min(ROUNDING_SAMPLES);
        let mut exact = Candidate::backend("reference", backends::BackendChoice::Reference { threads: None });
        let exact = exact.trace(&job, samples, interrupt.flag())?.film;
        for candidate in missing {
            let film = candidate.trace(&job, samples, interrupt.flag())?.film;
            data.rounding.push(rounding::rounding(&recipe.name, &candidate.name, &film, &exact));
        }
        progress.finished(EXPECTED_SECONDS);
        Ok(self.write_json()?)
    }

    fn write_json(&self) -> Result<()> {
        let target = JsonTarget::File(self.options.out.join("report.json"));
        write_json(&target, &self.machine, &Findings::of(&self.data, &[]))
    }

    fn write(&self) -> Result<()> {
        self.write_json()?;
        let (out, targets) = (&self.options.out, self.options.targets());
        let findings = Findings::of(&self.data, &targets);
        write_text(&out.join("report.csv"), &text::csv(&self.data))?;
        write_text(&out.join("report.md"), &text::markdown(&findings, &self.options.command))?;
        let figure = figure::figure(&self.data, &findings.curves, targets[0]);
        for name in ["error-vs-time.png", "error-vs-time.svg"] {
            chart::save(&out.join(name), &figure)?;
        }
        print(&format!(
            "wrote report.md, report.csv, report.json, error-vs-time.png and .svg to {}\n",
            out.display()
        ))
    }
}

/// The C program may be missing unless it was asked for.
fn candidates(options: &ReportOptions) -> Result<Vec<Candidate>> {
    let mut candidates = Vec::new();
    for name in options.backends() {
        let source = options.backend(&name)?.map_or(Source::C89, Source::Backend);
        let mut candidate = Candidate::new(name.clone(), source);
        match candidate.start().err() {
            None => candidates.push(candidate),
            Some(_) if candidate.is_baseline() && !options.names_backends() => {}
            Some(error) => return Err(error.context(format!("the backend {name} is not available"))),
        }
    }
    Ok(candidates)
}

/// The samplers to measure a candidate with. The C program only has its own independent numbers.
fn samplers(candidate: &Candidate, options: &ReportOptions) -> Vec<SamplerKind> {
    if candidate.is_baseline() { vec![SamplerKind::Independent] } else { options.samplers.clone() }
}

fn settings(options: &ReportOptions, reference: &ReferenceChoice) -> Settings {
    Settings {
        software: SOFTWARE.to_owned(),
        size: options.size,
        seeds: options.seeds,
        time_limit: options.time_limit,
        max_samples: options.max_samples,
        estimate_error: options.estimate_error,
        reference_samples: reference.samples,
        reference: reference.name.clone(),
    }
}

#[derive(Clone, Copy)]
struct Limits {
    seconds: f64,
    /// Samples per pixel.
    samples: u64,
}

/// Renders 1, 2, 4 ... samples and measures each picture. Stops when the next doubling would exceed the limits, but
/// renders at least two. Measures each picture denoised as well; the time of its filter then counts. Returns the backend's
/// name, the preparation time in seconds, and the figures raw and denoised.
fn measured(
    candidate: &mut Candidate,
    job: &RenderJob,
    reference: &ReferencePicture,
    limits: Limits,
    cancel: &AtomicBool,
) -> Result<(String, f64, [Vec<Measured>; 2]), Stop> {
    let begin = Instant::now();
    let renderer = candidate.start()?;
    renderer.prepare(job, cancel)?;
    let prepare_seconds = begin.elapsed().as_secs_f64();
    let info = renderer.info();
    let about = format!("{} {}, {} lanes, {} threads", info.name, info.device, info.lanes, info.threads);
    // The first picture pays for caches, threads and memory, so trace it off the clock.
    candidate.trace(job, 1, cancel)?;
    let device_begin = candidate.start()?.device_time();
    let mut film = candidate.new_film(job);
    let (mut total, mut wall, [mut raw, mut denoised]) =
        (Stats::default(), Duration::ZERO, [const { Vec::new() }; 2]);
    let mut samples = 1;
    while samples <= limits.samples.max(2) {
        let begin = Instant::now();
        let stats = candidate.add(job, film.sample_count()..samples, &mut film, cancel)?;
        // Starting the C program and reading its picture do not count as rendering.
        wall += if candidate.is_baseline() { stats.trace } else { begin.elapsed() };
        total.add(&stats);
        let device = candidate.start()?.device_time().zip(device_begin);
        let point = |film: &Film, mse_estimate, filter: Duration| {
            let errors = reference.errors(&film_means(film));
            Measured {
                samples,
                trace_seconds: total.trace.as_secs_f64(),
                wall_seconds: (wall + filter).as_secs_f64(),
                device_seconds: device.map(|(now, begin)| now.saturating_sub(begin).as_secs_f64()),
                mse: errors.mse,
                rel_mse: errors.rel_mse,
                flip: errors.flip,
                mse_estimate,
                rejected: total.rejected,
            }
        };
        raw.push(point(&film, film.error().map(|error| error.rmse.powi(2)), Duration::ZERO));
        let begin = Instant::now();
        if let Ok(found) = denoise::of_film(&film) {
            denoised.push(point(&found.film, Some(found.error.mse), begin.elapsed()));
        }
        // Assumes that twice the samples take twice as long.
        if samples >= 2 && 2.0 * wall.as_secs_f64() > limits.seconds {
            break;
        }
        samples *= 2;
    }
    Ok((about, prepare_seconds, [raw, denoised]))
}

/// Parses a `report.json`.
pub fn parse(json: &[u8]) -> Result<Data, serde_json::Error> {
    serde_json::from_slice(json)
}

/// The chart of a report, with the times to an error of `target` marked.
pub fn chart(data: &Data, target: f64) -> chart::Figure {
    figure::figure(data, &curves(data, &[target]), target)
}

/// The measurements in `path`, if made with the same settings.
fn resumed(path: &Path, settings: &Settings) -> Option<Data> {
    let data = parse(&files::read(path, "a report", REPORT_LIMIT).ok()?).ok()?;
    (data.schema == SCHEMA && data.settings == *settings).then_some(data)
}

fn job(recipe: &Recipe, sampler: SamplerKind, seed: u32, estimate_error: bool) -> Result<RenderJob> {
    let settings = RenderSettings { sampler, seed, estimate_error, ..recipe.settings };
    Ok(Recipe { settings, ..recipe.clone() }.job()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backends::BackendChoice;
    use crate::render_cpu::CpuOptions;

    pub fn curve(backend: &str, sampler: &str) -> Curve {
        Curve { scene: "s".to_owned(), backend: backend.to_owned(), sampler: sampler.to_owned() }
    }

    pub fn data() -> Data {
        Data::new(Settings {
            software: "Weekender 1.2.3".to_owned(),
            size: (48, 27),
            seeds: 4,
            time_limit: 10.0,
            max_samples: 64,
            estimate_error: true,
            reference_samples: 512,
            reference: "cpu".to_owned(),
        })
    }

    pub fn small() -> Recipe {
        let mut recipe = Recipe::find("metals").unwrap();
        (recipe.settings.width, recipe.settings.height) = (16, 9);
        recipe
    }

    /// One CPU thread, which panics after this many tiles.
    pub fn cpu(panics_after: Option<u64>) -> BackendChoice {
        BackendChoice::Cpu(CpuOptions { threads: Some(1), panics_after, ..CpuOptions::default() })
    }

    #[test]
    fn points_accumulate_until_limit() {
        let go_on = AtomicBool::new(false);
        let recipe = small();
        let job = job(&recipe, SamplerKind::Sobol, 3, true).unwrap();
        let film_of = |samples| Candidate::backend("", cpu(None)).trace(&job, samples, &go_on).unwrap().film;
        let reference = ReferencePicture::of_film("metals", "", &film_of(64), recipe.rules.transfer).unwrap();
        let mut candidate = Candidate::backend("cpu", cpu(None));
        let mut steps = |seconds, samples| {
            measured(&mut candidate, &job, &reference, Limits { seconds, samples }, &go_on).unwrap()
        };
        let (about, _, [points, denoised]) = steps(1e9, 5);
        assert!(about.starts_with("cpu ") && about.ends_with(" 1 threads"), "{about}");
        assert_eq!(points.iter().map(|point| point.samples).collect::<Vec<_>>(), [1, 2, 4]);
        for point in &points {
            let film = film_of(point.samples);
            let errors = reference.errors(&film_means(&film));
            assert_eq!((point.mse, point.rel_mse, point.flip), (errors.mse, errors.rel_mse, errors.flip));
            assert_eq!(point.mse_estimate, film.error().map(|error| error.rmse.powi(2)));
            assert!(0.0 < point.trace_seconds && point.trace_seconds <= point.wall_seconds, "{point:?}");
        }
        assert_eq!(denoised.iter().map(|point| point.samples).collect::<Vec<_>>(), [2, 4]);
        assert!(
            denoised.iter().zip(&points[1..]).all(|(denoised, raw)| denoised.wall_seconds > raw.wall_seconds)
        );
        assert!(points.is_sorted_by(|a, b| a.wall_seconds < b.wall_seconds), "{points:?}");
        assert_eq!(steps(1e-9, 64).2[0].len(), 2, "two samples are always taken");
        let limits = Limits { seconds: 1e9, samples: 64 };
        let cancelled = measured(&mut candidate, &job, &reference, limits, &AtomicBool::new(true));
        assert_eq!(cancelled.err(), Some(Stop::Cancelled));
    }

    #[test]
    fn resumes_only_with_same_settings() {
        let at = tempfile::tempdir().unwrap();
        let path = at.path().join("report.json");
        let data = data();
        let write = |data: &Data| {
            let target = JsonTarget::File(path.clone());
            write_json(&target, &Machine::look(), data).unwrap();
        };
        write(&data);
        assert_eq!(resumed(&path, &data.settings), Some(data.clone()));
        let other = Settings { max_samples: 128, ..data.settings.clone() };
        assert_eq!(resumed(&path, &other), None);
        assert_eq!(resumed(&at.path().join("nothing.json"), &data.settings), None);
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, text.replacen("\"schema\": 1", "\"schema\": 2", 1)).unwrap();
        assert_eq!(resumed(&path, &data.settings), None);
    }
}
