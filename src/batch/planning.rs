//! `weekender plan`: divides a picture or an animation into parts and makes the commands for them.

use crate::cli::{JsonTarget, PlanFormat, PlanOptions, PlannedWork};
use crate::console;
use crate::describe::counted;
use crate::failure::{Failure, output_failure};
use crate::files::ShownPath;
use crate::film::Film;
use crate::memory;
use crate::plan::{
    Commands, Division, Frames, Manifest, Plan, Samples, ScriptKind, Work, check_scripts, divide,
    write_scripts,
};
use crate::shell;
use crate::terminal::write_json;
use anyhow::{Context, anyhow};
use serde::Serialize;
use std::process::ExitCode;

/// The largest array that Slurm takes unless it is configured otherwise.
const USUAL_ARRAY: usize = 1001;

/// Writes the plan and makes its commands.
///
/// # Errors
/// [`Failure::Input`] if the plan cannot be written; [`Failure::Run`] if its commands cannot.
pub fn plan(options: &PlanOptions) -> Result<ExitCode, Failure> {
    options.notes.iter().for_each(|note| console::note(&format!("warning: {note}")));
    let too_few = || Failure::input(anyhow!("{} parts need as many samples or frames", options.parts));
    match &options.work {
        PlannedWork::Samples(samples) => {
            let division = divide(samples.clone(), options.parts).ok_or_else(too_few)?;
            let plan = written(options, Samples::new(samples, &division))?;
            console::note(&about_samples(&plan, &division));
            start(&plan, options)
        }
        PlannedWork::Frames { frames, turntable, rate } => {
            let work = Frames::new(frames, *turntable, *rate, options.parts).ok_or_else(too_few)?;
            let plan = written(options, work)?;
            console::note(&about_frames(&plan));
            start(&plan, options)
        }
    }
}

/// Writes the plan.
fn written<W: Work>(options: &PlanOptions, work: W) -> Result<Plan<W>, Failure> {
    let directory = &options.directory;
    std::fs::create_dir_all(directory)
        .with_context(|| {
            format!("cannot create the directory {}; choose another with --out", directory.shown())
        })
        .map_err(Failure::Input)?;
    if let Some(kind) = scripts(options.format) {
        check_scripts(kind, directory).map_err(Failure::input)?;
    }
    let manifest = Manifest {
        command: options.command.clone(),
        scene: options.recipe.name.clone(),
        stage: options.stage.map(|stage| stage.id.to_owned()),
        flags: options.flags.clone(),
        ..Manifest::new(work)
    };
    Plan::write(directory, &options.recipe, &options.job, manifest).map_err(Failure::input)
}

/// The scripts of this form, if it has any.
fn scripts(format: PlanFormat) -> Option<ScriptKind> {
    match format {
        PlanFormat::Text | PlanFormat::Json => None,
        PlanFormat::Slurm => Some(ScriptKind::Slurm),
        PlanFormat::Parallel => Some(ScriptKind::Parallel),
        PlanFormat::Make => Some(ScriptKind::Make),
    }
}

/// Makes the commands of a plan, in the form that is asked for.
fn start<W: Work>(plan: &Plan<W>, options: &PlanOptions) -> Result<ExitCode, Failure> {
    let directory = &options.directory;
    let told =
        || (plan.path.display().to_string(), directory.join(&plan.manifest.result).display().to_string());
    let (path, result) = told();
    let commands = Commands::new(&options.program, &path, plan);
    let Some(kind) = scripts(options.format) else {
        if options.format == PlanFormat::Json {
            let json = PlanJson::of(plan, &commands, &result);
            write_json(&json, &JsonTarget::StandardOutput).map_err(Failure::Run)?;
        } else {
            let lines: String =
                (0..plan.manifest.work.count()).map(|part| commands.part_line(part) + "\n").collect();
            console::write_out(&lines).map_err(|error| Failure::Run(anyhow!(output_failure(&error))))?;
            console::note(&format!("then: {}", commands.merge_line(&result)));
        }
        return Ok(ExitCode::SUCCESS);
    };
    let files = write_scripts(kind, plan, &options.program).map_err(Failure::run)?;
    if kind == ScriptKind::Slurm && plan.manifest.work.count() > USUAL_ARRAY {
        console::note(&format!(
            "Slurm refuses arrays of more than {USUAL_ARRAY} tasks unless its MaxArraySize is larger: \
             scontrol show config | grep MaxArraySize"
        ));
    }
    let start = match (kind, files.first()) {
        (ScriptKind::Make, _) => shell::line(["make", "-C", &shell::operand(&directory.to_string_lossy())]),
        (_, Some(first)) => shell::line(["sh", &shell::operand(&first.to_string_lossy())]),
        (_, None) => String::new(),
    };
    console::write_out(&(start + "\n")).map_err(|error| Failure::Run(anyhow!(output_failure(&error))))?;
    Ok(ExitCode::SUCCESS)
}

