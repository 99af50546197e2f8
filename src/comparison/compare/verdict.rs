//! Decides whether two pictures differ by more than noise and rounding.

use crate::comparison::Picture;
use crate::comparison::answer::Verdict;
use crate::film::{Film, PixelSum};
use crate::numbers::statistics::blocks::{Block, BlockTest, CHANCE, Differences, Noise, SUM_DEVIATIONS};
use crate::numbers::statistics::normal::largest_of;
use serde::Serialize;

/// Largest effect of rounding on a mean: docs/numerics.md, cases 12 and 13.
pub const ROUNDING_BIAS: f64 = 2e-6;

/// Share of pixels that may differ where all others are equal: rounding may send this many along a different path.
const FEW_PIXELS: f64 = 1e-3;

/// A difference above this cannot come from a few stray paths among many.
const LOUD: f64 = 0.1;

/// How two pictures differ, and how much of it is noise. Values are linear RGB.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// Whether all pixels are equal bit for bit; any two NaNs count as equal.
    pub is_same: bool,
    /// Root mean square difference over pixels and channels.
    pub rms: f64,
    /// Mean difference, second less first.
    pub bias: f64,
    /// Standard deviation of the bias from noise and rounding; `None` if the noise is unknown.
    pub bias_deviation: Option<f64>,
    /// Root mean square noise of both pictures, as if independent; `None` if unknown.
    pub noise: Option<f64>,
    /// Channels that could not be compared, over all pixels.
    pub left_out: usize,
    pub non_finite: NonFinite,
    #[serde(skip)]
    pub test: BlockTest,
    /// Why the pictures differ; empty if they are equal.
    pub reasons: Vec<String>,
    /// Caveats for reading the figures.
    pub notes: Vec<String>,
    /// Why there is no verdict, if no reason says that they differ.
    pub unclear: Option<String>,
}

impl Comparison {
    pub fn verdict(&self) -> Verdict {
        match (self.reasons.is_empty(), &self.unclear) {
            (false, _) => Verdict::Different,
            (true, Some(_)) => Verdict::Unclear,
            (true, None) => Verdict::Same,
        }
    }

    pub fn is_equal(&self) -> bool {
        self.verdict() == Verdict::Same
    }

    /// The difference divided by its noise: 1 for equal pictures with independent samples. Measured over pixels if the
    /// noise of both is known, otherwise over blocks.
    pub fn times_noise(&self) -> f64 {
        match self.noise {
            Some(noise) if noise > 0.0 => self.rms / noise,
            Some(_) if self.rms == 0.0 => 0.0,
            Some(_) => f64::INFINITY,
            None => self.test.ratio(),
        }
    }
}

/// Compares two pictures of equal size.
pub fn compare(a: &Picture, b: &Picture) -> Comparison {
    let (values, non_finite) = differences(a, b);
    let noise = a.film.as_deref().zip(b.film.as_deref()).and_then(|(a, b)| HalvesNoise::of(a, b));
    let steps = steps_of_both(a, b);
    let differences = Differences {
        width: a.width,
        values: &values,
        noise: noise.as_ref().map_or(Noise::Spread, |noise| Noise::Variances(&noise.variances)),
        steps: steps.as_deref(),
        tolerance: ROUNDING_BIAS,
        rare: noise.as_ref().map_or(0.0, |noise| noise.rare),
    };
    let mut test = BlockTest::of(&differences);
    let (mut clipped, mut few) = (0, None);
    if noise.is_none() {
        let is_moved = |pixel: usize, channel: usize| {
            let step = steps.as_ref().map_or(0.0, |steps| steps[pixel][channel]);
            values[pixel][channel].abs() > rounding(step)
        };
        narrow(&mut test, a.width, is_moved);
        few = few_pixels(&values, a.width, is_moved);
        clipped = add_clipped(&mut test, a, b, &differences);
    }
    let finite = || values.iter().flatten().copied().filter(|x| x.is_finite());
    let count = finite().count();
    let mean = |sum: f64| sum / count.max(1) as f64;
    let mut comparison = Comparison {
        // An unknown integer is its format's largest value.
        is_same: (count > 0 || a.limit.is_finite()) && is_same(a, b),
        rms: mean(finite().map(|x| x * x).sum()).sqrt(),
        bias: mean(finite().sum()),
        bias_deviation: noise.as_ref().map(|noise| noise.of_mean.hypot(ROUNDING_BIAS)),
        noise: noise.map(|noise| noise.of_both),
        left_out: 3 * values.len() - count,
        non_finite,
        test,
        reasons: Vec::new(),
        notes: Vec::new(),
        unclear: None,
    };
    judge(&mut comparison, clipped);
    note(&mut comparison);
    if !comparison.is_same {
        doubt(&mut comparison, few);
    }
    comparison
}

