//! Operations that some levels do in one instruction and the portable code does in several.

use fearless_simd::prelude::*;
use fearless_simd::{
    f32x4, f32x8, f32x16, i32x4, i32x8, i32x16, mask32x4, mask32x8, mask32x16, u32x4, u32x8, u32x16,
};

/// The operations, each with a portable default. A level without a permute instruction has 0 rows, and its permute is
/// never called.
pub trait Instructions: Simd {
    /// Rows that [`Instructions::permute_4`] can choose among.
    const ROWS_4: usize = 0;
    /// Rows that [`Instructions::permute_8`] can choose among.
    const ROWS_8: usize = 0;
    /// Rows that [`Instructions::permute_16`] can choose among.
    const ROWS_16: usize = 0;
    /// Whether an instruction can act on the lanes of a mask alone.
    const MASKED: bool = false;

    /// The element of `column` that each lane's index selects.
    #[inline(always)]
    fn permute_4(self, column: f32x4<Self>, _indices: u32x4<Self>) -> f32x4<Self> {
        column
    }
    /// The element of `column` that each lane's index selects.
    #[inline(always)]
    fn permute_8(self, column: f32x8<Self>, _indices: u32x8<Self>) -> f32x8<Self> {
        column
    }
    /// The element of `column` that each lane's index selects.
    #[inline(always)]
    fn permute_16(self, column: f32x16<Self>, _indices: u32x16<Self>) -> f32x16<Self> {
        column
    }

    /// Transposes two 4 by 4 blocks: one in the lower halves of the rows, one in the upper halves.
    #[inline(always)]
    fn transpose_8(self, records: [f32x8<Self>; 4]) -> [f32x8<Self>; 4] {
        let [a, b, c, d] = records.map(|row| row.split());
        let low = transpose4([a.0, b.0, c.0, d.0]);
        let high = transpose4([a.1, b.1, c.1, d.1]);
        [0, 1, 2, 3].map(|i| low[i].combine(high[i]))
    }

    /// Transposes four 4 by 4 blocks: one in each quarter of the rows.
    #[inline(always)]
    fn transpose_16(self, records: [f32x16<Self>; 4]) -> [f32x16<Self>; 4] {
        let [a, b, c, d] = records.map(|row| row.split());
        let low = self.transpose_8([a.0, b.0, c.0, d.0]);
        let high = self.transpose_8([a.1, b.1, c.1, d.1]);
        [0, 1, 2, 3].map(|i| low[i].combine(high[i]))
    }

    /// Rounds to the nearest integer, ties to even; the result must fit.
    #[inline(always)]
    fn to_nearest_4(self, x: f32x4<Self>) -> i32x4<Self> {
        x.round_ties_even().to_int()
    }
    /// Rounds to the nearest integer, ties to even; the result must fit.
    #[inline(always)]
    fn to_nearest_8(self, x: f32x8<Self>) -> i32x8<Self> {
        x.round_ties_even().to_int()
    }
    /// Rounds to the nearest integer, ties to even; the result must fit.
    #[inline(always)]
    fn to_nearest_16(self, x: f32x16<Self>) -> i32x16<Self> {
        x.round_ties_even().to_int()
    }

    /// `u32::MAX` where `m` is true, else 0.
    #[inline(always)]
    fn ones_4(self, m: mask32x4<Self>) -> u32x4<Self> {
        m.select(u32x4::splat(self, u32::MAX), u32x4::splat(self, 0))
    }
    /// `u32::MAX` where `m` is true, else 0.
    #[inline(always)]
    fn ones_8(self, m: mask32x8<Self>) -> u32x8<Self> {
        m.select(u32x8::splat(self, u32::MAX), u32x8::splat(self, 0))
    }
    /// `u32::MAX` where `m` is true, else 0.
    #[inline(always)]
    fn ones_16(self, m: mask32x16<Self>) -> u32x16<Self> {
        m.select(u32x16::splat(self, u32::MAX), u32x16::splat(self, 0))
    }
}

#[cfg(target_arch = "aarch64")]
impl Instructions for fearless_simd::Neon {}

#[cfg(target_arch = "wasm32")]
impl Instructions for fearless_simd::WasmSimd128 {}

/// Transposes four rows of four numbers.
#[inline(always)]
pub(super) fn transpose4<S: Simd>([a, b, c, d]: [f32x4<S>; 4]) -> [f32x4<S>; 4] {
    let (ac_low, ac_high) = (a.zip_low(c), a.zip_high(c));
    let (bd_low, bd_high) = (b.zip_low(d), b.zip_high(d));
    [ac_low.zip_low(bd_low), ac_low.zip_high(bd_low), ac_high.zip_low(bd_high), ac_high.zip_high(bd_high)]
}
