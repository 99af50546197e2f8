//! The lists of the back matter as HTML.

use crate::back_matter::{Area, GLOSSARY, REFERENCES};
use crate::library::{Entry, Fault};
use crate::prose::Place;
use crate::site::Site;
use crate::uses::Uses;
use maud::{Markup, html};

/// The terms with their definitions, by area. Each leads back to its first link in the chapters before.
pub fn glossary(site: &Site, place: &Place<'_>, uses: &mut Uses) -> Result<Markup, Fault> {
    Ok(html! {
        @for area in [Area::Rendering, Area::Parallelism, Area::Numbers, Area::Languages] {
            @let title = format!("{area:?}");
            h3 id={ "glossary-of-" (title.to_lowercase()) } { (title) }
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
