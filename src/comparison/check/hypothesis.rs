//! Hypotheses: the right picture and the picture that each mistake would give, rendered and compared with the reader's.

use super::tracer::{Steps, Tracer};
use super::written::{Seen, Written, reduced};
use crate::job::recipe::Recipe;
use crate::job::render::{RenderSettings, Renderer, SamplerKind};
use crate::numbers::statistics::blocks::{Block, BlockTest, Differences, Noise};
use crate::render_cpu::{CpuOptions, CpuRenderer};
use anyhow::Result;
use std::ops::Range;
use std::sync::atomic::AtomicBool;

/// Deviations by which a right picture's sum of squares may exceed noise. Noise alone stays below 4; the rest allows
/// for correlated random numbers and noise that is far from normal.
const EXCESS_LIMIT: f64 = 10.0;

/// Factor by which a block of a right picture may exceed the limit for normal noise.
const LARGEST_FACTOR: f64 = 1.6;

/// A common mistake in programs that follow the book, or another way to be right.
#[derive(Debug)]
pub struct Mistake {
    pub id: &'static str,
    /// The section of the book to reread.
    pub section: &'static str,
    pub title: &'static str,
    pub remedy: &'static str,
    /// Whether it can show in a picture of this recipe.
    pub applies: fn(&Recipe) -> bool,
    /// Whether it is another way to be right.
    pub is_right: bool,
    /// Each makes one variant of the mistake out of the right picture.
    pub changes: &'static [fn(&mut Hypothesis)],
}

impl Mistake {
    /// One hypothesis per variant, without those that change nothing in this recipe.
    pub fn pictures(&'static self, recipe: &Recipe) -> Vec<Hypothesis> {
        let right = Hypothesis::right(recipe);
        let picture = |change: &fn(&mut Hypothesis)| {
            let mut picture = Hypothesis { mistake: Some(self), ..right.clone() };
            change(&mut picture);
            let is_changed = picture.written != right.written
                || picture.fit.is_some()
                || !picture.is_right_before_writing(recipe);
            is_changed.then_some(picture)
        };
        self.changes.iter().filter_map(picture).collect()
    }
}

/// A candidate for the reader's picture: how its linear values are made, and how they become bytes.
#[derive(Clone, Debug)]
pub struct Hypothesis {
    /// The mistake; `None` for the right picture.
    pub mistake: Option<&'static Mistake>,
    /// An extra remark for the reader.
    pub note: Option<String>,
    pub recipe: Recipe,
    /// The steps of the plain tracer; if `None`, the program's own tracer renders the recipe.
    pub steps: Option<Steps>,
    /// A parameter of the mistake, fitted to the reader's picture.
    pub fit: Option<Fit>,
    /// Whether only pixels at edges show it.
    pub is_fine: bool,
    pub written: Written,
}

/// A picture that is added to the right one, times the factor that fits best.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fit {
    /// The right picture itself: a factor of brightness.
    Gain,
    /// The right picture, one pixel to the right, as if each pixel began with the mean of the one before.
    Carry,
}

impl Hypothesis {
    pub fn right(recipe: &Recipe) -> Hypothesis {
        Hypothesis {
            mistake: None,
            note: None,
            recipe: recipe.clone(),
            steps: None,
            fit: None,
            is_fine: false,
            written: Written::right(recipe),
        }
    }

    /// Switches to the plain tracer and returns its steps.
    pub fn plain(&mut self) -> &mut Steps {
        self.steps.get_or_insert(Steps::OF_THE_BOOK)
    }

    /// Whether the linear picture is the right one of `recipe`, so that only its bytes may be wrong.
    pub fn is_right_before_writing(&self, recipe: &Recipe) -> bool {
        self.steps.is_none() && self.recipe == *recipe
    }

    pub fn size(&self) -> [u32; 2] {
        [self.recipe.settings.width, self.recipe.settings.height]
    }
}

