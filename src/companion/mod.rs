//! `weekender companion`: one web page that goes through the book, made from the texts in `docs/companion`, the
//! sources, the gallery's stills and measurements.

mod book;
mod chapter;
mod directive;
mod excerpt;
mod faults;
mod formula;
mod highlight;
mod library;
mod measured;
mod page;
mod prose;
mod reference;
mod section;
mod site;
mod text;
mod timeline;

pub use excerpt::Excerpt;
pub use faults::{Fault, Faults};
pub use library::Library;
pub use page::Page;
pub use section::excerpts_between;

use crate::cli::CompanionOptions;
use crate::console;
use crate::failure::Failure;
use crate::files::{self, check_page, write_text};
use crate::gallery::{self, Order, Outcome, Quality, StillProgress};
use crate::interrupt::Interrupt;
use crate::terminal::print;
use anyhow::{Context, Result, anyhow};
use measured::Measured;
use site::Site;
use std::process::ExitCode;

/// Largest JSON of `weekender bench` that is read, bytes.
const BENCH_LIMIT: u64 = 16 << 20;

/// Where the stills are, beside the page.
const STILLS: &str = "figures";

/// Writes the page and renders the stills that changed.
///
/// # Errors
/// [`Failure::Input`] if nothing was written; [`Failure::BrokeOff`] or [`Failure::Run`] otherwise.
pub fn run(options: &CompanionOptions) -> Result<ExitCode, Failure> {
    let library = options.source.clone().map_or(Library::Embedded, Library::Checkout);
    let bench = match &options.bench {
        None => None,
        Some(path) => {
            let bytes = files::read(path, "the JSON of a benchmark", BENCH_LIMIT).map_err(Failure::input)?;
            Some(String::from_utf8_lossy(&bytes).into_owned())
        }
    };
    let page = build(&library, bench).map_err(Failure::Input)?;
    let interrupt = Interrupt::install().map_err(Failure::Run)?;
    let out = &options.out;
    std::fs::create_dir_all(out)
        .with_context(|| format!("cannot create the directory {}; choose another with --out", out.display()))
        .map_err(Failure::Input)?;
    let index = out.join("index.html");
    check_page(&index).map_err(Failure::input)?;
    // The page can be read while its figures are rendered.
    write_text(&index, &page.html).map_err(Failure::run)?;
    let order = Order {
        directory: &out.join(STILLS),
        stages: &page.stages,
        quality: if options.quick { Quality::Quick } else { Quality::Full },
        backend: &options.backend,
    };
    let mut progress = StillProgress::new(options.progress);
    let outcome = gallery::render(&order, &interrupt, |event| progress.tell(&event));
    progress.finish();
    let Outcome { rendered, kept, missing, .. } = outcome?;
    if missing > 0 {
        console::note(&format!(
            "interrupted: {missing} figures missing; run the same command again to go on"
        ));
        return Ok(interrupt.exit_code());
    }
    let length = page.html.len() / 1024;
    let words = format!("{rendered} figures rendered, {kept} unchanged, {length} KiB of text");
    print(&format!("{words}\nopen {}\n", index.display())).map_err(Failure::Run)?;
    Ok(ExitCode::SUCCESS)
}

/// Renders the page from the texts of `library`. `bench` is the JSON of a benchmark to show instead of the kept one.
///
/// # Errors
/// [`Faults`] of the texts, or a message about `bench`.
pub fn build(library: &Library, bench: Option<String>) -> Result<Page> {
    let mut faults = Vec::new();
    let mut measured = Measured::read(library, &mut faults);
    if let Some(text) = bench {
        measured.set_bench(text).map_err(|message| anyhow!(message)).context("the file of --bench")?;
    }
    let site = Site::read(library, measured, &mut faults)?;
    Ok(page::render(&site, faults)?)
}
