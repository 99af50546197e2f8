//! One body of work at several lane counts.

use fearless_simd::{Level, Simd};
use weekender::kernel::RecordColumns;
use weekender::render_cpu::Isa;
use weekender::render_cpu::lanes::{Lanes, Lanes4, Lanes8, Lanes16, MAX_LANES, Scalar, V3};
use weekender::render_cpu::sphere::{NONE, Rays};

/// Rays, directions or draws that a body goes through: few enough for the first cache.
pub const COUNT: usize = 256;

/// A measured piece of code. It goes through [`COUNT`] items in packets and returns something that depends on all.
pub trait Body {
    /// At the width of `l`.
    fn run<L: Lanes<Real = f32>>(&self, l: L) -> u32;
}

/// Lane counts of this processor's best level.
pub fn widths() -> Vec<usize> {
    Isa::available().last().map_or_else(|| vec![1], |isa| isa.lane_counts().to_vec())
}

/// Runs a body at one of [`widths`].
pub fn run(width: usize, body: &impl Body) -> u32 {
    let level = Level::new();
    #[cfg(target_arch = "x86_64")]
    match width {
        4 if let Some(simd) = level.as_sse4_2() => at(simd, Lanes4(simd), body),
        8 if let Some(simd) = level.as_avx2() => at(simd, Lanes8(simd), body),
        16 if let Some(simd) = level.as_avx512() => at(simd, Lanes16(simd), body),
        _ => body.run(Scalar::<false>),
    }
    #[cfg(target_arch = "aarch64")]
    match width {
        4 if let Some(simd) = level.as_neon() => at(simd, Lanes4(simd), body),
        8 if let Some(simd) = level.as_neon() => at(simd, Lanes8(simd), body),
        _ => body.run(Scalar::<false>),
    }
}

/// Compiled for the instructions of `simd`.
fn at<S: Simd, L: Lanes<Real = f32>>(simd: S, lanes: L, body: &impl Body) -> u32 {
    simd.vectorize(
        #[inline(always)]
        || body.run(lanes),
    )
}

/// [`COUNT`] vectors, each with a number, laid out like the records of a prepared scene.
pub struct Vectors(Vec<RecordColumns<f32>>);

impl Vectors {
    /// Spread evenly over a cube; the numbers are within `0..1`.
    pub fn within(low: f32, high: f32) -> Self {
        let row = |u: &[f32]| {
            let mut row = RecordColumns::default();
            row.0[..4].copy_from_slice(u);
            row.0[..3].iter_mut().for_each(|x| *x = low + (high - low) * *x);
            row
        };
        Vectors(units(4 * COUNT).chunks_exact(4).map(row).collect())
    }

    /// The same with length 1.
    pub fn normalised(mut self) -> Self {
        for row in &mut self.0 {
            let length = row.0[..3].iter().map(|x| x * x).sum::<f32>().sqrt();
            row.0[..3].iter_mut().for_each(|x| *x /= length);
        }
        self
    }

    /// Those from `first` on, and their numbers.
    #[inline(always)]
    pub fn load<L: Lanes<Real = f32>>(&self, l: L, first: usize) -> (V3<L::F>, L::F) {
        let mut rows = [&self.0[first]; MAX_LANES];
        for (lane, row) in rows.iter_mut().enumerate().take(L::WIDTH) {
            *row = &self.0[first + lane];
        }
        let [x, y, z, number] = l.gather(&rows, 0);
        (V3 { x, y, z }, number)
    }
}

/// Numbers in `[0, 1)` that are the same every time.
fn units(count: usize) -> Vec<f32> {
    let mut state = 1_u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 16_777_216.0
    };
    (0..count).map(|_| next()).collect()
}

/// Rays that leave nothing.
#[inline(always)]
pub fn rays<L: Lanes<Real = f32>>(l: L, origin: V3<L::F>, direction: V3<L::F>) -> Rays<L> {
    Rays { origin, direction, left: l.splat_u(NONE), inside: l.splat_u(NONE) }
}
