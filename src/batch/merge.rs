//! `weekender merge`: adds films of the same picture, or the existing parts of a plan, and says which parts are missing.

use crate::cli::terminal::print;
use crate::cli::{MergeOptions, check_paths, program};
use crate::film::{Description, Film, FilmSum, SampleRanges, checkpoint, key, merge_files};
use crate::job::output::{OutputFormat, write_image};
use crate::job::plan::{Commands, Part, Plan};
use crate::job::recipe::file;
use crate::job::saved::{Replaced, same_job};
use crate::progressive::Status;
use crate::progressive::describe::{counted, describe};
use crate::stages::Transfer;
use crate::system::console;
use crate::system::failure::{FAILED, Failure};
use crate::system::files::{FileLock, ShownPath, check_writable};
use crate::system::shell::Shell;
use anyhow::anyhow;
use std::collections::HashSet;
use std::path::PathBuf;
use std::process::ExitCode;

/// Merges or checks what the options name.
///
/// # Errors
/// [`Failure::Input`] if the films do not belong together, [`Failure::Run`] if the result cannot be written.
pub fn run(options: &MergeOptions) -> Result<ExitCode, Failure> {
    for out in &options.out {
        OutputFormat::from_path(out).map_err(Failure::input)?;
        check_writable(out).map_err(Failure::input)?;
    }
    let is_film = |out: &&PathBuf| matches!(OutputFormat::from_path(out), Ok(OutputFormat::Exr));
    let locks = options.out.iter().filter(is_film).map(|out| FileLock::take(out));
    let _locks = locks.collect::<Result<Vec<_>, _>>().map_err(Failure::input)?;
    let refuse = |message: &str| Err(Failure::Input(anyhow!("{message}")));
    match options.films.as_slice() {
        [plan] if Plan::is_at(plan) => merge_parts(&Plan::load(plan).map_err(Failure::Input)?, options),
        films if films.iter().any(|film| Plan::is_at(film)) => refuse(
            "a plan already names its parts: merge it alone, then merge the result with the other files",
        ),
        _ if options.check => refuse(
            "--check needs a plan: only a plan says which parts to expect; make one with `weekender plan`",
        ),
        films => merge(films, options),
    }
}

/// Merges films of one picture.
fn merge(films: &[PathBuf], options: &MergeOptions) -> Result<ExitCode, Failure> {
    let mut seen = HashSet::new();
    let is_again = |film: &&PathBuf| !seen.insert(film.canonicalize().unwrap_or_else(|_| film.to_path_buf()));
    if let Some(film) = films.iter().find(is_again) {
        return Err(Failure::Input(anyhow!("{} is named twice; name it once", film.shown())));
    }
    check_outputs(films, options)?;
    let sum = merge_files(films, same_job).map_err(Failure::input)?;
    let recipe = file::parse(sum.description.recipe(), "the films' recipe").map_err(Failure::input)?;
    let wrote = write(&options.out, &sum.film, recipe.rules.transfer, &sum.description)?;
    let samples = sum.film.samples();
    let (count, from) = (counted(samples.count(), "sample"), counted(films.len() as u64, "film"));
    let text = format!("{count} per pixel ({samples}) from {from}\n{wrote}");
    print(&text).map_err(Failure::Run)?;
    Ok(ExitCode::SUCCESS)
}

/// Refuses to replace an input by a result.
fn check_outputs(inputs: &[PathBuf], options: &MergeOptions) -> Result<(), Failure> {
    let [inputs, outputs] = [inputs, &options.out].map(|paths| paths.iter().map(PathBuf::as_path));
    check_paths(inputs, outputs).map_err(Failure::Input)
}

/// Writes a sum, and returns a line for each file. Warns of samples that are lost because it replaces a film that has
/// others.
fn write(
    out: &[PathBuf],
    film: &Film,
    transfer: Transfer,
    description: &Description,
) -> Result<String, Failure> {
    let is_kept = |samples: &SampleRanges| film.samples().contains(samples);
    for warning in out.iter().filter_map(|out| Replaced::at(out, description.recipe()).warning(out, is_kept))
    {
        console::note(&format!("warning: {warning}"));
    }
    out.iter().try_for_each(|out| write_image(out, film, transfer, description)).map_err(Failure::run)?;
    Ok(out.iter().map(|out| format!("wrote {}\n", out.shown())).collect())
}

/// Merges or checks the parts.
fn merge_parts(plan: &Plan, options: &MergeOptions) -> Result<ExitCode, Failure> {
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
    let found =
        format!("{count} of {of} samples per pixel ({samples}); {whole} of {all} parts are complete\n");
    if options.check {
        let lines = lines.iter().map(|line| format!("{line}\n"));
        print(&std::iter::once(found).chain(lines).collect::<String>()).map_err(Failure::Run)?;
    } else {
        if count > 0 {
            let wrote = write(&options.out, film, plan.recipe.rules.transfer, &sum.description())?;
            print(&(found + &wrote)).map_err(Failure::Run)?;
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
/// The samples that the part lacks, or why its film was not added.
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
