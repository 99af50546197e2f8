//! Packets: rows in one register, or in several where a level's registers are shorter.

use super::instructions::{Instructions, transpose4};
use super::{
    Float, Key, Lanes, MAX_LANES, Mask, Rows, Select, Unsigned, Wide, WideU, polynomial_sin_cos_turns,
};
use fearless_simd::prelude::*;
use fearless_simd::{
    f32x4, f32x8, f32x16, i32x4, i32x8, i32x16, mask32x4, mask32x8, mask32x16, u32x4, u32x8, u32x16,
};

/// Implements [`Lanes`] for rows of some width, given their types, then the names of what depends on the width.
macro_rules! simd_lanes {
    (
        $name:ident: $width:literal of $f:ident, $u:ident, $i:ident, $m:ident;
        $gather:ident, $records:ident, $permute:ident, $to_nearest:ident, $ones:ident
    ) => {
        #[doc = concat!(stringify!($width), " lanes of `f32`.")]
        #[derive(Clone, Copy)]
        pub struct $name<S: Simd>(pub S);

        impl<S: Instructions> Lanes for $name<S> {
            const PERMUTED_ROWS: usize = S::$records;
            const MASKED: bool = S::MASKED;

            type Real = f32;
            type F = $f<S>;
            type U = $u<S>;
            type M = $m<S>;
            type Key = $i<S>;
            const WIDTH: usize = $width;

            inlined! {
                fn splat(self, x: f32) -> $f<S> { $f::splat(self.0, x) }
                fn splat_u(self, x: u32) -> $u<S> { $u::splat(self.0, x) }
                fn mask(self, bits: u32) -> $m<S> { $m::from_bitmask(self.0, u64::from(bits)) }
                fn load(self, from: &Wide<f32>) -> $f<S> { $f::from_slice(self.0, &from.0[..$width]) }
                fn load_u(self, from: &WideU) -> $u<S> { $u::from_slice(self.0, &from.0[..$width]) }
                fn expand(self, m: $m<S>, from: &[u32; MAX_LANES]) -> $u<S> {
                    $u::from_slice(self.0, &from[..$width]).expand(m)
                }
                fn store_u(u: $u<S>, to: &mut WideU) { u.store_slice(&mut to.0[..$width]); }
                fn store(f: $f<S>, to: &mut Wide<f32>) { f.store_slice(&mut to.0[..$width]); }
                fn keep(self, m: $m<S>, a: $u<S>) -> $u<S> { self.0.$ones(m) & a }
                fn fill(self, m: $m<S>, a: $u<S>) -> $u<S> { self.0.$ones(m) | a }
                fn negate_where(self, m: $m<S>, f: $f<S>) -> $f<S> {
                    let bits: $u<S> = f.bitcast();
                    (bits ^ self.keep(m, self.splat_u(1 << 31))).bitcast()
                }
                fn key(negated: $f<S>) -> $i<S> { negated.bitcast() }
                fn from_key(k: $i<S>) -> $f<S> { k.bitcast() }
                fn exclude(self, m: $m<S>, k: $i<S>) -> $i<S> {
                    let bits: $u<S> = k.bitcast();
                    self.keep(!m, bits).bitcast()
                }
                fn float_of(u: $u<S>) -> $f<S> {
                    let signed: $i<S> = u.bitcast();
                    signed.to_float()
                }
                fn fixed_point(self, f: $f<S>) -> $u<S> { self.0.$to_nearest(f).bitcast() }
                fn permute(self, column: &Wide<f32>, indices: $u<S>) -> $f<S> {
                    self.0.$permute(self.load(column), indices)
                }
                fn gather(self, rows: &Rows<'_, f32>, group: usize) -> [$f<S>; 4] { $gather(self.0, rows, group) }
                fn sin_cos_turns(self, u: $f<S>) -> ($f<S>, $f<S>) { polynomial_sin_cos_turns(self, u) }
            }
        }

        impl<S: Instructions> Mask for $m<S> {
            inlined! {
                fn bits(self) -> u32 { self.to_bitmask() as u32 }
            }
        }

        select!($f by $m);
        select!($i by $m);
        select!($u by $m);

        impl<S: Instructions> Float for $f<S> {
            type Mask = $m<S>;

            inlined! {
                fn mul_add(self, b: Self, c: Self) -> Self { SimdFloat::mul_add(self, b, c) }
                fn neg_mul_add(self, b: Self, c: Self) -> Self { SimdFloat::mul_add(-self, b, c) }
                fn sqrt(self) -> Self { SimdFloat::sqrt(self) }
                fn abs(self) -> Self { SimdBase::abs(self) }
                fn copysign(self, sign: Self) -> Self { SimdFloat::copysign(self, sign) }
                fn min(self, other: Self) -> Self { SimdBase::min(self, other) }
                fn max(self, other: Self) -> Self { SimdBase::max(self, other) }
                fn lt(self, other: Self) -> $m<S> { self.simd_lt(other) }
                fn is_negative(self) -> $m<S> {
                    let bits: $i<S> = self.bitcast();
                    bits.simd_lt(0)
                }
            }
        }

        impl<S: Instructions> Unsigned for $u<S> {
            type Mask = $m<S>;

            inlined! {
                fn eq(self, other: Self) -> $m<S> { self.simd_eq(other) }
                fn min(self, other: Self) -> Self { SimdBase::min(self, other) }
            }
        }

        impl<S: Instructions> Key for $i<S> {
            type Mask = $m<S>;

            inlined! {
                fn min(self, other: Self) -> Self { SimdBase::min(self, other) }
                fn lt(self, other: Self) -> $m<S> { self.simd_lt(other) }
                fn eq(self, other: Self) -> $m<S> { self.simd_eq(other) }
            }
        }
    };
}

macro_rules! select {
    ($row:ident by $mask:ident) => {
        impl<S: Instructions> Select<$mask<S>> for $row<S> {
            inlined! {
                fn select(m: $mask<S>, a: Self, b: Self) -> Self { fearless_simd::Select::select(m, a, b) }
            }
        }
    };
}

simd_lanes! {
    Lanes4: 4 of f32x4, u32x4, i32x4, mask32x4;
    gather4, ROWS_4, permute_4, to_nearest_4, ones_4
}
simd_lanes! {
    Lanes8: 8 of f32x8, u32x8, i32x8, mask32x8;
    gather8, ROWS_8, permute_8, to_nearest_8, ones_8
}
simd_lanes! {
    Lanes16: 16 of f32x16, u32x16, i32x16, mask32x16;
    gather16, ROWS_16, permute_16, to_nearest_16, ones_16
}

/// Four columns of a lane's row, from column `4 * group` on.
#[inline(always)]
fn columns<S: Simd>(simd: S, rows: &Rows<'_, f32>, lane: usize, group: usize) -> f32x4<S> {
    f32x4::from_slice(simd, &rows[lane].0[4 * group..4 * group + 4])
}

/// The columns of two lanes, the second four lanes after the first.
#[inline(always)]
fn two_columns<S: Simd>(simd: S, rows: &Rows<'_, f32>, lane: usize, group: usize) -> f32x8<S> {
    columns(simd, rows, lane, group).combine(columns(simd, rows, lane + 4, group))
}

/// The columns of four lanes, each four lanes after the one before.
#[inline(always)]
fn four_columns<S: Simd>(simd: S, rows: &Rows<'_, f32>, lane: usize, group: usize) -> f32x16<S> {
    two_columns(simd, rows, lane, group).combine(two_columns(simd, rows, lane + 8, group))
}

#[inline(always)]
fn gather4<S: Simd>(simd: S, rows: &Rows<'_, f32>, group: usize) -> [f32x4<S>; 4] {
    transpose4([
        columns(simd, rows, 0, group),
        columns(simd, rows, 1, group),
        columns(simd, rows, 2, group),
        columns(simd, rows, 3, group),
    ])
}

#[inline(always)]
fn gather8<S: Instructions>(simd: S, rows: &Rows<'_, f32>, group: usize) -> [f32x8<S>; 4] {
    simd.transpose_8([
        two_columns(simd, rows, 0, group),
        two_columns(simd, rows, 1, group),
        two_columns(simd, rows, 2, group),
        two_columns(simd, rows, 3, group),
    ])
}

#[inline(always)]
fn gather16<S: Instructions>(simd: S, rows: &Rows<'_, f32>, group: usize) -> [f32x16<S>; 4] {
    simd.transpose_16([
        four_columns(simd, rows, 0, group),
        four_columns(simd, rows, 1, group),
        four_columns(simd, rows, 2, group),
        four_columns(simd, rows, 3, group),
    ])
}
