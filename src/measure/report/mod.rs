//! `weekender report`: error against time, for scenes, backends and samplers.
//!
//! The history that a render keeps has only estimates, so each picture is measured against a reference here.

mod curves;
mod data;
mod figure;
mod reference;
mod text;

pub use curves::{CurvePoint, CurveSummary, curves};
pub use data::{Curve, Data, Settings};

use super::machine::Machine;
use super::progress::Progress;
use super::{Candidate, write_json};
use crate::cli::ReportOptions;
use crate::denoise;
use crate::film::{Film, SOFTWARE};
use crate::job::recipe::Recipe;
use crate::job::render::{RenderJob, SamplerKind};
use crate::numbers::chart;
use crate::system::console;
use crate::system::failure::Failure;
use crate::system::files::{check_writable, make_directory, write_text};
use crate::system::interrupt::Interrupt;
use crate::system::terminal::print;
use anyhow::Result;
use data::{Measured, Run};
use reference::ReferencePicture;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Measures everything and writes the report to its directory. [`Failure::Input`] if nothing was rendered,
/// [`Failure::Run`] otherwise.
pub fn run(options: &ReportOptions) -> Result<ExitCode, Failure> {
    let mut report = Report::open(options).map_err(Failure::Input)?;
    let outcome = report.measure();
    report.progress.display.clear();
    // Keep the measured results even if the report failed.
    let written = if report.data.runs.is_empty() { Ok(()) } else { report.write() };
    if report.interrupt.is_set() {
        written.map_err(Failure::Run)?;
        console::note("interrupted: the report has what was measured before");
        return Ok(report.interrupt.exit_code());
    }
    outcome.and(written).map_err(Failure::Run)?;
    Ok(ExitCode::SUCCESS)
}

struct Report<'a> {
    options: &'a ReportOptions,
    scenes: Vec<Recipe>,
    machine: Machine,
    data: Data,
    candidates: Vec<Candidate>,
    interrupt: Interrupt,
    progress: Progress,
}

impl<'a> Report<'a> {
    /// Checks everything that could fail later.
    fn open(options: &'a ReportOptions) -> Result<Self> {
        options.check()?;
        let (scenes, candidates) = (options.scenes()?, candidates(options)?);
        make_directory(&options.out)?;
        check_writable(&options.out.join("report.json"))?;
        let ReportOptions { size, seeds, time_limit, max_samples, .. } = *options;
        let settings = Settings { software: SOFTWARE.to_owned(), size, seeds, time_limit, max_samples };
        let data = Data { settings, references: Vec::new(), runs: Vec::new() };
        let curves: usize = candidates.iter().map(|candidate| samplers(candidate, options).len()).sum();
        let pictures = scenes.len() * (1 + curves * seeds as usize);
        let progress = Progress::new(options.progress, pictures as f64);
        let (machine, interrupt) = (Machine::look(), Interrupt::install()?);
        Ok(Report { options, scenes, machine, data, candidates, interrupt, progress })
    }

    fn measure(&mut self) -> Result<()> {
        let scenes = std::mem::take(&mut self.scenes);
        let references: Vec<ReferencePicture> =
            scenes.iter().map(|recipe| self.reference(recipe)).collect::<Result<_>>()?;
        self.data.references = references.iter().map(|reference| reference.used.clone()).collect();
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
        Ok(())
    }

    fn reference(&mut self, recipe: &Recipe) -> Result<ReferencePicture> {
        self.progress.at(&format!("reference of {}", recipe.name));
        let job = reference::job_of(recipe, SamplerKind::Sobol, reference::SEED)?;
        let mut exact = Candidate::new("reference", self.options.reference()?);
        let film = exact.trace(&job, self.options.reference_samples(), self.interrupt.flag())?.film;
        self.progress.finished(1.0);
        let about = exact.info().map_or_else(String::new, |info| format!("{} {}", info.name, info.device));
        ReferencePicture::of_film(&recipe.name, &about, &film)
    }

    fn picture(
        &mut self,
        recipe: &Recipe,
        reference: &ReferencePicture,
        candidate: usize,
        sampler: SamplerKind,
        seed: u32,
    ) -> Result<()> {
        let candidate = &mut self.candidates[candidate];
        let (scene, backend) = (recipe.name.clone(), candidate.name.clone());
        let curve = Curve { scene, backend, sampler: sampler.name().to_owned() };
        self.progress.at(&format!("{}, {}, {}, seed {seed}", curve.scene, curve.backend, curve.sampler));
        let limits = (self.options.time_limit / f64::from(self.options.seeds), self.options.max_samples);
        let job = reference::job_of(recipe, sampler, seed)?;
        let [raw, denoised] = measured(candidate, &job, reference, curve, limits, self.interrupt.flag())?;
        self.data.runs.push(raw);
        // One denoised curve for each backend suffices.
        if !denoised.points.is_empty() && self.options.samplers.first() == Some(&sampler) {
            self.data.runs.push(denoised);
        }
        self.progress.finished(1.0);
        Ok(())
    }

