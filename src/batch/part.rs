//! `weekender render-part`: renders a part of a plan. The command can be repeated at any time: it goes on from the part's
//! last checkpoint or from the frames that are there, and ends at once if the part is whole.

use super::files::Places;
use super::summary::Summary;
use super::{check_before, frames, render_all, write_figures};
use crate::cli::{BatchOptions, CHECKPOINT_INTERVAL, FramesOptions, PartOptions, RenderOptions};
use crate::console;
use crate::failure::Failure;
use crate::files::{NAME_LIMIT, ShownPath, free_name};
use crate::film::{CheckpointError, Film};
use crate::output::PpmForm;
use crate::plan::{AnyPlan, Frames, Part, Plan, Samples};
use crate::progressive::{self, EndReason, Phase, Status, Stop};
use crate::saved::{self, OpenError, SavedFilm};
use crate::terminal::print_beside;
use anyhow::{Context, anyhow};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

/// Renders what a part lacks.
///
/// # Errors
/// [`Failure::Input`] if there is no such part, or its file is another film; otherwise those of a render.
pub fn render_part(options: PartOptions) -> Result<ExitCode, Failure> {
    match AnyPlan::load(&options.plan).map_err(Failure::input)? {
        AnyPlan::Samples(plan) => render_samples(&plan, options),
        AnyPlan::Frames(plan) => render_frames_of(&plan, options),
    }
}

fn render_frames_of(plan: &Plan<Frames>, options: PartOptions) -> Result<ExitCode, Failure> {
    let part = plan.part(options.part).map_err(Failure::input)?;
    if options.every.is_some() {
        return Err(Failure::Input(anyhow!(
            "--every is for films, but {} divides an animation, whose frames are kept one by one; leave it out",
            plan.path.shown()
        )));
    }
    frames::render_frames(FramesOptions {
        recipe: plan.recipe.clone(),
        job: plan.job.clone(),
        stage: plan.stage(),
        path: plan.camera_path(),
        frames: part.range(),
        names: plan.names(),
        animation: None,
        backend: options.backend,
        progress: options.progress,
        json: options.json,
        command: options.command,
        notes: Vec::new(),
    })
}

fn render_samples(plan: &Plan<Samples>, options: PartOptions) -> Result<ExitCode, Failure> {
    let part = plan.part(options.part).map_err(Failure::input)?;
    let path = plan.part_path(part);
    let render = RenderOptions {
        recipe: plan.recipe.clone(),
        job: plan.job.clone(),
        stage: plan.stage(),
        plan: progressive::Plan {
            first_sample: part.samples[0],
            pass_target: progressive::Plan::BATCH_PASS,
            ..progressive::Plan::until(Stop::at_samples(part.samples[1]))
        },
        out: path.clone(),
        checkpoint: Some(path.clone()),
        every: options.every.unwrap_or(CHECKPOINT_INTERVAL),
        resume: Some(path.clone()),
        is_part: true,
        asked_samples: None,
        ppm: PpmForm::Binary,
        command: options.command.clone(),
        notes: Vec::new(),
    };
    let batch = BatchOptions {
        renders: vec![render],
        directory: None,
        save_scene: None,
        backend: options.backend,
        progress: options.progress,
        json: options.json,
        crashes_at: None,
    };
    check_before(&batch)?;
    // The places are locked before the film is read: another run may be writing it.
    let places =
        batch.renders.iter().map(Places::of).collect::<Result<Vec<_>, _>>().map_err(Failure::input)?;
    let found = find(&path, plan, part)?;
    if let Some(found) = &found
        && part.missing(found.film.samples()) == 0
    {
        let [start, end] = part.samples;
        let words = format!("part {} is whole: samples {start}..{end} in {}\n", options.part, path.shown());
        print_beside(batch.json.as_ref(), &words).map_err(Failure::Run)?;
        let summaries = batch.renders.iter().map(|render| summary_of_whole(render, &found.film)).collect();
        write_figures(&batch, summaries).map_err(Failure::Run)?;
        return Ok(ExitCode::SUCCESS);
    }
    render_all(batch, &places, found, &[])
}

/// The figures of a part of which nothing was left to render.
fn summary_of_whole(render: &RenderOptions, film: &Film) -> Summary {
    let status = Status {
        phase: Phase::Done(EndReason::Samples),
        samples_per_pixel: film.sample_count(),
        rejected_samples: film.rejected(),
        error: film.error(),
        ..Status::default()
    };
    Summary::new(render, &status, Some(film), vec![render.out.clone()], Duration::ZERO)
}

/// The film of the part, if there is one to go on with. A damaged one is put aside.
fn find(path: &Path, plan: &Plan<Samples>, part: &Part) -> Result<Option<SavedFilm>, Failure> {
    if path.symlink_metadata().is_err() {
        return Ok(None);
    }
    match saved::resume(path, &plan.job) {
        Ok(found) if part.is_exceeded_by(found.film.samples()) => Err(Failure::Input(anyhow!(
            "{} holds the samples {}, but this part has {}..{}; move the file away, and run this again",
            path.shown(),
            found.film.samples(),
            part.samples[0],
            part.samples[1]
        ))),
        Ok(found) => Ok(Some(found)),
        Err(OpenError::Film(
            damaged @ (CheckpointError::Damaged { .. }
            | CheckpointError::NotExr { .. }
            | CheckpointError::NotFilm { .. }),
        )) => {
            let aside = free_name(|number| damaged_name(path, number)).ok_or_else(|| {
                let last = damaged_name(path, NAME_LIMIT);
                Failure::Input(anyhow!(
                    "{damaged}; it cannot be put aside, because the names up to {} are taken; delete some of them",
                    last.shown()
                ))
            })?;
            std::fs::rename(path, &aside)
                .with_context(|| format!("cannot rename {} to {}", path.shown(), aside.shown()))
                .map_err(Failure::Input)?;
            console::note(&format!(
                "warning: {damaged}; it is now {}, and the part is rendered again",
                aside.shown()
            ));
            Ok(None)
        }
        Err(OpenError::OtherPicture { path, difference }) => Err(Failure::Input(anyhow!(
            "{} is the film of another picture: {difference}; move the file away, and run this again",
            path.shown()
        ))),
        Err(error) => Err(Failure::input(error)),
    }
}

/// `part-0.exr.damaged`, or `part-0.exr.damaged-2` and so on.
fn damaged_name(path: &Path, number: u32) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(if number == 1 { ".damaged".to_owned() } else { format!(".damaged-{number}") });
    PathBuf::from(name)
}
