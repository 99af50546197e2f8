//! A picture of the page's own: what to render, and how.

use anyhow::{Context, Result};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use maud::{Markup, html};
use std::collections::BTreeSet;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use weekender::comparison::check::{Hypothesis, Mistake, Studio};
use weekender::denoise;
use weekender::film::Checksum;
use weekender::film::checkpoint::SAMPLE_VERSION;
use weekender::job::recipe::{Recipe, file::to_toml};
use weekender::job::render::Renderer;
use weekender::render_cpu::{CpuOptions, CpuRenderer};
use weekender::stages::{Setup, Stage};
use weekender::system::files::replace_file;

pub const FOLDER: &str = "figures/more";

/// Width of a picture that is denoised, pixels.
pub const NOISY_WIDTH: u32 = 480;

/// Width and samples per pixel of a still for a link that sets a picture.
const STILL_WIDTH: u32 = 320;
const STILL_SAMPLES: u64 = 64;

#[derive(Clone, Debug)]
pub struct Picture {
    stage: &'static Stage,
    name: &'static str,
    pub recipe: Recipe,
    tracer: Tracer,
    /// The part to keep: left, top, width and height.
    crop: Option<[u32; 4]>,
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
        Picture { stage, name, recipe, tracer, crop: None }
    }

    /// Only a part, in pixels of the stage's own size.
    pub fn cropped(mut self, crop: Option<[u32; 4]>) -> Self {
        if crop.is_some() {
            let Setup { width, height, .. } = self.stage.setup;
            (self.recipe.settings.width, self.recipe.settings.height, self.crop) = (width, height, crop);
        }
        self
    }

    /// The name holds fingerprints of the recipe and of the code that changes such pictures, so a file that exists is up to
    /// date.
    pub fn file(&self) -> String {
        let mut checksum = Checksum::default();
        checksum.text(to_toml(&self.recipe).as_bytes());
        checksum.word(SAMPLE_VERSION.into());
        checksum.text(format!("{:?}", self.crop).as_bytes());
        checksum.text(
            match self.tracer {
                Tracer::Plain(_) => concat!(
                    include_str!("../../src/comparison/check/mistakes.rs"),
                    include_str!("../../src/comparison/check/tracer.rs")
                ),
                Tracer::Denoised => concat!(
                    include_str!("../../src/denoise/filter.rs"),
                    include_str!("../../src/denoise/mod.rs")
                ),
                Tracer::Fast => "",
            }
            .as_bytes(),
        );
        format!("{FOLDER}/{}-{}-{:.8}.png", self.stage.id, self.name, checksum.finish())
    }

    /// A smooth and small picture of a stage.
    pub fn small(stage: &'static Stage) -> Self {
        Picture::new(stage, "denoised", (NOISY_WIDTH, 64), Tracer::Denoised)
    }

    /// A small picture of a stage whose recipe will be changed.
    pub fn still(stage: &'static Stage) -> Self {
        Picture::new(
            stage,
            "try",
            (STILL_WIDTH, STILL_SAMPLES.min(stage.setup.samples_per_pixel)),
            if stage.setup.samples_per_pixel > 1 { Tracer::Denoised } else { Tracer::Fast },
        )
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
            Tracer::Plain(mistake) => mistaken(self.stage, self.recipe.clone(), mistake)?,
            Tracer::Fast => sampled(&self.recipe, false)?,
            // A few samples are to be seen as they are.
            Tracer::Denoised => sampled(&self.recipe, self.recipe.samples_per_pixel >= 16)?,
        };
        let rows = bytes.chunks(3 * width as usize);
        let [left, top, width, height] = self.crop.unwrap_or([0, 0, width, height]);
        let row = |row: &[u8]| {
            row.iter().skip(3 * left as usize).take(3 * width as usize).copied().collect::<Vec<u8>>()
        };
        let bytes: Vec<u8> = rows.skip(top as usize).take(height as usize).flat_map(row).collect();
        let mut png = Vec::new();
        let encoder = PngEncoder::new_with_quality(&mut png, CompressionType::Best, FilterType::Adaptive);
        encoder.write_image(&bytes, width, height, ExtendedColorType::Rgb8)?;
        Ok(replace_file(&path, |writer| writer.write_all(&png))?)
    }

    pub fn img(&self, alt: &str) -> Markup {
        let settings = self.recipe.settings;
        let [_, _, width, height] = self.crop.unwrap_or([0, 0, settings.width, settings.height]);
        html! {
            img .pixels[self.crop.is_some()] src=(self.file()) width=(width) height=(height) loading="lazy"
                alt={ (self.stage.title) ": " (alt) };
        }
    }
}

fn mistaken(stage: &'static Stage, recipe: Recipe, mistake: Option<&'static Mistake>) -> Result<Vec<u8>> {
    let (size, samples) = ([recipe.settings.width, recipe.settings.height], recipe.samples_per_pixel);
    let stop = AtomicBool::new(false);
    let right = Hypothesis::right(stage, recipe, size);
    let picture = match mistake {
        Some(mistake) => {
            mistake.pictures(&right).into_iter().next().context("a mistake without a picture")?
        }
        None => right,
    };
    let linear = Studio::new(&stop)?.picture(&picture, samples)?;
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

/// Removes pictures that the page does not use.
pub fn remove_others(out: &Path, pictures: &[Picture]) -> Result<()> {
    let used: BTreeSet<PathBuf> = pictures.iter().map(|picture| out.join(picture.file())).collect();
    for entry in fs::read_dir(out.join(FOLDER))? {
        let path = entry?.path();
        if path.extension().is_some_and(|ending| ending == "png") && !used.contains(&path) {
            fs::remove_file(&path).with_context(|| format!("cannot remove {}", path.display()))?;
        }
    }
    Ok(())
}
