//! The filter, tile by tile: no pixel depends on others further away than [`HALO`].

#![expect(clippy::needless_range_loop, reason = "several arrays have the same index")]

use bytemuck::Zeroable;
use std::array::from_fn;

/// Columns and rows of a tile.
pub(super) const WIDE: usize = 64;
pub(super) const HIGH: usize = 32;
/// Pixels around a tile that its own depend on.
const HALO: usize = 16;
const STRIDE: usize = WIDE + 2 * HALO;
const ROWS: usize = HIGH + 2 * HALO;

/// The variance is a mean over 13x13 pixels.
const BOX: usize = 6;
/// The pilot compares patches of 7x7 pixels at shifts of up to 1.
const PILOT: usize = 1;
const PILOT_PATCH: usize = 3;
/// The fit compares patches of 3x3 pixels of the pilot at shifts of up to 4.
const FIT: usize = 4;
const FIT_PATCH: usize = 1;
/// Columns of the tile, and of pixels that reach it by a shift.
const FIT_WIDE: usize = WIDE + 2 * FIT;
/// The pilot begins at this column and row: it is needed in the tile, and around it as far as the fit looks.
const PILOT_FIRST: usize = HALO - FIT - FIT_PATCH;
const PILOT_HIGH: usize = HIGH + 2 * (FIT + FIT_PATCH);
const PILOT_WIDE: usize = WIDE + 2 * (FIT + FIT_PATCH);
/// Columns of the pilot, and of pixels that reach it by a shift, and some more to fill vectors.
const PILOT_WEIGHTS: usize = (PILOT_WIDE + 2 * PILOT).next_multiple_of(LANES);

// The rows of a tile are even or odd like those of the picture.
const _: () = assert!(HIGH.is_multiple_of(2));
const _: () = assert!(BOX + PILOT + PILOT_PATCH + FIT + FIT_PATCH <= HALO);

/// How far two patches may differ, in standard deviations.
const PILOT_REACH: f32 = 0.9;
const FIT_REACH: f32 = 1.3;
/// Pulls the slopes of the plane to zero; pixels squared.
const RIDGE: f32 = 0.16;
/// Keeps one over the variance finite. It is far below the variance of any noise that a film can hold, so a dark picture
/// is filtered like a bright one.
const LEAST_VARIANCE: f32 = 1e-30;
/// Lanes of the sums, which stay in registers: of the pilot for all shifts, of the fit for a row of them.
const LANES: usize = 16;

/// A channel of a tile and its halo.
type Plane = [[f32; STRIDE]; ROWS];

/// Red, green, blue, the variance of their noise (mean of the channels), and one over the variance.
type Guide = [Plane; 5];
const VARIANCE: usize = 3;
const INVERSE: usize = 4;

#[inline(always)]
fn inverse(variance: f32) -> f32 {
    1.0 / (variance + LEAST_VARIANCE)
}

#[inline(always)]
fn square(x: f32) -> f32 {
    x * x
}

/// The smaller of two numbers that are not NaN: one instruction, other than `f32::min`.
#[inline(always)]
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Where a tile is.
#[derive(Clone, Copy)]
pub(super) struct Place {
    /// The column and row of its first pixel.
    pub first: [usize; 2],
    /// The size of the picture.
    pub size: [usize; 2],
}

impl Place {
    /// The pixel of the picture that is nearest to a column and row of the tile with its halo.
    #[inline(always)]
    fn nearest(self, at: [usize; 2]) -> [usize; 2] {
        from_fn(|i| (self.first[i] + at[i]).saturating_sub(HALO).min(self.size[i] - 1))
    }

    /// Whether column (0) or row (1) number `at` of the tile with its halo is in the picture.
    #[inline(always)]
    fn holds(self, axis: usize, at: usize) -> bool {
        (HALO..self.size[axis] + HALO).contains(&(self.first[axis] + at))
    }

    /// 1 in columns of the picture, 0 beside it.
    #[inline(always)]
    fn columns(self) -> [f32; STRIDE] {
        from_fn(|x| f32::from(u8::from(self.holds(0, x))))
    }
}

/// One half of a film for the filter.
pub(super) struct Half<'a> {
    /// Linear RGB, row by row from the top.
    pub pixels: &'a [[f32; 3]],
    /// What share of the mean squared difference between the halves is the variance of this half.
    pub share: f32,
}

/// What a thread needs to filter a tile.
#[derive(Clone, Copy, Zeroable)]
pub(super) struct Scratch {
    raw: [Guide; 2],
    smooth: Guide,
    /// Mean squared difference between the halves, for the even and for the odd rows.
    apart: [Plane; 2],
    weights: [[[f32; FIT_WIDE]; HIGH + FIT]; 2 * FIT + 1],
    sums: [[[f32; WIDE]; 15]; HIGH],
    pilot_weights: [[[f32; PILOT_WEIGHTS]; PILOT_HIGH + PILOT]; 4],
    /// Per half, row, channel and column.
    pub filtered: [[[[f32; WIDE]; 3]; HIGH]; 2],
}

