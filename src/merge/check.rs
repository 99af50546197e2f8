//! `--check`: reads everything, and says what is missing, damaged, foreign or there twice.

use super::parts::{self, State};
use crate::console;
use crate::failure::{FAILED, Failure, output_failure};
use crate::files::ShownPath;
use crate::film::{FilmHead, SampleRanges, checkpoint};
use crate::plan::{Plan, Samples};
use crate::recipe::file;
use crate::saved::same_job;
use crate::shell;
use anyhow::anyhow;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Checks the parts of a plan.
///
/// # Errors
/// [`Failure::Run`] if standard output cannot be written.
pub(super) fn plan(plan: &Plan<Samples>, program: &str) -> Result<ExitCode, Failure> {
    let recipe = file::to_picture_toml(&plan.recipe);
    let count = plan.manifest.work.parts.len();
    let states = (0..count).map(|index| (index, parts::checked_state(plan, index, &recipe)));
    let lacking: Vec<_> = states.filter(|(_, state)| *state != State::Whole).collect();
    let mut lines: Vec<String> =
        lacking.iter().map(|(index, state)| parts::line(plan, *index, state)).collect();
    lines.extend(strays(plan));
    lines.push(format!("{} of {count} parts are whole", count - lacking.len()));
    if !lacking.is_empty() {
        lines.push(parts::remedy(plan, &parts::numbers(&lacking), program));
    }
    tell(&lines, lacking.is_empty())
}

/// Films in the plan's directory that are none of its parts.
fn strays(plan: &Plan<Samples>) -> Vec<String> {
    let known = |name: &str| {
        name == plan.manifest.result || plan.manifest.work.parts.iter().any(|part| part.file == name)
    };
    let entries = std::fs::read_dir(plan.directory()).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let mut strays: Vec<String> =
        names.filter(|name| name.to_lowercase().ends_with(".exr") && !known(name)).collect();
    strays.sort();
    let words = |name: String| {
        let held = checkpoint::read_head(&plan.path.with_file_name(&name));
        let held = held.map_or_else(|_| "no film".to_owned(), |head| format!("samples {}", head.samples));
        format!("{name} is not in the plan ({held})")
    };
    strays.into_iter().map(words).collect()
}

/// Checks films that are to be merged without a plan.
///
/// # Errors
/// [`Failure::Run`] if standard output cannot be written.
pub(super) fn films(films: &[PathBuf], program: &str) -> Result<ExitCode, Failure> {
    let (mut lines, mut good): (Vec<String>, Vec<(&Path, FilmHead)>) = (Vec::new(), Vec::new());
    let twice: HashMap<usize, String> = super::repeated(films).collect();
    for (index, path) in films.iter().enumerate() {
        if let Some(words) = twice.get(&index) {
            lines.push(words.clone());
            continue;
        }
        let head = match checkpoint::check(path) {
            Ok(head) => head,
            Err(error) => {
                lines.push(error.to_string());
                continue;
            }
        };
        let stranger = good.first().and_then(|(first, known)| {
            let difference = same_job(known.description.recipe(), head.description.recipe()).err()?;
            Some(format!(
                "{} is the film of another picture than {}: {difference}",
                path.shown(),
                first.shown()
            ))
        });
        lines.extend(stranger.clone());
        for (other, known) in &good {
            if let Some(range) = known.samples.first_common(&head.samples) {
                let (other, path) = (other.shown(), path.shown());
                lines
                    .push(format!("{other} and {path} both hold the samples {}..{}", range.start, range.end));
            }
        }
        if stranger.is_none() {
            good.push((path, head));
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
    tell(&lines, is_good)
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

/// Prints the lines in full, however long they are: some are commands.
pub(super) fn tell(lines: &[String], is_good: bool) -> Result<ExitCode, Failure> {
    let text: String = lines
        .iter()
        .flat_map(|line| line.split('\n'))
        .map(|line| console::printable(line).into_owned() + "\n")
        .collect();
    console::write_out(&text).map_err(|error| Failure::Run(anyhow!(output_failure(&error))))?;
    Ok(if is_good { ExitCode::SUCCESS } else { ExitCode::from(FAILED) })
}

#[cfg(test)]
mod tests {
    use super::super::parts::tests::{planned, save};
    use super::*;

    #[test]
    fn overlapping_samples_are_held_once() {
        let of = |ranges: &[(u64, u64)]| {
            let ranges = ranges.iter().map(|(start, end)| *start..*end);
            SampleRanges::from_ranges(ranges).unwrap()
        };
        for (all, more, both) in [
            (of(&[]), of(&[(2, 5)]), of(&[(2, 5)])),
            (of(&[(0, 4)]), of(&[]), of(&[(0, 4)])),
            (of(&[(0, 4)]), of(&[(2, 6)]), of(&[(0, 6)])),
            (of(&[(4, 6), (8, 9)]), of(&[(0, 12)]), of(&[(0, 12)])),
            (of(&[(0, 2), (6, 8)]), of(&[(1, 3), (7, 8), (9, 10)]), of(&[(0, 3), (6, 8), (9, 10)])),
        ] {
            assert_eq!(with(all.clone(), &more), both, "{all} and {more}");
        }
    }

    #[test]
    fn films_that_are_not_in_the_plan_are_listed_by_name() {
        let (_directory, plan) = planned();
        for name in ["part-0.exr", "picture.exr", "b.exr"] {
            save(&plan, name, 7..30);
        }
        for name in ["A.EXR", "note.txt", "exr"] {
            std::fs::write(plan.beside(name), "x").unwrap();
        }
        let told = ["A.EXR is not in the plan (no film)", "b.exr is not in the plan (samples 7..30)"];
        assert_eq!(strays(&plan), told);
    }
}
