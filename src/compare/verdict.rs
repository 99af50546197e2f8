//! Decides whether two pictures are the same except for noise and rounding.

use super::bounds::{add_bounds, rounding, step_of};
use super::non_finite::NonFinite;
use super::paired::{PARTED_SHARE, PairedSamples, ROUNDING_RMS};
use super::side::Side;
use super::sparse::{Sparse, narrow};
use super::variances::Variances;
use crate::statistics::blocks::{BlockTest, Differences, Noise, SUM_DEVIATIONS};
use serde::Serialize;

/// The largest effect of rounding on a mean: docs/numerics.md, cases 12 and 13.
pub const ROUNDING_BIAS: f64 = 2e-6;

/// How the noise of the difference was estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Evidence {
    /// From the halves of both films.
    Halves,
    /// From the spread of the differences within each block.
    Spread,
}

/// How two pictures differ, and how much of the difference is noise. Values are linear RGB.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Whether all pixels are equal to the bit; any NaN is equal to any other.
    pub is_same: bool,
    /// Root mean square difference over pixels and channels.
    pub rms: f64,
    /// Mean difference, second less first.
    pub bias: f64,
    /// Standard deviation of the bias from noise and rounding; `None` if the noise is not known.
    pub bias_deviation: Option<f64>,
    /// Root mean square noise of both pictures together, as if they shared none; `None` if it is not known.
    pub noise: Option<f64>,
    /// How the noise was estimated.
    pub evidence: Evidence,
    /// Channels that could not be compared, over all pixels.
    pub left_out: usize,
    /// Channels that are NaN or infinite.
    pub non_finite: NonFinite,
    /// The test of the blocks.
    pub test: BlockTest,
    /// The comparison sample by sample, if backends rendered both.
    pub paired: Option<PairedSamples>,
    /// Why the pictures are not equal; empty if they are.
    pub reasons: Vec<String>,
    /// What to know when reading the figures.
    pub notes: Vec<String>,
    /// Why nothing can be said, if there is no reason to call the pictures different.
    pub unclear: Option<String>,
}

/// Whether two pictures hold the same bits in the same format; any NaN is equal to any other.
fn is_same(a: &Side, b: &Side) -> bool {
    let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
    let all_same = |a: &[[f64; 3]], b: &[[f64; 3]]| a.iter().flatten().zip(b.iter().flatten()).all(same);
    let has_same_steps = match (&a.steps, &b.steps) {
        (Some(a), Some(b)) => all_same(a, b),
        (None, None) => true,
        _ => false,
    };
    // The largest value has no step.
    let is_same_format = has_same_steps && a.limit.to_bits() == b.limit.to_bits();
    is_same_format && all_same(&a.pixels, &b.pixels)
}

/// The steps of both pictures together, if either has steps.
fn added(a: Option<&Vec<[f64; 3]>>, b: Option<&Vec<[f64; 3]>>) -> Option<Vec<[f64; 3]>> {
    match (a, b) {
        (Some(a), Some(b)) => Some(
            a.iter().zip(b).map(|(a, b)| [0, 1, 2].map(|i| step_of(a[i]).hypot(step_of(b[i])))).collect(),
        ),
        (one, other) => one.or(other).map(|steps| steps.iter().map(|pixel| pixel.map(step_of)).collect()),
    }
}

/// Compares two pictures of one size.
pub fn compare(a: &Side, b: &Side, paired: Option<PairedSamples>) -> Comparison {
    let limit = a.limit.min(b.limit);
    let known = |x: f64| if x < limit { x } else { f64::NAN };
    let difference: Vec<[f64; 3]> =
        a.pixels.iter().zip(&b.pixels).map(|(a, b)| [0, 1, 2].map(|i| known(b[i]) - known(a[i]))).collect();
    let films = a.film.as_deref().zip(b.film.as_deref());
    let variances = films.and_then(|(a, b)| Variances::of(a, b));
    let steps = added(a.steps.as_ref(), b.steps.as_ref());
    let evidence = if variances.is_some() { Evidence::Halves } else { Evidence::Spread };
    let mut test = BlockTest::of(&Differences {
        width: a.width,
        values: &difference,
        noise: variances.as_ref().map_or(Noise::Spread, |v| Noise::Variances(&v.of_difference)),
        steps: steps.as_deref(),
        tolerance: ROUNDING_BIAS,
        rare: variances.as_ref().map_or(0.0, |v| v.rare),
    });
    let mut clipped_blocks = 0;
    let mut sparse = None;
    if evidence == Evidence::Spread {
        let is_moved = |pixel: usize, channel: usize| {
            let step = steps.as_ref().map_or(0.0, |steps| steps[pixel][channel]);
            difference[pixel][channel].abs() > rounding(step, ROUNDING_BIAS)
        };
        narrow(&mut test, a.width, is_moved);
        // Two backends compare sample by sample, which tells paths apart.
        sparse = paired.is_none().then(|| Sparse::of(&difference, a.width, is_moved)).flatten();
        clipped_blocks = add_bounds(&mut test, a, b, steps.as_deref(), ROUNDING_BIAS);
    }
    let finite = || difference.iter().flatten().copied().filter(|x| x.is_finite());
    let count = finite().count();
    let mean = |sum: f64| sum / count.max(1) as f64;
    let mut comparison = Comparison {
        // An integer that is not known is the largest of its format.
        is_same: (count > 0 || a.steps.is_some()) && is_same(a, b),
        rms: mean(finite().map(|x| x * x).sum()).sqrt(),
        bias: mean(finite().sum()),
        bias_deviation: variances.as_ref().map(|v| v.of_mean.hypot(ROUNDING_BIAS)),
        noise: variances.map(|v| v.of_both),
        evidence,
        left_out: 3 * difference.len() - count,
        non_finite: NonFinite::of(a, b),
        test,
        paired,
        reasons: Vec::new(),
        notes: Vec::new(),
        unclear: None,
    };
    if clipped_blocks > 0 {
        comparison.reasons.push(format!(
            "{clipped_blocks} blocks reach the largest value of an integer format in one picture, but are darker in the \
             other"
        ));
    }
    judge(&mut comparison);
    if !comparison.is_same {
        doubt(&mut comparison, sparse, difference.len());
    }
    comparison
}

