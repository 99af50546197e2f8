//! Hypotheses: the right picture, the picture each mistake would give, and how close the reader's comes to them.

use super::Mine;
use super::tracer::{Steps, Tracer};
use crate::job::output::Encoding;
use crate::job::recipe::Recipe;
use crate::job::render::{RenderSettings, Renderer, SamplerKind};
use crate::numbers::statistics::blocks::{BlockTest, Differences, Noise};
use crate::render_cpu::{CpuOptions, CpuRenderer};
use anyhow::Result;
use std::ops::Range;
use std::sync::atomic::AtomicBool;

/// Deviations by which a right picture's sum of squares may exceed noise. Noise alone stays below 4; the rest allows
/// for correlated random numbers and noise that is far from normal.
const EXCESS_LIMIT: f64 = 10.0;

/// Factor by which a block of a right picture may exceed the limit for normal noise.
const LARGEST_FACTOR: f64 = 1.6;

/// A common mistake in programs that follow the book.
#[derive(Debug)]
pub struct Mistake {
    pub id: &'static str,
    /// The section of the book to reread.
    pub section: &'static str,
    pub title: &'static str,
    pub remedy: &'static str,
    /// Whether the mistake can show in a picture of this recipe.
    pub applies: fn(&Recipe) -> bool,
    pub shows: Shows,
    /// Each makes one variant of the mistake out of the right picture.
    pub changes: &'static [fn(&mut Hypothesis)],
}

/// Where a mistake shows.
#[derive(Debug)]
pub enum Shows {
    /// In the means of blocks.
    InBlocks,
    /// At edges, pixel by pixel; block means hardly show it.
    AtEdges,
    /// In the bytes, even where blocks differ only by noise.
    InBytes(fn(&Mine, &Compared) -> bool),
    /// If nothing else explains the picture, in the difference from the right one, with a picture of one sample a pixel.
    /// Other random numbers give another picture, so it is not compared with one.
    InNoise(fn(&Mine, &Compared, &[[f64; 3]]) -> bool),
}

impl Mistake {
    /// One hypothesis per variant, without those that change nothing in this recipe.
    pub fn pictures(&'static self, recipe: &Recipe) -> Vec<Hypothesis> {
        let right = Hypothesis::right(recipe);
        let picture = |change: &fn(&mut Hypothesis)| {
            let mut picture = Hypothesis { mistake: Some(self), ..right.clone() };
            change(&mut picture);
            (picture.written != right.written || !picture.is_right_before_writing(recipe)).then_some(picture)
        };
        self.changes.iter().filter_map(picture).collect()
    }

    /// Whether it is a step of a later section rather than a fault.
    pub fn is_early(&self) -> bool {
        self.id.ends_with("-early")
    }

    pub fn is_at_edges(&self) -> bool {
        matches!(self.shows, Shows::AtEdges)
    }
}

/// A picture the reader's may be: how its linear values are made, and how they become bytes.
#[derive(Clone, Debug)]
pub struct Hypothesis {
    /// The mistake; `None` for the right picture.
    pub mistake: Option<&'static Mistake>,
    /// An extra remark for the reader.
    pub note: Option<String>,
    pub recipe: Recipe,
    /// The steps of the plain tracer; without, the program's own tracer renders the recipe.
    pub steps: Option<Steps>,
    pub written: Written,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Written {
    pub is_flipped: bool,
    pub is_mirrored: bool,
    /// Source channels of the written red, green and blue.
    pub channels: [usize; 3],
    /// The curve from linear to displayed values.
    pub curve: Encoding,
    /// Factor from displayed values to bytes.
    pub levels: f64,
    /// Whether 256 becomes 0 instead of 255.
    pub wraps: bool,
}

impl Hypothesis {
    pub fn right(recipe: &Recipe) -> Hypothesis {
        let curve = Encoding::Book(recipe.rules.transfer);
        let (is_flipped, is_mirrored, wraps) = (false, false, false);
        let written = Written { is_flipped, is_mirrored, channels: [0, 1, 2], curve, levels: 256.0, wraps };
        Hypothesis { mistake: None, note: None, recipe: recipe.clone(), steps: None, written }
    }

