//! Decides whether two pictures are the same except for noise and rounding.

use super::side::Side;
use crate::film::Film;
use crate::statistics::blocks::{BlockTest, Differences, Noise, SUM_DEVIATIONS};
use serde::Serialize;

/// The largest effect of rounding on a mean: docs/numerics.md, cases 12 and 13.
pub const ROUNDING_BIAS: f64 = 2e-6;

/// What rounding may move samples by, root of the mean square over those that take the same path.
pub const ROUNDING_RMS: f64 = 5e-5;

/// A sample with a larger difference has taken a different path.
pub const PARTED: f64 = 1e-3;

/// The share of samples that rounding may send along a different path.
pub const PARTED_SHARE: f64 = 1e-3;

/// Where the noise of the difference is known from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Evidence {
    /// Both films have halves.
    Halves,
    /// The spread of the differences within each block.
    Spread,
}

/// The same samples of two backends, one by one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PairedSamples {
    /// Samples over all pixels.
    pub count: u64,
    /// Those of them with a channel that differs by more than [`PARTED`].
    pub parted: u64,
    /// Root of the mean square difference of the others.
    pub rms: f64,
    /// Mean difference of the others, second less first.
    pub bias: f64,
}

impl PairedSamples {
    /// Share of the samples that took another path.
    pub fn parted_share(&self) -> f64 {
        self.parted as f64 / self.count.max(1) as f64
    }
}

/// Sums up [`PairedSamples`].
#[derive(Clone, Copy, Debug, Default)]
pub struct PairedSums {
    count: u64,
    parted: u64,
    sum: f64,
    squares: f64,
}

impl PairedSums {
    /// Adds a sample of every pixel as two backends have it.
    pub fn add(&mut self, a: &Film, b: &Film) {
        for pixel in 0..a.width() as usize * a.height() as usize {
            let (a, b) = (a.pixel_sum(pixel).radiance(), b.pixel_sum(pixel).radiance());
            let difference = [0, 1, 2].map(|channel| b[channel] - a[channel]);
            self.count += 1;
            if difference.iter().any(|x| x.abs() > PARTED) {
                self.parted += 1;
            } else {
                self.sum += difference.iter().sum::<f64>();
                self.squares += difference.iter().map(|x| x * x).sum::<f64>();
            }
        }
    }

    /// The figures.
    pub fn finish(&self) -> PairedSamples {
        let values = (3 * (self.count - self.parted)).max(1) as f64;
        PairedSamples {
            count: self.count,
            parted: self.parted,
            rms: (self.squares / values).sqrt(),
            bias: self.sum / values,
        }
    }
}

/// Channels that are NaN or infinite in a picture of floats.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct NonFinite {
    /// Pixels with a channel that is a number in one picture and none in the other, or another kind of none: infinite
    /// there and NaN here, or of the other sign. These are differences.
    pub differing_pixels: usize,
    /// Such channels.
    pub differing: usize,
    /// Column and row of the first of these pixels.
    pub first: Option<[u32; 2]>,
    /// Channels that are NaN in both pictures, or infinite with one sign in both. These are equal, and left out of all
    /// means.
    pub alike: usize,
}

/// What two values of a channel are to each other where one of them at least is no number.
enum Relation {
    /// Both are numbers, or one lies beyond what the other picture can tell.
    Numbers,
    Alike,
    Differing,
}

/// `None` is a value at the end of a picture's whole numbers: any that is as large, infinity included.
fn relation(a: Option<f64>, b: Option<f64>) -> Relation {
    match (a, b) {
        (Some(a), Some(b)) if a.is_finite() && b.is_finite() => Relation::Numbers,
        (Some(a), Some(b)) if a == b || (a.is_nan() && b.is_nan()) => Relation::Alike,
        (Some(_), Some(_)) => Relation::Differing,
        (None, None) => Relation::Numbers,
        (Some(one), None) | (None, Some(one)) if one.is_nan() || one == f64::NEG_INFINITY => {
            Relation::Differing
        }
        _ => Relation::Numbers,
    }
}

