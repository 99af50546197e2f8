//! Directives: paragraphs such as `{{figure sky}}` that become parts of the page.

use crate::figure::Figure;
use crate::library::FOLDER;
use crate::lists;
use crate::live;
use crate::picture::Picture;
use crate::pictures;
use crate::prose::Place;
use crate::site::Site;
use crate::timeline;
use crate::uses::Uses;
use crate::words::{numbered, typographic};
use anyhow::{Context, Error, Result, bail, ensure};
use maud::{Markup, PreEscaped, html};
use std::str::FromStr;
use weekender::excerpt::Excerpt;
use weekender::stages::Stage;

/// The directives and their arguments. More lines hold a caption, or what to quote.
const KNOWN: &str = "figure ID, figure ID crop LEFT TOP WIDTH HEIGHT, figure ID aim X Y Z DEGREES, code, code without LANGUAGES: REASON, fold TITLE, unfold, mistakes STAGE, bounces STAGE, samples STAGE (these three also with crop LEFT TOP WIDTH HEIGHT), denoised STAGE SAMPLES, table NAME, chart NAME, diagram NAME, diagram NAME where WORD < WORD, timeline STAGE, glossary, references";

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
        ["figure", id] => figure(id, caption()?, Part::None, uses),
        ["figure", id, "crop", part @ ..] => figure(id, caption()?, Part::Crop(numbers(part)?), uses),
        ["figure", id, "aim", part @ ..] => figure(id, caption()?, Part::Aim(numbers(part)?), uses),
        ["code"] => code(site, place, more, ""),
        ["code", "without", ..] => {
            code(site, place, more, head.split_once("without ").map_or("", |(_, why)| why))
        }
        [kind @ ("mistakes" | "bounces" | "samples"), stage, part @ ..] => {
            let crop = match part {
                [] => None,
                ["crop", part @ ..] => Some(numbers(part)?),
                _ => bail!("after the stage, only a crop can stand"),
            };
            match *kind {
                "mistakes" => pictures::mistakes(stage, more, crop, uses),
                kind => pictures::variants(stage, more, kind == "samples", crop, uses),
            }
        }
        ["fold", ..] => {
            let title = place.inside(site, &words[1..].join(" "), uses)?;
            Ok(PreEscaped(format!("<details class=\"fold\"><summary>{}</summary>", title.0)))
        }
        ["unfold"] => Ok(PreEscaped("</details>".to_owned())),
        ["denoised", stage, samples] => {
            let caption = caption()?.context("a figure of denoising needs a caption")?;
            let panels = pictures::denoised(stage, samples, uses)?;
            Ok(
                html! { figure .figure .wide id={ "denoised-" (stage) } { (panels) (numbered(&caption, uses)) } },
            )
        }
        ["table", name] => site.measured.table(name),
        ["chart", name] => site.measured.chart(name, uses),
        ["diagram", name] => diagram(site, name, caption()?, None, uses),
        ["diagram", name, "where", a, sign, b] => diagram(site, name, caption()?, Some([a, sign, b]), uses),
        ["timeline", stage] => timeline::figure(stage, uses),
        ["glossary"] => Ok(lists::glossary(site, place, uses)?),
        ["references"] => Ok(lists::references(site, place, uses)?),
        _ => bail!("{{{{{directive}}}}} is not a directive; use one of {KNOWN}"),
    }
}

fn numbers<T: FromStr>(words: &[&str]) -> Result<[T; 4]> {
    let numbers: Result<Vec<T>, _> = words.iter().map(|word| word.parse()).collect();
    numbers.ok().and_then(|numbers| numbers.try_into().ok()).context("give four numbers")
}