    fn write(&self) -> Result<()> {
        let (out, targets) = (&self.options.out, self.options.targets());
        let curves = curves(&self.data, &targets);
        write_json(&out.join("report.json"), &self.machine, &self.data)?;
        let text = text::markdown(&self.data, &curves, &targets, &self.options.command);
        write_text(&out.join("report.md"), &text)?;
        let figure = figure::figure(&self.data, &curves, targets[0]);
        write_text(&out.join("error-vs-time.svg"), &chart::svg(&figure)?)?;
        print(&format!("wrote report.md, report.json and error-vs-time.svg to {}\n", out.display()))
    }
}

/// The C program may be missing unless it was asked for.
fn candidates(options: &ReportOptions) -> Result<Vec<Candidate>> {
    let mut candidates = Vec::new();
    for name in options.backends() {
        let mut candidate = Candidate::new(name.clone(), options.backend(&name)?);
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

/// Renders 1, 2, 4 ... samples and measures each picture. Stops when the next doubling would exceed the limits, but
/// renders at least two. Measures each picture denoised as well; the time of its filter then counts. Returns the figures
/// raw and denoised. The limits are seconds of tracing and samples per pixel.
fn measured(
    candidate: &mut Candidate,
    job: &RenderJob,
    reference: &ReferencePicture,
    curve: Curve,
    (seconds, most_samples): (f64, u64),
    cancel: &AtomicBool,
) -> Result<[Run; 2]> {
    let renderer = candidate.start()?;
    renderer.prepare(job, cancel)?;
    let info = renderer.info();
    let about = format!("{} {}, {} lanes, {} threads", info.name, info.device, info.lanes, info.threads);
    let mut raw = Run { curve, seed: job.settings().seed, about, points: Vec::new() };
    let mut denoised = Run { curve: raw.curve.denoised(), ..raw.clone() };
    // The first picture pays for caches, threads and memory, so trace it off the clock.
    candidate.trace(job, 1, cancel)?;
    let mut film = candidate.new_film(job)?;
    let (mut wall, mut samples) = (Duration::ZERO, 1);
    while samples <= most_samples.max(2) {
        let begin = Instant::now();
        let stats = candidate.add(job, film.sample_count()..samples, &mut film, cancel)?;
        // Starting the C program and reading its picture do not count as rendering.
        wall += if candidate.is_baseline() { stats.trace } else { begin.elapsed() };
        let rejected = film.rejected();
        let point = |film: &Film, mse_estimate, wall: Duration| {
            let [mse, rel_mse] = reference.errors(film);
            Measured { samples, wall_seconds: wall.as_secs_f64(), mse, rel_mse, mse_estimate, rejected }
        };
        raw.points.push(point(&film, film.error().map(|error| error.rmse.powi(2)), wall));
        let begin = Instant::now();
        if let Ok(found) = denoise::of_film(&film) {
            denoised.points.push(point(&found.film, Some(found.error.mse), wall + begin.elapsed()));
        }
        // Assumes that twice the samples take twice as long.
        if samples >= 2 && 2.0 * wall.as_secs_f64() > seconds {
            break;
        }
        samples *= 2;
    }
    Ok([raw, denoised])
}

/// The chart of a report, with the times to an error of `target` marked.
pub fn chart(data: &Data, target: f64) -> chart::Figure {
    figure::figure(data, &curves(data, &[target]), target)
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
        let settings = Settings {
            software: "Weekender 1.2.3".to_owned(),
            size: (48, 27),
            seeds: 4,
            time_limit: 10.0,
            max_samples: 64,
        };
        Data { settings, references: Vec::new(), runs: Vec::new() }
    }

    fn small() -> Recipe {
        let mut recipe = Recipe::find("metals").unwrap();
        (recipe.settings.width, recipe.settings.height) = (16, 9);
        recipe
    }

    fn cpu() -> BackendChoice {
        BackendChoice::Cpu(CpuOptions { threads: Some(1), ..CpuOptions::default() })
    }

    #[test]
    fn points_accumulate_until_limit() {
        let go_on = AtomicBool::new(false);
        let recipe = small();
        let job = reference::job_of(&recipe, SamplerKind::Sobol, 3).unwrap();
        let film_of = |samples| Candidate::new("", cpu()).trace(&job, samples, &go_on).unwrap().film;
        let reference = ReferencePicture::of_film("metals", "", &film_of(64)).unwrap();
        let mut candidate = Candidate::new("cpu", cpu());
        let mut steps = |limits, cancel: &AtomicBool| {
            measured(&mut candidate, &job, &reference, curve("cpu", "sobol"), limits, cancel)
        };
        let [raw, denoised] = steps((1e9, 5), &go_on).unwrap();
        let samples = |run: &Run| run.points.iter().map(|point| point.samples).collect::<Vec<_>>();
        assert_eq!((samples(&raw), samples(&denoised)), (vec![1, 2, 4], vec![2, 4]));
        for point in &raw.points {
            let film = film_of(point.samples);
            assert_eq!([point.mse, point.rel_mse], reference.errors(&film));
            assert_eq!(point.mse_estimate, film.error().map(|error| error.rmse.powi(2)));
        }
        let seconds = [0, 1, 2].map(|index: usize| raw.points[index].wall_seconds);
        assert!(seconds.is_sorted() && denoised.points[1].wall_seconds > seconds[2], "{seconds:?}");
        let [raw, _] = steps((1e-9, 64), &go_on).unwrap();
        assert_eq!(raw.points.len(), 2, "two samples are always taken");
        assert!(steps((1e9, 64), &AtomicBool::new(true)).is_err());
    }
}
