//! Pictures as they should be if a certain mistake was made, or none.

use super::mistake::{Mistake, bubble};
use super::tracer::Tracer;
use crate::recipe::Recipe;
use crate::render::{RenderError, RenderSettings, Renderer, SamplerKind};
use crate::render_cpu::{CpuError, CpuOptions, CpuRenderer};
use crate::scene::{Material, Scene};
use crate::stages::{DielectricLaws, Diffuse, Rules, Transfer};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use thiserror::Error;

/// A picture that could be mine, in linear radiance, and how its bytes are to be read.
#[derive(Clone, Debug)]
pub struct Hypothesis {
    /// The mistake; `None` for the right picture.
    pub mistake: Option<Mistake>,
    /// What else is to be said about it.
    pub note: Option<String>,
    making: Making,
    shown: Shown,
}

#[derive(Clone, Debug)]
enum Making {
    /// By the program's own tracer, with this recipe.
    Fast(Box<Recipe>),
    /// By the plain tracer, with the mistake.
    Plain,
}

/// How the linear picture became bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shown {
    is_flipped: bool,
    is_mirrored: bool,
    /// The channel that is written as red, green and blue.
    channels: [usize; 3],
    curve: Curve,
    /// The number that displayed values are multiplied by.
    levels: f64,
}

/// The curve from linear values to bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Curve {
    /// That of the stage.
    Transfer(Transfer),
    /// The square root of the square root.
    Twice,
}

const USUAL: [usize; 3] = [0, 1, 2];

/// Numbers of rays that paths are cut off at.
const LIMITS: [u32; 9] = [1, 2, 3, 4, 5, 6, 8, 10, 15];

impl Hypothesis {
    /// The right picture of `recipe`.
    pub fn right(recipe: &Recipe) -> Hypothesis {
        let curve = Curve::Transfer(recipe.rules.transfer);
        Hypothesis {
            mistake: None,
            note: None,
            making: Making::Fast(Box::new(recipe.clone())),
            shown: Shown { is_flipped: false, is_mirrored: false, channels: USUAL, curve, levels: 256.0 },
        }
    }

    /// The same picture, of which something else explains the bytes.
    pub fn blamed_on(&self, mistake: Mistake) -> Hypothesis {
        Hypothesis { mistake: Some(mistake), ..self.clone() }
    }

    /// The pictures of all mistakes that can show in `recipe` and that a picture of linear values can tell.
    pub fn mistakes(recipe: &Recipe) -> Vec<Hypothesis> {
        let applying = Mistake::ALL.into_iter().filter(|mistake| mistake.applies_to(recipe));
        applying.flat_map(|mistake| Hypothesis::of(mistake, recipe)).collect()
    }

