//! Gives back what a filter has lost: texture that it took for noise, and the mean where noise is rare and strong.

use super::filter::HIGH;
use rayon::prelude::*;
use std::array::from_fn;
use std::ops::RangeInclusive;

/// Columns and rows on each side of a pixel that tell how much of the half to mix in.
const MIX: isize = 8;
/// Columns and rows on each side of a pixel over which the mean is kept.
const MEAN: isize = 16;

/// Repairs `smooth`, the filtered `own` half. `other` is the other half, whose noise is independent of it.
///
/// First, some of the half is mixed in: the share is that of a regression of the other half on what was filtered out, less
/// half a standard deviation. A row takes it from rows of the other parity, so that it does not depend on the row's own
/// noise. Then the mean of what is still missing around a pixel is added.
pub(super) fn repair(size: [usize; 2], own: &[[f32; 3]], other: &[[f32; 3]], smooth: &mut [[f32; 3]]) {
    let lost = |own: &[f32; 3], smooth: &[f32; 3]| -> [f32; 3] { from_fn(|c| own[c] - smooth[c]) };
    let fits = window_sums(size, MIX as usize, 1 - MIX..=MIX - 1, 2, |i| {
        let lost = lost(&own[i], &smooth[i]);
        let product: f32 = (0..3).map(|c| (other[i][c] - smooth[i][c]) * lost[c]).sum();
        [product, product * product, lost.iter().map(|x| x * x).sum()]
    });
    let pixels = smooth.par_iter_mut().zip(own).zip(fits);
    pixels.for_each(|((smooth, own), [product, squares, of_lost])| {
        let confirmed = product - 0.5 * squares.sqrt();
        if confirmed > 0.0 {
            let (share, lost) = (f32::min(confirmed / of_lost, 1.0), lost(own, smooth));
            (0..3).for_each(|c| smooth[c] += share * lost[c]);
        }
    });
    let missing = window_sums(size, MEAN as usize, -MEAN..=MEAN, 1, |i| {
        let [r, g, b] = lost(&own[i], &smooth[i]);
        [r, g, b, 1.0]
    });
    smooth.par_iter_mut().zip(missing).for_each(|(smooth, [r, g, b, count])| {
        [r, g, b].iter().zip(smooth).for_each(|(sum, channel)| *channel += sum / count);
    });
}

/// The sums of `value` over the columns up to `reach` from each pixel and the rows at the distances `rows`, a number
/// `step` apart, as far as they are in the picture.
pub(super) fn window_sums<const N: usize>(
    [width, height]: [usize; 2],
    reach: usize,
    rows: RangeInclusive<isize>,
    step: usize,
    value: impl Fn(usize) -> [f32; N] + Sync,
) -> Vec<[f32; N]> {
    let across = |row: usize| -> Vec<[f32; N]> {
        let mut until = vec![[0.0_f64; N]; width + 1];
        for x in 0..width {
            let value = value(row * width + x);
            until[x + 1] = from_fn(|i| until[x][i] + f64::from(value[i]));
        }
        let between = |x: usize| [x.saturating_sub(reach), (x + reach + 1).min(width)];
        let of_pixel = |x| {
            let [left, right] = between(x);
            from_fn(|i| (until[right][i] - until[left][i]) as f32)
        };
        (0..width).map(of_pixel).collect()
    };
    let mut sums = vec![[0.0; N]; width * height];
    sums.par_chunks_mut(HIGH * width).enumerate().for_each(|(band, sums)| {
        let top = band * HIGH;
        let first = top.saturating_add_signed(*rows.start());
        let end = (top + HIGH).saturating_add_signed(*rows.end()).min(height);
        let across: Vec<_> = (first..end).map(across).collect();
        for (row, sums) in sums.chunks_mut(width).enumerate() {
            for shift in rows.clone().step_by(step) {
                let near = (top + row).checked_add_signed(shift).and_then(|y| y.checked_sub(first));
                let Some(near) = near.and_then(|y| across.get(y)) else { continue };
                for (sum, near) in sums.as_flattened_mut().iter_mut().zip(near.as_flattened()) {
                    *sum += near;
                }
            }
        }
    });
    sums
}
