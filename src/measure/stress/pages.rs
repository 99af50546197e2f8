//! A page that compares the cases' pictures by Weekender and by the book's arithmetic.

use super::super::Candidate;
use super::case::Case;
use super::families::build::sized;
use super::report::{CaseReport, StressReport};
use super::suite::{by_the_book, trace};
use crate::film::Description;
use crate::job::output::write_image;
use crate::job::recipe::{Recipe, file, plain_name};
use crate::stages::Transfer;
use crate::system::files::{GENERATOR, write_text};
use anyhow::{Context, Result};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Size of a picture on the page, pixels.
const SIZE: [u32; 2] = [120, 80];

/// Samples per pixel of a picture on the page.
const SAMPLES: u64 = 32;

/// Larger scenes are not rendered with the book's arithmetic, which has no hierarchy.
const BOOK_SPHERES: usize = 5000;

/// A case's two pictures, as named in the files.
const KINDS: [&str; 2] = ["ours", "book"];

/// Renders a case's pictures into `directory`, leaving out any that cannot be rendered. Fails if a file cannot be
/// written.
pub fn write_pictures(
    directory: &Path,
    case: &Case,
    painter: &mut Candidate,
    interrupt: &AtomicBool,
) -> Result<()> {
    for (kind, recipe) in KINDS.into_iter().zip(recipes(&case.recipe)) {
        let Some(recipe) = recipe else { continue };
        if let Ok(traced) = trace(painter, &recipe, interrupt) {
            let description = Description::new(&file::to_picture_toml(&recipe));
            let path = directory.join(file_name(&case.id, kind));
            write_image(&path, &traced.film, Transfer::Gamma2, &description)?;
        }
    }
    Ok(())
}

/// The recipes of both pictures.
fn recipes(recipe: &Recipe) -> [Option<Recipe>; 2] {
    let [width, height] = SIZE;
    let is_square = recipe.settings.width == recipe.settings.height;
    let ours = sized(recipe.clone(), [if is_square { height } else { width }, height], SAMPLES);
    let book = (ours.scene.spheres.len() <= BOOK_SPHERES).then(|| by_the_book(&ours));
    [Some(ours), book]
}

fn file_name(id: &str, kind: &str) -> String {
    format!("{} {kind}.png", plain_name(id)).replace(' ', "-")
}

/// Writes the table and the page to `directory`.
pub fn write_pages(directory: &Path, report: &StressReport) -> Result<()> {
    write_text(&directory.join("table.md"), &report.markdown()).context("cannot write the table")?;
    let page = page(directory, report).into_string();
    write_text(&directory.join("index.html"), &page).context("cannot write the page")
}

const STYLE: &str = "\
body { font: 15px sans-serif; margin: 2em; max-width: 72em }
td { vertical-align: top; padding: .4em .8em .4em 0 }
img { width: 240px; image-rendering: pixelated; background: #ddd }
.wrong { color: #b00020; font-weight: bold }";

fn page(directory: &Path, report: &StressReport) -> Markup {
    let picture = |case: &CaseReport, kind: &str| {
        let name = file_name(&case.id, kind);
        let is_there = directory.join(&name).exists();
        html! {
            td { @if is_there { img src=(name) alt={ (case.id) " " (kind) }; } @else { "no picture" } }
        }
    };
    html! {
        (DOCTYPE)
        meta charset="utf-8";
        (PreEscaped(GENERATOR))
        title { "weekender stress" }
        style { (PreEscaped(STYLE)) }
        h1 { "weekender stress" }
        p { (report.summary().trim()) }
        table {
            tr { th { "case" } th { "Weekender" } th { "the book's arithmetic" } }
            @for case in &report.cases {
                tr { (about(case)) @for kind in KINDS { (picture(case, kind)) } }
            }
        }
    }
}

fn about(case: &CaseReport) -> Markup {
    html! {
        td {
            b { (case.id) } br; (case.stiff) br;
            "expected: " (case.expected) ", because " (case.why) br;
            @for measured in &case.measured {
                (measured.backend) ", " (measured.form) ": "
                @if measured.verdict.is_right() {
                    (measured.verdict.name())
                } @else {
                    span .wrong { (measured.verdict.name().to_lowercase()) } ": " (measured.verdict.reason())
                }
                br;
            }
        }
    }
}
