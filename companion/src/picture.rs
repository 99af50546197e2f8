//! A picture of the page: a stage's still, or another that the page makes of a stage.

use anyhow::{Context, Result};
use maud::{Markup, html};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use weekender::comparison::check::Mistake;
use weekender::film::checkpoint::SAMPLE_VERSION;
use weekender::film::{Checksum, SOFTWARE, key};
use weekender::job::recipe::{Recipe, file::to_toml};
use weekender::job::saved::is_whole_frame;
use weekender::stages::{Setup, Stage};

/// Pictures other than the stages' stills.
pub const FOLDER: &str = "figures/more";

/// Width of a picture for a link that sets a stage, pixels.
const SET_WIDTH: u32 = 320;

/// Maximum width and samples per pixel of a quick still or a picture that is denoised.
pub const QUICK_WIDTH: u32 = 480;
const QUICK_SAMPLES: u64 = 64;

/// Width of a full still, pixels: more than most figures are wide, and the page is below 6.5 MB.
const FULL_WIDTH: u32 = 720;

/// Samples per pixel of a full still. The estimated error is then at most 0.003, about half an 8-bit step.
const FULL_SAMPLES: u64 = 1024;

/// Code that changes pictures without changing a sample.
const SOURCES: [&str; 4] = [
    include_str!("../../src/comparison/check/mistakes.rs"),
    include_str!("../../src/comparison/check/tracer.rs"),
    include_str!("../../src/denoise/filter.rs"),
    include_str!("../../src/denoise/mod.rs"),
];

#[derive(Clone, Debug)]
pub struct Picture {
    pub stage: &'static Stage,
    /// `None` for the stage's still.
    name: Option<&'static str>,
    pub recipe: Recipe,
    pub tracer: Tracer,
    /// `None` for all of it.
    crop: Option<[u32; 4]>,
}

#[derive(Clone, Copy, Debug)]
pub enum Tracer {
    /// That of `weekender check`, with or without a mistake.
    Plain(Option<&'static Mistake>),
    Fast,
    Denoised,
}

/// A second picture below a panel's, or the part that pictures in a row show.
#[derive(Clone, Copy)]
pub enum Part {
    None,
    /// A part, enlarged: left, top, width and height in the stage's pixels.
    Crop([u32; 4]),
    /// The stage seen from the same eye: a point to look at, and the field of view in degrees.
    Aim([f64; 4]),
}

impl Picture {
    /// A stage with its own settings in the size and with the samples of a still.
    pub fn still(stage: &'static Stage, is_quick: bool) -> Self {
        let mut recipe = stage.recipe();
        if !stage.setup.is_about_pixels {
            let (settings, samples) = (&mut recipe.settings, &mut recipe.samples_per_pixel);
            let width = if is_quick { settings.width.min(QUICK_WIDTH) } else { FULL_WIDTH };
            settings.height = (settings.height * width).div_ceil(settings.width);
            settings.width = width;
            // A stage with one sample sends it through the pixel's centre; more would be the same.
            if *samples > 1 {
                *samples = if is_quick { QUICK_SAMPLES.min(*samples) } else { FULL_SAMPLES };
            }
        }
        Picture { stage, name: None, recipe, tracer: Tracer::Fast, crop: None }
    }

    pub fn new(stage: &'static Stage, name: &'static str, size: (u32, u64), tracer: Tracer) -> Self {
        let (width, samples) = size;
        let mut recipe = stage.recipe();
        let settings = &mut recipe.settings;
        (settings.width, settings.height) = (width, width * settings.height / settings.width);
        recipe.samples_per_pixel = samples;
        Picture { stage, name: Some(name), recipe, tracer, crop: None }
    }

    /// Only a part, in pixels of the stage's own size.
    pub fn cropped(mut self, part: Part) -> Self {
        if let Part::Crop(crop) = part {
            let Setup { width, height, .. } = self.stage.setup;
            (self.recipe.settings.width, self.recipe.settings.height, self.crop) =
                (width, height, Some(crop));
        }
        self
    }