/// A rendered picture: linear RGB, row by row from the top, as two halves with independent noise.
#[derive(Clone, Debug)]
pub struct Rendered {
    pub halves: [Vec<[f64; 3]>; 2],
    /// Per pixel.
    pub samples: u64,
}

impl Rendered {
    pub fn mean(&self) -> Vec<[f64; 3]> {
        let [a, b] = &self.halves;
        a.iter().zip(b).map(|(a, b)| [0, 1, 2].map(|channel| 0.5 * (a[channel] + b[channel]))).collect()
    }

    pub fn map(&self, change: impl Fn(&[[f64; 3]]) -> Vec<[f64; 3]>) -> Rendered {
        Rendered { halves: self.halves.each_ref().map(|half| change(half)), samples: self.samples }
    }

    /// The mean of each square of `factor` x `factor` pixels.
    pub fn reduced(&self, width: usize, factor: usize) -> Rendered {
        self.map(|half| reduced(half, width, factor))
    }

    /// This picture plus the difference of two others, which share random numbers so that most noise cancels.
    pub fn changed(&self, from: &Rendered, to: &Rendered) -> Rendered {
        let half = |half: usize| {
            let pixels = self.halves[half].iter().zip(&from.halves[half]).zip(&to.halves[half]);
            pixels.map(|((own, from), to)| [0, 1, 2].map(|c| own[c] + to[c] - from[c])).collect()
        };
        Rendered { halves: [half(0), half(1)], samples: self.samples }
    }
}

pub struct Studio {
    recipe: Recipe,
    fast: CpuRenderer,
}

/// The size of the book's pictures: 400 x 225.
const PIXELS: u64 = 90_000;

impl Studio {
    pub fn new(recipe: Recipe, [width, height]: [u32; 2]) -> Result<Studio> {
        let settings = RenderSettings {
            sampler: SamplerKind::Independent,
            // The reader's picture may be one of ours with the default seed.
            seed: 0x6368_6563,
            width: width.max(1),
            height: height.max(1),
            ..recipe.settings
        };
        let recipe = Recipe { settings, ..recipe };
        Ok(Studio { recipe, fast: CpuRenderer::new(CpuOptions::default())? })
    }

    pub fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// Renders a hypothesis: linear RGB in the layout of the file.
    pub fn render(&mut self, hypothesis: &Hypothesis, samples: u64) -> Result<Vec<[f64; 3]>> {
        let linear = self.halves(hypothesis, 1, samples, None)?.mean();
        Ok(hypothesis.written.laid_out(&linear, hypothesis.size()))
    }

