//! The glossary and references as HTML.

use super::directive::{GLOSSARY_MARK, REFERENCES_MARK};
use super::fault::Fault;
use super::library::Entry;
use super::prose;
use super::reference::{Area, GLOSSARY, REFERENCES};
use super::site::{Site, Uses};
use maud::{Markup, html};

/// Inserts the glossary and references where chapters ask for them.
pub fn fill(html: &str, site: &Site, uses: &mut Uses) -> Result<String, Fault> {
    for (file, mark) in [(GLOSSARY, GLOSSARY_MARK), (REFERENCES, REFERENCES_MARK)] {
        let count = html.matches(mark).count();
        if count != 1 {
            let name = mark.trim_matches(['<', '>', '!', '-', ' ']);
            let message =
                format!("{{{{{name}}}}} must be in one chapter once, but it is there {count} times");
            return Err(Fault::new(file, 0, message));
        }
    }
    let glossary = glossary(site, uses)?.into_string();
    let references = references(site, uses)?.into_string();
    Ok(html.replace(GLOSSARY_MARK, &glossary).replace(REFERENCES_MARK, &references))
}

fn glossary(site: &Site, uses: &mut Uses) -> Result<Markup, Fault> {
    let areas = [
        ("Rendering", Area::Rendering),
        ("Parallelism", Area::Parallelism),
        ("Numbers", Area::Numbers),
        ("Languages", Area::Languages),
    ];
    Ok(html! {
        @for (title, area) in areas {
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

fn references(site: &Site, uses: &mut Uses) -> Result<Markup, Fault> {
    Ok(html! {
        ol .references {
            @for Entry { key, line, value } in &site.references {
                li id={ "ref-" (key) } {
                    (value.authors) ". "
                    cite {
                        @match &value.url {
                            Some(url) => a href=(url) { (value.title) },
                            None => (value.title),
                        }
                    }
                    @if let Some(year) = value.year { ", " (year) }
                    ". "
                    (prose::short_text(site, REFERENCES, *line, value.note.as_deref().unwrap_or_default(), uses)?)
                }
            }
        }
    })
}
