//! Merges the existing parts of a plan, and says what is missing.

use super::{check_outputs, warn_of_loss, write, wrote};
use crate::cli::terminal::print;
use crate::cli::{MergeOptions, program};
use crate::film::{Film, FilmSum, checkpoint, key};
use crate::job::plan::{Commands, Part, Plan};
use crate::job::saved::same_job;
use crate::progressive::Status;
use crate::progressive::describe::describe;
use crate::system::console;
use crate::system::failure::{FAILED, Failure};
use crate::system::files::ShownPath;
use crate::system::shell::Shell;
use std::process::ExitCode;

/// Merges or checks the parts.
pub(super) fn run(plan: &Plan, options: &MergeOptions) -> Result<ExitCode, Failure> {
    check_outputs(&plan.files(), options)?;
    let mut sum = empty_sum(plan).map_err(Failure::input)?;
    let parts = &plan.manifest.parts;
    let added = parts.iter().enumerate().map(|(index, part)| (index, add(&mut sum, plan, part)));
    let lacking: Vec<(usize, String)> =
        added.filter_map(|(index, state)| Some((index, state.err()?))).collect();
    let mut lines: Vec<String> =
        lacking.iter().map(|(index, what)| format!("part {index}: {what}")).collect();
    lines.extend(remedy(plan, &lacking, &program()));
    let (film, [start, end]) = (sum.film(), plan.manifest.samples);
    let (samples, count, of) = (film.samples(), film.sample_count(), end - start);
    let (whole, all) = (parts.len() - lacking.len(), parts.len());
    let found = format!("{count} of {of} samples per pixel ({samples}); {whole} of {all} parts are whole\n");
    if options.check {
        let lines = lines.iter().map(|line| format!("{line}\n"));
        print(&std::iter::once(found).chain(lines).collect::<String>()).map_err(Failure::Run)?;
    } else {
        if count > 0 {
            warn_of_loss(&options.out, film, &sum.description());
            write(&options.out, film, plan.recipe.rules.transfer, &sum.description())?;
            print(&(found + &wrote(&options.out))).map_err(Failure::Run)?;
        } else {
            console::note(&found);
        }
        lines.iter().for_each(|line| console::note(line));
    }
    Ok(if lacking.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(FAILED) })
}

fn empty_sum(plan: &Plan) -> anyhow::Result<FilmSum> {
    let settings = plan.job.settings();
    let mut description = describe(&plan.recipe, plan.stage(), &Film::new(1, 1, 1), &Status::default(), None);
    description.set(key::COMMAND, &plan.manifest.command);
    FilmSum::new(settings.width, settings.height, settings.half_count(), description, &plan.path)
}

/// Adds what exists of a part.
///
/// # Errors
/// What the part lacks, or why its film was not added.
fn add(sum: &mut FilmSum, plan: &Plan, part: &Part) -> Result<(), String> {
    let (Part { file, samples: [start, end] }, path) = (part, plan.beside(&part.file));
    if path.symlink_metadata().is_err() {
        return Err(format!("{file} is missing"));
    }
    let head = checkpoint::read_head(&path).map_err(|error| error.to_string())?;
    if part.is_exceeded_by(&head.samples) {
        let (path, samples) = (path.shown(), head.samples);
        return Err(format!(
            "{path} holds the samples {samples}, but this part has {start}..{end}; move the file away"
        ));
    }
    let samples = sum.add(&path, same_job).map_err(|error| format!("{error:#}"))?;
    match (part.missing(&samples), end - start) {
        (0, _) => Ok(()),
        (missing, of) => Err(format!("{file} has {} of {of} samples per pixel", of - missing)),
    }
}

/// How to render what is missing: a heading, then one command per line.
fn remedy(plan: &Plan, lacking: &[(usize, String)], program: &str) -> Vec<String> {
    if lacking.is_empty() {
        return Vec::new();
    }
    let parts: Vec<usize> = lacking.iter().map(|(part, _)| *part).collect();
    let commands = Commands::new(program, &plan.path.to_string_lossy(), &plan.manifest);
    let heading = format!("for what is missing (--array={} in Slurm):", ranges(&parts));
    std::iter::once(heading)
        .chain(parts.iter().map(|part| commands.part(Shell::HERE, &part.to_string())))
        .collect()
}

/// Ascending numbers as Slurm writes them: `0,3-7,9`.
fn ranges(numbers: &[usize]) -> String {
    let runs = numbers.chunk_by(|number, next| number + 1 == *next);
    let text = |run: &[usize]| match run {
        [first, _, .., last] => format!("{first}-{last}"),
        few => few.iter().map(usize::to_string).collect::<Vec<_>>().join(","),
    };
    runs.map(text).collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped_as_slurm_reads_them() {
        assert_eq!(ranges(&[0, 3, 4, 5, 7, 8]), "0,3-5,7,8");
        assert_eq!(ranges(&[]), "");
    }
}
