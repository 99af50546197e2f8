//! Markdown to HTML, with the page's own links, directives, formulas and colours.

use crate::chapter::Chapter;
use crate::figure::FIGURES;
use crate::letters;
use crate::library::{Fault, line_of};
use crate::live;
use crate::picture::Picture;
use crate::site::Site;
use crate::uses::Uses;
use crate::words::{code_words, is_word, typographic};
use anyhow::{Context, Result, bail, ensure};
use math_core::MathDisplay;
use maud::{Markup, PreEscaped, html};
use pulldown_cmark::{
    BrokenLink, CodeBlockKind, CowStr, Event, LinkType, Options, Parser, Tag, TagEnd, html as writer,
};
use std::collections::btree_map::Entry;
use std::fmt::Write as _;
use std::iter::Peekable;
use std::mem::take;
use std::ops::Range;
use std::vec::IntoIter;
use weekender::stages::{self, Stage};

/// Makes the HTML of a directive, given without its braces. A directive may have Markdown in it.
pub type Directive = fn(&Site, &Place<'_>, &str, &mut Uses) -> Result<Markup>;

/// A text and its location.
pub struct Place<'a> {
    file: &'a str,
    lines_before: usize,
    /// The chapter; `None` in the back matter.
    chapter: Option<&'a Chapter>,
    text: &'a str,
    directive: Directive,
}

impl Place<'_> {
    /// Whether the text belongs to one of the book's chapters with code.
    pub fn is_of_book(&self) -> bool {
        self.chapter.is_some_and(|chapter| (2..=14).contains(&chapter.number))
    }

    /// A text inside a directive, without its paragraph.
    pub fn inside(&self, site: &Site, text: &str, uses: &mut Uses) -> Result<Markup, Fault> {
        let html = convert(site, &Place { text: text.trim(), ..*self }, uses)?.into_string();
        let inside = html.trim().strip_prefix("<p>").and_then(|html| html.strip_suffix("</p>"));
        Ok(PreEscaped(inside.unwrap_or(&html).to_owned()))
    }

    /// A short text of the back matter, from line `at` of a file, as HTML without its paragraph.
    pub fn short_text(
        &self,
        site: &Site,
        file: &str,
        at: usize,
        text: &str,
        uses: &mut Uses,
    ) -> Result<Markup, Fault> {
        let directive = self.directive;
        let place = Place { file, lines_before: at.saturating_sub(1), chapter: None, text, directive };
        place.inside(site, text, uses)
    }

    /// Gives the chapter's symbols their colours in a formula or in highlighted code.
    pub fn coloured(&self, html: &Markup) -> Markup {
        let colours =
            self.chapter.map(|chapter| &chapter.facts.colours).filter(|colours| !colours.is_empty());
        let Some(colours) = colours else { return html.clone() };
        let mut found = String::new();
        // The text after each tag.
        for part in html.0.split_inclusive('<').flat_map(|part| part.split_inclusive('>')) {
            if part.ends_with('>') || found.ends_with("hl-f\">") {
                found.push_str(part);
                continue;
            }
            for word in part.split_inclusive(|c| !is_word(c)) {
                let name = word.trim_end_matches(|c| !is_word(c));
                match colours.get(name).filter(|_| !found.ends_with('&')) {
                    Some(colour) => {
                        let _ =
                            write!(found, "<span class=\"q{colour}\">{name}</span>{}", &word[name.len()..]);
                    }
                    None => found.push_str(word),
                }
            }
        }
        // Formulas have no spans.
        PreEscaped(found.replace("<mi><span ", "<mi ").replace("</span></mi>", "</mi>"))
    }
}

pub fn chapter(
    site: &Site,
    chapter: &Chapter,
    directive: Directive,
    uses: &mut Uses,
) -> Result<Markup, Fault> {
    let text = site.measured.filled(&chapter.body).map_err(|(position, error)| {
        let line = chapter.lines_before + line_of(&chapter.body, position);
        Fault::new(&chapter.file, line, format!("{error:#}"))
    })?;
    let Chapter { file, lines_before, .. } = chapter;
    let place = Place { file, lines_before: *lines_before, chapter: Some(chapter), text: &text, directive };
    let html = convert(site, &place, uses)?;
    check_names(&place, uses)?;
    Ok(html)
}

/// Names in a section that shows code must be in the excerpts that are open when the page loads, or the chapter says that
/// they are found elsewhere.
fn check_names(place: &Place<'_>, uses: &mut Uses) -> Result<(), Fault> {
    let (names, words) = (take(&mut uses.names), take(&mut uses.words));
    let elsewhere = place.chapter.map(|chapter| chapter.facts.elsewhere.as_slice()).unwrap_or_default();
    for (code, line) in names.iter().filter(|_| !words.is_empty()) {
        let name = code.split('(').next().unwrap_or_default();
        if name.chars().all(is_word) && !words.contains(name) && elsewhere.iter().all(|known| known != name) {
            let remedy = "put the language that has it first, correct the name, or add it to the chapter's list `elsewhere`";
            let message = format!("`{name}` is not in the code that this section shows first; {remedy}");
            return Err(Fault::new(place.file, *line, message));
        }
    }
    Ok(())
}

