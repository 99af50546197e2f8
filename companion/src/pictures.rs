//! The page's own pictures beside the gallery's stills: what common mistakes look like, as `weekender check` renders
//! them, and a picture before and after denoising.

use crate::picture::{Part, Picture, QUICK_WIDTH, Tracer};
use crate::uses::Uses;
use crate::words::{numbered, typographic};
use anyhow::{Context, Result};
use maud::{Markup, html};
use weekender::comparison::check::{MISTAKES, Mistake};
use weekender::progressive::describe::counted;
use weekender::stages::Stage;

/// Width and samples per pixel of a picture in a row. The plain tracer takes fewer samples.
const SMALL: (u32, u64) = (180, 128);

/// A row of pictures: the stage as it should be, and with each of these mistakes, whose ids are words.
/// `part` shows them, at the size of the stage.
pub fn mistakes(stage: &str, ids: &str, part: Part, uses: &mut Uses) -> Result<Markup> {
    let stage = Stage::find(stage)?;
    let recipe = stage.recipe();
    let find = |id| {
        let is_it = |mistake: &&Mistake| mistake.id == id && (mistake.applies)(&recipe);
        MISTAKES.iter().find(is_it).with_context(|| format!("{} can have no mistake {id:?}", stage.id))
    };
    let plain = |name, mistake| Picture::new(stage, name, SMALL, Tracer::Plain(mistake)).cropped(part);
    let wrong: Result<Vec<&'static Mistake>> = ids.split_whitespace().map(find).collect();
    Ok(html! {
        ul .mistakes data-has-right {
            (entry(plain("right", None), "as it should be", None, uses))
            @for mistake in wrong? {
                (entry(plain(mistake.id, Some(mistake)), mistake.title, Some(mistake), uses))
            }
        }
    })
}

/// A row of pictures of a stage with these limits on bounces or, if `is_of_samples`, numbers of samples.
pub fn variants(
    stage: &str,
    numbers: &str,
    is_of_samples: bool,
    part: Part,
    uses: &mut Uses,
) -> Result<Markup> {
    let stage = Stage::find(stage)?;
    let numbers: Result<Vec<u32>, _> = numbers.split_whitespace().map(str::parse).collect();
    let mut shown = |number: u32| {
        let mut picture =
            Picture::new(stage, if is_of_samples { "samples" } else { "limit" }, SMALL, Tracer::Fast)
                .cropped(part);
        let title = if is_of_samples {
            picture.recipe.samples_per_pixel = number.into();
            counted(number.into(), "sample") + " per pixel"
        } else {
            picture.recipe.settings.max_depth = number + 1;
            format!("at most {}", counted(number.into(), "bounce"))
        };
        entry(picture, &title, None, uses)
    };
    Ok(html! { ul .mistakes { @for number in numbers.context("give whole numbers")? { (shown(number)) } } })
}

fn entry(picture: Picture, title: &str, mistake: Option<&Mistake>, uses: &mut Uses) -> Markup {
    let title = typographic(title);
    let mut letters = title.chars();
    let title: String = letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect();
    let shown = html! {
        li data-mistake=[mistake.map(|mistake| mistake.id)] {
            (picture.img(&title))
            p {
                strong { (title) "." }
                @if let Some(mistake) = mistake {
                    " Remedy: "
                    @for (index, part) in mistake.remedy.split('`').enumerate() {
                        @if index % 2 == 1 { code { (part) } } @else { (typographic(part)) }
                    }
                    "."
                }
            }
        }
    };
    uses.add(picture);
    shown
}

/// A stage with few samples, before and after denoising, for a wipe.
pub fn denoised(stage: &str, samples: &str, caption: &Markup, uses: &mut Uses) -> Result<Markup> {
    let (stage, samples) = (Stage::find(stage)?, samples.parse().context("give the samples per pixel")?);
    let mut panel = |name, tracer, label: &str| {
        let picture = Picture::new(stage, name, (QUICK_WIDTH, samples), tracer);
        uses.add(picture.clone());
        html! { div .panel { (picture.img(label)) p .label { (label) } } }
    };
    let label = format!("{samples} samples per pixel");
    let noisy = panel("noisy", Tracer::Fast, &label);
    let panels = [noisy, panel("denoised", Tracer::Denoised, &(label + ", denoised"))];
    Ok(html! {
        figure .figure .wide id={ "denoised-" (stage.id) } {
            div .panels .of-2 { @for panel in panels { (panel) } }
            (numbered(caption, uses))
        }
    })
}