/// How many channels of a pixel are numbers in one picture alone, or another kind of none, and how many are none alike.
fn non_finite_channels(a: &Side, b: &Side, pixel: usize) -> [usize; 2] {
    let told = |side: &Side, value: f64| (side.steps.is_none() || !value.is_nan()).then_some(value);
    let mut counts = [0; 2];
    for (mine, theirs) in a.pixels[pixel].iter().zip(&b.pixels[pixel]) {
        match relation(told(a, *mine), told(b, *theirs)) {
            Relation::Numbers => {}
            Relation::Differing => counts[0] += 1,
            Relation::Alike => counts[1] += 1,
        }
    }
    counts
}

/// Whether a channel of a pixel is a number in one picture alone, or another kind of none.
pub(super) fn differs_in_kind(a: &Side, b: &Side, pixel: usize) -> bool {
    non_finite_channels(a, b, pixel)[0] > 0
}

impl NonFinite {
    fn of(a: &Side, b: &Side) -> Self {
        let mut found = NonFinite::default();
        for pixel in 0..a.pixels.len() {
            let [differing, alike] = non_finite_channels(a, b, pixel);
            found.differing += differing;
            found.alike += alike;
            if differing > 0 {
                found.differing_pixels += 1;
                let width = a.width.max(1) as usize;
                found.first.get_or_insert([(pixel % width) as u32, (pixel / width) as u32]);
            }
        }
        found
    }
}

/// Whether two pictures of floats hold the same bits; any NaN is equal to any other.
fn is_same(a: &Side, b: &Side) -> bool {
    let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
    a.steps.is_none()
        && b.steps.is_none()
        && a.pixels.iter().flatten().zip(b.pixels.iter().flatten()).all(same)
}

/// How two pictures differ, and how much of it is noise.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Whether all pixels are equal to the bit; any NaN is equal to any other.
    pub is_same: bool,
    /// Root of the mean square difference over pixels and channels.
    pub rms: f64,
    /// Mean difference, second less first.
    pub bias: f64,
    /// Its deviation, of noise and rounding, where the noise is known.
    pub bias_deviation: Option<f64>,
    /// Root of the mean square that the noise of both pictures would give if they had none in common.
    pub noise: Option<f64>,
    /// Where the noise is known from.
    pub evidence: Evidence,
    /// Channels of pixels that could not be compared.
    pub left_out: usize,
    /// Channels that are NaN or infinite.
    pub non_finite: NonFinite,
    /// The blocks.
    pub test: BlockTest,
    /// Sample by sample, where backends rendered both.
    pub paired: Option<PairedSamples>,
    /// Why they are not equal; empty if they are.
    pub reasons: Vec<String>,
    /// What the reader should know.
    pub notes: Vec<String>,
}

