//! The lists of the back matter as HTML.

use crate::back_matter::{GLOSSARY, REFERENCES};
use crate::library::{Entry, Fault};
use crate::prose::Place;
use crate::site::Site;
use crate::uses::Uses;
use maud::{Markup, html};

/// The terms of an area with their definitions. Each leads back to its first link in the chapters before.
pub fn glossary(site: &Site, place: &Place<'_>, area: &str, uses: &mut Uses) -> Result<Markup, Fault> {
    Ok(html! {
        dl .glossary {
            @for Entry { key, line, value } in site.terms.iter().filter(|entry| entry.value.area == area) {
                div {
                    dt id={ "term-" (key) } { (value.term) }
                    dd {
                        span id={ "def-" (key) } { (place.short_text(site, GLOSSARY, *line, &value.text, uses)?) }
                        @if let Some(chapter) = uses.terms.get(key) {
                            " " a .back href={ "#use-" (key) } title="First link to the term" { (chapter) }
                        }
                    }
                }
            }
        }
    })
}

/// The works in the order of their numbers.
pub fn references(site: &Site, place: &Place<'_>, uses: &mut Uses) -> Result<Markup, Fault> {
    Ok(html! {
        ol .references {
            @for Entry { key, line, value } in &site.references {
                li id={ "ref-" (key) } {
                    (value.authors) ". "
                    cite { a href=(value.url) { (value.title) } }
                    ", " (value.year) ". "
                    (place.short_text(site, REFERENCES, *line, &value.note, uses)?)
                }
            }
        }
    })
}