/// Whether two pictures hold the same bits in the same format; any two NaNs count as equal.
fn is_same(a: &Picture, b: &Picture) -> bool {
    let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
    let all_same = |a: &[[f64; 3]], b: &[[f64; 3]]| a.iter().flatten().zip(b.iter().flatten()).all(same);
    let has_same_steps = match (&a.steps, &b.steps) {
        (Some(a), Some(b)) => all_same(a, b),
        (a, b) => a.is_none() && b.is_none(),
    };
    // The largest value has no step.
    has_same_steps && a.limit.to_bits() == b.limit.to_bits() && all_same(&a.pixels, &b.pixels)
}

/// Combined quantisation steps, if either picture has any. The largest value has none, because it is a bound.
fn steps_of_both(a: &Picture, b: &Picture) -> Option<Vec<[f64; 3]>> {
    let step = |picture: &Picture, pixel: usize, channel: usize| {
        let step = picture.steps.as_ref().map_or(0.0, |steps| steps[pixel][channel]);
        if step.is_finite() { step } else { 0.0 }
    };
    let of = |pixel| [0, 1, 2].map(|channel| step(a, pixel, channel).hypot(step(b, pixel, channel)));
    (a.steps.is_some() || b.steps.is_some()).then(|| (0..a.pixels.len()).map(of).collect())
}

/// Largest difference that rounding explains, where `step` is the root of the sum of both squared quantisation errors.
fn rounding(step: f64) -> f64 {
    // The sum of two numbers is at most sqrt(2) times the root of the sum of their squares. Neighbouring bytes reach
    // this limit, so allow for the rounding of this arithmetic.
    std::f64::consts::SQRT_2 * step * (1.0 + 1e-9) + ROUNDING_BIAS
}

/// Narrows the limit when noise is unknown: a block whose differences are all within rounding cannot reach it, so only
/// the others count as tries.
fn narrow(test: &mut BlockTest, width: u32, is_moved: impl Fn(usize, usize) -> bool) {
    let moved = |block: &Block, channel: usize| {
        let mut pixels = block.y.clone().flat_map(|y| block.x.clone().map(move |x| (y * width + x) as usize));
        block.is_known(channel) && pixels.any(|pixel| is_moved(pixel, channel))
    };
    let tries = test.blocks.iter().map(|block| (0..3).filter(|channel| moved(block, *channel)).count()).sum();
    test.largest_limit = largest_of(tries, CHANCE);
}

/// Adds blocks that are clipped throughout in one picture and nowhere in the other: there, the difference to the limit
/// is a lower bound. Returns their number.
fn add_clipped(test: &mut BlockTest, a: &Picture, b: &Picture, differences: &Differences) -> usize {
    let limit = a.limit.min(b.limit);
    if limit.is_infinite() {
        return 0;
    }
    let is_top = |picture: &Picture, pixel, channel| picture.value(pixel, channel).is_none_or(|x| x >= limit);
    let least = |pixel: usize, channel: usize| match [a, b].map(|picture| is_top(picture, pixel, channel)) {
        [true, false] => b.pixels[pixel][channel] - limit,
        [false, true] => limit - a.pixels[pixel][channel],
        _ => f64::NAN,
    };
    let values: Vec<[f64; 3]> =
        (0..a.pixels.len()).map(|pixel| [0, 1, 2].map(|channel| least(pixel, channel))).collect();
    let bounds = BlockTest::of(&Differences { values: &values, ..differences.clone() });
    let mut count = 0;
    for (block, bound) in test.blocks.iter_mut().zip(&bounds.blocks) {
        let proven: Vec<usize> = (0..3).filter(|c| bound.z[*c].abs() > bounds.largest_limit).collect();
        count += usize::from(!proven.is_empty());
        for channel in proven {
            (block.z[channel], block.means[channel]) = (bound.z[channel], bound.means[channel]);
            test.largest = test.largest.max(bound.z[channel].abs());
        }
    }
    count
}