    /// The steps of the plain tracer, which is then the one to render the picture.
    pub fn plain(&mut self) -> &mut Steps {
        self.steps.get_or_insert(Steps::OF_THE_BOOK)
    }

    /// Whether the linear picture is the right one of `recipe`, so that only its bytes may be wrong.
    pub fn is_right_before_writing(&self, recipe: &Recipe) -> bool {
        self.steps.is_none() && self.recipe == *recipe
    }
}

impl Written {
    /// The linear value of a byte in a row, and half of its step.
    pub fn linear(&self, byte: u8, row: usize, height: usize) -> [f64; 2] {
        let linear = |part: f64| self.curve.linear((f64::from(byte) + part) / self.levels, row, height);
        [linear(0.5), (linear(1.0) - linear(0.0)) / 2.0]
    }

    /// The linear value that a reader sees if the displayed value was multiplied by 255 instead of 256.
    pub fn times_255(&self, linear: f64, row: usize, height: usize) -> f64 {
        self.curve.linear(self.curve.displayed(linear, row, height) * 255.0 / 256.0, row, height)
    }

    pub fn byte_of(&self, linear: f64, row: usize, height: usize) -> u8 {
        let displayed = self.curve.displayed(linear.max(0.0), row, height);
        (self.levels * displayed.min(0.999)) as u8
    }

    /// The byte that the reader's program had before it wrapped, as far as ours tells.
    pub fn unwrapped(&self, byte: u8, expected: f64) -> u8 {
        if self.wraps && byte == 0 && expected > 0.5 { 255 } else { byte }
    }

    /// Bytes in the layout of the file, row by row.
    pub fn bytes_of(&self, linear: &[[f64; 3]], [width, height]: [u32; 2]) -> Vec<[u8; 3]> {
        let byte = |index: usize, x: f64| self.byte_of(x, index / width as usize, height as usize);
        linear.iter().enumerate().map(|(index, pixel)| pixel.map(|x| byte(index, x))).collect()
    }

