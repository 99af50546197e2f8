//! Films that are merged without a plan.

use super::{print_findings, warn_of_loss, write, wrote};
use crate::cli::{MergeOptions, Paths};
use crate::describe::counted;
use crate::failure::Failure;
use crate::files::ShownPath;
use crate::film::{FilmHead, SampleRanges, checkpoint, merge_files};
use crate::recipe::file;
use crate::saved::same_job;
use crate::shell;
use crate::terminal::print;
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
    let paths = films.iter().fold(Paths::default(), |paths, film| paths.read("the merge", Some(film)));
    let paths = options.out.iter().fold(paths, |paths, out| paths.write("--out", Some(out)));
    paths.check(&[]).map_err(Failure::input)?;
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

/// Reads all films, and prints what is damaged, foreign, there twice or missing between them.
fn check(films: &[PathBuf], program: &str) -> Result<ExitCode, Failure> {
    let (mut lines, mut good): (Vec<String>, Vec<(&Path, FilmHead)>) = (Vec::new(), Vec::new());
    for path in films {
        let head = match checkpoint::check(path) {
            Ok(head) => head,
            Err(error) => {
                lines.push(error.to_string());
                continue;
            }
        };
        let shown = path.shown();
        for (other, known) in &good {
            if let Some(range) = known.samples.first_common(&head.samples) {
                let other = other.shown();
                lines.push(format!(
                    "{other} and {shown} both hold the samples {}..{}",
                    range.start, range.end
                ));
            }
        }
        let first = good.first().map(|(first, known)| (first.shown(), known.description.recipe()));
        match first.map(|(first, recipe)| (first, same_job(recipe, head.description.recipe()))) {
            Some((first, Err(difference))) => {
                lines.push(format!("{shown} is the film of another picture than {first}: {difference}"));
            }
            _ => good.push((path, head)),
        }
    }
    let held = good.iter().fold(SampleRanges::default(), |all, (_, head)| with(all, &head.samples));
    let (mut from, mut commands) = (0, Vec::new());
    while let Some(gap) = held.first_gap(from..held.end(), u64::MAX) {
        lines.push(format!("samples {}..{} are missing", gap.start, gap.end));
        if let Some((first, _)) = good.first() {
            let first = first.to_string_lossy();
            let (first, range) = (shell::operand(&first), format!("{}..{}", gap.start, gap.end));
            let words = [program, "--batch", "--resume", &first, "--sample-range", &range, "--out", &first];
            commands.push(shell::line(words));
        }
        from = gap.end;
    }
    let is_good = lines.is_empty();
    let count = held.count();
    lines.push(format!("{count} samples per pixel ({held}) in {} of {} films", good.len(), films.len()));
    if !commands.is_empty() {
        lines.push("for what is missing:".to_owned());
        lines.extend(commands);
    }
    print_findings(&lines, is_good)
}

/// All samples that are in either, also where the two overlap.
fn with(mut all: SampleRanges, more: &SampleRanges) -> SampleRanges {
    for range in more.iter() {
        let mut from = range.start;
        while let Some(gap) = all.first_gap(from..range.end, u64::MAX) {
            from = gap.end;
            // A gap is free, so it can be added.
            let _ = all.insert(gap);
        }
    }
    all
}
