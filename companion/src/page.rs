//! The page around the chapters.

use crate::chapter::Chapter;
use crate::check;
use crate::directive;
use crate::library::Fault;
use crate::live;
use crate::picture::{Part, Picture};
use crate::prose;
use crate::site::Site;
use crate::uses::Uses;
use anyhow::{Result, ensure};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use std::fs;
use std::path::Path;
use weekender::stages::{BOOK_URL, Stage, book_url, heading};
use weekender::system::files::check_writable;

/// Styles and scripts.
const ASSETS: &str = "companion/assets";

/// The script of the diagrams, in its order.
const DIAGRAMS: [&str; 6] = [
    "diagrams/kit.js",
    "diagrams/chapters-1-to-7.js",
    "diagrams/chapters-8-to-10.js",
    "diagrams/chapters-11-to-14.js",
    "diagrams/chapters-a-to-g.js",
    "diagrams/run.js",
];

/// Marks a page as the program's own.
const GENERATOR: &str = "<meta name=\"generator\" content=\"Weekender\">";

const TITLE: &str = "Weekender, the companion";
const ABOUT: &str = "Ray Tracing in One Weekend, chapter by chapter: in pictures, in code, and live.";

#[derive(Debug)]
pub struct Page {
    /// The content of `index.html`.
    pub html: String,
    /// The content of `later.js`: what the first screen does not need.
    pub later: String,
    /// Its own pictures.
    pub pictures: Vec<Picture>,
}

/// Renders everything. Fails with the first [`Fault`] of the texts, or if a stage has no data for a browser.
pub fn render(site: &Site, is_quick: bool) -> Result<Page> {
    let mut uses = Uses::default();
    let chapters = html! { @for chapter in &site.chapters { (section(site, chapter, &mut uses)?) } };
    let count = |part: &str| chapters.0.matches(part).count();
    let content = html! { (cover(count(" data-stage=\"") - count("class=\"try\""), count("class=\"drawn\""), is_quick, &mut uses)?) (chapters) };
    let live = live::live_data(Stage::ALL)?;
    let fonts = serde_json::json!(site.library.read(&format!("{ASSETS}/more-fonts.css"))?);
    let later = format!("var later = {{ fonts: {fonts}, live: {live} }};\n");
    uses.add(Picture::small(cover_stage()));
    let html = document(site, &content)?.into_string();
    Ok(Page { html, later, pictures: uses.pictures })
}

/// Refuses to replace the page of another program.
///
/// # Errors
/// If `path` cannot be written or holds something without [`GENERATOR`].
pub fn check_replaceable(path: &Path) -> Result<()> {
    if path.exists() {
        check_writable(path)?;
        let is_own = fs::read_to_string(path).is_ok_and(|page| page.contains(GENERATOR));
        let remedy = "move it away, or choose another directory with --out";
        ensure!(is_own, "{}: there is a page that Weekender did not write; {remedy}", path.display());
    }
    Ok(())
}

/// The last stage, whose picture opens the page.
fn cover_stage() -> &'static Stage {
    &Stage::ALL[Stage::ALL.len() - 1]
}

/// Styles and scripts are read like the texts, so that an author sees a change at once.
fn document(site: &Site, content: &Markup) -> Result<Markup, Fault> {
    let assets = |names: &[&str]| -> Result<Markup, Fault> {
        let texts: Result<Vec<_>, _> =
            names.iter().map(|name| site.library.read(&format!("{ASSETS}/{name}"))).collect();
        Ok(PreEscaped(texts?.concat()))
    };
    Ok(html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                (PreEscaped(GENERATOR))
                title { (TITLE) }
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="description" content=(ABOUT);
                meta name="color-scheme" content="light dark";
                link rel="icon" href="data:,";
                style { (assets(&["fonts.css", "page.css", "live.css", "check.css"])?) }
                // Runs before anything is drawn, so that the page does not flash in the wrong colours.
                script { (assets(&["theme.js"])?) }
            }
            body id="top" {
                a .skip href="#content" { "Skip to the text" }
                (navigation(site))
                main id="content" tabindex="-1" {
                    (content)
                    (colophon())
                }
                script type="module" { (assets(&["page.js"])?) }
                script type="module" { (assets(&DIAGRAMS)?) }
                script type="module" { (assets(&["scene.js", "film.js", "live.js"])?) }
                script type="application/json" id="check-data" { (PreEscaped(check::data())) }
                script type="module" { (assets(&["check.js"])?) }
            }
        }
    })
}

