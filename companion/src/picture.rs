//! A picture of the page's own: what to render, and how.

use anyhow::{Context, Result};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use maud::{Markup, html};
use std::io::Write as _;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use weekender::comparison::check::{Hypothesis, Mistake, Studio};
use weekender::denoise;
use weekender::film::Checksum;
use weekender::film::checkpoint::SAMPLE_VERSION;
use weekender::job::recipe::{Recipe, file::to_toml};
use weekender::job::render::Renderer;
use weekender::render_cpu::{CpuOptions, CpuRenderer};
use weekender::stages::Stage;
use weekender::system::files::replace_file;

pub const FOLDER: &str = "figures/more";

/// Width of a picture that is denoised, pixels.
pub const NOISY_WIDTH: u32 = 480;

#[derive(Clone, Debug)]
pub struct Picture {
    stage: &'static Stage,
    name: &'static str,
    pub recipe: Recipe,
    tracer: Tracer,
}

#[derive(Clone, Copy, Debug)]
pub enum Tracer {
    /// That of `weekender check`, with or without a mistake.
    Plain(Option<&'static Mistake>),
    Fast,
    Denoised,
}

impl Picture {
    pub fn new(
        stage: &'static Stage,
        name: &'static str,
        (width, samples): (u32, u64),
        tracer: Tracer,
    ) -> Self {
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

    pub fn img(&self, alt: &str) -> Markup {
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
