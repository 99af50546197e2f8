//! Merges films without a plan.

use super::{check_outputs, print_findings, warn_of_loss, write, wrote};
use crate::cli::MergeOptions;
use crate::cli::terminal::print;
use crate::film::{FilmHead, FilmSum, MergeError, SampleRanges, checkpoint, merge_files};
use crate::job::recipe::file;
use crate::job::saved::same_job;
use crate::progressive::describe::counted;
use crate::system::failure::Failure;
use crate::system::files::ShownPath;
use crate::system::shell;
use anyhow::anyhow;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Merges or checks films of one picture.
pub(super) fn run(films: &[PathBuf], options: &MergeOptions) -> Result<ExitCode, Failure> {
    let mut seen = HashSet::new();
    let is_again = |film: &&PathBuf| !seen.insert(film.canonicalize().unwrap_or_else(|_| film.to_path_buf()));
    if let Some(film) = films.iter().find(is_again) {
        return Err(Failure::Input(anyhow!("{} is named twice; name it once", film.shown())));
    }
    check_outputs("the merge", films, options)?;
    if options.check { check(films, &options.program) } else { merge(films, &options.out) }
}

fn merge(films: &[PathBuf], out: &[PathBuf]) -> Result<ExitCode, Failure> {
    let sum = merge_files(films, same_job).map_err(Failure::input)?;
    let recipe = file::parse(sum.description.recipe(), "the films' recipe").map_err(Failure::input)?;
    warn_of_loss(out, &sum.film, &sum.description);
    write(out, &sum.film, recipe.rules.transfer, &sum.description)?;
    let samples = sum.film.samples();
    let (count, from) = (counted(samples.count(), "sample"), counted(films.len() as u64, "film"));
    print(&format!("{count} per pixel ({samples}) from {from}\n{}", wrote(out))).map_err(Failure::Run)?;
    Ok(ExitCode::SUCCESS)
}

/// Reads all films, and prints what is damaged, foreign, duplicated or missing between them.
fn check(films: &[PathBuf], program: &str) -> Result<ExitCode, Failure> {
    let (mut sum, mut lines): (Option<FilmSum>, Vec<String>) = (None, Vec::new());
    for path in films {
        let added = match &mut sum {
            Some(sum) => sum.add(path, same_job).map(drop),
            none => begin(path).map(|begun| *none = Some(begun)),
        };
        lines.extend(added.err().map(|error| error.to_string()));
    }
    let (damaged, mut commands) = (lines.len(), Vec::new());
    let held = sum.map_or_else(SampleRanges::default, |sum| sum.film().samples().clone());
    let mut from = 0;
    while let Some(gap) = held.first_gap(from..held.end(), u64::MAX) {
        let range = format!("{}..{}", gap.start, gap.end);
        lines.push(format!("samples {range} are missing"));
        let first = films[0].to_string_lossy();
        let first = shell::operand(&first);
        let words = [program, "--batch", "--resume", &first, "--sample-range", &range, "--out", &first];
        commands.push(shell::line(words));
        from = gap.end;
    }
    let (is_good, count, good) = (lines.is_empty(), held.count(), films.len() - damaged);
    lines.push(format!("{count} samples per pixel ({held}) in {good} of {} films", films.len()));
    if !commands.is_empty() {
        lines.push("for what is missing:".to_owned());
        lines.extend(commands);
    }
    print_findings(&lines, is_good)
}

/// Begins a sum with this film.
fn begin(path: &Path) -> Result<FilmSum, MergeError> {
    let FilmHead { width, height, halves, description, .. } = checkpoint::read_head(path)?;
    let mut sum = FilmSum::new(width, height, halves, description, path)?;
    sum.add(path, same_job)?;
    Ok(sum)
}
