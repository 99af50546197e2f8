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
    _mm512_cvtps_epi32, _mm512_permutexvar_ps,
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

impl Instructions for Sse4_2 {
    by!(Sse4_2, to_nearest_4(x: f32x4) -> i32x4, _mm_cvtps_epi32(x.into()));
    // Each lane of a mask is all ones or all zeros.
    by!(Sse4_2, ones_4(m: mask32x4) -> u32x4, __m128i::from(m));
}

impl Instructions for Avx2 {
    const ROWS_8: usize = 8;

    by!(Avx2, permute_8(column: f32x8, indices: u32x8) -> f32x8, _mm256_permutevar8x32_ps(column.into(), indices.into()));
    #[inline(always)]
    fn transpose_8(self, [a, b, c, d]: [f32x8<Self>; 4]) -> [f32x8<Self>; 4] {
        let (ab_low, ab_high) = (self.unpack_low(a, b), self.unpack_high(a, b));
        let (cd_low, cd_high) = (self.unpack_low(c, d), self.unpack_high(c, d));
        [
            self.pairs_low(ab_low, cd_low),
            self.pairs_high(ab_low, cd_low),
            self.pairs_low(ab_high, cd_high),
            self.pairs_high(ab_high, cd_high),
        ]
    }
    by!(Avx2, to_nearest_4(x: f32x4) -> i32x4, _mm_cvtps_epi32(x.into()));
    by!(Avx2, to_nearest_8(x: f32x8) -> i32x8, _mm256_cvtps_epi32(x.into()));
    by!(Avx2, ones_4(m: mask32x4) -> u32x4, __m128i::from(m));
    by!(Avx2, ones_8(m: mask32x8) -> u32x8, __m256i::from(m));
}

/// Unpacking within each half of a register.
trait Unpack: Sized {
    fn unpack_low(self, a: f32x8<Avx2>, b: f32x8<Avx2>) -> f32x8<Avx2>;
    fn unpack_high(self, a: f32x8<Avx2>, b: f32x8<Avx2>) -> f32x8<Avx2>;
    fn pairs_low(self, a: f32x8<Avx2>, b: f32x8<Avx2>) -> f32x8<Avx2>;
    fn pairs_high(self, a: f32x8<Avx2>, b: f32x8<Avx2>) -> f32x8<Avx2>;
}

impl Unpack for Avx2 {
    by!(Avx2, unpack_low(a: f32x8, b: f32x8) -> f32x8, _mm256_unpacklo_ps(a.into(), b.into()));
    by!(Avx2, unpack_high(a: f32x8, b: f32x8) -> f32x8, _mm256_unpackhi_ps(a.into(), b.into()));
    by!(Avx2, pairs_low(a: f32x8, b: f32x8) -> f32x8, _mm256_castpd_ps(_mm256_unpacklo_pd(
        _mm256_castps_pd(a.into()), _mm256_castps_pd(b.into()))));
    by!(Avx2, pairs_high(a: f32x8, b: f32x8) -> f32x8, _mm256_castpd_ps(_mm256_unpackhi_pd(
        _mm256_castps_pd(a.into()), _mm256_castps_pd(b.into()))));
}

impl Instructions for Avx512 {
    const ROWS_16: usize = 16;

    by!(Avx512, permute_16(column: f32x16, indices: u32x16) -> f32x16, _mm512_permutexvar_ps(indices.into(), column.into()));
    by!(Avx512, to_nearest_16(x: f32x16) -> i32x16, _mm512_cvtps_epi32(x.into()));
}
