//! Directives: paragraphs such as `{{figure sky}}` that become parts of the page.

use super::excerpt::Excerpt;
use super::library::FOLDER;
use super::site::{Site, Uses};
use super::timeline;
use crate::page::gallery::{Figure, is_about_pixels};
use crate::system::suggest::similar_names;
use anyhow::{Context, Result, bail};
use maud::{Markup, PreEscaped, html};

/// The directives and their arguments.
const KNOWN: &str = "figure ID, excerpt NAME, pair NAME NAME, table NAME, chart NAME, diagram NAME, timeline STAGE, glossary, references";

/// Marks the glossary's place until all chapters are rendered.
pub const GLOSSARY_MARK: &str = "<!-- glossary -->";

/// Marks the references' place.
pub const REFERENCES_MARK: &str = "<!-- references -->";

/// Replaces apostrophes by typographic ones.
pub fn typographic(text: &str) -> String {
    text.replace('\'', "’")
}

/// The HTML of a directive, given without its braces.
pub fn html(site: &Site, directive: &str, uses: &mut Uses) -> Result<Markup> {
    let words: Vec<&str> = directive.split_whitespace().collect();
    match words.as_slice() {
        ["figure", id] => figure(id, uses),
        ["excerpt", name] => excerpt(site, name, uses),
        ["pair", first, second] => {
            let pair = [excerpt(site, first, uses)?, excerpt(site, second, uses)?];
            Ok(html! { div .pair { @for side in pair { (side) } } })
        }
        ["table", name] => site.measured.table(name),
        ["chart", name] => site.measured.chart(name),
        ["diagram", name] => diagram(site, name),
        ["timeline", stage] => timeline::figure(stage),
        ["glossary"] => Ok(PreEscaped(GLOSSARY_MARK.to_owned())),
        ["references"] => Ok(PreEscaped(REFERENCES_MARK.to_owned())),
        _ => bail!("{{{{{directive}}}}} is no directive; use one of {KNOWN}"),
    }
}

fn figure(id: &str, uses: &mut Uses) -> Result<Markup> {
    let figure = Figure::find(id).with_context(|| {
        let near = similar_names(id, Figure::ALL.iter().map(|figure| figure.id));
        format!("there is no figure {id:?}; near: {}", near.join(", "))
    })?;
    if !uses.anchors.insert(format!("figure-{id}")) {
        bail!("the figure {id:?} is on the page already; link it as [text](#figure-{id})");
    }
    uses.figures.push(figure);
    let is_wide = figure.panels.len() > 1;
    Ok(html! {
        figure .figure .wide[is_wide] id={ "figure-" (id) } {
            div .panels .{ "of-" (figure.panels.len()) } {
                @for panel in figure.panels {
                    @let stage = panel.stage();
                    div .panel data-stage=(stage.id) {
                        img .pixels[is_about_pixels(stage)] src={ "figures/" (stage.id) ".png" }
                            width=(stage.setup.width) height=(stage.setup.height)
                            alt=(stage.alt) loading="lazy";
                        @if is_wide { p .label { (typographic(panel.label)) } }
                    }
                }
            }
            figcaption { strong { (typographic(figure.title)) "." } " " (typographic(figure.caption)) }
        }
    })
}

fn excerpt(site: &Site, name: &str, uses: &mut Uses) -> Result<Markup> {
    let excerpt = site.excerpts.get(name);
    let excerpt = excerpt.with_context(|| format!("excerpts.toml has no excerpt {name:?}"))?;
    uses.excerpts.insert(name.to_owned());
    let Excerpt { file, first, last, text } = excerpt;
    let language = file.rsplit('.').next().unwrap_or_default();
    let code = site.highlighter.html(language, text)?;
    let lines = if first == last { format!("line {first}") } else { format!("lines {first} to {last}") };
    Ok(html! {
        figure .code {
            figcaption { code .path { (file) } " " span .lines { (lines) } }
            pre tabindex="0" role="group" aria-label={ (file) ", " (lines) } { code { (code) } }
        }
    })
}

/// Diagrams are SVG files that take their colours from the text around them. The title becomes the caption.
fn diagram(site: &Site, name: &str) -> Result<Markup> {
    let path = format!("{FOLDER}/diagrams/{name}.svg");
    let text = site.library.read(&path)?;
    let start = text.find("<svg").with_context(|| format!("{path} has no <svg> element"))?;
    let title = text.split_once("<title").and_then(|(_, rest)| rest.split_once('>'));
    let caption = title.and_then(|(_, rest)| rest.split_once("</title>")).map(|(title, _)| title.trim());
    Ok(html! {
        figure .diagram id={ "diagram-" (name) } {
            div .scroll { (PreEscaped(text[start..].trim())) }
            @if let Some(caption) = caption { figcaption { (PreEscaped(caption)) } }
        }
    })
}
