//! Flags of `weekender plan` and `weekender render-part`.

use super::raw::{ProgressChoice, RawPicture};
use super::sources::{self, SampleFlags};
use super::values::{parse_duration, whole};
use super::{Line, backend};
use crate::backends::BackendChoice;
use crate::job::plan::{Format, Manifest};
use crate::job::recipe::Recipe;
use crate::job::render::RenderJob;
use crate::stages::Stage;
use crate::system::files::ShownPath;
use anyhow::{Context, Result, bail, ensure};
use clap::{Args, ValueHint};
use std::path::PathBuf;
use std::time::Duration;

/// The variables in which schedulers give a task its number.
const PART_VARIABLES: [&str; 2] = ["SLURM_ARRAY_TASK_ID", "JOB_COMPLETION_INDEX"];

#[derive(Debug, Args)]
pub(super) struct PlanFlags {
    /// Parts, 1 to 100000, each with some samples of the whole picture
    #[arg(long, value_name = "COUNT", value_parser = whole(1..=100_000_u64, 10))]
    parts: u64,
    /// The directory of the plan, of its parts and of the merged film; it is created if necessary
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Interval at which a part's film is written, as for rendering: 0.1s to 30d [default: 60s]
    #[arg(long, value_name = "DURATION", value_parser = parse_duration)]
    every: Option<Duration>,
    /// What is made: the commands, one per line, or files that give the parts to Slurm, GNU parallel or make
    #[arg(long, value_enum, default_value = "text")]
    format: Format,
    /// How the commands call this program [default: as it was called, with its directory if that was given]
    #[arg(long, value_name = "NAME", value_hint = ValueHint::ExecutablePath)]
    program: Option<String>,
    #[command(flatten)]
    picture: RawPicture,
    #[command(flatten)]
    samples: SampleFlags,
    #[command(flatten)]
    backend: BackendChoice,
}

/// Options of `weekender plan`.
#[derive(Debug)]
pub struct PlanOptions {
    pub recipe: Recipe,
    /// The validated job of the recipe.
    pub job: RenderJob,
    /// The stage that it comes from.
    pub stage: Option<&'static Stage>,
    /// The parts, without the scene.
    pub manifest: Manifest,
    pub directory: PathBuf,
    pub format: Format,
    /// Flags for the command of every part.
    pub flags: Vec<String>,
    /// How the commands call this program.
    pub program: String,
    /// The command that makes the plan.
    pub command: String,
}

/// Options of `weekender render-part`.
#[derive(Debug, Args)]
pub struct PartOptions {
    /// The plan: its directory, or its plan.json
    #[arg(value_name = "PLAN")]
    pub plan: PathBuf,
    /// The number of the part, from 0 [default: SLURM_ARRAY_TASK_ID or JOB_COMPLETION_INDEX of the environment]
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    pub(super) part: Option<u64>,
    /// Interval at which the part's film is written: 0.1s to 30d, such as 30s, 5m or 1h
    #[arg(long, value_name = "DURATION", value_parser = parse_duration, default_value = "60s")]
    pub every: Duration,
    /// Write the final figures as JSON; - for standard output
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
    /// Show progress on standard error; auto: if it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
    #[command(flatten)]
    pub backend: BackendChoice,
    /// The command that renders it.
    #[arg(skip)]
    pub command: String,
}

impl PartOptions {
    /// The number of the part.
    ///
    /// # Errors
    /// If neither a flag nor the environment says which part it is.
    pub fn part(&self) -> Result<u64> {
        let of_environment =
            || PART_VARIABLES.into_iter().find_map(|name| Some((name, std::env::var(name).ok()?)));
        match (self.part, of_environment()) {
            (Some(part), _) => Ok(part),
            (None, Some((name, value))) => value.parse().with_context(|| {
                format!(
                    "{name} is {value:?}, but must be the number of a part; set it, or give --part NUMBER"
                )
            }),
            (None, None) => bail!(
                "render-part needs --part NUMBER: neither SLURM_ARRAY_TASK_ID nor JOB_COMPLETION_INDEX says which part \
                 this task is to render"
            ),
        }
    }
}

pub(super) fn plan(flags: PlanFlags, line: &Line) -> Result<PlanOptions> {
    let PlanFlags { picture, samples, parts, .. } = &flags;
    ensure!(
        flags.out.to_str().is_some_and(|name| !name.chars().any(char::is_control)),
        "--out is {}, which cannot stand in a command: its name must be UTF-8 without control characters",
        flags.out.shown()
    );
    let (mut chosen, job) = sources::picture(picture, samples, None)?;
    let range = samples.sample_range.clone().unwrap_or(0..chosen.recipe.samples_per_pixel);
    chosen.recipe.samples_per_pixel = range.end;
    let manifest = Manifest::new(&range, *parts).with_context(|| {
        let count = range.end - range.start;
        format!("--parts is {parts}, but there are {count} samples per pixel to divide; each part needs one at least")
    })?;
    Ok(PlanOptions {
        flags: line.words(&[&backend::FLAGS[..], &["every"]].concat()),
        recipe: chosen.recipe,
        job,
        stage: chosen.stage,
        manifest,
        directory: flags.out,
        format: flags.format,
        program: flags.program.unwrap_or_else(|| line.program.clone()),
        command: line.command.clone(),
    })
}
