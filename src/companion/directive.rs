//! Directives: paragraphs such as `{{figure sky}}`, each of which becomes a part of the page.

use super::excerpt::Excerpt;
use super::library::FOLDER;
use super::measured;
use super::site::{Site, Uses};
use super::text::typographic;
use super::timeline;
use crate::gallery::{Figure, is_about_pixels};
use maud::{Markup, PreEscaped, html};

/// The directives with what follows them.
const KNOWN: &str = "figure ID, excerpt NAME, pair NAME NAME, table NAME, chart NAME, diagram NAME, timeline STAGE, glossary, references";

/// Stands where the glossary is to be put, until all chapters are rendered.
pub const GLOSSARY_MARK: &str = "<!-- glossary -->";

/// The same for the references.
pub const REFERENCES_MARK: &str = "<!-- references -->";

/// The HTML of a directive, given without its braces.
///
/// # Errors
/// What is wrong with it.
pub fn html(site: &Site, directive: &str, uses: &mut Uses) -> Result<Markup, String> {
    let words: Vec<&str> = directive.split_whitespace().collect();
    match words.as_slice() {
        ["figure", id] => figure(id, uses),
        ["excerpt", name] => Ok(html! { (excerpt(site, name, uses)?) }),
        ["pair", first, second] => {
            let pair = [excerpt(site, first, uses)?, excerpt(site, second, uses)?];
            Ok(html! { div .pair { @for side in pair { (side) } } })
        }
        ["table", name] => measured::table(&site.measured, name),
        ["chart", name] => measured::chart(&site.measured, name),
        ["diagram", name] => diagram(site, name, uses),
        ["timeline", stage] => timeline::figure(stage),
        ["glossary"] => Ok(PreEscaped(GLOSSARY_MARK.to_owned())),
        ["references"] => Ok(PreEscaped(REFERENCES_MARK.to_owned())),
        _ => Err(format!("{{{{{directive}}}}} is no directive; use one of {KNOWN}")),
    }
}

fn figure(id: &str, uses: &mut Uses) -> Result<Markup, String> {
    let figure = Figure::find(id).map_err(|error| error.to_string())?;
    if !uses.anchors.insert(format!("figure-{id}")) {
        return Err(format!("the figure {id:?} is on the page already; link it as [text](#figure-{id})"));
    }
    uses.figures.push(figure);
    let is_wide = figure.panels.len() > 1;
    Ok(html! {
        figure .figure .wide[is_wide] id={ "figure-" (id) } {
            div .panels .{ "of-" (figure.panels.len()) } {
                @for panel in figure.panels {
                    div .panel data-stage=(panel.stage.id) {
                        img .pixels[is_about_pixels(panel.stage)] src={ "figures/" (panel.stage.id) ".png" }
                            width=(panel.stage.setup.width) height=(panel.stage.setup.height)
                            alt=(panel.alt) loading="lazy";
                        @if is_wide { p .label { (typographic(panel.label)) } }
                    }
                }
            }
            figcaption { strong { (typographic(figure.title)) "." } " " (typographic(figure.caption)) }
        }
    })
}

fn excerpt(site: &Site, name: &str, uses: &mut Uses) -> Result<Markup, String> {
    let Some(excerpt) = site.excerpts.get(name) else {
        return Err(format!("excerpts.toml has no excerpt {name:?}, or it could not be read"));
    };
    uses.excerpts.insert(name.to_owned());
    let Excerpt { file, first, last, text } = excerpt;
    let language = file.rsplit('.').next().unwrap_or_default();
    let code = site.highlighter.html(language, text).map_err(|error| format!("{error:#}"))?;
    let lines = if first == last { format!("line {first}") } else { format!("lines {first} to {last}") };
    Ok(html! {
        figure .code {
            figcaption { code .path { (file) } " " span .lines { (lines) } }
            pre tabindex="0" role="group" aria-label={ (file) ", " (lines) } { code { (code) } }
        }
    })
}

/// Diagrams are SVG files whose colours are those of the text around them.
fn diagram(site: &Site, name: &str, uses: &mut Uses) -> Result<Markup, String> {
    let path = format!("{FOLDER}/diagrams/{name}.svg");
    let text = site.library.read(&path).map_err(|message| format!("{path} {message}"))?;
    let Some(start) = text.find("<svg") else {
        return Err(format!("{path} has no <svg> element"));
    };
    uses.diagrams.insert(name.to_owned());
    let caption = between(&text, "<title", "</title>");
    Ok(html! {
        figure .diagram id={ "diagram-" (name) } {
            div .scroll { (PreEscaped(text[start..].trim())) }
            @if let Some(caption) = caption { figcaption { (PreEscaped(caption)) } }
        }
    })
}

