//! `weekender report`: error against time, for scenes, backends and samplers.

mod calibration;
mod candidate;
mod csv;
mod data;
mod figure;
mod progress;
mod reference;
mod rendered;
mod rounding;
mod summary;
mod table;
#[cfg(test)]
mod tests;

use crate::backends;
use crate::chart;
use crate::cli::{JsonTarget, ReferenceChoice, ReportOptions};
use crate::console;
use crate::failure::Failure;
use crate::files;
use crate::files::{check_writable, write_text};
use crate::film::{Film, SOFTWARE};
use crate::interrupt::Interrupt;
use crate::recipe::{Recipe, plain_name};
use crate::render::{RenderJob, RenderSettings, Renderer, SamplerKind};
use crate::terminal::{print, write_json};
use anyhow::{Context, Result};
use calibration::Calibration;
use candidate::{Candidate, Limits};
pub use data::Data;
use data::SCHEMA;
pub use data::{Curve, Settings};
use progress::Progress;
use reference::ReferencePicture;
use serde::Serialize;
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use summary::SamplerRatio;
pub use summary::{CurvePoint, CurveSummary};
use table::Findings;

/// Samples per pixel of the films that show the effect of rounding.
const ROUNDING_SAMPLES: u64 = 256;

/// Expected seconds for a reference and the rounding of a scene, for the progress bar.
const EXPECTED_SECONDS: f64 = 40.0;

/// Measures everything and writes the report to its directory. Results of an earlier, interrupted report with the
/// same settings are used again.
///
/// # Errors
/// [`Failure::Input`] if nothing was rendered, [`Failure::Run`] otherwise.
pub fn run(options: &ReportOptions) -> Result<ExitCode, Failure> {
    let mut report = Report::open(options).map_err(Failure::Input)?;
    let outcome = report.measure();
    report.progress.clear();
    // Measured results are kept in any case.
    let written = if report.data.runs.is_empty() { Ok(()) } else { report.write() };
    outcome.and(written).map_err(Failure::Run)?;
    if report.interrupt.is_set() {
        console::note("interrupted; run the same command again to continue");
        return Ok(report.interrupt.exit_code());
    }
    Ok(ExitCode::SUCCESS)
}

struct Report<'a> {
    options: &'a ReportOptions,
    data: Data,
    candidates: Vec<(String, Candidate)>,
    interrupt: Interrupt,
    progress: Progress,
}

impl<'a> Report<'a> {
    /// Checks for everything that could fail later, and reads existing results.
    fn open(options: &'a ReportOptions) -> Result<Self> {
        let candidates = candidates(options)?;
        if let ReferenceChoice::File(path) = &options.reference {
            for recipe in &options.scenes {
                reference::read(path, recipe, &options.samplers, options.seeds)?;
            }
        }
        let out = &options.out;
        std::fs::create_dir_all(out).with_context(|| {
            format!("cannot create the directory {}; choose another with --out", out.display())
        })?;
        check_writable(&out.join("report.json"))?;
        let settings = settings(options);
        let data = resumed(&out.join("report.json"), &settings).unwrap_or_else(|| Data {
            schema: SCHEMA,
            settings,
            references: Vec::new(),
            runs: Vec::new(),
            rounding: Vec::new(),
        });
        let per_scene: usize = candidates.iter().map(|(_, c)| c.samplers(&options.samplers).len()).sum();
        let curves = options.scenes.len() * per_scene;
        let total = curves as f64 * options.time_limit + 2.0 * EXPECTED_SECONDS * options.scenes.len() as f64;
        Ok(Report {
            options,
            data,
            candidates,
            interrupt: Interrupt::install()?,
            progress: Progress::new(options.progress, total),
        })
    }

