//! `index.html`: the figures with captions, by chapter. It needs no server, script or network.

use super::still::{Stills, file_name, has_few_pixels};
use super::{Figure, Panel};
use crate::stages::{BOOK_URL, Stage};
use crate::system::files::GENERATOR;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use std::collections::BTreeSet;

const STYLE: &str = include_str!("../../../assets/gallery/style.css");

/// The page of the stills, with placeholders for missing ones.
pub fn page(stills: &Stills) -> String {
    let chapters = Figure::all().chunk_by(|a, b| a.stage().chapter() == b.stage().chapter());
    let chapters: Vec<(&Stage, &[Figure])> =
        chapters.filter_map(|figures| Some((figures.first()?.stage(), figures))).collect();
    let title = |stage: &Stage| html! { span.number { (stage.chapter()) } " " (stage.chapter_title()) };
    let backends: BTreeSet<&str> = stills.values().map(|still| still.backend.as_str()).collect();
    let backends: Vec<&str> = backends.into_iter().collect();
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                (PreEscaped(GENERATOR))
                title { "Ray Tracing in One Weekend in pictures" }
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta name="description" content="Every figure of Ray Tracing in One Weekend, with its settings, time \
                                                  and error.";
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    h1 { "Ray Tracing in One Weekend in pictures" }
                    p.lead {
                        "Every step of " a href=(BOOK_URL) { "the book" } ", rendered by Weekender. Each picture opens in \
                         full size and contains the settings that it was made with."
                    }
                    nav aria-label="Chapters" {
                        ul {
                            @for (stage, _) in &chapters {
                                li { a href={ "#chapter-" (stage.chapter()) } { (title(stage)) } }
                            }
                        }
                    }
                }
                main {
                    @for (stage, figures) in &chapters {
                        section id={ "chapter-" (stage.chapter()) } {
                            h2 { (title(stage)) }
                            @for figure in *figures { (shown(figure, stills)) }
                        }
                    }
                }
                footer {
                    p {
                        "Times are those of tracing alone. The error is the root of the mean squared error in linear radiance, \
                         estimated from two halves of the samples; ± is one standard deviation of the estimate."
                    }
                    @if !backends.is_empty() {
                        p { "Rendered by Weekender " (env!("CARGO_PKG_VERSION")) " (" (backends.join("; ")) ")." }
                    }
                }
            }
        }
    };
    page.into_string() + "\n"
}

fn shown(figure: &Figure, stills: &Stills) -> Markup {
    let stage = figure.stage();
    html! {
        figure.figure id={ "figure-" (figure.id) } {
            div .panels .{ "of-" (figure.panels.len()) } {
                @for panel in &figure.panels { (shown_panel(panel, figure.panels.len() > 1, stills)) }
            }
            figcaption {
                h3 { a href={ "#figure-" (figure.id) } { (figure.title) } }
                p { (figure.caption) }
                p.section { a href=(stage.url()) { "Section " (stage.section) ", " (stage.section_title()) } }
            }
        }
    }
}

/// `is_labelled` if the panel has neighbours.
fn shown_panel(panel: &Panel, is_labelled: bool, stills: &Stills) -> Markup {
    let stage = panel.stage();
    html! {
        div .panel .pixels[has_few_pixels(stage)] data-stage=(stage.id) {
            @match stills.get(stage.id) {
                Some(still) => {
                    @let file = file_name(stage);
                    a href=(file) {
                        img src=(file) width=(still.settings.width) height=(still.settings.height) alt=(stage.alt) loading="lazy";
                    }
                    p.facts {
                        @if is_labelled { strong { (panel.label) } " " }
                        (still.settings_words()) "; " (still.time_words()) ", " (still.error_words())
                    }
                }
                None => p.missing { "Not rendered yet: " code { "--only " (stage.id) } }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn page_has_figures_and_placeholders() {
        let page = page(&crate::pages::gallery::still::stills_of(&["metal", "metal-fuzzy", "book"]));
        for figure in Figure::all() {
            assert_eq!(page.matches(&format!("id=\"figure-{}\"", figure.id)).count(), 1, "{}", figure.id);
            let chapter = format!("<section id=\"chapter-{}\">", figure.stage().chapter());
            assert_eq!(page.matches(&chapter).count(), 1, "{chapter}");
        }
        // Metal appears alone and, with a label, beside its fuzzy neighbour.
        let panels: usize = Figure::all().iter().map(|figure| figure.panels.len()).sum();
        assert_eq!(page.matches("<img ").count(), 4);
        assert_eq!(page.matches("<p class=\"facts\"><strong>").count(), 2);
        assert_eq!(page.matches("Not rendered yet").count(), panels - 4);
        assert!(page.contains(" (cpu).</p>"), "{page}");
        assert!(!page.contains("<script") && !page.contains("style=\""));
    }
}
