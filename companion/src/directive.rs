//! Directives: paragraphs such as `{{figure sky}}` that become parts of the page.

use crate::figure::Figure;
use crate::library::FOLDER;
use crate::lists;
use crate::live;
use crate::picture::{Part, Picture};
use crate::pictures;
use crate::prose::Place;
use crate::site::Site;
use crate::timeline;
use crate::uses::Uses;
use crate::words::{is_word, numbered, typographic};
use anyhow::{Context, Error, Result, bail, ensure};
use maud::{Markup, PreEscaped, html};
use std::str::FromStr;
use weekender::excerpt::Excerpt;
use weekender::stages::Stage;

/// The directives and their arguments. More lines hold a caption, or what to quote.
const KNOWN: &str = "figure ID, figure ID crop LEFT TOP WIDTH HEIGHT, figure ID aim X Y Z DEGREES, code, code without: REASON, fold TITLE, unfold, mistakes STAGE, bounces STAGE, samples STAGE (these three also with crop LEFT TOP WIDTH HEIGHT), denoised STAGE SAMPLES, table NAME, chart NAME, diagram NAME, timeline STAGE, glossary AREA, references";

/// The HTML of a directive, given without its braces.
pub fn html(site: &Site, place: &Place<'_>, directive: &str, uses: &mut Uses) -> Result<Markup> {
    let (head, more) = directive.split_once('\n').unwrap_or((directive, ""));
    let words: Vec<&str> = head.split_whitespace().collect();
    // A caption is Markdown.
    let mut caption = || match more {
        "" => Ok(None),
        // The line to name is the directive's.
        text => place.inside(site, text, uses).map(Some).map_err(|fault| Error::msg(fault.message)),
    };
    match words.as_slice() {
        ["figure", id, shown @ ..] => figure(id, caption()?, part(shown)?, uses),
        ["code"] => code(site, place, more, "", uses),
        ["code", "without:", ..] => code(site, place, more, &words[2..].join(" "), uses),
        ["mistakes", stage, shown @ ..] => pictures::mistakes(stage, more, part(shown)?, uses),
        [kind @ ("bounces" | "samples"), stage, shown @ ..] => {
            pictures::variants(stage, more, *kind == "samples", part(shown)?, uses)
        }
        ["fold", ..] => {
            let title = place.inside(site, &words[1..].join(" "), uses)?;
            Ok(PreEscaped(format!("<details class=\"fold\"><summary>{}</summary>", title.0)))
        }
        ["unfold"] => Ok(PreEscaped("</details>".to_owned())),
        ["denoised", stage, samples] => {
            let caption = caption()?.context("a figure of denoising needs a caption")?;
            pictures::denoised(stage, samples, &caption, uses)
        }
        ["table", name] => site.measured.table(name),
        ["chart", name] => site.measured.chart(name, uses),
        ["diagram", name] => diagram(site, name, caption()?, uses),
        ["timeline", stage] => timeline::figure(stage, uses),
        ["glossary", area] => Ok(lists::glossary(site, place, area, uses)?),
        ["references"] => Ok(lists::references(site, place, uses)?),
        _ => bail!("{{{{{directive}}}}} is not a directive; use one of {KNOWN}"),
    }
}

fn part(words: &[&str]) -> Result<Part> {
    match words {
        [] => Ok(Part::None),
        ["crop", part @ ..] => Ok(Part::Crop(numbers(part)?)),
        ["aim", part @ ..] => Ok(Part::Aim(numbers(part)?)),
        _ => bail!("after the picture, only a crop or an aim can stand"),
    }
}

fn numbers<T: FromStr>(words: &[&str]) -> Result<[T; 4]> {
    let numbers: Result<Vec<T>, _> = words.iter().map(|word| word.parse()).collect();
    numbers.ok().and_then(|numbers| numbers.try_into().ok()).context("give four numbers")
}

/// Pictures narrower than this are enlarged with every pixel a square. (A reduced picture must not be shown so: its edges
/// would become jagged.)
const FEW_PIXELS: u32 = 100;

/// A panel's picture with the switch and the sliders that the script adds. `small` is for narrow windows; the panel is
/// then the page's first.
pub fn panel(
    stage: &'static Stage,
    label: Option<&str>,
    part: Part,
    small: Option<&Picture>,
    uses: &mut Uses,
) -> Result<Markup> {
    // A live panel fills its label again whenever its state changes.
    let said = label.map(|label| live::filled(stage, label)).transpose()?;
    // The window opens the page at a stage.
    let is_first = small.is_none() && uses.stages.insert(stage.id);
    let id = is_first.then(|| format!("stage-{}", stage.id));
    let (file, [width, height]) =
        (format!("figures/{}.png", stage.id), [stage.setup.width, stage.setup.height]);
    Ok(html! {
        div .panel id=[id] data-stage=(stage.id) {
            div .live-frame { img .pixels[width < FEW_PIXELS] src=(file) width=(width) height=(height) alt=(stage.alt)
                loading=[small.is_none().then_some("lazy")] fetchpriority=[small.map(|_| "high")]
                srcset=[small.map(|small| format!("{} {}w, {file} {width}w", small.file(), small.recipe.settings.width))]
                sizes=[small.map(|_| "(max-width: 40rem) 14rem, 70rem")]; }
            @if let Part::Aim([x, y, z, vfov]) = part { (aimed(stage, [x, y, z], vfov, uses)) }
            @if let Part::Crop(crop) = part {
                @let [x, y, w, h] = crop.map(f64::from);
                @let [wide, left, top] = [f64::from(width) / w, -x / w, -y / h].map(|share| 100.0 * share);
                div .crop style=(format!("aspect-ratio: {w} / {h}")) {
                    img src=(file) width=(width) height=(height) alt="A part of the picture, enlarged" loading="lazy"
                        style=(format!("width: {wide:.3}%; left: {left:.3}%; top: {top:.3}%"));
                }
            }
            @if let Some(said) = said {
                p .label data-label=[label.filter(|label| label.contains('{'))] { (typographic(&said)) }
            }
        }
    })
}