    /// Rearranges the linear picture to the layout of the file.
    pub fn laid_out(&self, linear: &[[f64; 3]], width: usize) -> Vec<[f64; 3]> {
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

pub struct Studio {
    recipe: Recipe,
    fast: CpuRenderer,
    /// The right picture and its sample count.
    right: Option<(u64, Vec<[f64; 3]>)>,
}

/// The size of the book's pictures: 400 x 225.
const PIXELS: u64 = 90_000;

impl Studio {
    pub fn new(recipe: Recipe, [width, height]: [u32; 2]) -> Result<Studio> {
        let settings = RenderSettings {
            sampler: SamplerKind::Independent,
            estimate_error: false,
            width: width.max(1),
            height: height.max(1),
            ..recipe.settings
        };
        let recipe = Recipe { settings, ..recipe };
        Ok(Studio { recipe, fast: CpuRenderer::new(CpuOptions::default())?, right: None })
    }

    pub fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// Renders a hypothesis: linear RGB in the layout of the file. Pictures larger than [`PIXELS`] get the same number
    /// of paths, and the plain tracer gets fewer.
    pub fn render(&mut self, hypothesis: &Hypothesis, samples: u64) -> Result<Vec<[f64; 3]>> {
        let RenderSettings { width, height, .. } = self.recipe.settings;
        let is_exact = !self.recipe.rules.antialiasing && self.recipe.samples_per_pixel == 1;
        let count = |samples: u64| match is_exact {
            true => 1,
            false => (samples * PIXELS / (u64::from(width) * u64::from(height))).clamp(1, samples),
        };
        let linear = match hypothesis.steps {
            Some(steps) => {
                Tracer::new(&hypothesis.recipe, steps).means(count((samples / 8).clamp(1, 16)) as u32)
            }
            None if hypothesis.is_right_before_writing(&self.recipe) => {
                let count = count(samples);
                if self.right.as_ref().is_none_or(|(samples, _)| *samples < count) {
                    self.right = Some((count, means(&mut self.fast, &self.recipe, count)?));
                }
                self.right.as_ref().map_or_else(Vec::new, |(_, linear)| linear.clone())
            }
            None => means(&mut self.fast, &hypothesis.recipe, count(samples))?,
        };
        Ok(hypothesis.written.laid_out(&linear, width as usize))
    }
}

fn means(fast: &mut CpuRenderer, recipe: &Recipe, samples: u64) -> Result<Vec<[f64; 3]>> {
    let job = recipe.job()?;
    let mut film = job.new_film();
    fast.accumulate(&job, 0..samples, &mut film, &AtomicBool::new(false))?;
    Ok(film.means().into_iter().map(|pixel| pixel.map(f64::from)).collect())
}

/// The reader's picture compared with a hypothesis.
#[derive(Clone, Debug)]
pub struct Compared {
    pub hypothesis: Hypothesis,
    /// Mean squared error beyond noise over blocks, in display values.
    pub misfit: f64,
    /// Whether the remaining difference is noise.
    pub is_noise: bool,
    /// Share of the blocks that differ by more than noise.
    pub differing: f64,
    /// Column and row of the middle of the block that differs most.
    pub worst: [u32; 2],
    pub expected: Vec<[f64; 3]>,
}

impl Compared {
    /// The same, if a mistake explains the difference.
    pub fn blamed_on(&self, mistake: &'static Mistake) -> Compared {
        let mut found = Compared { is_noise: true, ..self.clone() };
        found.hypothesis.mistake = Some(mistake);
        found
    }
}

pub fn compare(mine: &Mine, hypothesis: Hypothesis, expected: Vec<[f64; 3]>) -> Compared {
    let (width, height) = (mine.width as usize, mine.height as usize);
    let step = mine.step();
    let linear = |byte: u8, index: usize| hypothesis.written.linear(byte, index / width, height);
    let pixels = mine.bytes.iter().zip(&expected).enumerate();
    let (values, steps): (Vec<[f64; 3]>, Vec<[f64; 3]>) = pixels
        .map(|(index, (bytes, expected))| {
            let [least, most] = [0, 255].map(|byte| linear(byte, index)[0]);
            let unwrapped = |channel: usize| hypothesis.written.unwrapped(bytes[channel], expected[channel]);
            let mine_linear = [0, 1, 2].map(|channel| linear(unwrapped(channel), index));
            let value =
                [0, 1, 2].map(|channel| mine_linear[channel][0] - expected[channel].clamp(least, most));
            (value, mine_linear.map(|[_, half]| half * step))
        })
        .unzip();
    let test = BlockTest::of(&Differences {
        width: mine.width,
        values: &values,
        noise: Noise::Spread,
        steps: Some(&steps),
        tolerance: 1e-4,
        rare: 0.0,
    });
    let limit = LARGEST_FACTOR * test.largest_limit;
    let is_noise = test.largest_excess() <= EXCESS_LIMIT && test.largest <= limit;
    let differing = test.blocks.iter().filter(|block| block.largest() > limit).count() as f64;
    let middle = |range: &Range<u32>| u32::midpoint(range.start, range.end);
    Compared {
        misfit: misfit(&test, &values, &expected, width),
        is_noise,
        differing: differing / test.blocks.len().max(1) as f64,
        worst: test.worst(1).first().map_or([0; 2], |block| [middle(&block.x), middle(&block.y)]),
        hypothesis,
        expected,
    }
}

/// Mean squared error beyond noise over blocks and channels, in display values.
fn misfit(test: &BlockTest, values: &[[f64; 3]], expected: &[[f64; 3]], width: usize) -> f64 {
    let mut sum = 0.0;
    for block in &test.blocks {
        let pixels =
            || block.y.clone().flat_map(|y| block.x.clone().map(move |x| y as usize * width + x as usize));
        let count = pixels().count() as f64;
        for (channel, mean) in block.means.into_iter().enumerate() {
            let bright = pixels().map(|pixel| expected[pixel][channel]).sum::<f64>() / count;
            let spread: f64 = pixels().map(|pixel| (values[pixel][channel] - mean).powi(2)).sum();
            let noise = spread / (count * (count - 1.0).max(1.0));
            // The derivative of the square root converts linear errors to displayed ones.
            sum += (mean * mean - noise) / (4.0 * bright.max(0.02));
        }
    }
    sum / (3 * test.blocks.len().max(1)) as f64
}
