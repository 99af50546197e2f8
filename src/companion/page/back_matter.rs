//! The glossary and the references as HTML.

use super::super::directive::{GLOSSARY_MARK, REFERENCES_MARK};
use super::super::faults::Fault;
use super::super::prose;
use super::super::reference::{Area, Entry, GLOSSARY, REFERENCES, Term};
use super::super::site::{Site, Uses};
use maud::{Markup, html};

/// Puts glossary and references where the chapters want them.
pub fn fill(html: &str, site: &Site, uses: &mut Uses, faults: &mut Vec<Fault>) -> String {
    for (file, mark) in [(GLOSSARY, GLOSSARY_MARK), (REFERENCES, REFERENCES_MARK)] {
        let count = html.matches(mark).count();
        if count != 1 {
            let name = mark.trim_matches(['<', '>', '!', '-', ' ']);
            let message =
                format!("{{{{{name}}}}} must be in one chapter once, but it is there {count} times");
            faults.push(Fault::new(file, 0, message));
        }
    }
    let glossary = glossary(site, uses, faults).into_string();
    let references = references(site, uses, faults).into_string();
    html.replace(GLOSSARY_MARK, &glossary).replace(REFERENCES_MARK, &references)
}

fn glossary(site: &Site, uses: &mut Uses, faults: &mut Vec<Fault>) -> Markup {
    let areas =
        [("Rendering", Area::Rendering), ("Parallelism", Area::Parallelism), ("Numbers", Area::Numbers)];
    let parts = areas.map(|(title, area)| {
        let terms: Vec<Markup> = site
            .terms
            .iter()
            .filter(|entry| entry.value.area == area)
            .map(|entry| term(site, entry, uses, faults))
            .collect();
        (title, terms)
    });
    html! {
        @for (title, terms) in parts.into_iter().filter(|(_, terms)| !terms.is_empty()) {
            h3 id={ "glossary-of-" (title.to_lowercase()) } { (title) }
            dl .glossary { @for term in terms { (term) } }
        }
    }
}

fn term(site: &Site, entry: &Entry<Term>, uses: &mut Uses, faults: &mut Vec<Fault>) -> Markup {
    let key = &entry.key;
    let text = prose::short_text(site, GLOSSARY, entry.line, &entry.value.text, uses, faults);
    html! {
        div {
            dt id={ "term-" (key) } { (entry.value.term) }
            dd {
                span id={ "def-" (key) } { (text) }
                @if let Some(chapter) = uses.terms.get(key) {
                    " " a .back href={ "#use-" (key) } title="First link to the term" { (chapter) }
                }
            }
        }
    }
}

fn references(site: &Site, uses: &mut Uses, faults: &mut Vec<Fault>) -> Markup {
    let mut entries = Vec::new();
    for Entry { key, line, value } in &site.references {
        let note = value.note.as_deref().unwrap_or_default();
        let note = prose::short_text(site, REFERENCES, *line, note, uses, faults);
        entries.push(html! {
            li id={ "ref-" (key) } {
                (value.authors) ". "
                cite {
                    @match &value.url {
                        Some(url) => a href=(url) { (value.title) },
                        None => (value.title),
                    }
                }
                @if let Some(year) = value.year { ", " (year) }
                ". " (note)
            }
        });
    }
    html! { ol .references { @for entry in entries { (entry) } } }
}