/// Noise of the difference of two films, estimated from their halves.
struct HalvesNoise {
    /// Variance of each pixel's difference. Noise that the films share cancels.
    variances: Vec<[f64; 3]>,
    /// Root mean square noise of both films, as if independent.
    of_both: f64,
    /// Standard deviation of the mean difference over all pixels and channels.
    of_mean: f64,
    /// What two samples of radiance 1, one in each half, add to a pixel.
    rare: f64,
}

impl HalvesNoise {
    /// `None` unless both films have samples in two halves.
    fn of(a: &Film, b: &Film) -> Option<Self> {
        let (of_a, of_b) = (half_differences(a)?, half_differences(b)?);
        let count = of_a.len();
        let both: f64 = of_a.iter().chain(&of_b).flatten().map(|x| x * x).sum();
        let deviations =
            of_a.iter().zip(&of_b).map(|(a, b)| [0, 1, 2].map(|channel| b[channel] - a[channel]));
        // Channels of a pixel share their noise.
        let of_mean: f64 = deviations.clone().map(|pixel| (pixel.iter().sum::<f64>() / 3.0).powi(2)).sum();
        // Both halves may contain the same rare path, which their difference does not show.
        let pair = |film: &Film| std::f64::consts::SQRT_2 / film.sample_count() as f64;
        let rare = pair(a).hypot(pair(b));
        Some(HalvesNoise {
            variances: deviations.map(|pixel| pixel.map(|x| x * x)).collect(),
            of_both: (both / (3 * count) as f64).sqrt(),
            of_mean: of_mean.sqrt().hypot(rare) / count as f64,
            rare,
        })
    }
}

/// Half the difference between the halves' pixel means; its square estimates the variance of the pixel's mean. `None`
/// unless there are samples in two halves.
pub fn half_differences(film: &Film) -> Option<Vec<[f64; 3]>> {
    let [first, second] = film.halves() else { return None };
    let [count_a, count_b] = [0, 1].map(|half| film.half_sample_count(half) as f64);
    let half = |(a, b): (&PixelSum, &PixelSum)| {
        let (a, b) = (a.radiance(), b.radiance());
        [0, 1, 2].map(|channel| 0.5 * (a[channel] / count_a - b[channel] / count_b))
    };
    (count_a > 0.0 && count_b > 0.0).then(|| first.iter().zip(second).map(half).collect())
}

/// Counts of NaN and infinite channels in float pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct NonFinite {
    pub differing_pixels: usize,
    /// Channels that are finite in only one picture, NaN in one and infinite in the other, or infinite with different
    /// signs: these are differences.
    pub differing: usize,
    /// Column and row of the first differing pixel.
    pub first: Option<[u32; 2]>,
    /// Channels that are NaN in both pictures, or infinite with the same sign: equal, and left out of all means.
    pub alike: usize,
}

/// The differences, second less first, and what cannot be subtracted. A channel's difference is NaN if one of the two is
/// not finite, or at or above the largest value of an integer format, which stands for any larger one.
fn differences(a: &Picture, b: &Picture) -> (Vec<[f64; 3]>, NonFinite) {
    let limit = a.limit.min(b.limit);
    let mut found = NonFinite::default();
    let mut pixel = |pixel: usize| {
        let mut apart = 0;
        let values = [0, 1, 2].map(|channel| {
            match (a.value(pixel, channel), b.value(pixel, channel)) {
                (Some(a), Some(b)) if a.is_finite() && b.is_finite() => {
                    return if a < limit && b < limit { b - a } else { f64::NAN };
                }
                (Some(a), Some(b)) if a == b || (a.is_nan() && b.is_nan()) => found.alike += 1,
                (Some(_), Some(_)) => apart += 1,
                (Some(x), None) | (None, Some(x)) if x.is_nan() || x == f64::NEG_INFINITY => apart += 1,
                _ => {}
            }
            f64::NAN
        });
        if apart > 0 {
            found.differing += apart;
            found.differing_pixels += 1;
            found.first.get_or_insert([pixel as u32 % a.width, pixel as u32 / a.width]);
        }
        values
    };
    let values = (0..a.pixels.len()).map(&mut pixel).collect();
    (values, found)
}

