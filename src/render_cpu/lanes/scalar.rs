//! One lane: scalar code in the packets' precision, and the `f64` reference.

use super::{
    Float, Key, Lanes, MAX_LANES, Mask, Rows, Select, Unsigned, Wide, WideU, polynomial_sin_cos_turns,
};
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Shl, Shr, Sub};

/// One lane of `f32`. `FUSED` says whether the level has fused multiply-add; on a level without it, `f32::mul_add`
/// would call a library function.
#[derive(Clone, Copy)]
pub struct Scalar<const FUSED: bool>;

/// One lane of `f64`, for the reference.
#[derive(Clone, Copy)]
pub struct Reference;

/// A number of [`Scalar`].
#[derive(Clone, Copy, Debug)]
pub struct Single<const FUSED: bool>(pub f32);

/// A number of [`Reference`].
#[derive(Clone, Copy, Debug)]
pub struct Double(pub f64);

macro_rules! operator {
    ($trait:ident, $method:ident, $operator:tt, $number:ty, $make:ident $(, $fused:ident)?) => {
        impl$(<const $fused: bool>)? $trait for $number {
            type Output = Self;
            inlined! {
                fn $method(self, o: Self) -> Self { $make(self.0 $operator o.0) }
            }
        }
    };
}

macro_rules! scalar_float {
    ($number:ty, $make:ident, $is_fused:expr $(, $fused:ident)?) => {
        operator!(Add, add, +, $number, $make $(, $fused)?);
        operator!(Sub, sub, -, $number, $make $(, $fused)?);
        operator!(Mul, mul, *, $number, $make $(, $fused)?);
        operator!(Div, div, /, $number, $make $(, $fused)?);

        impl$(<const $fused: bool>)? Neg for $number {
            type Output = Self;
            inlined! {
                fn neg(self) -> Self { $make(-self.0) }
            }
        }

        impl$(<const $fused: bool>)? Select<bool> for $number {
            inlined! {
                fn select(m: bool, a: Self, b: Self) -> Self { if m { a } else { b } }
            }
        }

        impl$(<const $fused: bool>)? Float for $number {
            type Mask = bool;

            inlined! {
                fn mul_add(self, b: Self, c: Self) -> Self {
                    $make(if $is_fused { self.0.mul_add(b.0, c.0) } else { self.0 * b.0 + c.0 })
                }
                fn neg_mul_add(self, b: Self, c: Self) -> Self {
                    $make(if $is_fused { (-self.0).mul_add(b.0, c.0) } else { c.0 - self.0 * b.0 })
                }
                fn sqrt(self) -> Self { $make(self.0.sqrt()) }
                fn abs(self) -> Self { $make(self.0.abs()) }
                fn copysign(self, sign: Self) -> Self { $make(self.0.copysign(sign.0)) }
                fn min(self, other: Self) -> Self { if self.0 < other.0 { self } else { other } }
                fn max(self, other: Self) -> Self { if self.0 > other.0 { self } else { other } }
                fn lt(self, other: Self) -> bool { self.0 < other.0 }
                fn is_negative(self) -> bool { self.0.is_sign_negative() }
            }
        }
    };
}

scalar_float!(Single<FUSED>, Single, FUSED, FUSED);
scalar_float!(Double, Double, false);

impl Mask for bool {
    inlined! {
        fn bits(self) -> u32 { u32::from(self) }
    }
}

/// An integer of one lane, wrapping.
#[derive(Clone, Copy, Debug)]
pub struct Word(pub u32);

macro_rules! word_operator {
    ($trait:ident, $method:ident, |$a:ident, $b:ident: $other:ty| $value:expr) => {
        impl $trait<$other> for Word {
            type Output = Self;
            inlined! {
                fn $method(self, $b: $other) -> Self { let Word($a) = self; Word($value) }
            }
        }
    };
}

word_operator!(Add, add, |a, b: Word| a.wrapping_add(b.0));
word_operator!(Sub, sub, |a, b: Word| a.wrapping_sub(b.0));
word_operator!(Mul, mul, |a, b: Word| a.wrapping_mul(b.0));
word_operator!(BitXor, bitxor, |a, b: Word| a ^ b.0);
word_operator!(BitAnd, bitand, |a, b: Word| a & b.0);
word_operator!(BitOr, bitor, |a, b: Word| a | b.0);
word_operator!(Shl, shl, |a, n: u32| a << n);
word_operator!(Shr, shr, |a, n: u32| a >> n);