    /// Measures what is missing, unless interrupted.
    fn measure(&mut self) -> Result<()> {
        let mut references = Vec::new();
        for recipe in &self.options.scenes {
            match self.reference(recipe)? {
                Some(reference) => references.push(reference),
                None => return Ok(()),
            }
        }
        self.data.take_references(references.iter().map(|reference| reference.used.clone()).collect());
        // The outer loop is over seeds, so that load from other programs affects all curves alike.
        for seed in 0..self.options.seeds {
            for (recipe, reference) in self.options.scenes.iter().zip(&references) {
                for candidate in 0..self.candidates.len() {
                    for sampler in self.candidates[candidate].1.samplers(&self.options.samplers) {
                        self.run(recipe, reference, candidate, sampler, seed)?;
                        if self.interrupt.is_set() {
                            return Ok(());
                        }
                    }
                }
            }
        }
        for recipe in &self.options.scenes {
            self.rounding(recipe)?;
        }
        Ok(())
    }

    fn reference(&mut self, recipe: &Recipe) -> Result<Option<ReferencePicture>> {
        let (interrupt, progress) = (&self.interrupt, &mut self.progress);
        let reference = match &self.options.reference {
            ReferenceChoice::File(path) => {
                Some(reference::read(path, recipe, &self.options.samplers, self.options.seeds)?)
            }
            ReferenceChoice::Make { choice, samples, .. } => {
                let path = self.options.out.join(format!("reference-{}.exr", plain_name(&recipe.name)));
                let what = format!("reference of {}", recipe.name);
                rendered::make(&path, recipe, choice, *samples, |share| {
                    progress.at(&what, share * EXPECTED_SECONDS);
                    !interrupt.is_set()
                })?
            }
        };
        self.progress.finished(EXPECTED_SECONDS);
        Ok(reference)
    }

    fn run(
        &mut self,
        recipe: &Recipe,
        reference: &ReferencePicture,
        candidate: usize,
        sampler: SamplerKind,
        seed: u32,
    ) -> Result<()> {
        let (backend, candidate) = &mut self.candidates[candidate];
        let curve = Curve {
            scene: recipe.name.clone(),
            backend: backend.clone(),
            sampler: sampler.name().to_owned(),
        };
        let seconds = self.options.time_limit / f64::from(self.options.seeds);
        self.progress.at(&format!("{}, {backend}, {}, seed {seed}", curve.scene, curve.sampler), 0.0);
        if !self.data.runs.iter().any(|run| run.curve == curve && run.seed == seed) {
            let job = job(recipe, sampler, seed, self.options.estimate_error)?;
            let limits = Limits { seconds, samples: self.options.max_samples };
            let interrupt = &self.interrupt;
            let run = candidate.run(&curve, &job, reference, limits, &|| !interrupt.is_set())?;
            if let Some(run) = run {
                self.data.runs.push(run);
                self.write_json()?;
            }
        }
        self.progress.finished(seconds);
        Ok(())
    }

    /// Renders the same samples in `f64` and on every other backend.
    fn rounding(&mut self, recipe: &Recipe) -> Result<()> {
        let is_there = |data: &Data, backend: &str| {
            data.rounding.iter().any(|row| row.scene == recipe.name && row.backend == backend)
        };
        let missing: Vec<(&str, &mut dyn Renderer)> = self
            .candidates
            .iter_mut()
            .filter(|(name, _)| name != "reference" && !is_there(&self.data, name))
            .filter_map(|(name, candidate)| match candidate {
                Candidate::Renderer(renderer) => Some((name.as_str(), renderer.as_mut())),
                Candidate::Baseline(_) => None,
            })
            .collect();
        if missing.is_empty() || self.interrupt.is_set() {
            return Ok(());
        }
        self.progress.at(&format!("rounding of {}", recipe.name), 0.0);
        let job = job(recipe, SamplerKind::Sobol, 0, true)?;
        let samples = self.options.max_samples.min(ROUNDING_SAMPLES);
        let mut exact = backends::create(&backends::BackendChoice::Reference { threads: None })?;
        let exact = film(exact.as_mut(), &job, samples)?;
        for (name, renderer) in missing {
            let film = film(renderer, &job, samples)?;
            self.data.rounding.push(rounding::rounding(&recipe.name, name, &film, &exact));
        }
        self.progress.finished(EXPECTED_SECONDS);
        self.write_json()
    }