/// Filters both halves of a tile into `scratch.filtered`. The filters of both halves share the variance. Even rows use
/// that of odd rows and odd rows that of even ones, so one filtered half knows nothing of the other's noise there.
#[inline(always)]
pub(super) fn filter(halves: &[Half; 2], place: Place, scratch: &mut Scratch) {
    for (half, raw) in halves.iter().zip(&mut scratch.raw) {
        load(half, place, raw);
    }
    difference(&scratch.raw, place, &mut scratch.apart);
    for (index, half) in halves.iter().enumerate() {
        for parity in 0..2 {
            let [_, _, _, variance, over_variance] = &mut scratch.raw[index];
            for y in 0..ROWS {
                for x in 0..STRIDE {
                    variance[y][x] = half.share * scratch.apart[parity][y][x];
                    over_variance[y][x] = inverse(variance[y][x]);
                }
            }
            pilot(place, scratch, index);
            fit(place, scratch, index, parity);
        }
    }
}

#[inline(always)]
fn load(half: &Half, place: Place, raw: &mut Guide) {
    let columns: [usize; STRIDE] = from_fn(|x| place.nearest([x, 0])[0]);
    for y in 0..ROWS {
        let line = &half.pixels[place.nearest([0, y])[1] * place.size[0]..][..place.size[0]];
        for x in 0..STRIDE {
            let pixel = line[columns[x]];
            (0..3).for_each(|c| raw[c][y][x] = pixel[c]);
        }
    }
}

/// The mean squared difference of the halves, averaged over boxes: for even rows over the odd rows of the box, and the
/// reverse.
#[inline(always)]
fn difference([a, b]: &[Guide; 2], place: Place, apart: &mut [Plane; 2]) {
    const N: usize = STRIDE - 2 * BOX;
    let mut across = [[0.0f32; N]; ROWS];
    for (y, across) in across.iter_mut().enumerate() {
        let squares: [f32; STRIDE] = from_fn(|x| (0..3).map(|c| square(a[c][y][x] - b[c][y][x])).sum());
        for shift in 0..=2 * BOX {
            (0..N).for_each(|x| across[x] += squares[x + shift]);
        }
    }
    for (parity, apart) in apart.iter_mut().enumerate() {
        for (y, apart) in apart.iter_mut().enumerate().take(ROWS - BOX).skip(BOX) {
            let (mut sums, mut count) = ([0.0f32; N], 0.0f32);
            for row in y - BOX..=y + BOX {
                if place.nearest([0, row])[1] % 2 != parity {
                    (0..N).for_each(|x| sums[x] += across[row][x]);
                    count += 1.0;
                }
            }
            let scale = 1.0 / (3.0 * (2 * BOX + 1) as f32 * f32::max(count, 1.0));
            (0..N).for_each(|x| apart[x + BOX] = sums[x] * scale);
        }
    }
}

/// The weights of pixels at a shift, by the distance of the patches around both (Rousselle, Knaus and Zwicker 2012,
/// equation 3, with one variance for all channels and `(1 - d / 8)^8` instead of `exp(-d)`). `out` has the rows from
/// `top` and the columns from `left`; `WIDER` is at least `N + 2 PATCH`. Only every `step`-th row is set, from `first` on.
#[inline(always)]
fn weights<const PATCH: usize, const N: usize, const WIDER: usize>(
    guide: &Guide,
    [left, top]: [usize; 2],
    [dx, dy]: [isize; 2],
    reach: f32,
    [first, step]: [usize; 2],
    out: &mut [[f32; N]],
) {
    let side = 2 * PATCH + 1;
    let from = left - PATCH;
    let from_q = from.wrapping_add_signed(dx);
    // The distance of each patch's rows, for the latest rows.
    let mut latest = [[0.0f32; N]; 8];
    // In the sums, distances are in units of 6 reach^2 times the larger variance.
    let scale = -0.125 / (6.0 * reach * reach * (side * side) as f32);
    for row in 0..out.len() + 2 * PATCH {
        let p = top + row - PATCH;
        let q = p.wrapping_add_signed(dy);
        let (pr, qr) = (from..from + WIDER, from_q..from_q + WIDER);
        let [a, b, c, v, over_v] = from_fn(|i| &guide[i][p][pr.clone()]);
        let [aq, bq, cq, vq, over_vq] = from_fn(|i| &guide[i][q][qr.clone()]);
        let mut distance = [0.0f32; WIDER];
        for i in 0..WIDER {
            let squares = square(a[i] - aq[i]) + square(b[i] - bq[i]) + square(c[i] - cq[i]);
            distance[i] = (squares - 6.0 * least(v[i], vq[i])) * least(over_v[i], over_vq[i]);
        }
        let sums = &mut latest[row % side];
        *sums = from_fn(|i| distance[i]);
        (1..side).for_each(|shift| (0..N).for_each(|i| sums[i] += distance[i + shift]));
        let Some(row) = row.checked_sub(2 * PATCH).filter(|row| row % step == first) else { continue };
        let mut distance = latest[0];
        latest[1..side].iter().for_each(|sums| (0..N).for_each(|i| distance[i] += sums[i]));
        for i in 0..N {
            let near = -least(-(1.0 + least(scale * distance[i], 0.0)), 0.0);
            let near_2 = near * near;
            let near_4 = near_2 * near_2;
            out[row][i] = near_4 * near_4;
        }
    }
}

