//! Flags of `weekender plan` and `weekender render-part`.

use super::backend;
use super::error::CliError;
use super::frames::{DEFAULT_RATE, frames_of, path_of};
use super::paths::{Paths, same_name};
use super::raw::{self, ProgressChoice, RawAnimation, RawBackend, RawPicture, RawSwitch};
use super::sources::{self, ChosenRecipe};
use super::unused;
use super::values::{JsonTarget, parse_duration, parse_sample_range, whole};
use crate::animation::Turn;
use crate::backends::BackendChoice;
use crate::output::FrameRate;
use crate::plan::PlanFiles;
use crate::recipe::Recipe;
use crate::render::{RenderJob, SAMPLE_LIMIT};
use crate::stages::Stage;
use clap::{Args, ValueEnum, ValueHint};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Most parts of a plan.
const PARTS_LIMIT: u64 = 100_000;

/// The variables in which schedulers give a task its number.
const PART_VARIABLES: [&str; 2] = ["SLURM_ARRAY_TASK_ID", "JOB_COMPLETION_INDEX"];

#[derive(Debug, Args)]
pub(super) struct RawPlan {
    #[command(flatten)]
    pub picture: RawPicture,

    /// Samples per pixel of the whole picture, 1 to 4294967296 [default: the scene's]
    #[arg(long, value_name = "COUNT", value_parser = whole(1..=SAMPLE_LIMIT, 100),
          allow_hyphen_values = true, help_heading = "Parts")]
    pub samples: Option<u64>,
    /// Divide only samples A to B - 1, to add them to a picture that has the others
    #[arg(long, value_name = "A..B", value_parser = parse_sample_range, conflicts_with = "samples",
          help_heading = "Parts")]
    pub sample_range: Option<Range<u64>>,
    /// Keep samples in two halves, which is needed to estimate the error; off halves the memory
    /// [default: on, or the scene's]
    #[arg(long, value_enum, help_heading = "Parts")]
    pub estimate_error: Option<RawSwitch>,
    /// Parts, 1 to 100000: each holds some samples of the whole picture, or some whole frames of an animation
    #[arg(long, value_name = "COUNT", value_parser = whole(1..=PARTS_LIMIT, 10),
          allow_hyphen_values = true, help_heading = "Parts")]
    pub parts: u64,

    #[command(flatten)]
    pub animation: RawAnimation,

    #[command(flatten)]
    pub backend: RawBackend,

    /// The directory of the plan, of its parts and of the merged film; it is created if necessary
    #[arg(long, value_name = "DIR", help_heading = "Files")]
    pub out: PathBuf,
    /// Interval at which a part's film is written, as for rendering: 0.1s to 30d [default: 60s]
    #[arg(long, value_name = "DURATION", value_parser = parse_duration, allow_hyphen_values = true,
          help_heading = "Files")]
    pub every: Option<Duration>,
    /// What is made: the commands, one per line; the same as JSON; or files that give the parts to Slurm, GNU parallel or
    /// make
    #[arg(long, value_enum, default_value = "text", help_heading = "Files")]
    pub format: PlanFormat,
    /// How the commands call this program [default: as it was called, with its directory if that was given]
    #[arg(long, value_name = "NAME", value_hint = ValueHint::ExecutablePath, help_heading = "Files")]
    pub program: Option<String>,
}

#[derive(Debug, Args)]
pub(super) struct RawPart {
    /// The plan: its directory, or its plan.json
    #[arg(value_name = "PLAN")]
    pub plan: PathBuf,
    /// The number of the part, from 0 [default: SLURM_ARRAY_TASK_ID or JOB_COMPLETION_INDEX of the environment]
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    pub part: Option<u64>,

    #[command(flatten)]
    pub backend: RawBackend,

    /// Interval at which the part's film is written: 0.1s to 30d, such as 30s, 5m or 1h [default: 60s]
    #[arg(long, value_name = "DURATION", value_parser = parse_duration, allow_hyphen_values = true)]
    pub every: Option<Duration>,
    /// Write the final figures as JSON; - for standard output
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
    /// Show progress on standard error; auto: if it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
}

/// What `weekender plan` makes besides the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PlanFormat {
    /// The commands on standard output, one per line.
    Text,
    /// Manifest and commands as JSON on standard output.
    Json,
    /// A Slurm job array.
    Slurm,
    /// A script for GNU parallel.
    Parallel,
    /// A makefile.
    Make,
}

/// What a plan divides.
#[derive(Clone, Debug, PartialEq)]
pub enum PlannedWork {
    /// Samples of a picture.
    Samples(Range<u64>),
    /// Frames of an animation, whose cameras are valid.
    Frames {
        /// Numbers of the frames.
        frames: Range<u32>,
        /// How the camera circles, unless it follows keyframes.
        turntable: Option<Turn>,
        /// The rate of the animated PNG.
        rate: FrameRate,
    },
}

