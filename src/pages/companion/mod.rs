//! `weekender companion`: one web page that follows the book, built from the texts in `docs/companion`, the sources,
//! the gallery's stills and measurements.

mod agreement;
mod back_matter;
mod chapter;
mod check;
mod directive;
mod excerpt;
mod highlight;
mod library;
mod lists;
mod measured;
mod page;
mod picture;
mod pictures;
mod prose;
mod site;
mod timeline;
mod uses;
mod words;

pub use excerpt::{Excerpt, excerpts_between};
pub use highlight::Highlighter;

use crate::cli::CompanionOptions;
use crate::pages::gallery::{Order, Outcome, Work};
use crate::system::failure::Failure;
use crate::system::files::{make_directory, write_text};
use crate::system::interrupt::Interrupt;
use anyhow::Result;
use library::Library;
use site::Site;
use std::process::ExitCode;
use std::thread::sleep;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// How often `--watch` looks for changes.
const POLL_INTERVAL: Duration = Duration::from_millis(300);

/// What `--watch` adds to the page.
const RELOAD: &str = include_str!("../../../assets/companion/reload.js");

/// Writes the page and renders the stills that changed. [`Failure::Input`] if nothing was written;
/// [`Failure::BrokeOff`] or [`Failure::Run`] otherwise.
pub fn run(options: &CompanionOptions) -> Result<ExitCode, Failure> {
    let interrupt = Interrupt::install().map_err(Failure::Run)?;
    let index = options.out.join("index.html");
    let library = library(options);
    let mut stamps = library.stamps();
    let code = write(options, &interrupt)?.report(&index, &interrupt)?;
    while options.watch && !interrupt.is_set() {
        sleep(POLL_INTERVAL);
        let now = library.stamps();
        if now != stamps {
            stamps = now;
            let outcome = write(options, &interrupt).and_then(|outcome| outcome.report(&index, &interrupt));
            // The author corrects the text and saves again.
            outcome.unwrap_or_else(|failure| failure.report());
        }
    }
    Ok(if interrupt.is_set() { interrupt.exit_code() } else { code })
}

fn library(options: &CompanionOptions) -> Library {
    options.source.clone().map_or(Library::Embedded, Library::Checkout)
}

/// Writes the page and renders the stills that changed, until `interrupt` is set.
///
/// # Errors
/// Those of [`run`].
pub fn write(options: &CompanionOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    let page = Site::read(&library(options)).and_then(|site| page::render(&site)).map_err(Failure::Input)?;
    let out = &options.out;
    let index = out.join("index.html");
    let order = Order {
        directory: &out.join("figures"),
        page: &index,
        stages: &page.stages,
        is_quick: options.quick,
        backend: &options.backend,
        progress: options.progress,
        prints_stills: false,
    };
    let work = Work::begin(&order, interrupt)?;
    make_directory(&out.join(picture::FOLDER)).map_err(Failure::Input)?;
    // Write the page first, so that it can be read while its figures are rendered.
    let build = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_millis();
    let reload = format!("<script>\n{}</script>\n", RELOAD.replace("BUILD", &build.to_string()));
    check::copy(out).map_err(Failure::Run)?;
    write_text(&out.join("later.js"), &page.later).map_err(Failure::run)?;
    write_text(&index, &(page.html + if options.watch { &reload } else { "" })).map_err(Failure::run)?;
    let mut missing = page.pictures.len();
    for picture in page.pictures.iter().take_while(|_| !interrupt.is_set()) {
        picture.render(out).map_err(Failure::Run)?;
        missing -= 1;
    }
    let mut outcome = work.render()?;
    outcome.missing += missing;
    if options.watch {
        write_text(&out.join("build.js"), &format!("built({build});\n")).map_err(Failure::run)?;
    }
    Ok(outcome)
}

#[cfg(test)]
mod tests;
