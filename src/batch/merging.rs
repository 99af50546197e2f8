//! `weekender merge`: merges films of one picture.

use crate::cli::MergeOptions;
use crate::failure::Failure;
use crate::files::check_writable;
use crate::film::{SampleRanges, merge_files};
use crate::output::{OutputFormat, write_image};
use crate::recipe::file;
use crate::saved::same_job;
use crate::terminal::print;
use std::process::ExitCode;

/// Adds films and writes the sum.
///
/// # Errors
/// [`Failure::Input`] for films that do not go together, [`Failure::Run`] if the sum cannot be written.
pub fn merge(options: &MergeOptions) -> Result<ExitCode, Failure> {
    OutputFormat::from_path(&options.out).map_err(Failure::input)?;
    check_writable(&options.out).map_err(Failure::input)?;
    let sum = merge_files(&options.films, same_job).map_err(Failure::input)?;
    let recipe = file::parse(sum.description.recipe(), "the films' recipe").map_err(Failure::input)?;
    let transfer = recipe.rules.transfer;
    write_image(&options.out, &sum.film, transfer, &sum.description).map_err(Failure::run)?;
    let samples: &SampleRanges = sum.film.samples();
    print(&format!(
        "{} samples per pixel ({samples}) of {} films\nwrote {}\n",
        samples.count(),
        options.films.len(),
        options.out.display()
    ))
    .map_err(Failure::Run)?;
    Ok(ExitCode::SUCCESS)
}
