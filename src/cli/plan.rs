//! Flags of `weekender plan` and `weekender render-part`.

use super::command_line;
use super::sources::{self, ChosenRecipe, PictureFlags, SampleFlags};
use super::values::{ProgressChoice, parse_duration, whole};
use crate::backends::BackendChoice;
use crate::job::plan::{Format, Manifest};
use crate::job::recipe::Recipe;
use crate::job::render::RenderJob;
use crate::system::files::ShownPath;
use anyhow::{Context, Result, ensure};
use clap::{Args, ValueHint};
use std::path::PathBuf;
use std::time::Duration;

/// Environment variables in which schedulers pass the number of a task.
const PART_VARIABLES: [&str; 2] = ["SLURM_ARRAY_TASK_ID", "JOB_COMPLETION_INDEX"];

/// Options of `weekender plan`.
#[derive(Debug, Args)]
pub struct PlanOptions {
    /// Parts, 1 to 100000, each with some samples of the whole picture
    #[arg(long, value_name = "COUNT", value_parser = whole::<u64>(1..=100_000))]
    parts: u64,
    /// The directory of the plan, of its parts and of the merged film; it is created if necessary
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Interval at which a part's film is written, as for rendering: 0.1s to 30d [default: 60s]
    #[arg(long, value_name = "DURATION", value_parser = parse_duration)]
    every: Option<Duration>,
    /// Output: the commands, one per line, or files that hand the parts to Slurm, GNU parallel or make
    #[arg(long, value_enum, default_value = "text")]
    pub format: Format,
    /// How the commands call this program [default: as it was called, with its directory if that was given]
    #[arg(long, value_name = "NAME", value_hint = ValueHint::ExecutablePath)]
    pub program: Option<String>,
    #[command(flatten)]
    picture: PictureFlags,
    #[command(flatten)]
    samples: SampleFlags,
    #[command(flatten)]
    backend: BackendChoice,
    /// Flags for the command of every part.
    #[arg(skip)]
    pub(super) flags: Vec<String>,
}

impl PlanOptions {
    /// The picture, and the manifest of its parts.
    ///
    /// # Errors
    /// If the picture cannot be rendered or divided.
    pub fn divided(&self) -> Result<(Recipe, RenderJob, Manifest)> {
        ensure!(
            self.out.to_str().is_some_and(|name| !name.chars().any(char::is_control)),
            "--out is {}, which cannot be part of a command: its name must be UTF-8 without control characters",
            self.out.shown()
        );
        let (ChosenRecipe { mut recipe, stage }, job) = sources::picture(&self.picture, &self.samples, None)?;
        let range = self.samples.sample_range.clone().unwrap_or(0..recipe.samples_per_pixel);
        recipe.samples_per_pixel = range.end;
        let manifest = Manifest::new(&range, self.parts).with_context(|| {
            let (parts, count) = (self.parts, range.end - range.start);
            format!("--parts is {parts}, but there are {count} samples per pixel to divide; each part needs at least one")
        })?;
        let manifest = Manifest {
            command: command_line(),
            scene: recipe.name.clone(),
            stage: stage.map(|stage| stage.id.to_owned()),
            flags: self.flags.clone(),
            ..manifest
        };
        Ok((recipe, job, manifest))
    }
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
}

impl PartOptions {
    /// The number of the part.
    ///
    /// # Errors
    /// If neither a flag nor the environment says which part it is.
    pub fn part(&self) -> Result<u64> {
        if let Some(part) = self.part {
            return Ok(part);
        }
        let found = PART_VARIABLES.into_iter().find_map(|name| Some((name, std::env::var(name).ok()?)));
        let (name, value) = found.context(
            "render-part needs --part NUMBER: neither SLURM_ARRAY_TASK_ID nor JOB_COMPLETION_INDEX says which part to \
             render",
        )?;
        value.parse().with_context(|| {
            format!("{name} is {value:?}, but must be the number of a part; set it, or give --part NUMBER")
        })
    }
}
