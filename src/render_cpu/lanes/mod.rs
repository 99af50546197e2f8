//! Width-generic values: one source for scalar code, SIMD packets and the `f64` reference.
//!
//! A [`Lanes`] is a token that stands for a lane count, a precision and an instruction level. Its values are
//! rows of that many numbers. Everything is `#[inline(always)]`: a call that stays a call would run without the
//! level's instructions.

mod instructions;
mod scalar;
mod simd;
mod vector;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use instructions::Instructions;
pub use scalar::{Reference, Scalar};
pub use simd::{Lanes4, Lanes8, Lanes16};
pub use vector::{V3, dot, load3, mul_add3, neg_mul_add3, select3, splat3};

use crate::kernel::{Real, RecordColumns, UNIT_FLOAT_SCALE};
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

/// Largest lane count, for buffers on the stack.
pub const MAX_LANES: usize = 16;

/// Rows of numbers, and what can be done with them.
///
/// Ordering by [`Lanes::key`]: of a distance `t` the bits of `-t` are compared as signed integers, in which order
/// positive distances come first, the nearest before all, then infinity, then NaN and distances behind the ray; so
/// those lose a search for the nearest by themselves. (SSE and AVX2 compare signed integers alone.)
pub trait Lanes: Copy + Send + Sync + 'static {
    /// Precision.
    type Real: Real;
    /// Floating-point numbers.
    type F: Copy
        + Add<Output = Self::F>
        + Sub<Output = Self::F>
        + Mul<Output = Self::F>
        + Div<Output = Self::F>
        + Neg<Output = Self::F>;
    /// 32-bit unsigned integers, wrapping.
    type U: Copy
        + Add<Output = Self::U>
        + Sub<Output = Self::U>
        + Mul<Output = Self::U>
        + BitXor<Output = Self::U>
        + BitAnd<Output = Self::U>
        + BitOr<Output = Self::U>;
    /// Truth values.
    type M: Copy + BitAnd<Output = Self::M> + BitOr<Output = Self::M> + Not<Output = Self::M>;
    /// The bits of a negated distance, for ordering.
    type Key: Copy;
    /// Numbers in a row.
    const WIDTH: usize;

    /// The same number in every lane.
    fn splat(self, x: Self::Real) -> Self::F;
    /// The same number in every lane.
    fn splat_u(self, x: u32) -> Self::U;
    /// A literal in every lane.
    #[inline(always)]
    fn constant(self, x: f64) -> Self::F {
        self.splat(Self::Real::from_f64(x))
    }
    /// A row of numbers from memory.
    fn load(self, from: &Wide<Self::Real>) -> Self::F;
    /// Truth values from the lowest bits.
    fn mask(self, bits: u32) -> Self::M;
    /// The first [`Lanes::WIDTH`] numbers of a buffer.
    fn load_u(self, from: &WideU) -> Self::U;
    /// To the first [`Lanes::WIDTH`] numbers of a buffer.
    fn store_u(u: Self::U, to: &mut WideU);
    /// To the first [`Lanes::WIDTH`] numbers of a buffer.
    fn store(f: Self::F, to: &mut Wide<Self::Real>);

    /// `a b + c`, rounded once where the level can.
    fn mul_add(a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// `a b - c`, rounded once where the level can.
    #[inline(always)]
    fn mul_sub(a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        Self::mul_add(a, b, -c)
    }
    /// `c - a b`, rounded once where the level can.
    fn neg_mul_add(a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// Square root; NaN below 0.
    fn sqrt(x: Self::F) -> Self::F;
    /// Without the sign.
    fn abs(x: Self::F) -> Self::F;
    /// The size of one with the sign of another.
    fn copysign(size: Self::F, sign: Self::F) -> Self::F;
    /// `if a < b { a } else { b }`.
    fn min(a: Self::F, b: Self::F) -> Self::F;
    /// `if a > b { a } else { b }`.
    fn max(a: Self::F, b: Self::F) -> Self::F;
    /// `a < b`.
    fn lt(a: Self::F, b: Self::F) -> Self::M;
    /// Where `m`, `a`; else `b`.
    fn select(m: Self::M, a: Self::F, b: Self::F) -> Self::F;

    /// Whether the sign is a minus, also that of 0.
    fn is_negative(x: Self::F) -> Self::M;

    /// Where `m`, `a`; else `b`.
    fn select_u(m: Self::M, a: Self::U, b: Self::U) -> Self::U;
    /// Where `m`, `a`; else 0.
    #[inline(always)]
    fn keep(self, m: Self::M, a: Self::U) -> Self::U {
        Self::select_u(m, a, self.splat_u(0))
    }
    /// Where `m`, `u32::MAX`; else `a`.
    #[inline(always)]
    fn fill(self, m: Self::M, a: Self::U) -> Self::U {
        Self::select_u(m, self.splat_u(u32::MAX), a)
    }
    /// `a == b`.
    fn eq_u(a: Self::U, b: Self::U) -> Self::M;
    /// The smaller.
    fn min_u(a: Self::U, b: Self::U) -> Self::U;
    /// Left by `n` bits.
    fn shl(a: Self::U, n: u32) -> Self::U;
    /// Right by `n` bits.
    fn shr(a: Self::U, n: u32) -> Self::U;

    /// One bit a lane.
    fn bits(m: Self::M) -> u32;

    /// Of a negated distance, to compare as signed.
    fn key(negated: Self::F) -> Self::Key;
    /// The negated distance.
    fn from_key(k: Self::Key) -> Self::F;
    /// The key, or where `m` one that loses.
    fn exclude(self, m: Self::M, k: Self::Key) -> Self::Key;
    /// The smaller.
    fn min_key(a: Self::Key, b: Self::Key) -> Self::Key;
    /// `a < b`.
    fn lt_key(a: Self::Key, b: Self::Key) -> Self::M;
    /// `a == b`.
    fn eq_key(a: Self::Key, b: Self::Key) -> Self::M;

    /// An integer below `2^31` as a float.
    fn float_of(u: Self::U) -> Self::F;
    /// A float in `0 ..= 2^31 - 128` to the nearest integer, ties to even.
    fn fixed_point(self, f: Self::F) -> Self::U;
    /// Rows that [`Lanes::permute`] can choose among; 0 if it is not there.
    const PERMUTED_ROWS: usize = 0;
    /// From a column of numbers, the one that each lane's index names: one instruction for a table that fits a
    /// register. Indices count modulo [`Lanes::PERMUTED_ROWS`].
    #[inline(always)]
    fn permute(self, column: &Wide<Self::Real>, _indices: Self::U) -> Self::F {
        self.splat(column.0[0])
    }
    /// Columns `4 group ..` of the rows that the first [`Lanes::WIDTH`] `indices` name.
    fn gather(self, records: &[RecordColumns<Self::Real>], indices: &WideU, group: usize) -> [Self::F; 4];
    /// Sine and cosine of an angle in turns, `0 <= u < 1`.
    fn sin_cos_turns(self, u: Self::F) -> (Self::F, Self::F);
}

/// Numbers of one row in memory, of which a packet takes the first of its width.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub struct Wide<R>(pub [R; MAX_LANES]);

/// The same for integers.
pub type WideU = Wide<u32>;

impl<R: Copy> Wide<R> {
    /// The same number everywhere.
    pub fn splat(x: R) -> Self {
        Wide([x; MAX_LANES])
    }
}

/// A float in `[0, 1)` from the upper 24 bits.
#[inline(always)]
pub fn unit_float<L: Lanes>(l: L, u: L::U) -> L::F {
    L::float_of(L::shr(u, 8)) * l.constant(UNIT_FLOAT_SCALE)
}

/// The polynomial of [`crate::sampling::sin_cos_turns`].
#[inline(always)]
fn polynomial_sin_cos_turns<L: Lanes>(l: L, u: L::F) -> (L::F, L::F) {
    let quarter = l.constant(0.25);
    let x = u - l.constant(0.5);
    let q = L::abs(x) - quarter;
    let sine = sine_of_quarter(l, quarter - L::abs(q));
    (-L::copysign(sine, x), sine_of_quarter(l, q))
}

#[inline(always)]
fn sine_of_quarter<L: Lanes>(l: L, x: L::F) -> L::F {
    let c = crate::sampling::sine_coefficients();
    let y = x * x;
    let p = L::mul_add(y, l.constant(c[4]), l.constant(c[3]));
    let p = L::mul_add(y, p, l.constant(c[2]));
    let p = L::mul_add(y, p, l.constant(c[1]));
    L::mul_add(y, p, l.constant(c[0])) * x
}
