//! Width-generic values: one source for scalar code, SIMD packets and the `f64` reference.
//!
//! A [`Lanes`] is a token for a lane count, a precision and an instruction level. Its values are rows of that many
//! numbers. Every function is `#[inline(always)]`: a function that is not inlined would be compiled without the level's
//! instructions.

/// Declares methods that are always inlined, one per line.
macro_rules! inlined {
    ($($(#[$meta:meta])* $visible:vis fn $name:ident $arguments:tt $(-> $output:ty)? $body:block)*) => {
        $($(#[$meta])* #[inline(always)] $visible fn $name $arguments $(-> $output)? $body)*
    };
}

mod instructions;
mod scalar;
mod simd;
mod vector;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use instructions::Instructions;
pub use scalar::{Double, Reference, Scalar, Single, Word};
pub use simd::{Lanes4, Lanes8, Lanes16};
pub use vector::{V3, load3, splat3};

use crate::kernel::{Real, RecordColumns, UNIT_FLOAT_SCALE};
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};

/// The largest lane count, for buffers on the stack.
pub const MAX_LANES: usize = 16;

/// Values that a mask can choose between, lane by lane.
pub trait Select<M>: Copy {
    /// `a` where `m` is true, else `b`.
    fn select(m: M, a: Self, b: Self) -> Self;
}

/// One truth value per lane.
pub trait Mask:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + BitXor<Output = Self> + Not<Output = Self>
{
    /// The mask as bits, lane 0 in the lowest.
    fn bits(self) -> u32;
    /// `a` where the mask is true, else `b`.
    #[inline(always)]
    fn select<T: Select<Self>>(self, a: T, b: T) -> T {
        T::select(self, a, b)
    }
}

/// A row of floating-point numbers.
pub trait Float:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Select<Self::Mask>
{
    /// The result of a comparison.
    type Mask: Mask;

    /// `self b + c`, rounded once where the level has fused multiply-add.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// `self b - c`, rounded once where the level has fused multiply-add.
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        self.mul_add(b, -c)
    }
    /// `c - self b`, rounded once where the level has fused multiply-add.
    fn neg_mul_add(self, b: Self, c: Self) -> Self;
    /// Square root; NaN for numbers below 0.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// This magnitude with the sign of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// `if self < other { self } else { other }`.
    fn min(self, other: Self) -> Self;
    /// `if self > other { self } else { other }`.
    fn max(self, other: Self) -> Self;
    /// `self < other`.
    fn lt(self, other: Self) -> Self::Mask;
    /// Whether the sign bit is set, as it is for -0.
    fn is_negative(self) -> Self::Mask;
}

/// A row of 32-bit unsigned integers, wrapping.
pub trait Unsigned:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + BitXor<Output = Self>
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + Shl<u32, Output = Self>
    + Shr<u32, Output = Self>
    + Select<Self::Mask>
{
    /// The result of a comparison.
    type Mask: Mask;

    /// `self == other`.
    fn eq(self, other: Self) -> Self::Mask;
    /// The smaller of the two.
    fn min(self, other: Self) -> Self;
}

/// A row of negated distances, ordered by their bits as signed integers: see [`Lanes`].
pub trait Key: Copy + Select<Self::Mask> {
    /// The result of a comparison.
    type Mask: Mask;

    /// The smaller key, which belongs to the nearer hit.
    fn min(self, other: Self) -> Self;
    /// `self < other`.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self == other`.
    fn eq(self, other: Self) -> Self::Mask;
}

/// Whether a packet has enough lanes that several usually finish their blocks of samples at the same time.
pub const fn is_wide<L: Lanes>() -> bool {
    L::WIDTH >= 8
}

/// Whether work that only the lanes in `m` need can be skipped. With one lane, a jump costs less than needless work; with
/// several, some lane nearly always needs it, so the work is never skipped.
#[inline(always)]
pub fn is_idle<L: Lanes>(m: L::M) -> bool {
    L::WIDTH == 1 && m.bits() == 0
}

/// Rows of numbers of one width, and how they are made, loaded, stored and converted.
///
/// Distances are ordered by [`Lanes::key`]: the bits of `-t` are compared as signed integers. In that order positive
/// distances come first, the nearest before the others, then infinity, then NaN and distances behind the ray. Misses
/// therefore lose a search for the nearest hit without an extra test. (SSE and AVX2 can only compare signed integers.)
pub trait Lanes: Copy + Send + Sync + 'static {
    /// Precision of the numbers.
    type Real: Real;
    /// Floating-point numbers.
    type F: Float<Mask = Self::M>;
    /// 32-bit unsigned integers, wrapping.
    type U: Unsigned<Mask = Self::M>;
    /// Masks: one truth value per lane.
    type M: Mask;
    /// The bits of a negated distance, for ordering.
    type Key: Key<Mask = Self::M>;
    /// Numbers per row.
    const WIDTH: usize;
    /// Whether an instruction can act on the lanes of a mask alone, at no cost.
    const MASKED: bool = false;

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
    /// Spreads the first numbers of `from`, in order, over the lanes where `m` is true. The other lanes get any number.
    fn expand(self, m: Self::M, from: &[u32; MAX_LANES]) -> Self::U;
    /// Stores to the first [`Lanes::WIDTH`] numbers of a buffer.
    fn store_u(u: Self::U, to: &mut WideU);
    /// Stores to the first [`Lanes::WIDTH`] numbers of a buffer.
    fn store(f: Self::F, to: &mut Wide<Self::Real>);

    /// `a` where `m` is true, else 0.
    #[inline(always)]
    fn keep(self, m: Self::M, a: Self::U) -> Self::U {
        m.select(a, self.splat_u(0))
    }
    /// `u32::MAX` where `m` is true, else `a`.
    #[inline(always)]
    fn fill(self, m: Self::M, a: Self::U) -> Self::U {
        m.select(self.splat_u(u32::MAX), a)
    }

    /// `-f` where `m` is true, else `f`.
    fn negate_where(self, m: Self::M, f: Self::F) -> Self::F;

    /// The ordering key of a negated distance.
    fn key(negated: Self::F) -> Self::Key;
    /// The negated distance of a key.
    fn from_key(k: Self::Key) -> Self::F;
    /// 0 where `m` is true, else `k`. Keys of hits are negative, so 0 loses every comparison with them.
    fn exclude(self, m: Self::M, k: Self::Key) -> Self::Key;

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
    /// Loads the columns from `4 * group` on of the rows of the first [`Lanes::WIDTH`] lanes.
    fn gather(self, rows: &Rows<'_, Self::Real>, group: usize) -> [Self::F; 4];
    /// Sine and cosine of an angle in turns, `0 <= u < 1`.
    fn sin_cos_turns(self, u: Self::F) -> (Self::F, Self::F);
}

/// A record for each lane. A packet uses as many as it has lanes, from the front.
pub type Rows<'a, R> = [&'a RecordColumns<R>; MAX_LANES];

/// The records that `numbers` name, for each of the lanes.
///
/// # Panics
/// If a number is not below the number of records.
#[inline(always)]
pub fn rows_of<L: Lanes>(records: &[RecordColumns<L::Real>], numbers: L::U) -> Rows<'_, L::Real> {
    let mut wide = WideU::default();
    L::store_u(numbers, &mut wide);
    let mut rows = [&records[0]; MAX_LANES];
    for (row, number) in rows.iter_mut().zip(wide.0).take(L::WIDTH) {
        *row = &records[number as usize];
    }
    rows
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
    L::float_of(u >> 8) * l.constant(UNIT_FLOAT_SCALE)
}

/// Graphics APIs only guarantee their own sine to 2^-11, so CPU and GPU share this polynomial.
#[inline(always)]
fn polynomial_sin_cos_turns<L: Lanes>(l: L, u: L::F) -> (L::F, L::F) {
    let quarter = l.constant(0.25);
    let x = u - l.constant(0.5);
    let q = x.abs() - quarter;
    let sine = sine_of_quarter(l, quarter - q.abs());
    (-sine.copysign(x), sine_of_quarter(l, q))
}

#[inline(always)]
fn sine_of_quarter<L: Lanes>(l: L, x: L::F) -> L::F {
    let c = crate::kernel::sampling::sine_coefficients();
    let y = x * x;
    let p = y.mul_add(l.constant(c[4]), l.constant(c[3]));
    let p = y.mul_add(p, l.constant(c[2]));
    let p = y.mul_add(p, l.constant(c[1]));
    y.mul_add(p, l.constant(c[0])) * x
}
