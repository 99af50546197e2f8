//! One lane: scalar code in the packets' precision, and the `f64` reference.

use super::{Lanes, Wide, WideU, polynomial_sin_cos_turns};
use crate::kernel::RecordColumns;
use std::num::Wrapping;

/// One lane of `f32`. `FUSED` says whether the level has fused multiply-add; on a level without it, `f32::mul_add`
/// would call a library function.
#[derive(Clone, Copy)]
pub struct Scalar<const FUSED: bool>;

/// One lane of `f64`, for the reference.
#[derive(Clone, Copy)]
pub struct Reference;

macro_rules! scalar_lanes {
    ($real:ident, $bits:ident, $signed:ident, $fused:expr) => {
        type Real = $real;
        type F = $real;
        type U = Wrapping<u32>;
        type M = bool;
        type Key = $signed;
        const WIDTH: usize = 1;

        #[inline(always)]
        fn splat(self, x: $real) -> $real {
            x
        }
        #[inline(always)]
        fn splat_u(self, x: u32) -> Wrapping<u32> {
            Wrapping(x)
        }
        #[inline(always)]
        fn mask(self, bits: u32) -> bool {
            bits & 1 != 0
        }
        #[inline(always)]
        fn load(self, from: &Wide<$real>) -> $real {
            from.0[0]
        }
        #[inline(always)]
        fn load_u(self, from: &WideU) -> Wrapping<u32> {
            Wrapping(from.0[0])
        }
        #[inline(always)]
        fn store_u(u: Wrapping<u32>, to: &mut WideU) {
            to.0[0] = u.0;
        }
        #[inline(always)]
        fn store(f: $real, to: &mut Wide<$real>) {
            to.0[0] = f;
        }
        #[inline(always)]
        fn mul_add(a: $real, b: $real, c: $real) -> $real {
            if $fused { a.mul_add(b, c) } else { a * b + c }
        }
        #[inline(always)]
        fn neg_mul_add(a: $real, b: $real, c: $real) -> $real {
            if $fused { (-a).mul_add(b, c) } else { c - a * b }
        }
        #[inline(always)]
        fn sqrt(x: $real) -> $real {
            x.sqrt()
        }
        #[inline(always)]
        fn abs(x: $real) -> $real {
            x.abs()
        }
        #[inline(always)]
        fn copysign(size: $real, sign: $real) -> $real {
            size.copysign(sign)
        }
        #[inline(always)]
        fn min(a: $real, b: $real) -> $real {
            if a < b { a } else { b }
        }
        #[inline(always)]
        fn max(a: $real, b: $real) -> $real {
            if a > b { a } else { b }
        }
        #[inline(always)]
        fn lt(a: $real, b: $real) -> bool {
            a < b
        }
        #[inline(always)]
        fn select(m: bool, a: $real, b: $real) -> $real {
            if m { a } else { b }
        }
        #[inline(always)]
        fn is_negative(x: $real) -> bool {
            x.is_sign_negative()
        }
        #[inline(always)]
        fn select_u(m: bool, a: Wrapping<u32>, b: Wrapping<u32>) -> Wrapping<u32> {
            if m { a } else { b }
        }
        #[inline(always)]
        fn eq_u(a: Wrapping<u32>, b: Wrapping<u32>) -> bool {
            a == b
        }
        #[inline(always)]
        fn min_u(a: Wrapping<u32>, b: Wrapping<u32>) -> Wrapping<u32> {
            a.min(b)
        }
        #[inline(always)]
        fn shl(a: Wrapping<u32>, n: u32) -> Wrapping<u32> {
            Wrapping(a.0 << n)
        }
        #[inline(always)]
        fn shr(a: Wrapping<u32>, n: u32) -> Wrapping<u32> {
            Wrapping(a.0 >> n)
        }
        #[inline(always)]
        fn bits(m: bool) -> u32 {
            u32::from(m)
        }
        #[inline(always)]
        fn key(negated: $real) -> $signed {
            negated.to_bits() as $signed
        }
        #[inline(always)]
        fn from_key(k: $signed) -> $real {
            <$real>::from_bits(k as $bits)
        }
        #[inline(always)]
        fn exclude(self, m: bool, k: $signed) -> $signed {
            if m { $signed::MAX } else { k }
        }
        #[inline(always)]
        fn min_key(a: $signed, b: $signed) -> $signed {
            a.min(b)
        }
        #[inline(always)]
        fn lt_key(a: $signed, b: $signed) -> bool {
            a < b
        }
        #[inline(always)]
        fn eq_key(a: $signed, b: $signed) -> bool {
            a == b
        }
        #[inline(always)]
        fn float_of(u: Wrapping<u32>) -> $real {
            u.0 as i32 as $real
        }
        #[inline(always)]
        fn fixed_point(self, f: $real) -> Wrapping<u32> {
            Wrapping(f.round_ties_even() as i32 as u32)
        }
        #[inline(always)]
        fn gather(self, records: &[RecordColumns<$real>], indices: &WideU, group: usize) -> [$real; 4] {
            let row = &records[indices.0[0] as usize].0;
            [row[4 * group], row[4 * group + 1], row[4 * group + 2], row[4 * group + 3]]
        }
    };
}

impl<const FUSED: bool> Lanes for Scalar<FUSED> {
    scalar_lanes!(f32, u32, i32, FUSED);

    #[inline(always)]
    fn sin_cos_turns(self, u: f32) -> (f32, f32) {
        polynomial_sin_cos_turns(self, u)
    }
}

impl Lanes for Reference {
    scalar_lanes!(f64, u64, i64, false);

    #[inline(always)]
    fn sin_cos_turns(self, u: f64) -> (f64, f64) {
        (u * std::f64::consts::TAU).sin_cos()
    }
}
