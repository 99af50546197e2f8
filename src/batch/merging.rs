//! `weekender merge`: merges films of the same picture.

use crate::cli::MergeOptions;
use crate::describe::counted;
use crate::failure::Failure;
use crate::files::check_writable;
use crate::film::{SampleRanges, merge_files};
use crate::output::{OutputFormat, write_image};
use crate::recipe::file;
use crate::saved::same_job;
use crate::terminal::print;
use std::process::ExitCode;

/// Merges the films and writes the result.
///
/// # Errors
/// [`Failure::Input`] if the films do not belong together, [`Failure::Run`] if the result cannot be written.
pub fn merge(options: &MergeOptions) -> Result<ExitCode, Failure> {
    OutputFormat::from_path(&options.out).map_err(Failure::input)?;
    check_writable(&options.out).map_err(Failure::input)?;
    let sum = merge_files(&options.films, same_job).map_err(Failure::input)?;
    let recipe = file::parse(sum.description.recipe(), "the films' recipe").map_err(Failure::input)?;
    let transfer = recipe.rules.transfer;
    write_image(&options.out, &sum.film, transfer, &sum.description).map_err(Failure::run)?;
    let samples: &SampleRanges = sum.film.samples();
    print(&format!(
        "{} per pixel ({samples}) from {}\nwrote {}\n",
        counted(samples.count(), "sample"),
        counted(options.films.len() as u64, "film"),
        options.out.display()
    ))
    .map_err(Failure::Run)?;
    Ok(ExitCode::SUCCESS)
}
