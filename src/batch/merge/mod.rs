//! `weekender merge`: adds films of the same picture, or the existing parts of a plan.

mod plan;

use crate::cli::terminal::print;
use crate::cli::{MergeOptions, check_paths};
use crate::film::{Description, Film, SampleRanges, merge_files};
use crate::job::output::{OutputFormat, write_image};
use crate::job::plan::Plan;
use crate::job::recipe::file;
use crate::job::saved::{Replaced, same_job};
use crate::progressive::describe::counted;
use crate::stages::Transfer;
use crate::system::console;
use crate::system::failure::Failure;
use crate::system::files::{FileLock, ShownPath, check_writable};
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
        [plan] if Plan::is_at(plan) => plan::run(&Plan::load(plan).map_err(Failure::Input)?, options),
        films if films.iter().any(|film| Plan::is_at(film)) => refuse(
            "a plan names its parts itself: merge it alone, then merge the result with the other files",
        ),
        _ if options.check => refuse(
            "--check needs a plan: only a plan says which parts there should be; make one with `weekender plan`",
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
    warn_of_loss(&options.out, &sum.film, &sum.description);
    write(&options.out, &sum.film, recipe.rules.transfer, &sum.description)?;
    let samples = sum.film.samples();
    let (count, from) = (counted(samples.count(), "sample"), counted(films.len() as u64, "film"));
    let text = format!("{count} per pixel ({samples}) from {from}\n{}", wrote(&options.out));
    print(&text).map_err(Failure::Run)?;
    Ok(ExitCode::SUCCESS)
}

/// Refuses to replace an input by a result.
fn check_outputs(inputs: &[PathBuf], options: &MergeOptions) -> Result<(), Failure> {
    let [inputs, outputs] = [inputs, &options.out].map(|paths| paths.iter().map(PathBuf::as_path));
    check_paths(inputs, outputs).map_err(Failure::Input)
}

/// Warns of samples that are lost because `film` replaces a film that has others.
fn warn_of_loss(out: &[PathBuf], film: &Film, description: &Description) {
    let is_kept = |samples: &SampleRanges| film.samples().contains(samples);
    for warning in out.iter().filter_map(|out| Replaced::at(out, description.recipe()).warning(out, is_kept))
    {
        console::note(&format!("warning: {warning}"));
    }
}

fn write(out: &[PathBuf], film: &Film, transfer: Transfer, description: &Description) -> Result<(), Failure> {
    out.iter().try_for_each(|out| write_image(out, film, transfer, description)).map_err(Failure::run)
}

fn wrote(out: &[PathBuf]) -> String {
    out.iter().map(|out| format!("wrote {}\n", out.shown())).collect()
}