    fn write_json(&self) -> Result<()> {
        let curves = summary::summaries(&self.data, &self.options.targets);
        let written = Written {
            data: &self.data,
            calibration: calibration::calibration(&self.data),
            sampler_ratios: summary::sampler_ratios(&curves),
        };
        write_json(&written, &JsonTarget::File(self.options.out.join("report.json")))
    }

    fn write(&self) -> Result<()> {
        let out = &self.options.out;
        self.write_json()?;
        let (data, targets) = (&self.data, self.options.targets.as_slice());
        let curves = summary::summaries(data, targets);
        let findings = Findings {
            data,
            curves: &curves,
            targets,
            calibration: &calibration::calibration(data),
            sampler_ratios: &summary::sampler_ratios(&curves),
        };
        write_text(&out.join("report.csv"), &csv::csv(data))?;
        write_text(&out.join("report.md"), &table::markdown(&findings, &self.options.command))?;
        let figure = figure::figure(data, &curves, targets[0]);
        for name in ["error-vs-time.png", "error-vs-time.svg"] {
            chart::save(&out.join(name), &figure)?;
        }
        print(&format!(
            "wrote report.md, report.csv, report.json, error-vs-time.png and .svg to {}\n",
            out.display()
        ))
    }
}

/// The content of `report.json`: the measurements and the results derived from them.
#[derive(Serialize)]
struct Written<'a> {
    #[serde(flatten)]
    data: &'a Data,
    calibration: Vec<Calibration>,
    sampler_ratios: Vec<SamplerRatio>,
}

/// The candidates, without those that are not available and were not asked for.
fn candidates(options: &ReportOptions) -> Result<Vec<(String, Candidate)>> {
    let mut candidates = Vec::new();
    for (name, backend) in &options.backends {
        let candidate =
            Candidate::of(backend).with_context(|| format!("the backend {name} is not available"))?;
        candidates.extend(candidate.map(|candidate| (name.clone(), candidate)));
    }
    Ok(candidates)
}

fn settings(options: &ReportOptions) -> Settings {
    let (reference, reference_samples) = match &options.reference {
        ReferenceChoice::File(path) => (path.display().to_string(), 0),
        ReferenceChoice::Make { name, samples, .. } => (name.clone(), *samples),
    };
    Settings {
        software: SOFTWARE.to_owned(),
        size: options.size,
        seeds: options.seeds,
        time_limit: options.time_limit,
        max_samples: options.max_samples,
        estimate_error: options.estimate_error,
        reference_samples,
        reference,
    }
}

/// Parses the measurements in the text of a `report.json`.
///
/// # Errors
/// What is wrong, and where.
pub fn parse(json: &[u8]) -> Result<Data, serde_json::Error> {
    serde_json::from_slice(json)
}

/// The curves of a report, with the times until the errors in `targets` are reached.
pub fn curves(data: &Data, targets: &[f64]) -> Vec<CurveSummary> {
    summary::summaries(data, targets)
}

/// The chart of a report, with the times to an error of `target` marked.
pub fn chart(data: &Data, target: f64) -> chart::Figure {
    figure::figure(data, &curves(data, &[target]), target)
}

/// Largest `report.json` that is read, bytes.
const REPORT_LIMIT: u64 = 64 << 20;

/// The measurements in `path`, if they were made with the same settings.
fn resumed(path: &Path, settings: &Settings) -> Option<Data> {
    let data = parse(&files::read(path, "a report", REPORT_LIMIT).ok()?).ok()?;
    (data.schema == SCHEMA && data.settings == *settings).then_some(data)
}

fn job(recipe: &Recipe, sampler: SamplerKind, seed: u32, estimate_error: bool) -> Result<RenderJob> {
    let settings = RenderSettings { sampler, seed, estimate_error, ..recipe.settings };
    Ok(Recipe { settings, ..recipe.clone() }.job()?)
}

fn film(renderer: &mut dyn Renderer, job: &RenderJob, samples: u64) -> Result<Film> {
    let mut film = job.new_film();
    renderer.accumulate(job, 0..samples, &mut film, &AtomicBool::new(false))?;
    Ok(film)
}