/// A second picture below a panel's.
#[derive(Clone, Copy)]
pub enum Part {
    None,
    /// A part, enlarged: left, top, width and height in the stage's pixels.
    Crop([u32; 4]),
    /// The stage seen from the same eye: a point to look at, and the field of view in degrees.
    Aim([f64; 4]),
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
    let id = format!("stage-{}", stage.id);
    let id = Some(id).filter(|id| small.is_none() && uses.anchors.insert(id.clone()));
    let (file, [width, height]) =
        (format!("figures/{}.png", stage.id), [stage.setup.width, stage.setup.height]);
    Ok(html! {
        div .panel id=[id] data-stage=(stage.id) {
            div .live-frame { img .pixels[width < FEW_PIXELS] src=(file) width=(width) height=(height) alt=(stage.alt)
                loading=[small.is_none().then_some("lazy")] fetchpriority=[small.map(|_| "high")]
                srcset=[small.map(|small| format!("{}, {file} {width}w", small.candidate()))]
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
    let mut picture = Picture::still(stage);
    let camera = &mut picture.recipe.camera;
    (camera.look_at.x, camera.look_at.y, camera.look_at.z, camera.vfov_degrees) = (x, y, z, vfov);
    let shown = html! { div .aimed { (picture.img("seen with a camera that looks at it")) } };
    uses.pictures.push(picture);
    shown
}

fn figure(id: &str, caption: Option<Markup>, part: Part, uses: &mut Uses) -> Result<Markup> {
    let figure = Figure::find(id);
    let figure = figure
        .with_context(|| format!("there is no figure {id:?}; companion/assets/figures.toml has them"))?;
    if !uses.anchors.insert(format!("figure-{id}")) {
        bail!("the figure {id:?} is on the page already; link it as [text](#figure-{id})");
    }
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

/// Order of the switch between languages.
const LANGUAGES: [&str; 3] = ["c", "wgsl", "rs"];

fn name_of(language: &str) -> String {
    if language == "rs" { "Rust".to_owned() } else { language.to_uppercase() }
}

/// Excerpts, one a line, with a switch between their languages. The first is open. In the book's chapters, `why` gives the
/// reason for each language that is missing, as in `C, WGSL: the reason`.
fn code(site: &Site, place: &Place<'_>, wanted: &str, why: &str) -> Result<Markup> {
    let excerpts: Result<Vec<Excerpt>, String> =
        wanted.lines().map(|line| site.library.excerpt(line)).collect();
    let excerpts = excerpts.map_err(Error::msg)?;
    let mut languages: Vec<&str> = excerpts.iter().map(Excerpt::language).collect();
    let open = languages.first().copied().unwrap_or_default();
    languages.sort_by_key(|language| LANGUAGES.iter().position(|known| known == language));
    languages.dedup();
    let (lacking, reason) = why.split_once(": ").unwrap_or((why, ""));
    let lacking: Vec<&str> = lacking.split(", ").filter(|name| !name.is_empty()).collect();
    for language in LANGUAGES.iter().filter(|_| place.is_of_book()) {
        let name = name_of(language);
        let (is_there, is_excused) = (languages.contains(language), lacking.contains(&name.as_str()));
        if is_there == is_excused {
            let what = if is_there { "is there" } else { "is missing" };
            bail!("{name} {what}; list exactly what is missing: code without C, WGSL: REASON");
        }
    }
    Ok(html! {
        div .tabbed {
            @if languages.len() > 1 {
                div .tabs role="group" aria-label="Language" {
                    @for language in &languages {
                        button type="button" data-language=(language) aria-pressed=(*language == open) {
                            (name_of(language))
                        }
                    }
                }
            }
            @if !reason.is_empty() { p .without { "Not shown in " (lacking.join(" or ")) ": " (typographic(reason)) "." } }
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

/// Diagrams are SVG files that take their colours from the text around them. Without a caption, they have their title. What
/// the caption of a random one claims is given as two words of its reading, each with a number after it.
fn diagram(
    site: &Site,
    name: &str,
    caption: Option<Markup>,
    claim: Option<[&str; 3]>,
    uses: &mut Uses,
) -> Result<Markup> {
    let path = format!("{FOLDER}/diagrams/{name}.svg");
    // The line to name is the directive's.
    let text = site.library.read(&path).map_err(|fault| Error::msg(fault.to_string()))?;
    let start = text.find("<svg").with_context(|| format!("{path} has no <svg> element"))?;
    ensure!(
        claim.is_some() || !text.contains("data-random"),
        "{name} draws random numbers: add what its reading shows, as in `where Sobol < random`"
    );
    if let Some([a, sign, b]) = claim {
        let reading = text
            .split_once("<desc")
            .and_then(|(_, rest)| rest.split_once("</desc>"))
            .map_or("", |(reading, _)| reading);
        let [left, right] = [number_after(reading, a)?, number_after(reading, b)?];
        let holds = match sign {
            "<" => left < right,
            // Within 2 % of a whole.
            _ => (left - right).abs() <= 2.0,
        };
        ensure!(
            holds,
            "the reading of {name} contradicts its caption: {a} {left} {sign} {b} {right}; open it in another state"
        );
    }
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

/// The number after the last occurrence of a word.
fn number_after(reading: &str, word: &str) -> Result<f64> {
    let (_, rest) = reading.rsplit_once(word).with_context(|| format!("the reading has no {word:?}"))?;
    let number = rest.trim_start_matches(|c: char| !c.is_ascii_digit());
    let end = number.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(number.len());
    number[..end]
        .trim_end_matches('.')
        .parse()
        .with_context(|| format!("no number is after {word:?} in the reading"))
}
