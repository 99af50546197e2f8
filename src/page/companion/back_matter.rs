//! The glossary and references as HTML.

use super::library::{Entry, Fault};
use super::prose;
use super::site::{Site, Uses};
use maud::{Markup, html};
use serde::Deserialize;

pub const GLOSSARY: &str = "docs/companion/glossary.toml";

pub const REFERENCES: &str = "docs/companion/references.toml";

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Term {
    pub term: String,
    /// Definition, in Markdown.
    pub text: String,
    pub area: Area,
}

/// A part of the glossary: light, pictures and noise; lanes, threads and devices; how numbers are stored and rounded;
/// words of Rust, WGSL and C++.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
#[rustfmt::skip]
pub enum Area { Rendering, Parallelism, Numbers, Languages }

/// A work cited in the text.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reference {
    pub title: String,
    pub authors: String,
    pub year: u16,
    pub url: String,
    /// Where it appeared, and what it is good for.
    pub note: String,
}

/// The terms with their definitions, by area. Each leads back to its first link in the chapters before.
pub fn glossary(site: &Site, uses: &mut Uses) -> Result<Markup, Fault> {
    Ok(html! {
        @for area in [Area::Rendering, Area::Parallelism, Area::Numbers, Area::Languages] {
            @let title = format!("{area:?}");
            h3 id={ "glossary-of-" (title.to_lowercase()) } { (title) }
            dl .glossary {
                @for Entry { key, line, value } in site.terms.iter().filter(|entry| entry.value.area == area) {
                    div {
                        dt id={ "term-" (key) } { (value.term) }
                        dd {
                            span id={ "def-" (key) } { (prose::short_text(site, GLOSSARY, *line, &value.text, uses)?) }
                            @if let Some(chapter) = uses.terms.get(key) {
                                " " a .back href={ "#use-" (key) } title="First link to the term" { (chapter) }
                            }
                        }
                    }
                }
            }
        }
    })
}

/// The works in the order of their numbers.
pub fn references(site: &Site, uses: &mut Uses) -> Result<Markup, Fault> {
    Ok(html! {
        ol .references {
            @for Entry { key, line, value } in &site.references {
                li id={ "ref-" (key) } {
                    (value.authors) ". "
                    cite { a href=(value.url) { (value.title) } }
                    ", " (value.year) ". "
                    (prose::short_text(site, REFERENCES, *line, &value.note, uses)?)
                }
            }
        }
    })
}
