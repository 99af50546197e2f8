//! `weekender companion`: one web page that follows the book, built from the texts in `docs/companion`, the sources,
//! the gallery's stills and measurements.

mod back_matter;
mod book;
mod chapter;
mod directive;
mod excerpt;
mod fault;
mod formula;
mod highlight;
mod library;
mod measured;
mod mistakes;
mod page;
mod prose;
mod reference;
mod section;
mod site;
mod timeline;

pub use excerpt::Excerpt;
pub use section::excerpts_between;

use crate::cli::CompanionOptions;
use crate::page::gallery::{self, Order, Quality};
use crate::system::failure::Failure;
use crate::system::files::{self, check_page, write_text};
use crate::system::interrupt::Interrupt;
use anyhow::{Context, Result};
use library::Library;
use page::Page;
use site::Site;
use std::process::ExitCode;

/// Largest JSON of `weekender bench` read, bytes.
const BENCH_LIMIT: u64 = 16 << 20;

/// Writes the page and renders the stills that changed. [`Failure::Input`] if nothing was written;
/// [`Failure::BrokeOff`] or [`Failure::Run`] otherwise.
pub fn run(options: &CompanionOptions) -> Result<ExitCode, Failure> {
    let interrupt = Interrupt::install().map_err(Failure::Run)?;
    let index = options.out.join("index.html");
    write(options, &interrupt)?.report("figure", &index, &interrupt)
}

/// Writes the page and renders the stills that changed, until `interrupt` is set.
///
/// # Errors
/// Those of [`run`].
pub fn write(options: &CompanionOptions, interrupt: &Interrupt) -> Result<gallery::Outcome, Failure> {
    let page = build(options).map_err(Failure::Input)?;
    let out = &options.out;
    std::fs::create_dir_all(out)
        .with_context(|| format!("cannot create the directory {}; choose another with --out", out.display()))
        .map_err(Failure::Input)?;
    let index = out.join("index.html");
    check_page(&index).map_err(Failure::input)?;
    // Write the page first, so that it can be read while its figures are rendered.
    write_text(&index, &page.html).map_err(Failure::run)?;
    let order = Order {
        directory: &out.join("figures"),
        stages: &page.stages,
        quality: Quality::new(options.quick),
        backend: &options.backend,
        progress: options.progress,
        prints_stills: false,
    };
    let pictures = out.join("figures/mistakes");
    std::fs::create_dir_all(&pictures)
        .with_context(|| format!("cannot create the directory {}", pictures.display()))
        .map_err(Failure::Run)?;
    for picture in page.mistakes.iter().take_while(|_| !interrupt.is_set()) {
        picture.render(out).map_err(Failure::Run)?;
    }
    gallery::render(&order, interrupt)
}

fn build(options: &CompanionOptions) -> Result<Page> {
    let library = options.source.clone().map_or(Library::Embedded, Library::Checkout);
    let mut site = Site::read(&library)?;
    if let Some(path) = &options.bench {
        let bytes = files::read(path, "the JSON of a benchmark", BENCH_LIMIT)?;
        site.measured
            .set_bench(String::from_utf8_lossy(&bytes).into_owned())
            .context("the file of --bench")?;
    }
    page::render(&site)
}

#[cfg(test)]
mod tests;
