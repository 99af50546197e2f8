//! The page's own pictures beside the gallery's stills: what common mistakes look like, as `weekender check` renders
//! them, and a picture before and after denoising.

use super::directive::typographic;
use super::site::Uses;
use crate::denoise;
use crate::film::Checksum;
use crate::film::checkpoint::SAMPLE_VERSION;
use crate::job::recipe::{Recipe, file::to_toml};
use crate::job::render::Renderer;
use crate::pictures::check::{Hypothesis, MISTAKES, Mistake, Studio};
use crate::progressive::describe::counted;
use crate::render_cpu::{CpuOptions, CpuRenderer};
use crate::stages::Stage;
use crate::system::files::replace_file;
use anyhow::{Context, Result};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use maud::{Markup, html};
use std::io::Write as _;
use std::path::Path;
use std::sync::atomic::AtomicBool;

pub const FOLDER: &str = "figures/more";

/// Width and samples per pixel of a picture in a row. The plain tracer takes fewer samples.
const SMALL: (u32, u64) = (180, 128);

/// Width of a picture that is denoised, pixels.
const NOISY_WIDTH: u32 = 480;

#[derive(Clone, Debug)]
pub struct Picture {
    stage: &'static Stage,
    name: &'static str,
    recipe: Recipe,
    tracer: Tracer,
}

#[derive(Clone, Copy, Debug)]
enum Tracer {
    /// That of `weekender check`, with or without a mistake.
    Plain(Option<&'static Mistake>),
    Fast,
    Denoised,
}

impl Picture {
    fn new(stage: &'static Stage, name: &'static str, (width, samples): (u32, u64), tracer: Tracer) -> Self {
        let mut recipe = stage.recipe();
        let settings = &mut recipe.settings;
        (settings.width, settings.height) = (width, width * settings.height / settings.width);
        recipe.samples_per_pixel = samples;
        Picture { stage, name, recipe, tracer }
    }

    /// The name holds the recipe's fingerprint, so a file that exists is up to date.
    fn file(&self) -> String {
        let mut checksum = Checksum::default();
        checksum.text(to_toml(&self.recipe).as_bytes());
        checksum.word(SAMPLE_VERSION.into());
        format!("{FOLDER}/{}-{}-{:.8}.png", self.stage.id, self.name, checksum.finish())
    }

    /// A smooth and small picture of a stage.
    pub fn small(stage: &'static Stage) -> Self {
        Picture::new(stage, "denoised", (NOISY_WIDTH, 64), Tracer::Denoised)
    }

    /// Its file and width, as candidates for a place have it.
    pub fn candidate(&self) -> String {
        format!("{} {}w", self.file(), self.recipe.settings.width)
    }

    /// Renders the picture unless it exists.
    pub fn render(&self, out: &Path) -> Result<()> {
        let path = out.join(self.file());
        if path.exists() {
            return Ok(());
        }
        let [width, height] = [self.recipe.settings.width, self.recipe.settings.height];
        let bytes = match self.tracer {
            Tracer::Plain(mistake) => mistaken(self.recipe.clone(), mistake)?,
            Tracer::Fast => sampled(&self.recipe, false)?,
            Tracer::Denoised => sampled(&self.recipe, true)?,
        };
        let mut png = Vec::new();
        let encoder = PngEncoder::new_with_quality(&mut png, CompressionType::Best, FilterType::Adaptive);
        encoder.write_image(&bytes, width, height, ExtendedColorType::Rgb8)?;
        Ok(replace_file(&path, |writer| writer.write_all(&png))?)
    }

