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
    subject: Subject,
}

#[derive(Clone, Copy, Debug)]
enum Subject {
    Right,
    Mistake(&'static Mistake),
    /// With at most this many rays per path.
    Limit(u32),
    Noisy(u64),
    Denoised(u64),
}

/// Identifies the picture that this program renders of a recipe.
fn fingerprint(recipe: &Recipe) -> String {
    let mut checksum = Checksum::default();
    checksum.text(to_toml(recipe).as_bytes());
    checksum.word(SAMPLE_VERSION.into());
    checksum.finish()
}

impl Picture {
    fn recipe(&self) -> Recipe {
        let (width, samples) = match self.subject {
            Subject::Right | Subject::Mistake(_) | Subject::Limit(_) => SMALL,
            Subject::Noisy(samples) | Subject::Denoised(samples) => (NOISY_WIDTH, samples),
        };
        let mut recipe = self.stage.recipe();
        let settings = &mut recipe.settings;
        (settings.width, settings.height) = (width, width * settings.height / settings.width);
        if let Subject::Limit(limit) = self.subject {
            settings.max_depth = limit;
        }
        recipe.samples_per_pixel = samples;
        recipe
    }

    /// The name holds the recipe's fingerprint, so a file that exists is up to date.
    fn file(&self) -> String {
        let name = match self.subject {
            Subject::Right => "right",
            Subject::Mistake(mistake) => mistake.id,
            Subject::Limit(_) => "limit",
            Subject::Noisy(_) => "noisy",
            Subject::Denoised(_) => "denoised",
        };
        format!("{FOLDER}/{}-{name}-{:.8}.png", self.stage.id, fingerprint(&self.recipe()))
    }

    /// A smooth and small picture of a stage.
    pub fn small(stage: &'static Stage) -> Self {
        Picture { stage, subject: Subject::Denoised(64) }
    }

    /// Its file and width, as candidates for a place have it.
    pub fn candidate(&self) -> String {
        format!("{} {}w", self.file(), self.recipe().settings.width)
    }

    /// Renders the picture unless it exists.
    pub fn render(&self, out: &Path) -> Result<()> {
        let path = out.join(self.file());
        if path.exists() {
            return Ok(());
        }
        let recipe = self.recipe();
        let [width, height] = [recipe.settings.width, recipe.settings.height];
        let bytes = match self.subject {
            Subject::Right => mistaken(recipe, None)?,
            Subject::Mistake(mistake) => mistaken(recipe, Some(mistake))?,
            Subject::Limit(_) | Subject::Noisy(_) => sampled(&recipe, false)?,
            Subject::Denoised(_) => sampled(&recipe, true)?,
        };
        let mut png = Vec::new();
        let encoder = PngEncoder::new_with_quality(&mut png, CompressionType::Best, FilterType::Adaptive);
        encoder.write_image(&bytes, width, height, ExtendedColorType::Rgb8)?;
        Ok(replace_file(&path, |writer| writer.write_all(&png))?)
    }

    fn img(&self, alt: &str) -> Markup {
        let settings = self.recipe().settings;
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
    let wrong: Result<Vec<&Mistake>> = ids.split_whitespace().map(find).collect();
    Ok(html! {
        ul .mistakes {
            (entry(Picture { stage, subject: Subject::Right }, "as it should be", "", uses))
            @for mistake in wrong? {
                (entry(Picture { stage, subject: Subject::Mistake(mistake) }, mistake.title, mistake.remedy, uses))
            }
        }
    })
}

/// A row of pictures of a stage with these limits on the rays of a path.
pub fn limits(stage: &str, limits: &str, uses: &mut Uses) -> Result<Markup> {
    let stage = Stage::find(stage)?;
    let limits: Result<Vec<u32>, _> = limits.split_whitespace().map(str::parse).collect();
    let limits = limits.context("the limits are whole numbers")?;
    let mut shown = |limit| {
        let picture = Picture { stage, subject: Subject::Limit(limit) };
        entry(picture, &format!("at most {} per path", counted(limit.into(), "ray")), "", uses)
    };
    Ok(html! { ul .mistakes { @for limit in limits { (shown(limit)) } } })
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
    let mut panel = |subject, label: &str| {
        let picture = Picture { stage, subject };
        uses.pictures.push(picture.clone());
        html! { div .panel { (picture.img(label)) p .label { (label) } } }
    };
    let label = format!("{samples} samples per pixel");
    let panels =
        [panel(Subject::Noisy(samples), &label), panel(Subject::Denoised(samples), &(label + ", denoised"))];
    Ok(html! { div .panels .of-2 { @for panel in panels { (panel) } } })
}