/// Compares two pictures of one size.
pub fn compare(a: &Side, b: &Side, paired: Option<PairedSamples>) -> Comparison {
    let limit = a.limit.min(b.limit);
    let known = |x: f64| if x < limit { x } else { f64::NAN };
    let difference: Vec<[f64; 3]> =
        a.pixels.iter().zip(&b.pixels).map(|(a, b)| [0, 1, 2].map(|i| known(b[i]) - known(a[i]))).collect();
    let halves = a.film.as_ref().and_then(two_halves).zip(b.film.as_ref().and_then(two_halves));
    let variances = halves.as_ref().map(|(a, b)| variances(a, b));
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

fn judge(comparison: &mut Comparison, compared: usize) {
    let Comparison { test, reasons, notes, .. } = comparison;
    if compared == 0 {
        reasons.push("no pixel could be compared".to_owned());
    }
    let non_finite = comparison.non_finite;
    if let Some([column, row]) = non_finite.first {
        reasons.push(format!(
            "{} channels of {} pixels are NaN or infinite in one picture alone, the first at {column},{row}: find out what made them",
            non_finite.differing, non_finite.differing_pixels
        ));
    }
    if test.largest_excess() > SUM_DEVIATIONS {
        reasons.push(format!(
            "the sum of z^2 over the blocks is {:.1} deviations above that of noise, which stays below {SUM_DEVIATIONS:.0}",
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
            reasons.push(format!("samples on the same path differ by {:.1e} RMS, but rounding gives at most {ROUNDING_RMS:.0e}", paired.rms));
        }
        if paired.parted_share() > PARTED_SHARE {
            reasons.push(format!(
                "{:.1e} of the samples take another path, but rounding sends at most {PARTED_SHARE:.0e}",
                paired.parted_share()
            ));
        }
    }
    if comparison.evidence == Evidence::Spread && !comparison.is_same {
        notes.push(
            "the noise is taken from the spread of the differences within each block, so that differences finer \
             than 8 pixels pass for noise; films with two halves (--checkpoint) are compared more sharply"
                .to_owned(),
        );
    }
    if test.is_too_near() && comparison.paired.is_none() {
        notes.push("the blocks are nearer to each other than the noise of the halves allows: do the halves belong to one picture?".to_owned());
    }
    if non_finite.alike > 0 {
        let text = "are NaN in both pictures, or infinite with the same sign: these count as equal";
        notes.push(format!("{} channels of pixels {text}", non_finite.alike));
    }
    if comparison.left_out > 0 {
        let text = "are left out of the figures, with their blocks: they are at the end of a picture's whole numbers, or no numbers";
        notes.push(format!("{} channels of pixels {text}", comparison.left_out));
    }
}

struct Halves<'a> {
    film: &'a Film,
    scale: [f64; 2],
}

fn two_halves(film: &Film) -> Option<Halves<'_>> {
    let counts = [0, 1].map(|half| if half < film.halves().len() { film.half_sample_count(half) } else { 0 });
    let scale = counts.map(|count| 1.0 / count as f64);
    counts.iter().all(|count| *count > 0).then_some(Halves { film, scale })
}

impl Halves<'_> {
    /// Half the difference of the halves' means: its square estimates the variance of their mean.
    fn deviation(&self, pixel: usize) -> [f64; 3] {
        let mean = |half: usize| self.film.halves()[half][pixel].radiance().map(|sum| sum * self.scale[half]);
        let (a, b) = (mean(0), mean(1));
        [0, 1, 2].map(|channel| 0.5 * (a[channel] - b[channel]))
    }
}

struct Variances {
    /// Of each pixel's difference. What the pictures' noise has in common drops out.
    of_difference: Vec<[f64; 3]>,
    /// Root of the mean of both pictures' variances, added.
    of_both: f64,
    /// Deviation of the mean difference over all pixels and channels.
    of_mean: f64,
    /// What two samples of radiance 1, one in each half, bring to a pixel.
    rare: f64,
}

fn variances(a: &Halves, b: &Halves) -> Variances {
    let count = a.film.width() as usize * a.film.height() as usize;
    let (mut both, mut of_mean) = (0.0, 0.0);
    let of_difference = (0..count)
        .map(|pixel| {
            let (a, b) = (a.deviation(pixel), b.deviation(pixel));
            both += a.iter().chain(&b).map(|x| x * x).sum::<f64>();
            let deviation = [0, 1, 2].map(|channel| b[channel] - a[channel]);
            // Channels of a pixel share their noise.
            of_mean += (deviation.iter().sum::<f64>() / 3.0).powi(2);
            deviation.map(|x| x * x)
        })
        .collect();
    // As in a block, both halves may hold the same rare path.
    let pair = |film: &Film| std::f64::consts::SQRT_2 / film.sample_count() as f64;
    let rare = pair(a.film).hypot(pair(b.film));
    Variances {
        of_difference,
        of_mean: of_mean.sqrt().hypot(rare) / count as f64,
        of_both: (both / (3 * count) as f64).sqrt(),
        rare,
    }
}

