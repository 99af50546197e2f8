//! Channels that are NaN or infinite, and what makes them equal or different.

use super::side::Side;
use serde::Serialize;

/// Channels that are NaN or infinite in a picture of floats.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct NonFinite {
    /// Pixels with a differing channel; see `differing`.
    pub differing_pixels: usize,
    /// Channels that are finite in only one picture, or NaN in one and infinite in the other, or infinite with
    /// different signs. These are differences.
    pub differing: usize,
    /// Column and row of the first differing pixel.
    pub first: Option<[u32; 2]>,
    /// Channels that are NaN in both pictures, or infinite with the same sign. These are equal, and left out of all
    /// means.
    pub alike: usize,
}

impl NonFinite {
    /// Counts the channels of two pictures of one size.
    pub(super) fn of(a: &Side, b: &Side) -> Self {
        let mut found = NonFinite::default();
        for pixel in 0..a.pixels.len() {
            let [differing, alike] = count_channels(a, b, pixel);
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

/// How two values of a channel relate.
enum Relation {
    /// Both are finite, or one is in a range that the other picture cannot represent.
    Comparable,
    /// Both are NaN, or infinite with the same sign.
    Alike,
    Differing,
}

/// `None` is the largest value of an integer format. It stands for any value at least as large, including infinity.
fn relation(a: Option<f64>, b: Option<f64>) -> Relation {
    match (a, b) {
        (Some(a), Some(b)) if a.is_finite() && b.is_finite() => Relation::Comparable,
        (Some(a), Some(b)) if a == b || (a.is_nan() && b.is_nan()) => Relation::Alike,
        (Some(_), Some(_)) => Relation::Differing,
        (None, None) => Relation::Comparable,
        (Some(one), None) | (None, Some(one)) if one.is_nan() || one == f64::NEG_INFINITY => {
            Relation::Differing
        }
        _ => Relation::Comparable,
    }
}

/// The number of a pixel's channels that differ in kind, and the number that are alike but not finite.
fn count_channels(a: &Side, b: &Side, pixel: usize) -> [usize; 2] {
    let known = |side: &Side, value: f64| (side.steps.is_none() || !value.is_nan()).then_some(value);
    let mut counts = [0; 2];
    for (mine, theirs) in a.pixels[pixel].iter().zip(&b.pixels[pixel]) {
        match relation(known(a, *mine), known(b, *theirs)) {
            Relation::Comparable => {}
            Relation::Differing => counts[0] += 1,
            Relation::Alike => counts[1] += 1,
        }
    }
    counts
}

/// Whether a pixel has a channel that counts as [`NonFinite::differing`].
pub(super) fn differs_in_kind(a: &Side, b: &Side, pixel: usize) -> bool {
    count_channels(a, b, pixel)[0] > 0
}
