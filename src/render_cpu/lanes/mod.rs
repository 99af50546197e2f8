//! Width-generic values: one source for scalar code, SIMD packets and the `f64` reference.
//!
//! A [`Lanes`] is a token for a lane count, a precision and an instruction level. Its values are rows of that many
//! numbers. Every function is `#[inline(always)]`: a function that is not inlined would be compiled without the level's
//! instructions.

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

/// The largest lane count, for buffers on the stack.
pub const MAX_LANES: usize = 16;

/// Operations on rows of numbers.
///
/// Distances are ordered by [`Lanes::key`]: the bits of `-t` are compared as signed integers. In that order positive
/// distances come first, the nearest before the others, then infinity, then NaN and distances behind the ray. Misses
/// therefore lose a search for the nearest hit without an extra test. (SSE and AVX2 can only compare signed integers.)
pub trait Lanes: Copy + Send + Sync + 'static {
    /// Precision of the numbers.
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
    /// Masks: one truth value per lane.
    type M: Copy + BitAnd<Output = Self::M> + BitOr<Output = Self::M> + Not<Output = Self::M>;
    /// The bits of a negated distance, for ordering.
    type Key: Copy;
    /// Numbers per row.
    const WIDTH: usize;

    /// The same number in every lane.
    fn splat(self, x: Self::Real) -> Self::F;
    /// The same number in every lane.
    fn splat_u(self, x: u32) -> Self::U;
    /// The same literal in every lane, rounded to the precision.
    #[inline(always)]
    fn constant(self, x: f64) -> Self::F {
        self.splat(Self::Real::from_f64(x))
    }
    /// Loads a row of numbers from memory.
    fn load(self, from: &Wide<Self::Real>) -> Self::F;
    /// A mask from the lowest bits of `bits`, lane 0 in the lowest.
    fn mask(self, bits: u32) -> Self::M;
    /// Loads the first [`Lanes::WIDTH`] numbers of a buffer.
    fn load_u(self, from: &WideU) -> Self::U;
    /// Stores to the first [`Lanes::WIDTH`] numbers of a buffer.
    fn store_u(u: Self::U, to: &mut WideU);
    /// Stores to the first [`Lanes::WIDTH`] numbers of a buffer.
    fn store(f: Self::F, to: &mut Wide<Self::Real>);

    /// `a b + c`, rounded once where the level has fused multiply-add.
    fn mul_add(a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// `a b - c`, rounded once where the level has fused multiply-add.
    #[inline(always)]
    fn mul_sub(a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        Self::mul_add(a, b, -c)
    }
    /// `c - a b`, rounded once where the level has fused multiply-add.
    fn neg_mul_add(a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// Square root; NaN for numbers below 0.
    fn sqrt(x: Self::F) -> Self::F;
    /// Absolute value.
    fn abs(x: Self::F) -> Self::F;
    /// The magnitude of `size` with the sign of `sign`.
    fn copysign(size: Self::F, sign: Self::F) -> Self::F;
    /// `if a < b { a } else { b }`.
    fn min(a: Self::F, b: Self::F) -> Self::F;
    /// `if a > b { a } else { b }`.
    fn max(a: Self::F, b: Self::F) -> Self::F;
    /// `a < b`.
    fn lt(a: Self::F, b: Self::F) -> Self::M;
    /// `a` where `m` is true, else `b`.
    fn select(m: Self::M, a: Self::F, b: Self::F) -> Self::F;

    /// Whether the sign bit is set, as it is for -0.
    fn is_negative(x: Self::F) -> Self::M;

    /// `a` where `m` is true, else `b`.
    fn select_u(m: Self::M, a: Self::U, b: Self::U) -> Self::U;
    /// `a` where `m` is true, else 0.
    #[inline(always)]
    fn keep(self, m: Self::M, a: Self::U) -> Self::U {
        Self::select_u(m, a, self.splat_u(0))
    }
    /// `u32::MAX` where `m` is true, else `a`.
    #[inline(always)]
    fn fill(self, m: Self::M, a: Self::U) -> Self::U {
        Self::select_u(m, self.splat_u(u32::MAX), a)
    }
    /// `a == b`.
    fn eq_u(a: Self::U, b: Self::U) -> Self::M;
    /// The smaller of the two.
    fn min_u(a: Self::U, b: Self::U) -> Self::U;
    /// Shifts left by `n` bits.
    fn shl(a: Self::U, n: u32) -> Self::U;
    /// Shifts right by `n` bits.
    fn shr(a: Self::U, n: u32) -> Self::U;

    /// The mask as bits, one per lane.
    fn bits(m: Self::M) -> u32;

    /// The ordering key of a negated distance, to be compared as a signed integer.
    fn key(negated: Self::F) -> Self::Key;
    /// The negated distance of a key.
    fn from_key(k: Self::Key) -> Self::F;
    /// A key that loses every comparison where `m` is true, else `k`.
    fn exclude(self, m: Self::M, k: Self::Key) -> Self::Key;
    /// The smaller key, which belongs to the nearer hit.
    fn min_key(a: Self::Key, b: Self::Key) -> Self::Key;
    /// `a < b`.
    fn lt_key(a: Self::Key, b: Self::Key) -> Self::M;
    /// `a == b`.
    fn eq_key(a: Self::Key, b: Self::Key) -> Self::M;

    /// Converts an integer below `2^31` to a float.
    fn float_of(u: Self::U) -> Self::F;
    /// Rounds a float in `0 ..= 2^31 - 128` to the nearest integer, ties to even.
    fn fixed_point(self, f: Self::F) -> Self::U;
    /// Rows that [`Lanes::permute`] can choose among; 0 if the level has no permute instruction.
    const PERMUTED_ROWS: usize = 0;
    /// The element of a column that each lane's index selects: one instruction for a table that fits a register.
    /// Indices count modulo [`Lanes::PERMUTED_ROWS`].
    #[inline(always)]
    fn permute(self, column: &Wide<Self::Real>, _indices: Self::U) -> Self::F {
        self.splat(column.0[0])
    }
    /// Loads the columns from `4 * group` on of the rows that the first [`Lanes::WIDTH`] `indices` name.
    fn gather(self, records: &[RecordColumns<Self::Real>], indices: &WideU, group: usize) -> [Self::F; 4];
    /// Sine and cosine of an angle in turns, `0 <= u < 1`.
    fn sin_cos_turns(self, u: Self::F) -> (Self::F, Self::F);
}

/// A row of numbers in memory. A packet uses as many as it has lanes, from the front.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub struct Wide<R>(pub [R; MAX_LANES]);

/// A [`Wide`] of integers.
pub type WideU = Wide<u32>;

impl<R: Copy> Wide<R> {
    /// The same number in every place.
    pub fn splat(x: R) -> Self {
        Wide([x; MAX_LANES])
    }
}

/// Converts the upper 24 bits to a float in `[0, 1)`.
#[inline(always)]
pub fn unit_float<L: Lanes>(l: L, u: L::U) -> L::F {
    L::float_of(L::shr(u, 8)) * l.constant(UNIT_FLOAT_SCALE)
}

/// Evaluates the polynomial of [`crate::sampling::sin_cos_turns`].
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