/// `live` pictures can run, and `drawn` diagrams be dragged.
fn cover(live: usize, drawn: usize, is_quick: bool, uses: &mut Uses) -> Result<Markup> {
    let stage = cover_stage();
    let panel = directive::panel(stage, None, Part::None, Some(&Picture::small(stage)), uses)?;
    Ok(html! {
        header .cover {
            p .kicker { "Weekender, the companion" }
            h1 { cite { "Ray Tracing in One Weekend" } ", many rays at a time" }
            p .lead {
                "The book, chapter by chapter: every picture rendered by the program, every excerpt its real code. "
                (drawn) " drawings move, and in a browser with WebGPU " (live + 1) " pictures run. Then: lanes, threads and GPUs, measured."
            }
            @if check::find().is_some() { div .check-box {} }
            figure .figure id="figure-cover" {
                div .panels { (panel) }
                figcaption {
                    "The book’s last picture."
                    span .runs { " Press " em { "Run" } " and drag it: your own device then traces it, with the program’s shaders." }
                    @if is_quick { " This is a quick copy of the page: its pictures are small and a little noisy." }
                }
            }
        }
    })
}

fn colophon() -> Markup {
    html! {
        footer .colophon {
            p {
                "Made by " code { "cargo run --release -p companion" } ", version " (env!("CARGO_PKG_VERSION"))
                ". The book is by Peter Shirley, Trevor David Black and Steve Hollasch: "
                a href=(BOOK_URL) { "Ray Tracing in One Weekend" } "."
            }
            p { a href="#top" { "Back to the top" } }
        }
    }
}

fn navigation(site: &Site) -> Markup {
    let last_of_book = site.chapters.iter().rposition(|chapter| chapter.facts.book.is_some());
    let (with_book, beyond) = site.chapters.split_at(last_of_book.map_or(0, |place| place + 1));
    html! {
        nav .contents id="contents" aria-label="Chapters" {
            details {
                summary { span .now { "Chapters" } }
                div .list {
                    a .home href="#top" { strong { "Weekender" } " the companion" }
                    @for (title, chapters) in [("With the book", with_book), ("Beyond the book", beyond)] {
                        p .part { (title) }
                        ol {
                            @for chapter in chapters {
                                li {
                                    a href={ "#" (chapter.id) } {
                                        span .number { @if let Some(number) = chapter.shown_number() { (number) " " } }
                                        (chapter.short())
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn section(site: &Site, chapter: &Chapter, uses: &mut Uses) -> Result<Markup, Fault> {
    let (id, title) = (&chapter.id, &chapter.facts.title);
    let text = prose::chapter(site, chapter, directive::html, uses)?;
    let of_book = |number| {
        let found = heading(number).map(|heading| (number, book_url(number), heading));
        found.ok_or_else(|| Fault::new(&chapter.file, 1, format!("the book has no chapter {number:?}")))
    };
    let book = chapter.facts.book.as_deref().map(of_book).transpose()?;
    Ok(html! {
        section .chapter aria-labelledby=(id) {
            header .head {
                p .kicker {
                    @if let Some(number) = chapter.shown_number() { "Chapter " (number) }
                    @if let Some((number, url, heading)) = book {
                        @if chapter.shown_number().is_some() { " · " }
                        a .book href=(url) {
                            "The book, chapter " (number) @if heading != title { ": " (heading) }
                        }
                    }
                }
                h2 id=(id) {
                    (title)
                    a .anchor href={ "#" (id) } aria-label="Link to this chapter" { "#" }
                }
            }
            (text)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_own_pages_are_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("index.html");
        check_replaceable(&path).unwrap();
        for (page, is_own) in [
            (format!("<!DOCTYPE html><head>{GENERATOR}<title>T</title>"), true),
            ("<title>My own pictures, rendered by Weekender</title>".to_owned(), false),
        ] {
            fs::write(&path, &page).unwrap();
            let checked = check_replaceable(&path).map_err(|error| error.to_string());
            assert_eq!(checked.is_ok(), is_own, "{checked:?}");
            assert!(checked.err().is_none_or(|message| message.contains("index.html: there is a page")));
        }
    }
}