    /// The pictures of a mistake; several if it has variants.
    pub fn of(mistake: Mistake, recipe: &Recipe) -> Vec<Hypothesis> {
        let right = Hypothesis { mistake: Some(mistake), ..Hypothesis::right(recipe) };
        let shown = |change: &dyn Fn(&mut Shown)| {
            let mut changed = right.clone();
            change(&mut changed.shown);
            vec![changed]
        };
        let rules = |change: &dyn Fn(&mut Rules)| {
            let mut changed = recipe.clone();
            change(&mut changed.rules);
            vec![Hypothesis { making: Making::Fast(Box::new(changed)), ..right.clone() }]
        };
        let scene = |change: &dyn Fn(&mut Scene)| {
            let mut changed = (*recipe.scene).clone();
            change(&mut changed);
            let changed = Recipe { scene: Arc::new(changed), ..recipe.clone() };
            vec![Hypothesis { making: Making::Fast(Box::new(changed)), ..right.clone() }]
        };
        match mistake {
            Mistake::FlippedRows => shown(&|shown| shown.is_flipped = true),
            Mistake::MirroredColumns => shown(&|shown| shown.is_mirrored = true),
            Mistake::SwappedChannels => {
                let orders = [[2, 1, 0], [1, 0, 2], [0, 2, 1], [1, 2, 0], [2, 0, 1]];
                let named = |order: [usize; 3]| {
                    let names = order.map(|channel| ["red", "green", "blue"][channel]).join(", ");
                    let note = format!("the channels seem to be {names}");
                    let shown = Shown { channels: order, ..right.shown };
                    Hypothesis { note: Some(note), shown, ..right.clone() }
                };
                orders.map(named).to_vec()
            }
            Mistake::NoGamma => shown(&|shown| shown.curve = Curve::Transfer(Transfer::Linear)),
            Mistake::GammaEarly => shown(&|shown| shown.curve = Curve::Transfer(Transfer::Gamma2)),
            Mistake::GammaTwice => shown(&|shown| shown.curve = Curve::Twice),
            Mistake::TimesInteger => shown(&|shown| shown.levels = 255.0),
            Mistake::Truncated => Vec::new(),
            Mistake::NoAntialiasing => rules(&|rules| rules.antialiasing = false),
            Mistake::Hemisphere => rules(&|rules| rules.diffuse = Diffuse::Hemisphere),
            Mistake::LambertianEarly => rules(&|rules| rules.diffuse = Diffuse::Lambertian),
            Mistake::AlwaysRefract => rules(&|rules| rules.dielectric = DielectricLaws::RefractOnly),
            Mistake::SchlickMissing => rules(&|rules| rules.dielectric = DielectricLaws::TotalReflection),
            Mistake::SkyReversed => scene(&|scene| std::mem::swap(&mut scene.sky.bottom, &mut scene.sky.top)),
            Mistake::FuzzMissing => scene(&|scene| {
                for named in &mut scene.materials {
                    if let Material::Metal { fuzz, .. } = &mut named.material {
                        *fuzz = 0.0;
                    }
                }
            }),
            Mistake::HollowMissing => scene(&|scene| {
                if let Some(index) = bubble(recipe) {
                    scene.spheres.remove(index);
                }
            }),
            Mistake::HollowIndex => scene(&|scene| {
                let material = bubble(recipe).map(|index| scene.spheres[index].material);
                if let Some(named) = material.and_then(|material| scene.materials.get_mut(material))
                    && let Material::Dielectric { refraction_index } = &mut named.material
                {
                    *refraction_index = 1.0 / *refraction_index;
                }
            }),
            Mistake::LensCentre => {
                let mut changed = recipe.clone();
                changed.camera.defocus_angle_degrees = 0.0;
                vec![Hypothesis { making: Making::Fast(Box::new(changed)), ..right }]
            }
            Mistake::BounceLimit => {
                let of = |limit: u32| {
                    let mut changed = recipe.clone();
                    changed.settings.max_depth = limit;
                    let note = format!("it looks as with max_depth = {limit}");
                    Hypothesis { note: Some(note), making: Making::Fast(Box::new(changed)), ..right.clone() }
                };
                LIMITS.into_iter().filter(|limit| *limit < recipe.settings.max_depth).map(of).collect()
            }
            _ => vec![Hypothesis { making: Making::Plain, ..right }],
        }
    }
}

/// A picture of a hypothesis.
#[derive(Clone, Debug)]
pub struct Expected {
    /// Linear RGB in the layout of my picture, row by row from the top.
    pub pixels: Vec<[f64; 3]>,
}

/// Renders hypotheses of one recipe.
pub struct Studio {
    recipe: Recipe,
    fast: CpuRenderer,
    /// The last picture of the fast tracer, which several hypotheses share.
    last: Option<(Recipe, u64, Vec<[f64; 3]>)>,
}

/// Why a picture cannot be rendered.
#[derive(Debug, Error)]
pub enum StudioError {
    /// No thread can be started.
    #[error(transparent)]
    Threads(#[from] CpuError),
    /// A picture cannot be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// Samples per pixel of a picture up to the size of [`PIXELS`]; larger ones get as many paths.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Samples of the program's own tracer.
    pub fast: u64,
    /// Samples of the plain tracer.
    pub plain: u64,
}

/// The book's 400 x 225 pixels.
const PIXELS: u64 = 90_000;

impl Studio {
    /// For pictures of `recipe`.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn new(recipe: &Recipe) -> Result<Studio, CpuError> {
        let settings =
            RenderSettings { sampler: SamplerKind::Independent, estimate_error: false, ..recipe.settings };
        let recipe = Recipe { settings, ..recipe.clone() };
        Ok(Studio { recipe, fast: CpuRenderer::new(CpuOptions::default())?, last: None })
    }