    /// Renders a hypothesis, smaller by a factor. Pictures larger than [`PIXELS`] get the same number of paths, and the
    /// plain tracer gets fewer; it skips the pixels that `mask` excludes.
    pub fn halves(
        &mut self,
        hypothesis: &Hypothesis,
        factor: u32,
        samples: u64,
        mask: Option<&[bool]>,
    ) -> Result<Rendered> {
        let [width, height] = hypothesis.size().map(|side| (side / factor).max(1));
        let mut recipe = hypothesis.recipe.clone();
        (recipe.settings.width, recipe.settings.height) = (width, height);
        let is_exact = !recipe.rules.antialiasing && recipe.samples_per_pixel == 1;
        let limit = samples * PIXELS / (u64::from(width) * u64::from(height));
        let mut samples = if is_exact { 1 } else { limit.clamp(2, samples.max(2)) };
        if hypothesis.steps.is_some() {
            samples = 2 * (samples / 16).clamp(1, 8);
        }
        let mut half = |half: u32| match hypothesis.steps {
            Some(steps) => Ok(Tracer::new(&recipe, steps, factor).means((samples / 2) as u32, half, mask)),
            None => {
                recipe.settings.seed = hypothesis.recipe.settings.seed.wrapping_add(half);
                means(&mut self.fast, &recipe, samples.div_ceil(2))
            }
        };
        let first = half(0)?;
        let second = if is_exact { first.clone() } else { half(1)? };
        Ok(Rendered { halves: [first, second], samples })
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
    /// Whether the blocks differ only by noise.
    pub is_noise: bool,
    /// Share of the blocks that differ by more than noise.
    pub differing: f64,
    /// The middle of each block that differs by more than noise, the worst first: column and row.
    pub places: Vec<[u32; 2]>,
    /// The picture of the hypothesis, with what was fitted, and what it predicts in the values that `Seen` has.
    pub rendered: Rendered,
    pub expected: Vec<[f64; 3]>,
}

/// The hypothesis with what was fitted, and the mean squared error of its picture, in display values.
pub fn rough(seen: &Seen, mut hypothesis: Hypothesis, rendered: Rendered) -> (Hypothesis, Rendered, f64) {
    let rendered = fitted(seen, &mut hypothesis, rendered);
    let expected = hypothesis.written.predicted(seen, &rendered.mean());
    let (mut sum, mut count, mut known) = (0.0, 1e-9, 0.0);
    let halves = rendered.halves.each_ref().map(|half| hypothesis.written.predicted(seen, half));
    for (index, (seen, expected)) in
        seen.values.as_flattened().iter().zip(expected.as_flattened()).enumerate()
    {
        // The render's own noise does not count as an error.
        let [a, b] = halves.each_ref().map(|half| half[index / 3][index % 3]);
        let noise = 0.25 * (a - b).powi(2);
        // Converted to display values at the reader's brightness: at ours, noise would affect its own weight.
        let square = ((seen - expected).powi(2) - noise) / (4.0 * seen.max(0.02));
        known += f64::from(u8::from(seen.is_finite()));
        if square.is_finite() {
            sum += square;
            count += 1.0;
        }
    }
    let is_known = 4.0 * count > known;
    (hypothesis, rendered, if is_known { sum / count } else { f64::INFINITY })
}

/// The blocks of a picture of this size, without means.
pub fn blocks_of(width: u32, pixels: usize) -> Vec<Block> {
    let (values, noise) = (vec![[0.0; 3]; pixels], Noise::Spread);
    BlockTest::of(&Differences { width, values: &values, noise, steps: None, tolerance: 0.0, rare: 0.0 })
        .blocks
}

/// Compares what is seen of the reader's picture with a hypothesis and its rendered picture.
pub fn compare(seen: &Seen, mut hypothesis: Hypothesis, rendered: Rendered) -> Compared {
    let width = seen.size[0] as usize;
    let rendered = fitted(seen, &mut hypothesis, rendered);
    let expected = hypothesis.written.predicted(seen, &rendered.mean());
    let values: Vec<[f64; 3]> = seen
        .values
        .iter()
        .zip(&expected)
        .map(|(seen, expected)| [0, 1, 2].map(|channel| seen[channel] - expected[channel]))
        .collect();
    let test = BlockTest::of(&Differences {
        width: seen.size[0],
        values: &values,
        noise: Noise::Spread,
        steps: Some(&seen.half_steps),
        tolerance: seen.tolerance,
        rare: 0.0,
    });
    let limit = LARGEST_FACTOR * test.largest_limit;
    let finite = |values: &[[f64; 3]]| values.as_flattened().iter().filter(|value| value.is_finite()).count();
    let is_known = 4 * finite(&values) > finite(&seen.values) && test.counts.iter().sum::<usize>() > 0;
    let is_noise = is_known && test.largest_excess() <= EXCESS_LIMIT && test.largest <= limit;
    let middle = |range: &Range<u32>| u32::midpoint(range.start, range.end);
    let beyond = test.blocks.iter().filter(|block| block.largest() > limit).count();
    let places = test.worst(beyond.max(1)).into_iter().map(|block| [middle(&block.x), middle(&block.y)]);
    Compared {
        misfit: misfit(&test, &values, &expected, width),
        is_noise,
        differing: beyond as f64 / test.blocks.len().max(1) as f64,
        places: places.collect(),
        hypothesis,
        rendered,
        expected,
    }
}

/// A fitted factor below this is not a mistake.
const LEAST_FIT: f64 = 0.009;

/// The rendered picture with what the hypothesis adds to it.
fn fitted(seen: &Seen, hypothesis: &mut Hypothesis, rendered: Rendered) -> Rendered {
    let Some(fit) = hypothesis.fit else { return rendered };
    let from = |index: usize| match fit {
        Fit::Gain => index,
        Fit::Carry => index.saturating_sub(1),
    };
    let right = rendered.mean();
    let (mut product, mut square) = (0.0, 1e-9);
    for (index, (seen, expected)) in seen.values.iter().zip(&right).enumerate() {
        for channel in 0..3 {
            let (direction, value) = (right[from(index)][channel], seen[channel]);
            // A value at the top of its range is only a lower bound.
            if value.is_finite() && value < 0.98 {
                let weight = 1.0 / (0.01 + expected[channel]);
                product += weight * direction * (value - expected[channel]);
                square += weight * direction * direction;
            }
        }
    }
    let times = product / square;
    if times.abs() < LEAST_FIT {
        return rendered;
    }
    hypothesis.note = Some(match fit {
        Fit::Gain => format!("your picture is {:.3} times as bright as ours, in linear values", 1.0 + times),
        Fit::Carry => format!("each pixel holds about 1/{:.0} of the one before", 1.0 / times),
    });
    rendered.map(|half| {
        let add = |index: usize| [0, 1, 2].map(|c| half[index][c] + times * half[from(index)][c]);
        (0..half.len()).map(add).collect()
    })
}

/// Mean squared error beyond noise over blocks and channels, in display values.
fn misfit(test: &BlockTest, values: &[[f64; 3]], expected: &[[f64; 3]], width: usize) -> f64 {
    let (mut sum, mut count) = (0.0, 0_usize);
    for block in &test.blocks {
        for (channel, mean) in block.means.into_iter().enumerate().filter(|(c, _)| block.is_known(*c)) {
            let pixels = || pixels_of(block, width);
            let number = pixels().count() as f64;
            let bright = pixels().map(|pixel| expected[pixel][channel]).sum::<f64>() / number;
            let spread: f64 = pixels().map(|pixel| (values[pixel][channel] - mean).powi(2)).sum();
            let noise = spread / (number * (number - 1.0).max(1.0));
            // The derivative of the square root converts linear errors to displayed ones.
            sum += (mean * mean - noise) / (4.0 * bright.max(0.02));
            count += 1;
        }
    }
    // Without any known value, nothing is explained.
    if count == 0 { f64::INFINITY } else { sum / count as f64 }
}

/// Indices of a block's pixels.
pub fn pixels_of(block: &Block, width: usize) -> impl Iterator<Item = usize> + Clone + use<> {
    let (x, y) = (block.x.clone(), block.y.clone());
    y.flat_map(move |y| x.clone().map(move |x| y as usize * width + x as usize))
}

/// How far a direction leads from a hypothesis towards the reader's picture: 0 if the hypothesis is right, and 1 if the
/// picture at the end of the direction is.
#[derive(Clone, Copy, Debug, Default)]
pub struct Slope {
    pub at: f64,
    /// The same in deviations, from the blocks' own scatter.
    pub deviations: f64,
}

impl Slope {
    /// Whether the direction leads at least as far, as clearly.
    pub fn is_beyond(&self, limit: Slope) -> bool {
        self.at > limit.at && self.deviations > limit.deviations
    }
}

/// The residual of the reader's picture under a hypothesis, regressed on directions, pixel by pixel. The noise of the
/// renders does not bias it, since each product combines different halves.
pub struct Rest<'a> {
    seen: &'a Seen,
    from: &'a Rendered,
    blocks: Vec<Block>,
    /// Of each block and channel; 0 if the channel is not known.
    weights: Vec<[f64; 3]>,
}

