//! Operations that some levels do in one instruction and the portable code does in several.

use fearless_simd::prelude::*;
use fearless_simd::{
    f32x4, f32x8, f32x16, i32x4, i32x8, i32x16, mask32x4, mask32x8, mask32x16, u32x4, u32x8, u32x16,
};

/// The operations on rows of one width, each with a portable default.
macro_rules! of_width {
    (
        $f:ident, $u:ident, $i:ident, $m:ident;
        $rows:ident, $permute:ident, $to_nearest:ident, $ones:ident
    ) => {
        /// Rows that the permute instruction can choose among; 0 without one, which is then never called.
        const $rows: usize = 0;

        inlined! {
            /// The element of `column` that each lane's index selects.
            fn $permute(self, column: $f<Self>, _indices: $u<Self>) -> $f<Self> { column }
            /// Rounds to the nearest integer, ties to even; the result must fit.
            fn $to_nearest(self, x: $f<Self>) -> $i<Self> { x.round_ties_even().to_int() }
            /// `u32::MAX` where `m` is true, else 0.
            fn $ones(self, m: $m<Self>) -> $u<Self> {
                m.select($u::splat(self, u32::MAX), $u::splat(self, 0))
            }
        }
    };
}

/// The operations of a level.
pub trait Instructions: Simd {
    /// Whether an instruction can act on the lanes of a mask alone.
    const MASKED: bool = false;

    of_width! { f32x4, u32x4, i32x4, mask32x4; ROWS_4, permute_4, to_nearest_4, ones_4 }
    of_width! { f32x8, u32x8, i32x8, mask32x8; ROWS_8, permute_8, to_nearest_8, ones_8 }
    of_width! { f32x16, u32x16, i32x16, mask32x16; ROWS_16, permute_16, to_nearest_16, ones_16 }

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