/// Options of `weekender plan`.
#[derive(Debug)]
pub struct PlanOptions {
    /// What to render.
    pub recipe: Recipe,
    /// The validated job of the recipe.
    pub job: RenderJob,
    /// The stage that it comes from.
    pub stage: Option<&'static Stage>,
    /// What is divided.
    pub work: PlannedWork,
    /// Number of parts.
    pub parts: u64,
    /// Directory of the plan.
    pub directory: PathBuf,
    /// What is made.
    pub format: PlanFormat,
    /// Flags for the command of every part.
    pub flags: Vec<String>,
    /// How the commands call this program.
    pub program: String,
    /// The command that makes the plan.
    pub command: String,
    /// Warnings about flags that have no effect.
    pub notes: Vec<String>,
}

/// Options of `weekender render-part`.
#[derive(Debug)]
pub struct PartOptions {
    /// The manifest, or its directory.
    pub plan: PathBuf,
    /// The number of the part.
    pub part: u64,
    /// The backend.
    pub backend: BackendChoice,
    /// Interval at which the film is written, if it was given.
    pub every: Option<Duration>,
    /// Whether progress is shown.
    pub progress: ProgressChoice,
    /// Where the JSON is written.
    pub json: Option<JsonTarget>,
    /// The command that renders it.
    pub command: String,
}

pub(super) fn plan(raw: RawPlan, program: &str, command: String) -> Result<PlanOptions, CliError> {
    if raw.picture.is_every_stage() {
        let reason = "a plan is of one picture; choose one stage";
        return Err(CliError::Together { flag: "--stage all", other: "plan", reason });
    }
    backend::choice(&raw.backend)?;
    let mut chosen = sources::find(&raw.picture, None)?;
    raw::change(&mut chosen.recipe, &raw.picture, raw.estimate_error);
    let is_animation = raw.animation.frames.is_some() || raw.animation.turntable.is_some();
    let (job, work) = if is_animation { frames(&raw, &mut chosen)? } else { samples(&raw, &mut chosen)? };
    let (count, what) = match &work {
        PlannedWork::Samples(samples) => (samples.end - samples.start, "samples per pixel"),
        PlannedWork::Frames { frames, .. } => (u64::from(frames.end - frames.start), "frames"),
    };
    if raw.parts > count {
        return Err(CliError::TooManyParts { parts: raw.parts, count, what });
    }
    let name = raw.out.to_str().filter(|name| !name.chars().any(char::is_control));
    if name.is_none() {
        return Err(CliError::PlanDirectory { path: raw.out });
    }
    let signs: &[char] = if cfg!(windows) { &['%'] } else { &['%', '\\'] };
    if raw.format == PlanFormat::Slurm && physical(&raw.out).to_string_lossy().contains(signs) {
        return Err(CliError::SlurmDirectory { path: raw.out });
    }
    let written = PlanFiles::to_write(&raw.out);
    Paths::default()
        .read("--scene", sources::scene_file(raw.picture.scene.as_deref()))
        .own("the plan's file", &raw.out, move |name| same_name(name, written.names()))
        .check(&[])?;
    let mut flags = backend::words(&raw.backend);
    flags.extend(raw.every.map(|every| format!("--every={}s", every.as_secs_f64())));
    Ok(PlanOptions {
        notes: unused::notes(&job, chosen.stage, &raw.picture, &raw.animation, raw.samples),
        recipe: chosen.recipe,
        job,
        stage: chosen.stage,
        work,
        parts: raw.parts,
        directory: raw.out,
        format: raw.format,
        flags,
        program: raw.program.unwrap_or_else(|| program.to_owned()),
        command,
    })
}

/// The path without links, as far as it exists: Slurm names logs by it.
fn physical(path: &Path) -> PathBuf {
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let known = whole.ancestors().find_map(|at| Some((at, at.canonicalize().ok()?)));
    known
        .and_then(|(at, known)| whole.strip_prefix(at).ok().map(|rest| known.join(rest)))
        .unwrap_or_else(|| whole.clone())
}

/// Samples to divide.
fn samples(raw: &RawPlan, chosen: &mut ChosenRecipe) -> Result<(RenderJob, PlannedWork), CliError> {
    if raw.animation.fps.is_some() {
        let reason = "a single picture has no rate; add --frames A..B or --turntable";
        return Err(CliError::Needs { flag: "--fps", other: "--frames", reason });
    }
    let samples = match &raw.sample_range {
        Some(range) => range.clone(),
        None => 0..raw.samples.unwrap_or(chosen.recipe.samples_per_pixel),
    };
    chosen.recipe.samples_per_pixel = samples.end;
    Ok((chosen.recipe.job()?, PlannedWork::Samples(samples)))
}