/// Non-local means over few shifts: a first picture, from which the weights of the fit are made, and its variance. The
/// weight of two pixels is the same both ways, so each is computed once.
#[inline(always)]
fn pilot(place: Place, scratch: &mut Scratch, index: usize) {
    const SHIFTS: [[isize; 2]; 4] = [[1, 0], [-1, 1], [0, 1], [1, 1]];
    let Scratch { raw, smooth, pilot_weights, .. } = scratch;
    let raw = &raw[index];
    for (out, shift) in pilot_weights.iter_mut().zip(SHIFTS) {
        weights::<PILOT_PATCH, PILOT_WEIGHTS, { PILOT_WEIGHTS + 8 }>(
            raw,
            [PILOT_FIRST - PILOT, PILOT_FIRST - PILOT],
            shift,
            PILOT_REACH,
            [0, 1],
            out,
        );
    }
    let inside = place.columns();
    for row in (0..PILOT_HIGH).filter(|row| place.holds(1, PILOT_FIRST + row)) {
        let y = PILOT_FIRST + row;
        for lane in (0..PILOT_WIDE).step_by(LANES).map(|lane| lane.min(PILOT_WIDE - LANES)) {
            let x = PILOT_FIRST + lane;
            let mut s = [[0.0f32; LANES]; 5];
            let mut add = |[dx, dy]: [isize; 2], weights: &[f32; LANES]| {
                let (left, line) = (x.wrapping_add_signed(dx), y.wrapping_add_signed(dy));
                if !place.holds(1, line) {
                    return;
                }
                let inside = &inside[left..left + LANES];
                let rgb: [&[f32]; 3] = from_fn(|c| &raw[c][line][left..left + LANES]);
                for i in 0..LANES {
                    let w = weights[i] * inside[i];
                    (0..3).for_each(|c| s[c][i] += w * rgb[c][i]);
                    s[3][i] += w;
                    s[4][i] += w * w;
                }
            };
            // The weight of a pixel for itself is 1.
            add([0, 0], &[1.0; LANES]);
            for (weights, [dx, dy]) in pilot_weights.iter().zip(SHIFTS) {
                let (row, lane) = (row + PILOT, lane + PILOT);
                add([dx, dy], weights[row][lane..].first_chunk().unwrap());
                let (row, lane) = (row.wrapping_add_signed(-dy), lane.wrapping_add_signed(-dx));
                add([-dx, -dy], weights[row][lane..].first_chunk().unwrap());
            }
            for i in 0..LANES {
                let scale = 1.0 / s[3][i];
                (0..3).for_each(|c| smooth[c][y][x + i] = s[c][i] * scale);
                let variance = raw[VARIANCE][y][x + i] * s[4][i] * scale * scale;
                smooth[VARIANCE][y][x + i] = variance;
                smooth[INVERSE][y][x + i] = inverse(variance);
            }
        }
    }
    // Beside the picture, its border is repeated.
    let pilot = |axis: usize, length: usize| {
        let at = PILOT_FIRST..PILOT_FIRST + length;
        let [first, last] =
            [at.start, at.end - 1].map(|at| place.nearest([at; 2])[axis] + HALO - place.first[axis]);
        (at, first..=last)
    };
    let (columns, inner_columns) = pilot(0, PILOT_WIDE);
    let (rows, inner_rows) = pilot(1, PILOT_HIGH);
    for plane in smooth {
        for y in inner_rows.clone() {
            let (start, end) = (plane[y][*inner_columns.start()], plane[y][*inner_columns.end()]);
            plane[y][columns.start..*inner_columns.start()].fill(start);
            plane[y][*inner_columns.end()..columns.end].fill(end);
        }
        let [start, end] = [*inner_rows.start(), *inner_rows.end()].map(|y| plane[y]);
        plane[rows.start..*inner_rows.start()].fill(start);
        plane[*inner_rows.end()..rows.end].fill(end);
    }
}

