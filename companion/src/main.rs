//! Writes the companion: one web page that follows the book, made of the texts in `docs/companion`, the sources, the
//! stages' pictures and measurements.

#![warn(clippy::disallowed_macros)]

mod back_matter;
mod chapter;
mod check;
mod directive;
mod figure;
mod highlight;
mod letters;
mod library;
mod lists;
mod live;
mod measured;
mod options;
mod page;
mod picture;
mod pictures;
mod prose;
mod site;
mod timeline;
mod uses;
mod words;
mod work;

use clap::Parser;
use library::Library;
use options::Options;
use site::Site;
use std::process::ExitCode;
use weekender::system::failure::Failure;
use weekender::system::files::write_text;
use weekender::system::interrupt::{self, Interrupt};
use weekender::system::journal;
use work::Outcome;

fn main() -> ExitCode {
    interrupt::survive_file_size_limit();
    let version = concat!("weekender companion ", env!("CARGO_PKG_VERSION")).to_owned();
    journal::watched(version, || run().unwrap_or_else(|failure| failure.report()))
}

fn run() -> Result<ExitCode, Failure> {
    let options = Options::try_parse().map_err(Failure::CommandLine)?;
    let interrupt = Interrupt::install().map_err(Failure::Run)?;
    write(&options, &interrupt)?.report(&options, &interrupt)
}

/// Writes the page and renders the pictures that changed, or those of `only`, until `interrupt` is set.
///
/// # Errors
/// [`Failure::Input`] if nothing was written; [`Failure::BrokeOff`] or [`Failure::Run`] otherwise.
fn write(options: &Options, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    if !options.only.is_empty() {
        return work::render(options, interrupt, options.stills(), || Ok(()));
    }
    let page = Site::read(&Library::of_checkout()).and_then(|site| page::render(&site, options.quick));
    let page = page.map_err(Failure::Input)?;
    let (out, index) = (&options.out, options.made());
    page::check_replaceable(&index).map_err(Failure::Input)?;
    let pictures = page.pictures.iter().cloned().chain(options.stills()).collect();
    // The page comes first, so that it can be read while its figures are rendered.
    let outcome = work::render(options, interrupt, pictures, || {
        check::copy(out).map_err(Failure::Run)?;
        write_text(&out.join("later.js"), &page.later).map_err(Failure::run)?;
        write_text(&index, &page.html).map_err(Failure::run)
    })?;
    if outcome.missing == 0 {
        picture::remove_others(out, &page.pictures).map_err(Failure::Run)?;
    }
    Ok(outcome)
}

#[cfg(test)]
mod tests;