/// The content of the first element that begins so.
fn between<'a>(text: &'a str, open: &str, close: &str) -> Option<&'a str> {
    let inside = &text[text.find(open)?..];
    let inside = &inside[inside.find('>')? + 1..];
    Some(inside[..inside.find(close)?].trim())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::companion::library::Library;

    fn excerpt(file: &str, [first, last]: [usize; 2], text: &str) -> Excerpt {
        Excerpt { file: file.to_owned(), first, last, text: text.to_owned() }
    }

    #[test]
    fn excerpts_have_their_path_and_their_lines_and_pairs_are_in_order() {
        let (mut site, mut uses) = (Site::made_up(), Uses::default());
        site.excerpts.insert("one".to_owned(), excerpt("a/b.text", [7, 7], "x < y\n"));
        site.excerpts.insert("more".to_owned(), excerpt("c.text", [8, 10], "z\n"));
        site.excerpts.insert("code".to_owned(), excerpt("d.rs", [1, 1], "fn d() {}\n"));
        let shown = |file: &str, lines: &str, text: &str| {
            format!(
                "<figure class=\"code\"><figcaption><code class=\"path\">{file}</code> <span class=\"lines\">{lines}</span>\
                 </figcaption><pre tabindex=\"0\" role=\"group\" aria-label=\"{file}, {lines}\"><code>{text}\n</code></pre>\
                 </figure>"
            )
        };
        let one = shown("a/b.text", "line 7", "x &lt; y");
        let more = shown("c.text", "lines 8 to 10", "z");
        let mut made = |directive: &str| html(&site, directive, &mut uses).map(Markup::into_string);
        assert_eq!(made("excerpt one"), Ok(one.clone()));
        assert_eq!(made("pair more one"), Ok(format!("<div class=\"pair\">{more}{one}</div>")));
        assert!(made("excerpt code").unwrap().contains("<span class=\"hl-k\">fn</span>"));
        for wrong in ["excerpt none", "pair one none", "pair none one"] {
            assert!(made(wrong).unwrap_err().contains("has no excerpt \"none\""), "{wrong}");
        }
        assert_eq!(uses.excerpts.iter().collect::<Vec<_>>(), ["code", "more", "one"]);
    }

    #[test]
    fn a_diagram_is_its_svg_with_its_title_as_the_caption() {
        let directory = tempfile::tempdir().unwrap();
        let folder = directory.path().join(FOLDER).join("diagrams");
        std::fs::create_dir_all(&folder).unwrap();
        let drawing = "<svg><title id=\"t\"> A <b>lens</b> </title><path/></svg>";
        for (name, text) in [
            ("lens", format!("<?xml version=\"1.0\"?>\n{drawing}\n")),
            ("untitled", "<svg></svg>".to_owned()),
            ("empty", "nothing".to_owned()),
        ] {
            std::fs::write(folder.join(format!("{name}.svg")), text).unwrap();
        }
        let (mut site, mut uses) = (Site::made_up(), Uses::default());
        site.library = Library::Checkout(directory.path().to_owned());
        let mut made = |directive: &str| html(&site, directive, &mut uses).map(Markup::into_string);
        let figure = |name: &str, inside: &str| {
            format!("<figure class=\"diagram\" id=\"diagram-{name}\"><div class=\"scroll\">{inside}</figure>")
        };
        let caption = "<figcaption>A <b>lens</b></figcaption>";
        assert_eq!(made("diagram lens"), Ok(figure("lens", &format!("{drawing}</div>{caption}"))));
        assert_eq!(made("diagram untitled"), Ok(figure("untitled", "<svg></svg></div>")));
        let message = "docs/companion/diagrams/empty.svg has no <svg> element";
        assert_eq!(made("diagram empty"), Err(message.to_owned()));
        assert!(made("diagram none").unwrap_err().starts_with("docs/companion/diagrams/none.svg "));
        assert_eq!(uses.diagrams.iter().collect::<Vec<_>>(), ["lens", "untitled"]);
    }
}