/// Splits a heading that starts with a section number, such as "6.1 Shading with Surface Normals".
fn split_heading(heading: &str) -> Option<(&str, &str)> {
    let (number, title) = heading.split_once(' ')?;
    let is_section = number.contains('.') && number.split('.').all(|part| part.parse::<u8>().is_ok());
    is_section.then_some((number, title.trim()))
}

/// The anchor for a heading: `What a lane is` becomes `what-a-lane-is`.
fn slug(heading: &str) -> String {
    let plain = heading.replace(['\'', '’', '.'], "").to_lowercase();
    let words = plain.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<&str>>().join("-")
}

type Events<'a> = Peekable<IntoIter<(Event<'a>, Range<usize>)>>;

fn convert(site: &Site, place: &Place<'_>, uses: &mut Uses) -> Result<Markup, Fault> {
    let options = Options::ENABLE_TABLES | Options::ENABLE_MATH | Options::ENABLE_SMART_PUNCTUATION;
    // Markdown does not know the target of `[@key]`.
    let mut citation = |link: BrokenLink<'_>| {
        let is_citation = link.reference.starts_with('@');
        is_citation.then(|| (CowStr::from(format!("{CITATION}{}", link.reference)), CowStr::from("")))
    };
    let parser = Parser::new_with_broken_link_callback(place.text, options, Some(&mut citation));
    let events: Vec<(Event<'_>, Range<usize>)> = parser.into_offset_iter().collect();
    let mut converter = Converter { site, place, uses, line: 0, closing: Vec::new() };
    let mut events = events.into_iter().peekable();
    let mut out = Vec::new();
    while let Some((event, range)) = events.next() {
        converter.line = place.lines_before + line_of(place.text, range.start);
        let converted = converter.convert(event, &range, &mut events, &mut out);
        converted.map_err(|error| {
            // A text inside has named its own place.
            error
                .downcast()
                .unwrap_or_else(|error| Fault::new(place.file, converter.line, format!("{error:#}")))
        })?;
    }
    let mut html = String::new();
    writer::push_html(&mut html, out.into_iter());
    Ok(PreEscaped(html))
}

struct Converter<'a> {
    site: &'a Site,
    place: &'a Place<'a>,
    uses: &'a mut Uses,
    /// Line in the file.
    line: usize,
    /// The ends of all open links.
    closing: Vec<Markup>,
}

/// The heading below which the page offers to check the reader's picture.
const MISTAKES: &str = "What a mistake looks like";

/// Prefix of a citation's target, such as `[@key]` or `[@key; @other]`.
const CITATION: &str = "cite:";

/// HTML as a block of its own.
fn block<'e>(markup: Markup) -> Event<'e> {
    Event::Html(format!("{}\n", markup.into_string()).into())
}

/// HTML within a line of text.
fn inline<'e>(markup: Markup) -> Event<'e> {
    Event::InlineHtml(markup.into_string().into())
}