fn added(a: Option<&Vec<[f64; 3]>>, b: Option<&Vec<[f64; 3]>>) -> Option<Vec<[f64; 3]>> {
    match (a, b) {
        (Some(a), Some(b)) => {
            Some(a.iter().zip(b).map(|(a, b)| [0, 1, 2].map(|i| a[i].hypot(b[i]))).collect())
        }
        (one, other) => one.or(other).cloned(),
    }
}

impl Comparison {
    /// Whether the pictures differ only by noise and rounding.
    pub fn is_equal(&self) -> bool {
        self.reasons.is_empty()
    }

    /// How many times its noise the difference is: 1 for pictures that are alike and share no random numbers. Of
    /// pixels where the noise of both is known, else of blocks.
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
    use crate::film::{PixelSum, fixed_point};
    use crate::sampling::pcg4d;

    /// Two samples a pixel: noise that depends on pixel and half, and an offset.
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
    fn noise_is_equal_and_an_offset_that_noise_hides_is_not_once_samples_are_the_same() {
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
    fn what_is_no_number_in_one_picture_alone_is_a_difference() {
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
        // Numbers that differ by their sign alone are equal, but not to the bit.
        let found = compare(&floats(0.0), &floats(-0.0), None);
        assert!(found.is_equal() && !found.is_same);
    }

    #[test]
    fn a_picture_without_a_number_is_equal_to_none() {
        let mut none = side(1, 0.0);
        (none.film, none.pixels) = (None, vec![[f64::NAN; 3]; 80 * 48]);
        let found = compare(&none, &none, None);
        assert!(!found.is_equal() && !found.is_same, "{found:?}");
    }

    #[test]
    fn the_end_of_whole_numbers_stands_for_any_larger_number() {
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
    fn what_is_beyond_whole_numbers_is_left_out_on_both_sides() {
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
        // As bright as the other can tell, or brighter: not known, and no difference.
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
    fn a_bias_is_the_second_less_the_first() {
        let (dark, bright) = (side(1, 0.0), side(1, 2e-3));
        for (first, second, sign) in [(&dark, &bright, 1.0), (&bright, &dark, -1.0)] {
            let mut sums = PairedSums::default();
            sums.add(first.film.as_ref().unwrap(), second.film.as_ref().unwrap());
            let found = compare(first, second, Some(sums.finish()));
            assert!((found.bias - sign * 2e-3).abs() < 1e-6, "{}", found.bias);
            // A path that has parted tells no bias: these films' sums, of two samples, differ by too much.
            assert_eq!(found.paired.unwrap().parted, 80 * 48);
        }
        let (dark, bright) = (side(1, 0.0), side(1, 1e-5));
        let mut sums = PairedSums::default();
        sums.add(dark.film.as_ref().unwrap(), bright.film.as_ref().unwrap());
        assert!((sums.finish().bias - 2e-5).abs() < 1e-6, "{:?}", sums.finish());
    }

    #[test]
    fn paired_samples_tell_other_paths_from_rounding() {
        let (a, b) = (side(1, 0.0), side(1, 1e-5));
        let mut sums = PairedSums::default();
        let (film_a, film_b) = (a.film.as_ref().unwrap(), b.film.as_ref().unwrap());
        sums.add(film_a, film_b);
        let found = sums.finish();
        assert_eq!((found.count, found.parted), (80 * 48, 0));
        // A film of two samples has their sum.
        assert!((found.rms - 2e-5).abs() < 1e-6, "{found:?}");
        let other = side(2, 0.0);
        sums.add(film_a, other.film.as_ref().unwrap());
        assert!(sums.finish().parted_share() > 0.4);
    }
}