impl<'a> Rest<'a> {
    pub fn new(seen: &'a Seen, from: &'a Rendered) -> Self {
        let width = seen.size[0] as usize;
        let blocks = blocks_of(seen.size[0], seen.values.len());
        let mean = from.mean();
        let weight = |block: &Block, channel: usize| {
            let (mut sum, mut square, mut step, mut count) = (0.0, 0.0, 0.0, 0.0);
            for pixel in pixels_of(block, width) {
                let rest = seen.values[pixel][channel] - mean[pixel][channel];
                sum += rest;
                square += rest * rest;
                step += seen.half_steps[pixel][channel];
                count += 1.0;
            }
            let (mean, step) = (sum / count, step / count);
            let weight = 1.0 / ((square / count - mean * mean).max(0.0) + step * step + 1e-6);
            if sum.is_finite() && weight.is_finite() { weight } else { 0.0 }
        };
        let weights = blocks.iter().map(|block| [0, 1, 2].map(|channel| weight(block, channel))).collect();
        Rest { seen, from, blocks, weights }
    }

    /// How far the residual leads in the direction of another picture: over the whole picture, then over each ninth of
    /// it. With `is_local`, the means of the blocks are left out, so that only details count.
    pub fn slopes(&self, to: &Rendered, is_local: bool) -> [Slope; 10] {
        let width = self.seen.size[0] as usize;
        let (mut products, mut squares, mut scatters) = ([0.0; 10], [0.0; 10], [0.0; 10]);
        for (block, weights) in self.blocks.iter().zip(&self.weights) {
            let (mut product, mut square) = (0.0, 0.0);
            for channel in (0..3).filter(|channel| weights[*channel] > 0.0) {
                // The sums of both halves' rests and directions, of their products, and of the directions' product.
                let mut sums = [0.0; 7];
                for pixel in pixels_of(block, width) {
                    let value = self.seen.values[pixel][channel];
                    let [a, b] = self.from.halves.each_ref().map(|half| half[pixel][channel]);
                    let [c, d] = to.halves.each_ref().map(|half| half[pixel][channel]);
                    // A value at an end of its range is only a bound.
                    if value > 0.985 || a.max(b) > 0.97 || a.min(b) < self.seen.half_steps[pixel][channel] {
                        continue;
                    }
                    let (rests, directions) = ([value - a, value - b], [c - a, d - b]);
                    let products = rests[0] * directions[1] + rests[1] * directions[0];
                    let of = [
                        1.0,
                        rests[0],
                        rests[1],
                        directions[0],
                        directions[1],
                        products,
                        directions[0] * directions[1],
                    ];
                    (0..7).for_each(|index| sums[index] += of[index]);
                }
                let [count, rest_a, rest_b, direction_a, direction_b, mut products, mut directions] = sums;
                if is_local && count > 0.0 {
                    products -= (rest_a * direction_b + rest_b * direction_a) / count;
                    directions -= direction_a * direction_b / count;
                }
                product += 0.5 * weights[channel] * products;
                square += weights[channel] * directions;
            }
            let [width, height] = self.seen.size;
            let ninth = |at: u32, side: u32| (3 * at / side.max(1)) as usize;
            for index in [0, 1 + ninth(block.x.start, width) + 3 * ninth(block.y.start, height)] {
                products[index] += product;
                squares[index] += square;
                scatters[index] += product * product;
            }
        }
        std::array::from_fn(|index| {
            if squares[index] <= 0.0 || scatters[index] == 0.0 {
                return Slope::default();
            }
            Slope {
                at: products[index] / squares[index],
                deviations: products[index] / scatters[index].sqrt(),
            }
        })
    }
}