/// If only a few pixels differ by more than rounding and all others are equal (so there is no noise): the largest
/// difference, and a sentence about it.
fn few_pixels(
    values: &[[f64; 3]],
    width: u32,
    is_moved: impl Fn(usize, usize) -> bool,
) -> Option<(f64, String)> {
    let by = |pixel: usize| {
        let moved = (0..3).filter(|channel| is_moved(pixel, *channel));
        moved.map(|channel| values[pixel][channel].abs()).fold(0.0, f64::max)
    };
    let moved = (0..values.len()).map(|pixel| (pixel, by(pixel))).filter(|(_, by)| *by > 0.0);
    let (count, all) = (moved.clone().count(), values.len());
    let (pixel, largest) = moved.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let (column, row) = (pixel % width as usize, pixel / width as usize);
    (count as f64 <= (FEW_PIXELS * all as f64).max(1.0)).then(|| {
        let what = format!("only {count} of {all} pixels differ by more than rounding");
        (largest, format!("{what}, most by {largest:.1e} at {column},{row}"))
    })
}

/// Adds the reasons for calling the pictures different.
fn judge(comparison: &mut Comparison, clipped: usize) {
    let Comparison { test, non_finite: NonFinite { differing, differing_pixels, first, .. }, .. } =
        comparison;
    let (excess, largest, limit) = (test.largest_excess(), test.largest, test.largest_limit);
    let off = comparison.bias_deviation.map_or(0.0, |deviation| comparison.bias.abs() / deviation);
    let reasons = [
        (clipped > 0).then(|| {
            format!(
                "{clipped} blocks are at the largest value of an integer format in one picture, but are darker in the other"
            )
        }),
        first.map(|[column, row]| {
            format!(
                "{differing} channels of {differing_pixels} pixels are NaN or infinite in only one picture, the first at \
                 {column},{row}: find out what produced them"
            )
        }),
        (excess > SUM_DEVIATIONS).then(|| {
            format!(
                "the sum of z^2 over the blocks is {excess:.1} deviations above that of noise, but noise stays below \
                 {SUM_DEVIATIONS:.0}"
            )
        }),
        (largest > limit)
            .then(|| format!("a block is {largest:.1} deviations off, but noise gives at most {limit:.1}")),
        (off > SUM_DEVIATIONS).then(|| {
            format!("the mean is {off:.1} deviations off, but noise gives at most {SUM_DEVIATIONS:.0}")
        }),
    ];
    comparison.reasons = reasons.into_iter().flatten().collect();
}

/// Adds the caveats for reading the figures.
fn note(comparison: &mut Comparison) {
    let Comparison { test, is_same, left_out, non_finite: NonFinite { alike, .. }, .. } = comparison;
    let notes = [
        (comparison.noise.is_none() && !*is_same).then(|| {
            "the noise is estimated from the spread of the differences within each block, so differences finer than 8 \
             pixels pass for noise; films with two halves (--checkpoint) give a sharper comparison"
                .to_owned()
        }),
        test.is_too_near().then(|| {
            "the blocks differ by less than their noise allows: the pictures share random numbers, differ in a pattern \
             finer than 8 pixels, or their halves do not belong together"
                .to_owned()
        }),
        (*alike > 0).then(|| {
            format!(
                "{alike} channels are NaN in both pictures, or infinite with the same sign: these count as equal"
            )
        }),
        (*left_out > 0).then(|| {
            format!(
                "{left_out} channels are left out of the figures, with their blocks: they are NaN, infinite, or at the \
                 largest value of an integer format"
            )
        }),
    ];
    comparison.notes = notes.into_iter().flatten().collect();
}

/// Withholds the verdict if too little can be compared.
fn doubt(comparison: &mut Comparison, few: Option<(f64, String)>) {
    let known: usize = comparison.test.counts.iter().sum();
    let all = 3 * comparison.test.blocks.len();
    let mut unclear = (2 * known < all).then(|| {
        format!(
            "only {known} of {all} channels of blocks can be judged: the others are NaN, infinite, or at the largest \
             value of an integer format; compare films, or render both with a darker sky"
        )
    });
    match few {
        Some((largest, text)) if largest > LOUD => {
            let hint = "too few to tell noise from a fault; look there, or compare films with two halves";
            unclear.get_or_insert_with(|| format!("{text}: {hint}"));
        }
        few => comparison.notes.extend(few.map(|(_, text)| text)),
    }
    comparison.unclear = unclear.filter(|_| comparison.reasons.is_empty());
}