/// Notes what cannot be judged, and withholds the verdict if that is too much. `pixels` is the size of the pictures.
fn doubt(comparison: &mut Comparison, sparse: Option<Sparse>, pixels: usize) {
    let known: usize = comparison.test.counts.iter().sum();
    let all = 3 * comparison.test.blocks.len();
    let mut unclear = None;
    if 2 * known < all {
        unclear = Some(format!(
            "only {known} of {all} channels of blocks can be judged: the others are NaN, infinite, or at the largest \
             value of an integer format; compare films, or render both with a darker sky"
        ));
    }
    if let Some(sparse) = sparse {
        let text = sparse.told(pixels);
        if sparse.is_loud() {
            unclear.get_or_insert_with(|| {
                format!(
                "{text}: too few to tell noise from a fault; look at them with --heat-map, or compare films with two \
                 halves"
            )});
        } else {
            comparison.notes.push(text);
        }
    }
    comparison.unclear = unclear.filter(|_| comparison.reasons.is_empty());
}

/// Adds the reasons and notes.
fn judge(comparison: &mut Comparison) {
    let Comparison { test, reasons, notes, .. } = comparison;
    let non_finite = comparison.non_finite;
    if let Some([column, row]) = non_finite.first {
        reasons.push(format!(
            "{} channels of {} pixels are NaN or infinite in only one picture, the first at {column},{row}: find out what made them",
            non_finite.differing, non_finite.differing_pixels
        ));
    }
    if test.largest_excess() > SUM_DEVIATIONS {
        reasons.push(format!(
            "the sum of z^2 over the blocks is {:.1} deviations above that of noise, but noise stays below {SUM_DEVIATIONS:.0}",
            test.largest_excess()
        ));
    }
    if test.largest > test.largest_limit {
        reasons.push(format!(
            "a block is {:.1} deviations off, but noise gives at most {:.1}",
            test.largest, test.largest_limit
        ));
    }
    if let Some(deviation) = comparison.bias_deviation
        && comparison.bias.abs() > SUM_DEVIATIONS * deviation
    {
        let times = comparison.bias.abs() / deviation;
        reasons.push(format!(
            "the mean is {times:.1} deviations off, but noise gives at most {SUM_DEVIATIONS:.0}"
        ));
    }
    if let Some(paired) = &comparison.paired {
        if paired.rms > ROUNDING_RMS {
            reasons.push(format!(
                "samples on the same path differ by {:.1e} RMS, but rounding causes at most {ROUNDING_RMS:.0e}",
                paired.rms
            ));
        }
        if paired.parted_share() > PARTED_SHARE {
            reasons.push(format!(
                "a share of {:.1e} of the samples takes a different path, but rounding causes at most {PARTED_SHARE:.0e}",
                paired.parted_share()
            ));
        }
    }
    if comparison.evidence == Evidence::Spread && !comparison.is_same {
        notes.push(
            "the noise is estimated from the spread of the differences within each block, so differences finer \
             than 8 pixels pass for noise; films with two halves (--checkpoint) give a sharper comparison"
                .to_owned(),
        );
    }
    if test.is_too_near() && comparison.paired.is_none() {
        let text = match comparison.evidence {
            Evidence::Halves => {
                "the blocks differ by less than the noise of the halves allows: do the halves belong to one picture?"
            }
            Evidence::Spread => {
                "the means of the blocks differ by less than the spread within the blocks explains: the pictures \
                 differ in a pattern finer than 8 pixels, such as stripes, or share random numbers"
            }
        };
        notes.push(text.to_owned());
    }
    if non_finite.alike > 0 {
        let text = "are NaN in both pictures, or infinite with the same sign: these count as equal";
        notes.push(format!("{} channels {text}", non_finite.alike));
    }
    if comparison.left_out > 0 {
        let text = "are left out of the figures, with their blocks: they are NaN, infinite, or at the largest value \
                    of an integer format";
        notes.push(format!("{} channels {text}", comparison.left_out));
    }
}

impl Comparison {
    /// Whether the pictures differ only by noise and rounding.
    pub fn is_equal(&self) -> bool {
        self.reasons.is_empty() && self.unclear.is_none()
    }

    /// The difference divided by its noise: 1 for equal pictures that share no random numbers. Measured over pixels if
    /// the noise of both pictures is known, else over blocks.
    pub fn times_noise(&self) -> f64 {
        match self.noise {
            Some(noise) if noise > 0.0 => self.rms / noise,
            Some(_) if self.rms == 0.0 => 0.0,
            Some(_) => f64::INFINITY,
            None => self.test.ratio(),
        }
    }
}

#[cfg(test)]
mod tests;