/// The stage from the same eye, with a camera that looks at a point.
fn aimed(stage: &'static Stage, [x, y, z]: [f64; 3], vfov: f64, uses: &mut Uses) -> Markup {
    let mut picture = Picture::set(stage);
    let camera = &mut picture.recipe.camera;
    (camera.look_at.x, camera.look_at.y, camera.look_at.z, camera.vfov_degrees) = (x, y, z, vfov);
    let shown = html! { div .aimed { (picture.img("seen with a camera that looks at it")) } };
    uses.add(picture);
    shown
}

fn figure(id: &str, caption: Option<Markup>, part: Part, uses: &mut Uses) -> Result<Markup> {
    let figure = Figure::find(id);
    let figure = figure
        .with_context(|| format!("there is no figure {id:?}; companion/assets/figures.toml has them"))?;
    let is_wide = figure.panels.len() > 1;
    let panels: Result<Vec<Markup>> = figure
        .panels
        .iter()
        .map(|shown| panel(shown.stage(), is_wide.then_some(shown.label.as_str()), part, None, uses))
        .collect();
    Ok(html! {
        figure .figure .wide[is_wide] id={ "figure-" (id) } {
            div .panels .{ "of-" (figure.panels.len()) } {
                @for panel in panels? { (panel) }
            }
            (numbered(&html! {
                strong { (typographic(&figure.title)) "." } " "
                (caption.unwrap_or_else(|| html! { (typographic(&figure.caption)) }))
            }, uses))
        }
    })
}

/// The languages of excerpts with their names, in the order of the switch.
const LANGUAGES: [(&str, &str); 3] = [("c", "C"), ("wgsl", "WGSL"), ("rs", "Rust")];

/// Excerpts, one a line, with a switch between their languages. The first is open. In the book's chapters, `why` gives the
/// reason if a language is missing.
fn code(site: &Site, place: &Place<'_>, wanted: &str, why: &str, uses: &mut Uses) -> Result<Markup> {
    let excerpts = wanted.lines().map(|line| site.library.excerpt(line)).collect::<Result<Vec<Excerpt>>>()?;
    let open = excerpts.first().map(Excerpt::language).unwrap_or_default();
    let shown = excerpts.iter().filter(|excerpt| excerpt.language() == open);
    uses.words.extend(shown.flat_map(|excerpt| excerpt.text.split(|c| !is_word(c))).map(str::to_owned));
    let has = |language: &str| excerpts.iter().any(|excerpt| excerpt.language() == language);
    let languages: Vec<_> = LANGUAGES.iter().filter(|(language, _)| has(language)).collect();
    let lacking = LANGUAGES.iter().filter(|(language, _)| place.is_of_book() && !has(language));
    let lacking: Vec<&str> = lacking.map(|(_, name)| *name).collect();
    let is_said = lacking.is_empty() == why.is_empty();
    ensure!(is_said, "for what is missing ({}), and only then, say why", lacking.join(", "));
    Ok(html! {
        div .tabbed {
            @if languages.len() > 1 {
                div .tabs role="group" aria-label="Language" {
                    @for (language, name) in languages {
                        button type="button" data-language=(language) aria-pressed=(*language == open) { (name) }
                    }
                }
            }
            @if !why.is_empty() { p .without { "Not shown in " (lacking.join(" or ")) ": " (typographic(why)) "." } }
            @for excerpt in &excerpts {
                @let language = excerpt.language();
                @let Excerpt { file, first, last, text } = excerpt;
                figure .code .shown[language == open] data-language=(language) {
                    figcaption {
                        code .path { (file) } " "
                        span .lines { @if first == last { "line " (first) } @else { "lines " (first) " to " (last) } }
                    }
                    @let code = site.highlighter.html(language, text)?;
                    // The others have names of their own.
                    pre { code { (if language == open { place.coloured(&code) } else { code }) } }
                }
            }
        }
    })
}

/// Diagrams are SVG files that take their colours from the text around them. Without a caption, they have their title.
fn diagram(site: &Site, name: &str, caption: Option<Markup>, uses: &mut Uses) -> Result<Markup> {
    let path = format!("{FOLDER}/diagrams/{name}.svg");
    // The line to name is the directive's.
    let text = site.library.read(&path).map_err(|fault| Error::msg(fault.to_string()))?;
    let start = text.find("<svg").with_context(|| format!("{path} has no <svg> element"))?;
    let title = text.split_once("<title").and_then(|(_, rest)| rest.split_once('>'));
    let title = title.and_then(|(_, rest)| rest.split_once("</title>")).map(|(title, _)| title.trim());
    let caption = caption.or(title.map(|title| PreEscaped(title.to_owned())));
    Ok(html! {
        figure .diagram id={ "diagram-" (name) } {
            div .scroll tabindex="0" role="group" aria-label="Diagram" { (PreEscaped(text[start..].trim())) }
            (numbered(&caption.unwrap_or_default(), uses))
        }
    })
}