    fn img(&self, alt: &str) -> Markup {
        let settings = self.recipe.settings;
        html! {
            img src=(self.file()) width=(settings.width) height=(settings.height) loading="lazy"
                alt={ (self.stage.title) ": " (alt) };
        }
    }
}

fn mistaken(recipe: Recipe, mistake: Option<&'static Mistake>) -> Result<Vec<u8>> {
    let (size, samples) = ([recipe.settings.width, recipe.settings.height], recipe.samples_per_pixel);
    let mut studio = Studio::new(recipe, size)?;
    let recipe = studio.recipe().clone();
    let picture = match mistake {
        Some(mistake) => {
            mistake.pictures(&recipe).into_iter().next().context("a mistake without a picture")?
        }
        None => Hypothesis::right(&recipe),
    };
    let linear = studio.render(&picture, samples)?;
    let mut bytes = picture.written.bytes_of(&linear, size).concat();
    if picture.written.wraps {
        let values = bytes.iter_mut().zip(linear.as_flattened());
        values.filter(|(_, linear)| **linear >= 1.0).for_each(|(byte, _)| *byte = 0);
    }
    Ok(bytes)
}

fn sampled(recipe: &Recipe, is_denoised: bool) -> Result<Vec<u8>> {
    let job = recipe.job()?;
    let mut film = job.new_film();
    let mut renderer = CpuRenderer::new(CpuOptions::default())?;
    renderer.accumulate(&job, 0..recipe.samples_per_pixel, &mut film, &AtomicBool::new(false))?;
    let film = if is_denoised { denoise::of_film(&film)?.film } else { film };
    Ok(film.to_rgb8(recipe.rules.transfer))
}

/// A row of pictures: the stage as it should be, and with each of these mistakes, whose ids are words.
pub fn mistakes(stage: &str, ids: &str, uses: &mut Uses) -> Result<Markup> {
    let stage = Stage::find(stage)?;
    let recipe = stage.recipe();
    let find = |id| {
        let is_it = |mistake: &&Mistake| mistake.id == id && (mistake.applies)(&recipe);
        MISTAKES.iter().find(is_it).with_context(|| format!("{} can have no mistake {id:?}", stage.id))
    };
    let plain = |name, mistake| Picture::new(stage, name, SMALL, Tracer::Plain(mistake));
    let wrong: Result<Vec<&'static Mistake>> = ids.split_whitespace().map(find).collect();
    Ok(html! {
        ul .mistakes {
            (entry(plain("right", None), "as it should be", "", uses))
            @for mistake in wrong? {
                (entry(plain(mistake.id, Some(mistake)), mistake.title, mistake.remedy, uses))
            }
        }
    })
}

/// A row of pictures of a stage with these limits on the rays of a path or, if `is_of_samples`, with so many samples.
pub fn variants(stage: &str, numbers: &str, is_of_samples: bool, uses: &mut Uses) -> Result<Markup> {
    let stage = Stage::find(stage)?;
    let numbers: Result<Vec<u32>, _> = numbers.split_whitespace().map(str::parse).collect();
    let mut shown = |number: u32| {
        let mut picture =
            Picture::new(stage, if is_of_samples { "samples" } else { "limit" }, SMALL, Tracer::Fast);
        let title = if is_of_samples {
            picture.recipe.samples_per_pixel = number.into();
            counted(number.into(), "sample") + " per pixel"
        } else {
            picture.recipe.settings.max_depth = number;
            format!("at most {} per path", counted(number.into(), "ray"))
        };
        entry(picture, &title, "", uses)
    };
    Ok(html! { ul .mistakes { @for number in numbers.context("give whole numbers")? { (shown(number)) } } })
}

fn entry(picture: Picture, title: &str, remedy: &str, uses: &mut Uses) -> Markup {
    let title = typographic(title);
    let title = title[..1].to_uppercase() + &title[1..];
    let shown = html! {
        li {
            (picture.img(&title))
            p { strong { (title) "." } @if !remedy.is_empty() { " Remedy: " (typographic(remedy)) "." } }
        }
    };
    uses.pictures.push(picture);
    shown
}

/// A stage with few samples, before and after denoising, for a wipe.
pub fn denoised(stage: &str, samples: &str, uses: &mut Uses) -> Result<Markup> {
    let (stage, samples) = (Stage::find(stage)?, samples.parse().context("give the samples per pixel")?);
    let mut panel = |name, tracer, label: &str| {
        let picture = Picture::new(stage, name, (NOISY_WIDTH, samples), tracer);
        uses.pictures.push(picture.clone());
        html! { div .panel { (picture.img(label)) p .label { (label) } } }
    };
    let label = format!("{samples} samples per pixel");
    let noisy = panel("noisy", Tracer::Fast, &label);
    let panels = [noisy, panel("denoised", Tracer::Denoised, &(label + ", denoised"))];
    Ok(html! { div .panels .of-2 { @for panel in panels { (panel) } } })
}