/// Frames to divide.
fn frames(raw: &RawPlan, chosen: &mut ChosenRecipe) -> Result<(RenderJob, PlannedWork), CliError> {
    let flag = if raw.animation.frames.is_some() { "--frames" } else { "--turntable" };
    let whole = "a frame is rendered whole, with all its samples; give --samples";
    let kept = "whole frames are kept, and the frame in progress is short work";
    for (other, is_given, reason) in
        [("--sample-range", raw.sample_range.is_some(), whole), ("--every", raw.every.is_some(), kept)]
    {
        if is_given {
            return Err(CliError::Together { flag, other, reason });
        }
    }
    chosen.recipe.samples_per_pixel = raw.samples.unwrap_or(chosen.recipe.samples_per_pixel);
    let job = chosen.recipe.job()?;
    let path = path_of(&raw.animation, &raw.picture, &chosen.recipe)?;
    let frames = frames_of(&raw.animation, &path, &job)?;
    let rate = raw.animation.fps.unwrap_or(DEFAULT_RATE);
    Ok((job, PlannedWork::Frames { frames, turntable: raw.animation.turntable, rate }))
}

pub(super) fn part(raw: RawPart, command: String) -> Result<PartOptions, CliError> {
    let part = match raw.part {
        Some(part) => part,
        None => part_of_environment(|name| std::env::var(name).ok())?,
    };
    let json = raw.json.map(JsonTarget::from);
    if let Some(JsonTarget::File(_)) = &json {
        files_of(Paths::default(), &raw.plan, true).write_json(json.as_ref()).check(&[])?;
    }
    Ok(PartOptions {
        plan: raw.plan,
        part,
        backend: backend::choice(&raw.backend)?,
        every: raw.every,
        progress: raw.progress,
        json,
        command,
    })
}

/// Adds the files of a plan, also what its parts are merged into if `with_result`. A plan that cannot be read has none;
/// whoever uses it says why.
pub(super) fn files_of(paths: Paths, plan: &Path, with_result: bool) -> Paths {
    let Ok(files) = PlanFiles::of(plan) else { return paths };
    let directory = files.directory.clone();
    paths.own("a file of the plan", &directory, move |name| {
        let result = files.result.clone().filter(|_| with_result);
        same_name(name, files.names().chain(result))
    })
}

fn part_of_environment(value: impl Fn(&str) -> Option<String>) -> Result<u64, CliError> {
    let found = PART_VARIABLES.into_iter().find_map(|name| value(name).map(|value| (name, value)));
    let (name, value) = found.ok_or(CliError::Needs {
        flag: "render-part",
        other: "--part NUMBER",
        reason: "neither SLURM_ARRAY_TASK_ID nor JOB_COMPLETION_INDEX says which part this task is to render",
    })?;
    value.parse().map_err(|_| CliError::PartVariable { name, value })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_environment_of_a_task_names_its_part() {
        let with = |pairs: &'static [(&str, &str)]| {
            part_of_environment(|name| {
                pairs.iter().find(|(key, _)| *key == name).map(|(_, value)| (*value).to_owned())
            })
        };
        assert_eq!(with(&[("JOB_COMPLETION_INDEX", "7")]).unwrap(), 7);
        assert_eq!(with(&[("SLURM_ARRAY_TASK_ID", "12")]).unwrap(), 12);
        let told = with(&[("JOB_COMPLETION_INDEX", "x7")]).unwrap_err().to_string();
        assert!(told.contains("JOB_COMPLETION_INDEX") && told.contains("x7"), "{told}");
        assert!(with(&[]).unwrap_err().to_string().contains("--part NUMBER"));
    }

    #[test]
    fn the_variable_of_slurm_comes_first() {
        assert_eq!(part_of_environment(|name| Some(name.len().to_string())).unwrap(), 19);
    }

    #[test]
    fn there_may_be_as_many_parts_as_samples_or_frames() {
        for (what, most, told) in [
            ("--samples 4", 4, "4 samples per pixel"),
            ("--sample-range 8..11", 3, "3 samples per pixel"),
            ("--frames 2..4 --turntable", 2, "2 frames"),
        ] {
            let planned = |parts: u64| {
                let line = format!("weekender plan --out no-such-plan --parts {parts} {what}");
                crate::cli::parse(line.split(' ').map(Into::into))
            };
            assert!(planned(most).is_ok(), "{what}");
            let error = planned(most + 1).unwrap_err().to_string();
            let expected = format!("error: --parts is {}, but there are {told} to divide", most + 1);
            assert!(error.starts_with(&expected), "{error}");
        }
    }
}