    /// The path in the page's folder. Except for a still, which keeps its name, it holds fingerprints of the recipe and of the
    /// code that changes such pictures, so a file that exists is up to date.
    pub fn file(&self) -> String {
        let id = self.stage.id;
        let Some(name) = self.name else { return format!("figures/{id}.png") };
        let mut checksum = Checksum::default();
        checksum.text(to_toml(&self.recipe).as_bytes());
        checksum.word(SAMPLE_VERSION.into());
        checksum.text(format!("{:?} {:?}", self.crop, matches!(self.tracer, Tracer::Denoised)).as_bytes());
        SOURCES.iter().for_each(|source| checksum.text(source.as_bytes()));
        format!("{FOLDER}/{id}-{name}-{:.8}.png", checksum.finish())
    }

    /// Whether the file is up to date. A full still satisfies a quick order.
    pub fn is_done(&self, out: &Path) -> bool {
        let path = out.join(self.file());
        let is_made_of = |recipe: &Recipe| {
            let samples = recipe.samples_per_pixel.to_string();
            is_whole_frame(&path, recipe, SOFTWARE, (key::SAMPLES, &samples))
        };
        match self.name {
            Some(_) => path.exists(),
            None => is_made_of(&self.recipe) || is_made_of(&Picture::still(self.stage, false).recipe),
        }
    }

    pub fn is_still(&self) -> bool {
        self.name.is_none()
    }

    pub fn pixels(&self) -> u64 {
        u64::from(self.recipe.settings.width) * u64::from(self.recipe.settings.height)
    }

    /// The paths of all its samples.
    pub fn paths(&self) -> u64 {
        self.recipe.samples_per_pixel * self.pixels()
    }

    /// The part to keep: left, top, width and height.
    pub fn part(&self) -> [u32; 4] {
        self.crop.unwrap_or([0, 0, self.recipe.settings.width, self.recipe.settings.height])
    }

    /// A smooth and small picture of a stage.
    pub fn small(stage: &'static Stage) -> Self {
        Picture::new(stage, "denoised", (QUICK_WIDTH, QUICK_SAMPLES), Tracer::Denoised)
    }

    /// A small picture of a stage whose recipe will be changed.
    pub fn set(stage: &'static Stage) -> Self {
        let samples = QUICK_SAMPLES.min(stage.setup.samples_per_pixel);
        Picture::new(stage, "try", (SET_WIDTH, samples), Tracer::Denoised)
    }

    pub fn img(&self, alt: &str) -> Markup {
        let [_, _, width, height] = self.part();
        html! {
            img .pixels[self.crop.is_some()] src=(self.file()) width=(width) height=(height) loading="lazy"
                alt={ (self.stage.title) ": " (alt) };
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stills_keep_aspect_ratio() {
        for stage in Stage::ALL {
            let own = stage.recipe();
            for is_quick in [true, false] {
                let recipe = Picture::still(stage, is_quick).recipe;
                recipe.job().expect(stage.id);
                let [shape, own_shape] = [&recipe.settings, &own.settings]
                    .map(|settings| f64::from(settings.width) / f64::from(settings.height));
                assert!((shape / own_shape - 1.0).abs() < 0.01, "{}: {shape}", stage.id);
                assert_eq!(recipe.samples_per_pixel == 1, own.samples_per_pixel == 1, "{}", stage.id);
                if stage.setup.is_about_pixels {
                    assert_eq!(recipe, own);
                }
            }
        }
        let sizes = |id: &str| {
            [true, false].map(|is_quick| {
                let recipe = Picture::still(Stage::find(id).unwrap(), is_quick).recipe;
                (recipe.settings.width, recipe.settings.height, recipe.samples_per_pixel)
            })
        };
        assert_eq!(sizes("book"), [(480, 270, 64), (720, 405, 1024)]);
        assert_eq!(sizes("sky"), [(480, 270, 1), (720, 405, 1)]);
    }
}
