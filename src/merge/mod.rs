//! `weekender merge`: adds films of the same picture, or the parts of a plan as they come, and makes an animated PNG of
//! frames.

mod check;
mod frames;
mod parts;
mod watch;

use crate::cli::{MergeOptions, MergeSource};
use crate::console;
use crate::describe::counted;
use crate::failure::{FAILED, Failure};
use crate::files::{FileIdentity, FileLock, ShownPath, check_writable};
use crate::film::{Description, Film, SampleRanges, merge_files};
use crate::output::{OutputFormat, write_image};
use crate::plan::{AnyPlan, Plan, Samples};
use crate::recipe::file;
use crate::saved::{Replaced, same_job};
use crate::stages::Transfer;
use crate::terminal::print;
use anyhow::anyhow;
use parts::{PlanSum, State};
use std::path::PathBuf;
use std::process::ExitCode;

/// Merges or checks what the options name.
///
/// # Errors
/// [`Failure::Input`] if the films do not belong together, [`Failure::Run`] if the result cannot be written.
pub fn run(options: &MergeOptions) -> Result<ExitCode, Failure> {
    for out in &options.out {
        check_writable(out).map_err(Failure::input)?;
    }
    let is_film = |out: &&PathBuf| matches!(OutputFormat::from_path(out), Ok(OutputFormat::Exr));
    let locks = options.out.iter().filter(is_film).map(|out| FileLock::take(out));
    let _locks = locks.collect::<Result<Vec<_>, _>>().map_err(Failure::input)?;
    match (&options.source, options.watch) {
        (MergeSource::Films(films), _) if options.check => check::films(films, &options.program),
        (MergeSource::Films(films), _) => match repeated(films).next() {
            Some((_, words)) => Err(Failure::Input(anyhow!("{words}; name it once"))),
            None => merge_all(films, &options.out),
        },
        (MergeSource::Plan(path), watch) => match (AnyPlan::load(path).map_err(Failure::input)?, watch) {
            (AnyPlan::Samples(plan), _) if options.check => check::plan(&plan, &options.program),
            (AnyPlan::Samples(plan), None) => merge_plan(&plan, options),
            (AnyPlan::Samples(plan), Some(every)) => watch::run(&plan, options, every),
            (AnyPlan::Frames(plan), _) if options.check => frames::check(&plan, &options.program),
            (AnyPlan::Frames(plan), None) => frames::merge(&plan, options),
            (AnyPlan::Frames(plan), Some(every)) => frames::watch(&plan, options, every),
        },
    }
}

fn merge_all(films: &[PathBuf], out: &[PathBuf]) -> Result<ExitCode, Failure> {
    let sum = merge_files(films, same_job).map_err(Failure::input)?;
    let recipe = file::parse(sum.description.recipe(), "the films' recipe").map_err(Failure::input)?;
    warn_of_loss(out, &sum.film, &sum.description);
    write(out, &sum.film, recipe.rules.transfer, &sum.description)?;
    let samples = sum.film.samples();
    let count = counted(samples.count(), "sample");
    let from = counted(films.len() as u64, "film");
    print(&format!("{count} per pixel ({samples}) from {from}\n{}", wrote(out))).map_err(Failure::Run)?;
    Ok(ExitCode::SUCCESS)
}

/// Merges what is there of a plan, checkpoints of unfinished parts too, and says what is missing.
fn merge_plan(plan: &Plan<Samples>, options: &MergeOptions) -> Result<ExitCode, Failure> {
    let mut sum = PlanSum::new(plan).map_err(Failure::input)?;
    for index in 0..plan.manifest.work.parts.len() {
        sum.add(index, true);
    }
    let lacking = sum.lacking();
    if sum.film().sample_count() > 0 {
        warn_of_loss(&options.out, sum.film(), &sum.description());
        write(&options.out, sum.film(), plan.recipe.rules.transfer, &sum.description())?;
        print(&format!("{}\n{}", sum.words(), wrote(&options.out))).map_err(Failure::Run)?;
    }
    if lacking.is_empty() {
        return Ok(ExitCode::SUCCESS);
    }
    for (index, state) in &lacking {
        console::note(&parts::line(plan, *index, state));
    }
    parts::note_remedy(plan, &parts::numbers(&lacking), &options.program);
    Ok(ExitCode::from(FAILED))
}

/// The films that are named more than once, by their places in the list, each with words on it.
fn repeated(films: &[PathBuf]) -> impl Iterator<Item = (usize, String)> {
    let files: Vec<Option<FileIdentity>> = films.iter().map(|film| FileIdentity::of(film)).collect();
    (1..films.len()).filter_map(move |index| {
        let again = files[index].as_ref()?;
        let earlier = files[..index].iter().flatten().any(|file| file.is_same_as(again));
        earlier.then(|| (index, format!("{} is named twice", films[index].shown())))
    })
}

/// Warns of samples that are lost because `film` replaces a film that has others.
fn warn_of_loss(out: &[PathBuf], film: &Film, description: &Description) {
    losses(out, film, description).iter().for_each(|words| console::note(&format!("warning: {words}")));
}

/// What is lost if `film` replaces what is at `out`, in words.
fn losses(out: &[PathBuf], film: &Film, description: &Description) -> Vec<String> {
    let is_kept = |samples: &SampleRanges| film.samples().contains(samples);
    out.iter().filter_map(|out| Replaced::at(out, description.recipe()).warning(out, is_kept)).collect()
}

/// Writes the film to each file.
fn write(out: &[PathBuf], film: &Film, transfer: Transfer, description: &Description) -> Result<(), Failure> {
    out.iter().try_for_each(|out| write_image(out, film, transfer, description)).map_err(Failure::run)
}

fn wrote(out: &[PathBuf]) -> String {
    out.iter().map(|out| format!("wrote {}\n", out.shown())).collect()
}

/// The parts of a plan that are not whole.
type Lacking = Vec<(usize, State)>;

#[cfg(test)]
mod tests {
    use super::parts::tests::{film, planned, save};
    use super::*;

    #[test]
    fn only_samples_that_the_result_does_not_have_are_lost() {
        let (_directory, plan) = planned();
        for (name, samples) in [("inner.exr", 10..13), ("same.exr", 7..30), ("more.exr", 29..31)] {
            save(&plan, name, samples);
        }
        std::fs::write(plan.beside("empty.exr"), "").unwrap();
        let out = ["inner.exr", "same.exr", "more.exr", "empty.exr", "new.exr"].map(|name| plan.beside(name));
        let description = PlanSum::new(&plan).unwrap().description();
        let lost = losses(&out, &film(&plan, 7..30), &description);
        let words = "more.exr, which holds 2 samples per pixel of this picture (29..31)";
        assert!(lost.len() == 1 && lost[0].contains(words), "{lost:?}");
        // With a gap, other films have what is not in the sum.
        let mut gappy = film(&plan, 7..12);
        gappy.merge(&film(&plan, 13..31)).unwrap();
        let lost = losses(&out, &gappy, &description);
        assert!(lost.len() == 2 && lost[0].contains("inner.exr") && lost[1].contains("same.exr"), "{lost:?}");
    }
}