    /// The recipe of the right picture.
    pub fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// Renders a hypothesis.
    ///
    /// # Errors
    /// If the renderer fails.
    pub fn render(&mut self, hypothesis: &Hypothesis, effort: Effort) -> Result<Expected, RenderError> {
        let RenderSettings { width, height, .. } = self.recipe.settings;
        let pixels = u64::from(width) * u64::from(height);
        let is_exact = !self.recipe.rules.antialiasing && self.recipe.samples_per_pixel == 1;
        let samples = |samples: u64| match is_exact {
            true => 1,
            false => (samples * PIXELS / pixels).clamp(1, samples),
        };
        let linear = match &hypothesis.making {
            Making::Plain => {
                Tracer::new(&self.recipe, hypothesis.mistake).means(samples(effort.plain) as u32)
            }
            Making::Fast(recipe) => {
                let samples = samples(effort.fast);
                let kept = self.last.as_ref().filter(|(of, count, _)| of == &**recipe && *count == samples);
                match kept {
                    Some((.., pixels)) => pixels.clone(),
                    None => {
                        let pixels = self.fast_means(recipe, samples)?;
                        self.last = Some(((**recipe).clone(), samples, pixels.clone()));
                        pixels
                    }
                }
            }
        };
        Ok(Expected { pixels: hypothesis.shown.laid_out(&linear, width as usize) })
    }

    fn fast_means(&mut self, recipe: &Recipe, samples: u64) -> Result<Vec<[f64; 3]>, RenderError> {
        let job = recipe
            .job()
            .map_err(|error| RenderError::Backend { backend: "cpu", reason: error.to_string() })?;
        let mut film = job.new_film();
        self.fast.accumulate(&job, 0..samples, &mut film, &AtomicBool::new(false))?;
        Ok(film.means().into_iter().map(|pixel| pixel.map(f64::from)).collect())
    }
}

impl Shown {
    fn laid_out(&self, linear: &[[f64; 3]], width: usize) -> Vec<[f64; 3]> {
        let height = linear.len() / width;
        (0..linear.len())
            .map(|index| {
                let (x, y) = (index % width, index / width);
                let x = if self.is_mirrored { width - 1 - x } else { x };
                let y = if self.is_flipped { height - 1 - y } else { y };
                let pixel = linear[y * width + x];
                self.channels.map(|channel| pixel[channel])
            })
            .collect()
    }
}

impl Hypothesis {
    /// The linear value of a byte in a row, and half of its step.
    pub fn linear(&self, byte: u8, row: usize, height: usize) -> [f64; 2] {
        let curve = |value: f64| match self.shown.curve {
            Curve::Twice => value.powi(4),
            Curve::Transfer(transfer) if transfer.is_gamma(row, height) => value * value,
            Curve::Transfer(_) => value,
        };
        let [low, middle, high] =
            [0.0, 0.5, 1.0].map(|part| curve((f64::from(byte) + part) / self.shown.levels));
        [middle, (high - low) / 2.0]
    }

    /// The linear value that is read if the displayed value was multiplied by 255 instead of 256.
    pub fn times_255(&self, linear: f64, row: usize, height: usize) -> f64 {
        let factor: f64 = 255.0 / 256.0;
        match self.shown.curve {
            Curve::Twice => linear * factor.powi(4),
            Curve::Transfer(transfer) if transfer.is_gamma(row, height) => linear * factor.powi(2),
            Curve::Transfer(_) => linear * factor,
        }
    }

    /// The byte that a linear value becomes.
    pub fn byte_of(&self, linear: f64, row: usize, height: usize) -> u8 {
        let value = match self.shown.curve {
            Curve::Twice => linear.max(0.0).sqrt().sqrt(),
            Curve::Transfer(transfer) if transfer.is_gamma(row, height) => linear.max(0.0).sqrt(),
            Curve::Transfer(_) => linear,
        };
        (self.shown.levels * value.clamp(0.0, 0.999)) as u8
    }
}

#[cfg(test)]
mod tests;
