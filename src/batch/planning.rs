//! `weekender plan`: writes a plan and makes the commands for its parts.

use super::create_directory;
use crate::cli::terminal::write_json;
use crate::cli::{JsonTarget, PlanOptions};
use crate::film::Film;
use crate::job::plan::{Commands, Format, Manifest, Plan, Work, scripts};
use crate::progressive::describe::counted;
use crate::system::console;
use crate::system::failure::{Failure, output_failure};
use crate::system::files::ShownPath;
use crate::system::memory;
use crate::system::shell::{Shell, operand};
use anyhow::anyhow;
use serde::Serialize;
use std::process::ExitCode;

/// Writes the plan and makes its commands.
///
/// # Errors
/// [`Failure::Input`] if the plan cannot be written; [`Failure::Run`] if its commands cannot.
pub fn plan(options: &PlanOptions) -> Result<ExitCode, Failure> {
    create_directory(&options.directory)?;
    let manifest = Manifest {
        command: options.command.clone(),
        scene: options.recipe.name.clone(),
        stage: options.stage.map(|stage| stage.id.to_owned()),
        flags: options.flags.clone(),
        ..Manifest::new(options.work.clone())
    };
    let scripts = scripts(options.format, &manifest, &options.program);
    let plan = Plan::write(&options.directory, &options.recipe, &options.job, manifest, &scripts)
        .map_err(Failure::Input)?;
    console::note(&about(&plan));
    let (path, count) = (plan.path.to_string_lossy(), plan.manifest.work.count());
    let result = options.directory.join(&plan.manifest.result).to_string_lossy().into_owned();
    let commands = Commands::new(&options.program, &path, &plan.manifest);
    let lines: String = match (options.format, scripts.first()) {
        (Format::Json, _) => {
            let json = PlanJson {
                plan: &commands.manifest,
                manifest: &plan.manifest,
                part_commands: (0..count).map(|part| commands.part(part)).collect(),
                merge_command: commands.merge(&result),
            };
            write_json(&json, &JsonTarget::StandardOutput).map_err(Failure::Run)?;
            return Ok(ExitCode::SUCCESS);
        }
        (Format::Make, _) => {
            Shell::HERE.line(["make", "-C", &operand(&options.directory.to_string_lossy())]) + "\n"
        }
        (_, Some((first, _))) => {
            Shell::HERE.line(["sh", &operand(&plan.beside(first).to_string_lossy())]) + "\n"
        }
        (_, None) => {
            (0..count).map(|part| commands.part_line(Shell::HERE, &part.to_string()) + "\n").collect()
        }
    };
    console::write_out(&lines).map_err(|error| Failure::Run(anyhow!(output_failure(&error))))?;
    if options.format == Format::Text {
        console::note(&format!("then: {}", Shell::HERE.line(commands.merge(&result))));
    }
    Ok(ExitCode::SUCCESS)
}

/// What was divided.
fn about(plan: &Plan) -> String {
    let (settings, lengths) = (plan.job.settings(), plan.manifest.work.lengths());
    let parts = counted(lengths.len() as u64, "part");
    let longest = lengths.into_iter().max().unwrap_or_default();
    let each = match &plan.manifest.work {
        Work::Samples(work) => {
            let film = Film::bytes(settings.width, settings.height, settings.half_count());
            let (each, film) = (counted(longest, "sample"), memory::words(film));
            format!("{each} per pixel, in blocks of {}; a part's film takes {film} of memory", work.block)
        }
        Work::Frames(_) => {
            let samples = counted(plan.recipe.samples_per_pixel, "sample");
            format!("{} of {samples} per pixel", counted(longest, "frame"))
        }
    };
    let size = format!("{}x{}", settings.width, settings.height);
    format!("{}: {} of {size}, {parts} of at most {each}", plan.path.shown(), plan.recipe.name)
}

/// The plan and its commands for other programs.
#[derive(Serialize)]
struct PlanJson<'a> {
    plan: &'a str,
    #[serde(flatten)]
    manifest: &'a Manifest,
    part_commands: Vec<Vec<String>>,
    merge_command: Vec<String>,
}
