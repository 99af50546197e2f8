//! Markdown to HTML, with the page's own links, directives, formulas and colours.

use super::book::Book;
use super::chapter::Chapter;
use super::directive;
use super::faults::{Fault, line_of};
use super::library::is_source;
use super::site::{Site, Uses};
use super::text::{slug, typographic};
use maud::{Markup, PreEscaped, html};
use pulldown_cmark::{
    BrokenLink, CodeBlockKind, CowStr, Event, LinkType, Options, Parser, Tag, TagEnd, html as writer,
};
use std::iter::Peekable;
use std::ops::Range;
use std::vec::IntoIter;

/// A text and where it stands.
struct Place<'a> {
    file: &'a str,
    lines_before: usize,
    /// The chapter; `None` for a text in the back matter.
    chapter: Option<&'a Chapter>,
    text: &'a str,
}

/// A chapter's text as HTML.
pub fn chapter(site: &Site, chapter: &Chapter, uses: &mut Uses, faults: &mut Vec<Fault>) -> Markup {
    let place = Place {
        file: &chapter.file,
        lines_before: chapter.lines_before,
        chapter: Some(chapter),
        text: &chapter.body,
    };
    convert(site, &place, uses, faults)
}

/// A short text as HTML, without the paragraph around it.
pub fn short_text(
    site: &Site,
    file: &str,
    line: usize,
    text: &str,
    uses: &mut Uses,
    faults: &mut Vec<Fault>,
) -> Markup {
    let place = Place { file, lines_before: line.saturating_sub(1), chapter: None, text: text.trim() };
    let html = convert(site, &place, uses, faults).into_string();
    let inside = html.trim().strip_prefix("<p>").and_then(|html| html.strip_suffix("</p>"));
    PreEscaped(inside.map_or(html.clone(), str::to_owned))
}

type Events<'a> = Peekable<IntoIter<(Event<'a>, Range<usize>)>>;

fn convert(site: &Site, place: &Place<'_>, uses: &mut Uses, faults: &mut Vec<Fault>) -> Markup {
    let options = Options::ENABLE_TABLES | Options::ENABLE_MATH | Options::ENABLE_SMART_PUNCTUATION;
    // `[@key]` is a link to something that Markdown does not know.
    let mut citation = |link: BrokenLink<'_>| {
        let is_citation = link.reference.starts_with('@');
        is_citation.then(|| (CowStr::from(format!("{CITATION}{}", link.reference)), CowStr::from("")))
    };
    let parser = Parser::new_with_broken_link_callback(place.text, options, Some(&mut citation));
    let events: Vec<(Event<'_>, Range<usize>)> = parser.into_offset_iter().collect();
    let mut converter = Converter { site, place, uses, faults, closing: Vec::new() };
    let mut events = events.into_iter().peekable();
    let mut out = Vec::new();
    while let Some((event, range)) = events.next() {
        converter.convert(event, range, &mut events, &mut out);
    }
    let mut html = String::new();
    writer::push_html(&mut html, out.into_iter());
    PreEscaped(html)
}

struct Converter<'a> {
    site: &'a Site,
    place: &'a Place<'a>,
    uses: &'a mut Uses,
    faults: &'a mut Vec<Fault>,
    /// What closes each open link.
    closing: Vec<Markup>,
}

/// Begins the target of a citation such as `[@key]` or `[@key; @other]`.
const CITATION: &str = "cite:";

/// HTML that stands by itself.
fn block<'e>(markup: Markup) -> Event<'e> {
    Event::Html(format!("{}\n", markup.into_string()).into())
}

/// HTML in a line of text.
fn inline<'e>(markup: Markup) -> Event<'e> {
    Event::InlineHtml(markup.into_string().into())
}