impl Select<bool> for Word {
    inlined! {
        fn select(m: bool, a: Self, b: Self) -> Self { if m { a } else { b } }
    }
}

impl Unsigned for Word {
    type Mask = bool;

    inlined! {
        fn eq(self, other: Self) -> bool { self.0 == other.0 }
        fn min(self, other: Self) -> Self { Word(self.0.min(other.0)) }
    }
}

/// Rounds to the nearest integer, ties to even; any integer where the result is not within `u32`. The lowest bits of the
/// sum are the integer: two instructions, where a cast, which saturates, takes six.
#[inline(always)]
fn nearest_integer(x: f64) -> u32 {
    const UNIT_IN_THE_LAST_PLACE_IS_1: f64 = 6_755_399_441_055_744.0;
    (x + UNIT_IN_THE_LAST_PLACE_IS_1).to_bits() as u32
}

macro_rules! scalar_lanes {
    ($real:ident, $float:ty, $number:ident, $bits:ident, $signed:ident) => {
        type Real = $real;
        type F = $float;
        type U = Word;
        type M = bool;
        type Key = $signed;
        const WIDTH: usize = 1;

        inlined! {
            fn splat(self, x: $real) -> Self::F { $number(x) }
            fn splat_u(self, x: u32) -> Word { Word(x) }
            fn mask(self, bits: u32) -> bool { bits & 1 != 0 }
            fn load(self, from: &Wide<$real>) -> Self::F { $number(from.0[0]) }
            fn load_u(self, from: &WideU) -> Word { Word(from.0[0]) }
            fn expand(self, _m: bool, from: &[u32; MAX_LANES]) -> Word { Word(from[0]) }
            fn store_u(u: Word, to: &mut WideU) { to.0[0] = u.0; }
            fn store(f: Self::F, to: &mut Wide<$real>) { to.0[0] = f.0; }
            fn negate_where(self, m: bool, f: Self::F) -> Self::F { if m { -f } else { f } }
            fn key(negated: Self::F) -> $signed { negated.0.to_bits() as $signed }
            fn from_key(k: $signed) -> Self::F { $number(<$real>::from_bits(k as $bits)) }
            fn exclude(self, m: bool, k: $signed) -> $signed { if m { 0 } else { k } }
            fn float_of(u: Word) -> Self::F { $number(u.0 as i32 as $real) }
            fn fixed_point(self, f: Self::F) -> Word { Word(nearest_integer(f64::from(f.0))) }
            fn gather(self, rows: &Rows<'_, $real>, group: usize) -> [Self::F; 4] {
                [0, 1, 2, 3].map(|column| $number(rows[0].0[4 * group + column]))
            }
        }
    };
}

macro_rules! scalar_key {
    ($signed:ident) => {
        impl Select<bool> for $signed {
            inlined! {
                fn select(m: bool, a: Self, b: Self) -> Self { if m { a } else { b } }
            }
        }

        impl Key for $signed {
            type Mask = bool;

            inlined! {
                fn min(self, other: Self) -> Self { Ord::min(self, other) }
                fn lt(self, other: Self) -> bool { self < other }
                fn eq(self, other: Self) -> bool { self == other }
            }
        }
    };
}

scalar_key!(i32);
scalar_key!(i64);

impl<const FUSED: bool> Lanes for Scalar<FUSED> {
    scalar_lanes!(f32, Single<FUSED>, Single, u32, i32);

    #[inline(always)]
    fn sin_cos_turns(self, u: Single<FUSED>) -> (Single<FUSED>, Single<FUSED>) {
        polynomial_sin_cos_turns(self, u)
    }
}

impl Lanes for Reference {
    scalar_lanes!(f64, Double, Double, u64, i64);

    #[inline(always)]
    fn sin_cos_turns(self, u: Double) -> (Double, Double) {
        let (sine, cosine) = (u.0 * std::f64::consts::TAU).sin_cos();
        (Double(sine), Double(cosine))
    }
}
