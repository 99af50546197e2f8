//! Decides whether two pictures are the same except for noise and rounding.

use super::non_finite::NonFinite;
use super::paired::{PARTED_SHARE, PairedSamples, ROUNDING_RMS};
use super::side::Side;
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
}

/// Whether two pictures of floats hold the same bits; any NaN is equal to any other.
fn is_same(a: &Side, b: &Side) -> bool {
    let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
    a.steps.is_none()
        && b.steps.is_none()
        && a.pixels.iter().flatten().zip(b.pixels.iter().flatten()).all(same)
}

/// The steps of both pictures together, if either has steps.
fn added(a: Option<&Vec<[f64; 3]>>, b: Option<&Vec<[f64; 3]>>) -> Option<Vec<[f64; 3]>> {
    match (a, b) {
        (Some(a), Some(b)) => {
            Some(a.iter().zip(b).map(|(a, b)| [0, 1, 2].map(|i| a[i].hypot(b[i]))).collect())
        }
        (one, other) => one.or(other).cloned(),
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
    let test = BlockTest::of(&Differences {
        width: a.width,
        values: &difference,
        noise: variances.as_ref().map_or(Noise::Spread, |v| Noise::Variances(&v.of_difference)),
        steps: steps.as_deref(),
        tolerance: ROUNDING_BIAS,
        rare: variances.as_ref().map_or(0.0, |v| v.rare),
    });
    let finite = || difference.iter().flatten().copied().filter(|x| x.is_finite());
    let count = finite().count();
    let mean = |sum: f64| sum / count.max(1) as f64;
    let mut comparison = Comparison {
        is_same: count > 0 && is_same(a, b),
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
    };
    judge(&mut comparison, count);
    comparison
}

/// Adds the reasons and notes. `compared` is the number of channels that could be compared.
fn judge(comparison: &mut Comparison, compared: usize) {
    let Comparison { test, reasons, notes, .. } = comparison;
    if compared == 0 {
        reasons.push("no pixel could be compared".to_owned());
    }
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
        notes.push(
            "the blocks differ by less than the noise of the halves allows: do the halves belong to one picture?"
                .to_owned(),
        );
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
        self.reasons.is_empty()
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
mod tests {
    use super::*;
    use crate::compare::PairedSums;
    use crate::film::{FIXED_POINT_SCALE, Film, PixelSum, fixed_point};
    use crate::sampling::pcg4d;

    /// Two samples per pixel: noise that depends on pixel and half, and an offset.
    fn side(seed: u32, offset: f64) -> Side {
        let mut film = Film::new(80, 48, 2);
        for half in 0..2_u32 {
            for pixel in 0..80 * 48 {
                let noise = f64::from(pcg4d([pixel, half, seed, 5])[0]) / 4_294_967_296.0;
                let sum: PixelSum = fixed_point([0.5 + 0.2 * noise + offset; 3]).unwrap();
                film.halves_mut()[half as usize][pixel as usize] = sum;
            }
        }
        film.record(0..2, 0).unwrap();
        Side::of_film(String::new(), String::new(), film)
    }

    #[test]
    fn noise_hides_a_small_offset_but_not_between_the_same_samples() {
        let noise = compare(&side(1, 0.0), &side(2, 0.0), None);
        assert!(noise.is_equal(), "{:?}", noise.reasons);
        assert!((noise.times_noise() - 1.0).abs() < 0.1, "{}", noise.times_noise());
        assert!(compare(&side(1, 0.0), &side(2, 2e-3), None).is_equal());
        let same = compare(&side(1, 0.0), &side(1, 2e-3), None);
        assert!(!same.is_equal() && same.times_noise() < 0.1, "{same:?}");
        assert!(compare(&side(1, 0.0), &side(1, 1e-6), None).is_equal());
        assert!(compare(&side(1, 0.0), &side(1, 0.0), None).is_same);
    }

    #[test]
    fn nan_or_infinity_in_only_one_picture_is_a_difference() {
        let floats = |value: f64| {
            let mut side = side(1, 0.0);
            side.pixels.iter_mut().take(60).for_each(|pixel| pixel[1] = value);
            side.film = None;
            side
        };
        let (nan, inf) = (f64::NAN, f64::INFINITY);
        for (a, b) in [(nan, 0.5), (0.5, inf), (-inf, 0.5), (nan, inf), (inf, -inf), (nan, -inf)] {
            let found = compare(&floats(a), &floats(b), None);
            assert!(!found.is_equal() && !found.is_same, "{a} and {b}");
            assert_eq!((found.non_finite.differing, found.non_finite.differing_pixels), (60, 60));
            assert_eq!((found.non_finite.first, found.non_finite.alike), (Some([0, 0]), 0));
            assert!(found.reasons[0].starts_with("60 channels of 60 pixels are NaN"), "{:?}", found.reasons);
        }
        for (a, b) in [(nan, -nan), (inf, inf), (-inf, -inf)] {
            let found = compare(&floats(a), &floats(b), None);
            assert!(found.is_equal() && found.is_same, "{a} and {b}: {:?}", found.reasons);
            assert_eq!((found.non_finite.differing, found.non_finite.alike), (0, 60));
        }
        // Zeros of different signs are equal, but not to the bit.
        let found = compare(&floats(0.0), &floats(-0.0), None);
        assert!(found.is_equal() && !found.is_same);
    }

    #[test]
    fn a_picture_without_a_finite_number_equals_no_picture() {
        let mut none = side(1, 0.0);
        (none.film, none.pixels) = (None, vec![[f64::NAN; 3]; 80 * 48]);
        let found = compare(&none, &none, None);
        assert!(!found.is_equal() && !found.is_same, "{found:?}");
    }

    #[test]
    fn the_largest_value_of_an_integer_format_stands_for_any_larger_number() {
        let whole = |value: f64| {
            let mut side = side(1, 0.0);
            (side.film, side.limit) = (None, 0.99);
            side.pixels[7][2] = value;
            side.steps = Some(vec![[0.002; 3]; 80 * 48]);
            side
        };
        let float = |value: f64| {
            let mut side = side(1, 0.0);
            side.film = None;
            side.pixels[7][2] = value;
            side
        };
        let end = whole(f64::NAN);
        for beyond in [1.0, 50.0, f64::INFINITY] {
            assert!(compare(&end, &float(beyond), None).is_equal(), "{beyond}");
        }
        assert!(compare(&end, &end, None).is_equal());
        for other in [f64::NAN, f64::NEG_INFINITY] {
            assert!(!compare(&float(other), &end, None).is_equal(), "{other}");
        }
        assert!(!compare(&whole(0.5), &float(f64::INFINITY), None).is_equal());
    }

    #[test]
    fn values_beyond_an_integer_format_are_left_out_on_both_sides() {
        let whole = |value: f64| {
            let mut side = side(1, 0.0);
            (side.film, side.limit) = (None, 0.99);
            side.pixels.iter_mut().take(80 * 8).for_each(|pixel| *pixel = [value; 3]);
            side.steps = Some(vec![[0.002; 3]; 80 * 48]);
            side
        };
        let film = |value: f64| {
            let mut side = side(1, 0.0);
            side.pixels.iter_mut().take(80 * 8).for_each(|pixel| *pixel = [value; 3]);
            side
        };
        // At or above the limit of the other picture: unknown, and no difference.
        for (a, b) in [(f64::NAN, 5.0), (f64::NAN, 0.99), (0.988, 0.99)] {
            for found in [compare(&whole(a), &film(b), None), compare(&film(b), &whole(a), None)] {
                assert!(found.is_equal(), "{a} and {b}: {:?}", found.reasons);
                assert_eq!(found.left_out, 3 * 80 * 8, "{a} and {b}");
            }
        }
        assert_eq!(compare(&whole(0.5), &film(0.5), None).left_out, 0);
        assert!(!compare(&whole(0.5), &film(0.6), None).is_equal());
    }

    #[test]
    fn the_bias_is_the_second_less_the_first() {
        let (dark, bright) = (side(1, 0.0), side(1, 2e-3));
        for (first, second, sign) in [(&dark, &bright, 1.0), (&bright, &dark, -1.0)] {
            let mut sums = PairedSums::default();
            sums.add(first.film.as_ref().unwrap(), second.film.as_ref().unwrap());
            let found = compare(first, second, Some(sums.finish()));
            assert!((found.bias - sign * 2e-3).abs() < 1e-6, "{}", found.bias);
            // Parted samples do not count toward the paired bias: the sums of these films differ by too much.
            assert_eq!(found.paired.unwrap().parted, 80 * 48);
        }
        let (dark, bright) = (side(1, 0.0), side(1, 1e-5));
        let mut sums = PairedSums::default();
        sums.add(dark.film.as_ref().unwrap(), bright.film.as_ref().unwrap());
        assert!((sums.finish().bias - 2e-5).abs() < 1e-6, "{:?}", sums.finish());
    }

    #[test]
    fn paired_samples_distinguish_other_paths_from_rounding() {
        let (a, b) = (side(1, 0.0), side(1, 1e-5));
        let mut sums = PairedSums::default();
        let (film_a, film_b) = (a.film.as_ref().unwrap(), b.film.as_ref().unwrap());
        sums.add(film_a, film_b);
        let found = sums.finish();
        assert_eq!((found.count, found.parted), (80 * 48, 0));
        // A film of two samples holds their sum.
        assert!((found.rms - 2e-5).abs() < 1e-6, "{found:?}");
        let other = side(2, 0.0);
        sums.add(film_a, other.film.as_ref().unwrap());
        assert!(sums.finish().parted_share() > 0.4);
    }

    /// With many samples the noise of the mean is far below what rounding may do to it.
    #[test]
    fn a_mean_that_rounding_moves_is_equal() {
        let side = |offset: f64| {
            let samples = 1 << 20;
            let sum = (samples / 2) as f64 * (0.5 + offset) * FIXED_POINT_SCALE;
            let mut film = Film::new(80, 48, 2);
            film.halves_mut()
                .iter_mut()
                .flatten()
                .for_each(|pixel| *pixel = PixelSum([sum.round() as u64; 3]));
            film.record(0..samples, 0).unwrap();
            Side::of_film(String::new(), String::new(), film)
        };
        let rounded = compare(&side(0.0), &side(ROUNDING_BIAS), None);
        assert!(rounded.is_equal(), "{:?}", rounded.reasons);
        let moved = compare(&side(0.0), &side(5.0 * ROUNDING_BIAS), None);
        assert!(moved.reasons.iter().any(|reason| reason.starts_with("the mean is")), "{:?}", moved.reasons);
    }
}