impl Converter<'_> {
    fn fault(&mut self, range: &Range<usize>, message: impl std::fmt::Display) {
        let line = self.line(range);
        self.faults.push(Fault::new(self.place.file, line, message));
    }

    fn line(&self, range: &Range<usize>) -> usize {
        self.place.lines_before + line_of(self.place.text, range.start)
    }

    fn convert<'e>(
        &mut self,
        event: Event<'e>,
        range: Range<usize>,
        rest: &mut Events<'e>,
        out: &mut Vec<Event<'e>>,
    ) {
        match event {
            Event::Start(Tag::Paragraph) => self.paragraph(range, rest, out),
            Event::Start(Tag::Heading { level, .. }) => {
                let heading = self.heading(level as usize, &range, rest);
                out.push(block(heading));
            }
            Event::Start(Tag::CodeBlock(kind)) => {
                let code = self.code(&kind, &range, rest);
                out.push(block(code));
            }
            Event::Start(Tag::Table(columns)) => {
                let open = "<div class=\"scroll\" tabindex=\"0\" role=\"group\" aria-label=\"Table\">\n";
                out.extend([Event::Html(open.into()), Event::Start(Tag::Table(columns))]);
            }
            Event::End(TagEnd::Table) => {
                out.extend([Event::End(TagEnd::Table), Event::Html("</div>\n".into())]);
            }
            Event::Start(Tag::Link { dest_url, .. }) if dest_url.starts_with(CITATION) => {
                // The numbers replace the keys.
                skip_to(rest, TagEnd::Link);
                let numbers = self.citation(&dest_url, &range);
                out.push(inline(numbers));
            }
            Event::Start(Tag::Link { link_type, dest_url, .. }) => {
                let (open, close) = self.link(link_type, &dest_url, &range);
                self.closing.push(close);
                out.push(inline(open));
            }
            Event::End(TagEnd::Link) => out.extend(self.closing.pop().map(inline)),
            Event::InlineMath(latex) => match self.site.formulas.inline(&latex) {
                Ok(formula) => out.push(inline(with_punctuation(&formula, rest))),
                Err(message) => self.fault(&range, message),
            },
            Event::DisplayMath(latex) => match self.site.formulas.block(&latex) {
                Ok(formula) => {
                    let box_of_it =
                        html! { span .formula tabindex="0" role="group" aria-label="Formula" { (formula) } };
                    out.push(inline(box_of_it));
                }
                Err(message) => self.fault(&range, message),
            },
            Event::Html(_) | Event::InlineHtml(_) => {
                self.fault(&range, "HTML is not allowed in the text; use Markdown or a directive");
            }
            Event::Start(Tag::Image { .. }) => {
                self.fault(
                    &range,
                    "pictures come from figures and diagrams; use {{figure ID}} or {{diagram NAME}}",
                );
                skip_to(rest, TagEnd::Image);
            }
            Event::Text(ref text) if text.contains("{{") => {
                self.fault(
                    &range,
                    "a directive stands alone in its paragraph: leave a blank line above and below",
                );
            }
            event => out.push(event),
        }
    }

    fn paragraph<'e>(&mut self, range: Range<usize>, rest: &mut Events<'e>, out: &mut Vec<Event<'e>>) {
        let text = self.place.text[range.clone()].trim();
        let Some(inside) = text.strip_prefix("{{").and_then(|text| text.strip_suffix("}}")) else {
            // A formula alone may be wider than the text.
            let is_formula = text.len() > 4 && text.starts_with("$$") && text.ends_with("$$");
            let wide = Event::Html("<p class=\"wide\">".into());
            out.push(if is_formula { wide } else { Event::Start(Tag::Paragraph) });
            return;
        };
        skip_to(rest, TagEnd::Paragraph);
        let line = self.line(&range);
        match directive::html(self.site, inside.trim(), self.uses) {
            Ok(html) => out.push(block(html)),
            Err(message) => self.faults.push(Fault::new(self.place.file, line, message)),
        }
    }

    fn heading<'e>(&mut self, level: usize, range: &Range<usize>, rest: &mut Events<'e>) -> Markup {
        let mut inner = Vec::new();
        let mut words = String::new();
        while let Some((event, at)) = rest.next() {
            match &event {
                Event::End(TagEnd::Heading(_)) => break,
                Event::Text(text) | Event::Code(text) => words.push_str(text),
                _ => {}
            }
            self.convert(event, at, rest, &mut inner);
        }
        if !(2..=4).contains(&level) {
            self.fault(range, "headings in a chapter have two to four #; the title is in the facts");
        }
        let chapter = self.place.chapter.map(|chapter| chapter.id.as_str()).unwrap_or_default();
        let anchor = format!("{chapter}-{}", slug(&words));
        if !self.uses.anchors.insert(anchor.clone()) {
            self.fault(range, format!("another heading has the anchor #{anchor}; choose other words"));
        }
        let mut title = String::new();
        writer::push_html(&mut title, inner.into_iter());
        let mut title = PreEscaped(title);
        let source = self.place.text[range.clone()].trim_start_matches('#').trim();
        if let Some((number, words)) = Book::split(source) {
            match self.site.book.heading(number) {
                None => self.fault(range, format!("the book has no section {number}")),
                Some(heading) if heading != words => {
                    self.fault(range, format!("section {number} of the book is called {heading:?}"));
                }
                Some(heading) => {
                    let url = self.site.book.url(number);
                    title = html! {
                        span .number { (number) } " " (typographic(heading)) " "
                        @if let Some(url) = url {
                            a .book href=(url) title={ "Section " (number) " in the book" } { "book" span .hidden { ", section " (number) } }
                        }
                    };
                }
            }
        }
        let link = html! { a .anchor href={ "#" (anchor) } aria-label="Link to this section" { "#" } };
        // The page's title is h1 and a chapter's h2.
        match level {
            3 => html! { h4 id=(anchor) { (title) (link) } },
            4 => html! { h5 id=(anchor) { (title) (link) } },
            _ => html! { h3 id=(anchor) { (title) (link) } },
        }
    }

    fn code<'e>(&mut self, kind: &CodeBlockKind<'_>, range: &Range<usize>, rest: &mut Events<'e>) -> Markup {
        let mut code = String::new();
        for (event, _) in rest.by_ref() {
            match event {
                Event::Text(text) => code.push_str(&text),
                Event::End(TagEnd::CodeBlock) => break,
                _ => {}
            }
        }
        let language = match kind {
            CodeBlockKind::Fenced(language) if !language.is_empty() => language.to_string(),
            _ => "text".to_owned(),
        };
        match self.site.highlighter.html(&language, &code) {
            Ok(code) => html! {
                pre .block tabindex="0" role="group" aria-label={ "Code" } { code { (code) } }
            },
            Err(error) => {
                self.fault(range, error);
                html! {}
            }
        }
    }

    fn citation(&mut self, target: &str, range: &Range<usize>) -> Markup {
        let keys =
            target.trim_start_matches(CITATION).split(';').map(|key| key.trim().trim_start_matches('@'));
        let mut links = Vec::new();
        for key in keys {
            match self.site.reference(key) {
                Some((number, entry)) => {
                    let title = format!("{}: {}", entry.value.authors, entry.value.title);
                    links.push((number, html! { a href={ "#ref-" (key) } title=(title) { (number) } }));
                }
                None => self.fault(range, format!("references.toml has no entry {key:?}")),
            }
        }
        links.sort_by_key(|(number, _)| *number);
        html! {
            span .cite {
                "[" @for (place, (_, link)) in links.iter().enumerate() { @if place > 0 { ", " } (link) } "]"
            }
        }
    }

    /// What opens and what closes a link.
    fn link(&mut self, link_type: LinkType, target: &str, range: &Range<usize>) -> (Markup, Markup) {
        let close = PreEscaped("</a>".to_owned());
        let open = |class: &str, href: &str, title: &str, id: Option<String>| {
            let whole = html! {
                a id=[id] class=[(!class.is_empty()).then_some(class)] href=(href)
                    title=[(!title.is_empty()).then_some(title)] {}
            };
            PreEscaped(whole.into_string().replace("</a>", ""))
        };
        let nothing = || (html! {}, html! {});
        let (scheme, rest) = target.split_once(':').unwrap_or(("", target));
        let words = self.place.text[range.clone()].split("](").next().unwrap_or_default();
        let there = if scheme == "book" { rest } else { rest.split_once('#').unwrap_or_default().1 };
        if matches!(scheme, "book" | "page")
            && let Some(section) = Book::named(words).filter(|section| *section != there)
        {
            let remedy = format!("write page:CHAPTER#{section} or book:{section}");
            self.fault(range, format!("the link names section {section} but leads to {target:?}; {remedy}"));
        }
        match scheme {
            "glossary" => match self.site.term(rest) {
                Some(entry) => {
                    let is_first = self.place.chapter.is_some_and(|chapter| {
                        let is_new = !self.uses.terms.contains_key(&entry.key);
                        self.uses.terms.entry(entry.key.clone()).or_insert_with(|| chapter.short.clone());
                        is_new
                    });
                    (
                        open("term", &format!("#term-{rest}"), "", is_first.then(|| format!("use-{rest}"))),
                        close,
                    )
                }
                None => {
                    self.fault(range, format!("the glossary has no term {rest:?}"));
                    nothing()
                }
            },
            "book" => match self.site.book.url(rest) {
                Some(url) => {
                    let kind = if rest.contains('.') { "section" } else { "chapter" };
                    let title = self.site.book.heading(rest).unwrap_or_default();
                    (open("book", &url, &format!("The book, {kind} {rest}: {title}"), None), close)
                }
                None => {
                    self.fault(range, format!("the book has no section {rest:?}"));
                    nothing()
                }
            },
            "page" => {
                let (name, fragment) = rest.split_once('#').unwrap_or((rest, ""));
                let Some(chapter) = self.site.chapters.iter().find(|chapter| chapter.id == name) else {
                    self.fault(range, format!("the page has no chapter {name:?}"));
                    return nothing();
                };
                let heading = self.site.book.heading(fragment).map(|heading| format!("{fragment} {heading}"));
                let anchor = match &heading {
                    Some(heading) => format!("{name}-{}", slug(heading)),
                    None if fragment.is_empty() => name.to_owned(),
                    None => format!("{name}-{fragment}"),
                };
                let line = self.line(range);
                self.uses.targets.push((anchor.clone(), self.place.file.to_owned(), line));
                let number = chapter.shown_number().map(|number| format!("Chapter {number}: "));
                let title = heading.map(|heading| format!("Section {heading}"));
                let title = title.unwrap_or_else(|| number.unwrap_or_default() + &chapter.title);
                (open("", &format!("#{anchor}"), &title, None), close)
            }
            "source" => {
                if !is_source(rest) {
                    self.fault(
                        range,
                        format!("there is no source {rest:?}; give its path in the repository"),
                    );
                }
                // The page has no copy of the repository, so it cites the path as it cites references.
                (html! {}, html! { " " span .cite { "[" code .path { (rest) } "]" } })
            }
            "https" | "mailto" => (open("", target, "", None), close),
            "" if target.starts_with('#') => {
                let line = self.line(range);
                self.uses.targets.push((rest[1..].to_owned(), self.place.file.to_owned(), line));
                (open("", target, "", None), close)
            }
            _ => {
                let kinds =
                    "glossary:TERM, book:SECTION, page:CHAPTER, source:PATH, [@REFERENCE] or https://";
                let form =
                    if link_type == LinkType::Inline { target.to_owned() } else { format!("[{target}]") };
                self.fault(range, format!("{form:?} is no link of the page; use {kinds}"));
                nothing()
            }
        }
    }
}

/// The formula and a punctuation mark that follows it, which must not begin a line.
fn with_punctuation(formula: &Markup, rest: &mut Events<'_>) -> Markup {
    let Some((Event::Text(next), _)) = rest.peek_mut() else { return formula.clone() };
    let Some(mark) = next.chars().next().filter(|c| ".,;:!?)".contains(*c)) else { return formula.clone() };
    *next = CowStr::from(next[mark.len_utf8()..].to_owned());
    html! { span .nb { (formula) (mark) } }
}

fn skip_to(rest: &mut Events<'_>, end: TagEnd) {
    for (event, _) in rest.by_ref() {
        if event == Event::End(end) {
            break;
        }
    }
}

#[cfg(test)]
mod tests;
