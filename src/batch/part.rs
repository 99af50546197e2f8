//! `weekender render-part`: renders a part of a plan. The command can be repeated at any time: it continues from the
//! part's last checkpoint, and ends at once if the part is complete.

use super::files::Files;
use super::summary::Summary;
use super::{check_before, render, write_figures};
use crate::cli::terminal::print_beside;
use crate::cli::{BatchOptions, PartOptions, check_paths};
use crate::film::CheckpointError;
use crate::job::output::OutputFormat;
use crate::job::plan::{Part, Plan};
use crate::job::saved::{self, OpenError, SavedFilm};
use crate::progressive::{self, EndReason, Phase, Status};
use crate::system::console;
use crate::system::failure::Failure;
use crate::system::files::ShownPath;
use anyhow::{Context, anyhow};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

/// Renders what a part lacks.
///
/// # Errors
/// [`Failure::Input`] if there is no such part, or its file is another film; otherwise those of a render.
pub fn render_part(options: PartOptions) -> Result<ExitCode, Failure> {
    let part = options.part().map_err(Failure::Input)?;
    let plan = Plan::load(&options.plan).map_err(Failure::Input)?;
    let index = plan.index(part).map_err(Failure::Input)?;
    let files = plan.files();
    check_paths(files.iter().map(PathBuf::as_path), options.json.as_deref()).map_err(Failure::Input)?;
    render_samples(&plan, index, options)
}

fn render_samples(plan: &Plan, index: usize, options: PartOptions) -> Result<ExitCode, Failure> {
    let part = &plan.manifest.parts[index];
    let ([start, end], path) = (part.samples, plan.beside(&part.file));
    let batch = BatchOptions {
        recipe: plan.recipe.clone(),
        job: plan.job.clone(),
        stage: plan.stage(),
        plan: progressive::Plan { first_sample: start, ..super::Studio::plan(end) },
        denoise: false,
        out: vec![(path.clone(), OutputFormat::Exr)],
        checkpoint: Some(path.clone()),
        every: options.every,
        resume: Some(path.clone()),
        save_scene: None,
        backend: options.backend,
        progress: options.progress,
        json: options.json,
        crashes_at: None,
    };
    check_before(&batch)?;
    let files = Files::lock(&batch)?;
    match find(&path, plan, part)? {
        Some(found) if part.missing(found.film.samples()) == 0 => {
            let text = format!("part {index} is complete: samples {start}..{end} in {}\n", path.shown());
            print_beside(batch.json.as_deref(), &text).map_err(Failure::Run)?;
            let figures = summary_of_whole(&batch, &found).json();
            write_figures(&figures, batch.json.as_deref()).map_err(Failure::Run)?;
            Ok(ExitCode::SUCCESS)
        }
        found => render(&batch, files, found),
    }
}

/// Figures of a part with nothing left to render.
fn summary_of_whole<'a>(render: &'a BatchOptions, found: &SavedFilm) -> Summary<'a> {
    let film = &found.film;
    let status = Status {
        phase: Phase::Done(EndReason::Samples),
        samples_per_pixel: film.sample_count(),
        rejected_samples: film.rejected(),
        error: film.error(),
        ..Status::default()
    };
    let samples = Some(film.samples().to_string());
    let files = render.files().cloned().collect();
    Summary { render, samples, status, denoised: None, files, writing: Duration::ZERO }
}

/// The part's film to continue, or `None`. A damaged film is moved aside.
fn find(path: &Path, plan: &Plan, part: &Part) -> Result<Option<SavedFilm>, Failure> {
    if path.symlink_metadata().is_err() {
        return Ok(None);
    }
    const REMEDY: &str = "move the file away, and run this again";
    match saved::resume(path, &plan.job) {
        Ok(found) if part.is_exceeded_by(found.film.samples()) => Err(Failure::Input(anyhow!(
            "{} holds the samples {}, but this part has {}..{}; {REMEDY}",
            path.shown(),
            found.film.samples(),
            part.samples[0],
            part.samples[1]
        ))),
        Ok(found) => Ok(Some(found)),
        Err(OpenError::Film(
            damaged @ (CheckpointError::Damaged { .. }
            | CheckpointError::NotExr { .. }
            | CheckpointError::NotFilm { .. }
            | CheckpointError::Resaved { .. }),
        )) => put_aside(path, &damaged).map(|()| None).map_err(Failure::Input),
        Err(OpenError::OtherPicture { path, difference }) => Err(Failure::Input(anyhow!(
            "{} is the film of another picture: {difference}; {REMEDY}",
            path.shown()
        ))),
        Err(error) => Err(Failure::input(error)),
    }
}

/// Renames a damaged film to `part-0.exr.damaged`.
fn put_aside(path: &Path, damaged: &CheckpointError) -> anyhow::Result<()> {
    let mut aside = path.as_os_str().to_owned();
    aside.push(".damaged");
    let context = || format!("cannot rename {} to {}", path.shown(), aside.shown());
    std::fs::rename(path, &aside).with_context(context)?;
    console::note(&format!(
        "warning: {damaged}; it is now {}, and the part is rendered again",
        aside.shown()
    ));
    Ok(())
}