/// Fits a plane to the half around each pixel of the even or odd rows, by weights from the pilot. The result is the plane's
/// value at the pixel. The weight of two pixels is the same both ways, so each is computed once.
#[inline(always)]
fn fit(place: Place, scratch: &mut Scratch, index: usize, parity: usize) {
    let Scratch { raw, smooth, weights: all, sums, filtered, .. } = scratch;
    let raw = &raw[index];
    let inside = place.columns();
    // The weight of a pixel for itself is 1.
    for (y, sums) in sums.iter_mut().enumerate().skip(parity).step_by(2) {
        *sums = [[0.0; WIDE]; 15];
        sums[0] = [1.0; WIDE];
        (0..3).for_each(|c| sums[6 + c].copy_from_slice(&raw[c][HALO + y][HALO..HALO + WIDE]));
    }
    let reach = FIT as isize;
    for dy in 0..=FIT {
        // From the pixels of all rows and columns that reach the tile by this shift.
        let shifts = if dy == 0 { 1..=reach } else { -reach..=reach };
        let all = &mut all[..shifts.clone().count()];
        for (out, dx) in all.iter_mut().zip(shifts.clone()) {
            let corner = [HALO - FIT, HALO - dy];
            let out = &mut out[..HIGH + dy];
            weights::<FIT_PATCH, FIT_WIDE, { FIT_WIDE + 8 }>(
                smooth,
                corner,
                [dx, dy as isize],
                FIT_REACH,
                // At an odd shift, one end of every second weight is in a row of the other parity.
                if dy % 2 == 0 { [parity, 2] } else { [0, 1] },
                out,
            );
        }
        for (row, sums) in sums.iter_mut().enumerate().skip(parity).step_by(2) {
            for sign in [1, -1] {
                let line = (HALO + row).wrapping_add_signed(sign * dy as isize);
                if !place.holds(1, line) {
                    continue;
                }
                // A weight is stored where its shift begins: at the pixel itself, or at the other one.
                let weights_row = if sign == 1 { row + dy } else { row };
                for lane in (0..WIDE).step_by(LANES) {
                    let mut s = [[0.0f32; LANES]; 9];
                    for (weights, dx) in all.iter().zip(shifts.clone()) {
                        let dx = sign * dx;
                        let x = dx as f32;
                        let from = (FIT + lane).wrapping_add_signed(if sign == 1 { 0 } else { dx });
                        let left = (HALO + lane).wrapping_add_signed(dx);
                        let (weights, inside) =
                            (&weights[weights_row][from..from + LANES], &inside[left..left + LANES]);
                        let [r, g, b]: [&[f32]; 3] = from_fn(|c| &raw[c][line][left..left + LANES]);
                        for i in 0..LANES {
                            let w = weights[i] * inside[i];
                            let wx = w * x;
                            s[0][i] += w;
                            s[1][i] += wx;
                            s[2][i] += wx * x;
                            s[3][i] += w * r[i];
                            s[4][i] += w * g[i];
                            s[5][i] += w * b[i];
                            s[6][i] += wx * r[i];
                            s[7][i] += wx * g[i];
                            s[8][i] += wx * b[i];
                        }
                    }
                    let y = (sign * dy as isize) as f32;
                    for i in 0..LANES {
                        let at = lane + i;
                        sums[0][at] += s[0][i];
                        sums[1][at] += s[1][i];
                        sums[2][at] += y * s[0][i];
                        sums[3][at] += s[2][i];
                        sums[4][at] += y * s[1][i];
                        sums[5][at] += y * y * s[0][i];
                        for c in 0..3 {
                            sums[6 + c][at] += s[3 + c][i];
                            sums[9 + c][at] += s[6 + c][i];
                            sums[12 + c][at] += y * s[3 + c][i];
                        }
                    }
                }
            }
        }
    }
    for (out, s) in filtered[index].iter_mut().zip(sums).skip(parity).step_by(2) {
        for i in 0..WIDE {
            let (n, x, y, xy) = (s[0][i], s[1][i], s[2][i], s[4][i]);
            let (xx, yy) = (s[3][i] + RIDGE * n, s[5][i] + RIDGE * n);
            // The first row of the inverse of [n x y; x xx xy; y xy yy].
            let cofactors = [xx * yy - xy * xy, xy * y - x * yy, x * xy - xx * y];
            let scale = 1.0 / (n * cofactors[0] + x * cofactors[1] + y * cofactors[2]);
            for c in 0..3 {
                let sum =
                    cofactors[0] * s[6 + c][i] + cofactors[1] * s[9 + c][i] + cofactors[2] * s[12 + c][i];
                out[c][i] = scale * sum;
            }
        }
    }
}