impl Converter<'_> {
    fn convert<'e>(
        &mut self,
        event: Event<'e>,
        range: &Range<usize>,
        rest: &mut Events<'e>,
        out: &mut Vec<Event<'e>>,
    ) -> Result<()> {
        match event {
            Event::Start(Tag::Paragraph) => out.push(self.paragraph(range, rest)?),
            Event::Start(Tag::Heading { level, .. }) => {
                out.push(block(self.heading(level as usize, range, rest)?));
            }
            Event::Start(Tag::CodeBlock(kind)) => out.push(block(self.code(&kind, rest)?)),
            Event::Start(Tag::Table(columns)) => {
                let open = "<div class=\"scroll\" tabindex=\"0\" role=\"group\" aria-label=\"Table\">\n";
                out.extend([Event::Html(open.into()), Event::Start(Tag::Table(columns))]);
            }
            Event::End(TagEnd::Table) => {
                out.extend([Event::End(TagEnd::Table), Event::Html("</div>\n".into())]);
            }
            Event::Start(Tag::Link { dest_url, .. }) if dest_url.starts_with(CITATION) => {
                // Numbers replace the keys.
                skip_to(rest, TagEnd::Link);
                out.push(inline(self.citation(&dest_url)?));
            }
            Event::Start(Tag::Link { link_type, dest_url, .. }) => {
                let (open, close) = self.link(link_type, &dest_url)?;
                self.closing.push(close);
                out.push(inline(open));
            }
            Event::End(TagEnd::Link) => out.extend(self.closing.pop().map(inline)),
            Event::InlineMath(latex) => {
                let formula = self.formula(&latex, MathDisplay::Inline)?;
                out.push(inline(with_punctuation(&formula, rest)));
            }
            Event::DisplayMath(latex) => {
                let formula = self.formula(&latex, MathDisplay::Block)?;
                out.push(inline(
                    html! { span .formula tabindex="0" role="group" aria-label="Formula" { (formula) } },
                ));
            }
            Event::Code(text) => {
                self.uses.names.push((text.to_string(), self.line));
                out.push(inline(code_words(&text)));
            }
            Event::Html(_) | Event::InlineHtml(_) | Event::Start(Tag::Image { .. }) => {
                bail!("HTML and pictures are not allowed in the text; use Markdown or a directive");
            }
            Event::Text(text) if text.contains("{{") => {
                bail!("a directive stands alone in its paragraph: leave a blank line above and below");
            }
            Event::Text(text) => out.push(Event::Text(typographic(&text).into())),
            event => out.push(event),
        }
        Ok(())
    }

    /// The start of a paragraph, or the directive that is all of it.
    fn paragraph<'e>(&mut self, range: &Range<usize>, rest: &mut Events<'e>) -> Result<Event<'e>> {
        let text = self.place.text[range.clone()].trim();
        if let Some(inside) = text.strip_prefix("{{").and_then(|text| text.strip_suffix("}}")) {
            skip_to(rest, TagEnd::Paragraph);
            return (self.place.directive)(self.site, self.place, inside.trim(), self.uses).map(block);
        }
        Ok(Event::Start(Tag::Paragraph))
    }

    fn heading<'e>(&mut self, level: usize, range: &Range<usize>, rest: &mut Events<'e>) -> Result<Markup> {
        check_names(self.place, self.uses)?;
        let mut inner = Vec::new();
        let mut plain_text = String::new();
        while let Some((event, at)) = rest.next() {
            match &event {
                Event::End(TagEnd::Heading(_)) => break,
                Event::Text(text) | Event::Code(text) => plain_text.push_str(text),
                _ => {}
            }
            self.convert(event, &at, rest, &mut inner)?;
        }
        let chapter = self.place.chapter.map(|chapter| chapter.id.as_str()).unwrap_or_default();
        let anchor = format!("{chapter}-{}", slug(&plain_text));
        let source = self.place.text[range.clone()].trim_start_matches('#').trim();
        let title = match split_heading(source) {
            Some((number, words)) => Self::book_heading(number, words)?,
            None => {
                let mut title = String::new();
                writer::push_html(&mut title, inner.into_iter());
                PreEscaped(title)
            }
        };
        let link = html! { a .anchor href={ "#" (anchor) } aria-label="Link to this section" { "#" } };
        // h1 is the page's title, h2 a chapter's.
        ensure!(level == 2, "headings in a chapter have two #; the title is in the facts");
        let is_of_mistakes = plain_text == MISTAKES;
        Ok(html! { h3 id=(anchor) data-mistakes[is_of_mistakes] { (title) (link) } })
    }

    /// The heading of a section of the book, with a link to it.
    fn book_heading(number: &str, words: &str) -> Result<Markup> {
        let heading = stages::heading(number);
        let heading = heading.with_context(|| format!("the book has no section {number}"))?;
        ensure!(heading == words, "section {number} of the book is called {heading:?}");
        Ok(html! {
            span .number { (number) } " " (typographic(heading)) " "
            a .book href=(stages::book_url(number)) title={ "Section " (number) " in the book" } {
                "book" span .hidden { ", section " (number) }
            }
        })
    }

    fn formula(&self, latex: &str, display: MathDisplay) -> Result<Markup> {
        let formula = match self.site.formulas.convert_with_local_state(latex.trim(), display) {
            Ok(converted) => converted.mathml,
            Err(error) => bail!("the formula {:?} is not understood: {error}", latex.trim()),
        };
        let chapter = self.place.chapter.map(|chapter| chapter.id.as_str());
        if let Some(letter) = chapter.and_then(|id| letters::unknown(&self.site.letters, id, &formula)) {
            bail!("{letter} has no meaning in this chapter; add it to {}", letters::FILE);
        }
        Ok(self.place.coloured(&PreEscaped(formula)))
    }

    fn code(&self, kind: &CodeBlockKind<'_>, rest: &mut Events<'_>) -> Result<Markup> {
        let inside = rest.by_ref().map(|(event, _)| event);
        let inside = inside.take_while(|event| *event != Event::End(TagEnd::CodeBlock));
        let text = |event| if let Event::Text(text) = event { Some(text.into_string()) } else { None };
        let code: String = inside.filter_map(text).collect();
        let language = match kind {
            CodeBlockKind::Fenced(language) if !language.is_empty() => language,
            _ => "text",
        };
        let code = self.site.highlighter.html(language, &code)?;
        Ok(html! { pre .block { code { (code) } } })
    }

    fn citation(&self, target: &str) -> Result<Markup> {
        let mut links = Vec::new();
        for key in target.trim_start_matches(CITATION).split(';') {
            let key = key.trim().trim_start_matches('@');
            let found = (1..).zip(&self.site.references).find(|(_, entry)| entry.key == key);
            let (number, entry) = found.with_context(|| format!("references.toml has no entry {key:?}"))?;
            let title = format!("{}: {}", entry.value.authors, entry.value.title);
            links.push((number, html! { a href={ "#ref-" (key) } title=(title) { (number) } }));
        }
        links.sort_by_key(|(number, _)| *number);
        Ok(html! {
            span .cite {
                "[" @for (place, (_, link)) in links.iter().enumerate() { @if place > 0 { ", " } (link) } "]"
            }
        })
    }

    /// The opening and closing markup of a link.
    fn link(&mut self, link_type: LinkType, target: &str) -> Result<(Markup, Markup)> {
        let site = self.site;
        let (scheme, rest) = target.split_once(':').unwrap_or(("", target));
        let open = match scheme {
            "glossary" => {
                ensure!(
                    site.terms.iter().any(|entry| entry.key == rest),
                    "the glossary has no term {rest:?}"
                );
                let mut first = None;
                if let (Some(chapter), Entry::Vacant(term)) =
                    (self.place.chapter, self.uses.terms.entry(rest.to_owned()))
                {
                    term.insert(chapter.short().to_owned());
                    first = Some(format!("use-{rest}"));
                }
                opened("term", &format!("#term-{rest}"), first)
            }
            "page" => {
                let (name, fragment) = rest.split_once('#').unwrap_or((rest, ""));
                let is_there = site.chapters.iter().any(|chapter| chapter.id == name);
                ensure!(is_there, "the page has no chapter {name:?}");
                let heading = stages::heading(fragment).map(|heading| format!("{fragment} {heading}"));
                let anchor = match &heading {
                    Some(heading) => format!("{name}-{}", slug(heading)),
                    None if fragment.is_empty() => name.to_owned(),
                    None => format!("{name}-{fragment}"),
                };
                opened("", &format!("#{anchor}"), None)
            }
            "live" => {
                let (id, settings) = rest.split_once('?').unwrap_or((rest, ""));
                let figure = FIGURES.iter().find(|figure| figure.shows(id));
                let figure = figure.with_context(|| format!("no figure shows the stage {id:?}"))?;
                let anchor = format!("figure-{}", figure.id);
                let stage = Stage::find(id)?;
                // For browsers without WebGPU.
                let mut still = Picture::set(stage);
                live::set(&mut still.recipe, settings)?;
                let file = still.file();
                self.uses.add(still);
                unclosed(
                    &html! { a .try href={ "#" (anchor) } data-stage=(id) data-set=(settings) data-still=(file) {} },
                )
            }
            "source" => {
                ensure!(site.library.has(rest), "there is no file {rest:?} in the sources");
                // The page has no copy of the repository, so it cites the path like a reference.
                return Ok((html! {}, html! { " " span .cite { "[" code .path { (rest) } "]" } }));
            }
            "https" | "mailto" => opened("", target, None),
            "" if target.starts_with('#') => opened("", target, None),
            _ => {
                let kinds = "glossary:TERM, page:CHAPTER, live:STAGE?SLIDER=VALUE, source:PATH, [@REFERENCE] or https://";
                let is_inline = link_type == LinkType::Inline;
                let form = if is_inline { target.to_owned() } else { format!("[{target}]") };
                bail!("{form:?} is not a link of the page; use {kinds}");
            }
        };
        Ok((open, PreEscaped("</a>".to_owned())))
    }
}

fn opened(class: &str, href: &str, id: Option<String>) -> Markup {
    unclosed(&html! { a id=[id] class=[(!class.is_empty()).then_some(class)] href=(href) {} })
}

fn unclosed(link: &Markup) -> Markup {
    PreEscaped(link.0.replace("</a>", ""))
}

/// The formula with any punctuation that follows it, which must not start a line.
fn with_punctuation(formula: &Markup, rest: &mut Events<'_>) -> Markup {
    let Some((Event::Text(next), _)) = rest.peek_mut() else { return formula.clone() };
    let Some(mark) = next.chars().next().filter(|c| ".,;:!?)".contains(*c)) else { return formula.clone() };
    *next = CowStr::from(next[mark.len_utf8()..].to_owned());
    html! { span .nb { (formula) (mark) } }
}

fn skip_to(rest: &mut Events<'_>, end: TagEnd) {
    rest.by_ref().take_while(|(event, _)| *event != Event::End(end)).for_each(drop);
}