/// What was chosen, in words.
fn about_samples(plan: &Plan<Samples>, Division { block, parts }: &Division) -> String {
    let lengths = || parts.iter().map(|part| part.end - part.start);
    let (shortest, longest) = (lengths().min().unwrap_or(0), lengths().max().unwrap_or(0));
    let each = if shortest == longest {
        format!("{} per pixel each", counted(longest, "sample"))
    } else {
        format!("{shortest} to {longest} samples per pixel, in blocks of {block}")
    };
    let settings = plan.job.settings();
    let film = Film::bytes(settings.width, settings.height, settings.half_count());
    format!(
        "{}: {} of {}x{}, {} of {each}; a part's film takes {} of memory",
        plan.path.shown(),
        plan.recipe.name,
        settings.width,
        settings.height,
        counted(parts.len() as u64, "part"),
        memory::words(film)
    )
}

/// What was chosen, in words.
fn about_frames(plan: &Plan<Frames>) -> String {
    let lengths = || plan.manifest.work.parts.iter().map(|part| part.range().len() as u64);
    let (shortest, longest) = (lengths().min().unwrap_or(0), lengths().max().unwrap_or(0));
    let each = if shortest == longest {
        format!("{} each", counted(longest, "frame"))
    } else {
        format!("{shortest} to {longest} frames")
    };
    let (settings, parts) = (plan.job.settings(), plan.manifest.work.count() as u64);
    format!(
        "{}: {} of {}x{} with {} per pixel, {} of {each}",
        plan.path.shown(),
        plan.recipe.name,
        settings.width,
        settings.height,
        counted(plan.recipe.samples_per_pixel, "sample"),
        counted(parts, "part")
    )
}

/// The plan and its commands for other programs.
#[derive(Serialize)]
struct PlanJson<'a, W: Work> {
    plan: &'a str,
    #[serde(flatten)]
    manifest: &'a Manifest<W>,
    part_commands: Vec<Vec<String>>,
    merge_command: Vec<String>,
}

impl<'a, W: Work> PlanJson<'a, W> {
    fn of(plan: &'a Plan<W>, commands: &'a Commands<'_>, result: &str) -> Self {
        let part = |part: usize| commands.part(&part.to_string());
        PlanJson {
            plan: &commands.manifest,
            manifest: &plan.manifest,
            part_commands: (0..plan.manifest.work.count()).map(part).collect(),
            merge_command: commands.merge(result),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::FrameRate;
    use crate::recipe::Recipe;
    use std::path::Path;

    fn planned<W: Work>(directory: &Path, samples_per_pixel: u64, work: W) -> Plan<W> {
        let mut recipe = Recipe::find("three-spheres").unwrap();
        (recipe.settings.width, recipe.settings.height) = (4, 3);
        recipe.samples_per_pixel = samples_per_pixel;
        Plan::write(directory, &recipe, &recipe.job().unwrap(), Manifest::new(work)).unwrap()
    }

    #[test]
    fn a_plan_of_samples_is_told_with_its_lengths_and_the_memory_of_a_part() {
        for (count, parts, each) in [
            (8, 2, "2 parts of 4 samples per pixel each"),
            (1, 1, "1 part of 1 sample per pixel each"),
            (100, 2, "2 parts of 48 to 52 samples per pixel, in blocks of 16"),
        ] {
            let directory = tempfile::tempdir().unwrap();
            let division = divide(0..count, parts).unwrap();
            let plan = planned(directory.path(), count, Samples::new(&(0..count), &division));
            // 12 pixels with two halves of 24 bytes.
            let expected = format!(
                "{}: three-spheres of 4x3, {each}; a part's film takes 576 bytes of memory",
                plan.path.shown()
            );
            assert_eq!(about_samples(&plan, &division), expected);
        }
    }

    #[test]
    fn a_plan_of_frames_is_told_with_its_lengths_and_samples() {
        for (count, parts, samples, words) in [
            (7, 3, 6, "6 samples per pixel, 3 parts of 2 to 3 frames"),
            (6, 3, 6, "6 samples per pixel, 3 parts of 2 frames each"),
            (1, 1, 1, "1 sample per pixel, 1 part of 1 frame each"),
        ] {
            let directory = tempfile::tempdir().unwrap();
            let rate = FrameRate { frames: 30, seconds: 1 };
            let work = Frames::new(&(5..5 + count), None, rate, parts).unwrap();
            let plan = planned(directory.path(), samples, work);
            let expected = format!("{}: three-spheres of 4x3 with {words}", plan.path.shown());
            assert_eq!(about_frames(&plan), expected);
        }
    }
}
