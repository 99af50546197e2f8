//! The operations that x86-64 does in one instruction.

use super::instructions::Instructions;
use fearless_simd::prelude::*;
use fearless_simd::{
    Avx2, Avx512, Sse4_2, f32x4, f32x8, f32x16, i32x4, i32x8, i32x16, kernel, mask32x4, mask32x8, u32x4,
    u32x8, u32x16,
};
use std::arch::x86_64::{
    __m128i, __m256i, _mm_cvtps_epi32, _mm256_castpd_ps, _mm256_castps_pd, _mm256_cvtps_epi32,
    _mm256_permutevar8x32_ps, _mm256_unpackhi_pd, _mm256_unpackhi_ps, _mm256_unpacklo_pd, _mm256_unpacklo_ps,
    _mm512_castpd_ps, _mm512_castps_pd, _mm512_cvtps_epi32, _mm512_permutexvar_ps, _mm512_unpackhi_pd,
    _mm512_unpackhi_ps, _mm512_unpacklo_pd, _mm512_unpacklo_ps,
};

/// Implements a method with an intrinsic.
macro_rules! by {
    ($level:ident, $method:ident($($x:ident: $from:ident),+) -> $to:ident, $value:expr) => {
        #[inline(always)]
        fn $method(self, $($x: $from<Self>),+) -> $to<Self> {
            kernel!(
                #[inline(always)]
                fn kernel(token: $level, $($x: $from<$level>),+) -> $to<$level> {
                    $value.simd_into(token)
                }
            );
            kernel(self, $($x),+)
        }
    };
}

/// Implements a transposition of 4 by 4 blocks with the level's instructions for unpacking within blocks.
macro_rules! transpose_by {
    (
        $level:ident, $method:ident, $f:ident;
        $low:ident, $high:ident, $low_pairs:ident, $high_pairs:ident, $pairs:ident, $numbers:ident
    ) => {
        #[inline(always)]
        fn $method(self, [a, b, c, d]: [$f<Self>; 4]) -> [$f<Self>; 4] {
            kernel!(
                #[inline(always)]
                fn kernel(
                    token: $level,
                    a: $f<$level>,
                    b: $f<$level>,
                    c: $f<$level>,
                    d: $f<$level>,
                ) -> [$f<$level>; 4] {
                    let (a, b, c, d) = (a.into(), b.into(), c.into(), d.into());
                    let (ab_low, ab_high) = ($pairs($low(a, b)), $pairs($high(a, b)));
                    let (cd_low, cd_high) = ($pairs($low(c, d)), $pairs($high(c, d)));
                    [
                        $numbers($low_pairs(ab_low, cd_low)).simd_into(token),
                        $numbers($high_pairs(ab_low, cd_low)).simd_into(token),
                        $numbers($low_pairs(ab_high, cd_high)).simd_into(token),
                        $numbers($high_pairs(ab_high, cd_high)).simd_into(token),
                    ]
                }
            );
            kernel(self, a, b, c, d)
        }
    };
}

impl Instructions for Sse4_2 {
    by!(Sse4_2, to_nearest_4(x: f32x4) -> i32x4, _mm_cvtps_epi32(x.into()));
    // Each lane of a mask is all ones or all zeros.
    by!(Sse4_2, ones_4(m: mask32x4) -> u32x4, __m128i::from(m));
}

impl Instructions for Avx2 {
    const ROWS_8: usize = 8;

    by!(Avx2, permute_8(column: f32x8, indices: u32x8) -> f32x8, _mm256_permutevar8x32_ps(column.into(), indices.into()));
    transpose_by! {
        Avx2, transpose_8, f32x8;
        _mm256_unpacklo_ps, _mm256_unpackhi_ps, _mm256_unpacklo_pd, _mm256_unpackhi_pd,
        _mm256_castps_pd, _mm256_castpd_ps
    }
    by!(Avx2, to_nearest_8(x: f32x8) -> i32x8, _mm256_cvtps_epi32(x.into()));
    by!(Avx2, ones_8(m: mask32x8) -> u32x8, __m256i::from(m));
}

impl Instructions for Avx512 {
    const ROWS_16: usize = 16;
    const MASKED: bool = true;

    by!(Avx512, permute_16(column: f32x16, indices: u32x16) -> f32x16, _mm512_permutexvar_ps(indices.into(), column.into()));
    transpose_by! {
        Avx512, transpose_16, f32x16;
        _mm512_unpacklo_ps, _mm512_unpackhi_ps, _mm512_unpacklo_pd, _mm512_unpackhi_pd,
        _mm512_castps_pd, _mm512_castpd_ps
    }
    by!(Avx512, to_nearest_16(x: f32x16) -> i32x16, _mm512_cvtps_epi32(x.into()));
}
