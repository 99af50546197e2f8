//! Width-generic values: one source for scalar code, SIMD packets and the `f64` reference.
//!
//! A [`Lanes`] is a token that stands for a lane count, a precision and an instruction level. Its values are
//! rows of that many numbers. Everything is `#[inline(always)]`: a call that stays a call would run without the
//! level's instructions.

use crate::tables::{Real, Row};
use fearless_simd::prelude::*;
use fearless_simd::{
    f32x4, f32x8, f32x16, i32x4, i32x8, i32x16, mask32x4, mask32x8, mask32x16, u32x4, u32x8, u32x16,
};
use std::num::Wrapping;
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
    fn gather(self, rows: &[Row<Self::Real>], indices: &WideU, group: usize) -> [Self::F; 4];
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
    L::float_of(L::shr(u, 8)) * l.constant(1.0 / 16_777_216.0)
}

/// Three rows: a point, a direction or a colour.
#[derive(Clone, Copy)]
pub struct V3<F> {
    /// First component.
    pub x: F,
    /// Second component.
    pub y: F,
    /// Third component.
    pub z: F,
}

impl<F: Copy + Add<Output = F>> Add for V3<F> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        V3 { x: self.x + o.x, y: self.y + o.y, z: self.z + o.z }
    }
}

impl<F: Copy + Sub<Output = F>> Sub for V3<F> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        V3 { x: self.x - o.x, y: self.y - o.y, z: self.z - o.z }
    }
}

impl<F: Copy + Mul<Output = F>> V3<F> {
    /// All components times `s`.
    #[inline(always)]
    pub fn scale(self, s: F) -> Self {
        V3 { x: self.x * s, y: self.y * s, z: self.z * s }
    }

    /// Component by component.
    #[inline(always)]
    pub fn times(self, o: Self) -> Self {
        V3 { x: self.x * o.x, y: self.y * o.y, z: self.z * o.z }
    }
}

/// The same vector in every lane.
#[inline(always)]
pub fn splat3<L: Lanes>(l: L, v: [L::Real; 3]) -> V3<L::F> {
    V3 { x: l.splat(v[0]), y: l.splat(v[1]), z: l.splat(v[2]) }
}

/// A vector a lane, from memory.
#[inline(always)]
pub fn load3<L: Lanes>(l: L, v: &[Wide<L::Real>; 3]) -> V3<L::F> {
    V3 { x: l.load(&v[0]), y: l.load(&v[1]), z: l.load(&v[2]) }
}

/// Scalar product.
#[inline(always)]
pub fn dot<L: Lanes>(a: V3<L::F>, b: V3<L::F>) -> L::F {
    L::mul_add(a.x, b.x, L::mul_add(a.y, b.y, a.z * b.z))
}

/// `a s + b`.
#[inline(always)]
pub fn mul_add3<L: Lanes>(a: V3<L::F>, s: L::F, b: V3<L::F>) -> V3<L::F> {
    V3 { x: L::mul_add(a.x, s, b.x), y: L::mul_add(a.y, s, b.y), z: L::mul_add(a.z, s, b.z) }
}

/// `b - a s`.
#[inline(always)]
pub fn neg_mul_add3<L: Lanes>(a: V3<L::F>, s: L::F, b: V3<L::F>) -> V3<L::F> {
    // The factor that changes most is negated: a negated direction would be kept in registers of its own.
    V3 { x: L::neg_mul_add(s, a.x, b.x), y: L::neg_mul_add(s, a.y, b.y), z: L::neg_mul_add(s, a.z, b.z) }
}

/// Where `m`, `a`; else `b`.
#[inline(always)]
pub fn select3<L: Lanes>(m: L::M, a: V3<L::F>, b: V3<L::F>) -> V3<L::F> {
    V3 { x: L::select(m, a.x, b.x), y: L::select(m, a.y, b.y), z: L::select(m, a.z, b.z) }
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

/// One lane of `f32`. `FUSED` says whether the level it runs at has fused multiply and add; on one that has not,
/// `f32::mul_add` would be a call to a library.
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
        fn gather(self, rows: &[Row<$real>], indices: &WideU, group: usize) -> [$real; 4] {
            let row = &rows[indices.0[0] as usize].0;
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

macro_rules! simd_lanes {
    (
        $name:ident, $width:literal, $f:ident, $u:ident, $i:ident, $m:ident,
        $gather:ident, $rows:ident, $permute:ident, $to_nearest:ident, $ones:ident, $what:literal
    ) => {
        #[doc = $what]
        #[derive(Clone, Copy)]
        pub struct $name<S: Simd>(pub S);

        impl<S: Instructions> Lanes for $name<S> {
            const PERMUTED_ROWS: usize = S::$rows;

            type Real = f32;
            type F = $f<S>;
            type U = $u<S>;
            type M = $m<S>;
            type Key = $i<S>;
            const WIDTH: usize = $width;

            #[inline(always)]
            fn splat(self, x: f32) -> $f<S> {
                $f::splat(self.0, x)
            }
            #[inline(always)]
            fn splat_u(self, x: u32) -> $u<S> {
                $u::splat(self.0, x)
            }
            #[inline(always)]
            fn mask(self, bits: u32) -> $m<S> {
                $m::from_bitmask(self.0, u64::from(bits))
            }
            #[inline(always)]
            fn load(self, from: &Wide<f32>) -> $f<S> {
                $f::from_slice(self.0, &from.0[..$width])
            }
            #[inline(always)]
            fn load_u(self, from: &WideU) -> $u<S> {
                $u::from_slice(self.0, &from.0[..$width])
            }
            #[inline(always)]
            fn store_u(u: $u<S>, to: &mut WideU) {
                u.store_slice(&mut to.0[..$width]);
            }
            #[inline(always)]
            fn store(f: $f<S>, to: &mut Wide<f32>) {
                f.store_slice(&mut to.0[..$width]);
            }
            #[inline(always)]
            fn mul_add(a: $f<S>, b: $f<S>, c: $f<S>) -> $f<S> {
                a.mul_add(b, c)
            }
            #[inline(always)]
            fn neg_mul_add(a: $f<S>, b: $f<S>, c: $f<S>) -> $f<S> {
                (-a).mul_add(b, c)
            }
            #[inline(always)]
            fn sqrt(x: $f<S>) -> $f<S> {
                x.sqrt()
            }
            #[inline(always)]
            fn abs(x: $f<S>) -> $f<S> {
                x.abs()
            }
            #[inline(always)]
            fn copysign(size: $f<S>, sign: $f<S>) -> $f<S> {
                size.copysign(sign)
            }
            #[inline(always)]
            fn min(a: $f<S>, b: $f<S>) -> $f<S> {
                a.min(b)
            }
            #[inline(always)]
            fn max(a: $f<S>, b: $f<S>) -> $f<S> {
                a.max(b)
            }
            #[inline(always)]
            fn lt(a: $f<S>, b: $f<S>) -> $m<S> {
                a.simd_lt(b)
            }
            #[inline(always)]
            fn select(m: $m<S>, a: $f<S>, b: $f<S>) -> $f<S> {
                m.select(a, b)
            }
            #[inline(always)]
            fn is_negative(x: $f<S>) -> $m<S> {
                let bits: $i<S> = x.bitcast();
                bits.simd_lt(0)
            }
            #[inline(always)]
            fn select_u(m: $m<S>, a: $u<S>, b: $u<S>) -> $u<S> {
                m.select(a, b)
            }
            #[inline(always)]
            fn keep(self, m: $m<S>, a: $u<S>) -> $u<S> {
                self.0.$ones(m) & a
            }
            #[inline(always)]
            fn fill(self, m: $m<S>, a: $u<S>) -> $u<S> {
                self.0.$ones(m) | a
            }
            #[inline(always)]
            fn eq_u(a: $u<S>, b: $u<S>) -> $m<S> {
                a.simd_eq(b)
            }
            #[inline(always)]
            fn min_u(a: $u<S>, b: $u<S>) -> $u<S> {
                a.min(b)
            }
            #[inline(always)]
            fn shl(a: $u<S>, n: u32) -> $u<S> {
                a << n
            }
            #[inline(always)]
            fn shr(a: $u<S>, n: u32) -> $u<S> {
                a >> n
            }
            #[inline(always)]
            fn bits(m: $m<S>) -> u32 {
                m.to_bitmask() as u32
            }
            #[inline(always)]
            fn key(negated: $f<S>) -> $i<S> {
                negated.bitcast()
            }
            #[inline(always)]
            fn from_key(k: $i<S>) -> $f<S> {
                k.bitcast()
            }
            #[inline(always)]
            fn exclude(self, m: $m<S>, k: $i<S>) -> $i<S> {
                // -1 is a NaN's bits.
                let bits: $u<S> = k.bitcast();
                self.fill(m, bits).bitcast()
            }
            #[inline(always)]
            fn min_key(a: $i<S>, b: $i<S>) -> $i<S> {
                a.min(b)
            }
            #[inline(always)]
            fn lt_key(a: $i<S>, b: $i<S>) -> $m<S> {
                a.simd_lt(b)
            }
            #[inline(always)]
            fn eq_key(a: $i<S>, b: $i<S>) -> $m<S> {
                a.simd_eq(b)
            }
            #[inline(always)]
            fn float_of(u: $u<S>) -> $f<S> {
                let signed: $i<S> = u.bitcast();
                signed.to_float()
            }
            #[inline(always)]
            fn fixed_point(self, f: $f<S>) -> $u<S> {
                self.0.$to_nearest(f).bitcast()
            }
            #[inline(always)]
            fn permute(self, column: &Wide<f32>, indices: $u<S>) -> $f<S> {
                self.0.$permute(self.load(column), indices)
            }
            #[inline(always)]
            fn gather(self, rows: &[Row<f32>], indices: &WideU, group: usize) -> [$f<S>; 4] {
                $gather(self.0, rows, indices, 0, group)
            }
            #[inline(always)]
            fn sin_cos_turns(self, u: $f<S>) -> ($f<S>, $f<S>) {
                polynomial_sin_cos_turns(self, u)
            }
        }
    };
}

simd_lanes!(
    Lanes4,
    4,
    f32x4,
    u32x4,
    i32x4,
    mask32x4,
    gather4,
    ROWS_4,
    permute_4,
    to_nearest_4,
    ones_4,
    "Four lanes of `f32`."
);
simd_lanes!(
    Lanes8,
    8,
    f32x8,
    u32x8,
    i32x8,
    mask32x8,
    gather8,
    ROWS_8,
    permute_8,
    to_nearest_8,
    ones_8,
    "Eight lanes of `f32`."
);
simd_lanes!(
    Lanes16,
    16,
    f32x16,
    u32x16,
    i32x16,
    mask32x16,
    gather16,
    ROWS_16,
    permute_16,
    to_nearest_16,
    ones_16,
    "Sixteen lanes of `f32`."
);

/// What a level does in one instruction and the portable operations in more. A level without permutation has 0
/// rows, and is never asked for it.
pub trait Instructions: Simd {
    /// Rows for 4 lanes.
    const ROWS_4: usize = 0;
    /// Rows for 8 lanes.
    const ROWS_8: usize = 0;
    /// Rows for 16 lanes.
    const ROWS_16: usize = 0;

    /// Each lane's choice.
    #[inline(always)]
    fn permute_4(self, column: f32x4<Self>, _indices: u32x4<Self>) -> f32x4<Self> {
        column
    }
    /// Each lane's choice.
    #[inline(always)]
    fn permute_8(self, column: f32x8<Self>, _indices: u32x8<Self>) -> f32x8<Self> {
        column
    }
    /// Each lane's choice.
    #[inline(always)]
    fn permute_16(self, column: f32x16<Self>, _indices: u32x16<Self>) -> f32x16<Self> {
        column
    }

    /// Transposes four rows of four numbers in the lower half, and four in the upper.
    #[inline(always)]
    fn transpose_8(self, rows: [f32x8<Self>; 4]) -> [f32x8<Self>; 4] {
        let [a, b, c, d] = rows.map(|row| row.split());
        let low = transpose4([a.0, b.0, c.0, d.0]);
        let high = transpose4([a.1, b.1, c.1, d.1]);
        [0, 1, 2, 3].map(|i| low[i].combine(high[i]))
    }

    /// To the nearest integer, ties to even; it must fit.
    #[inline(always)]
    fn to_nearest_4(self, x: f32x4<Self>) -> i32x4<Self> {
        x.round_ties_even().to_int()
    }
    /// To the nearest integer, ties to even; it must fit.
    #[inline(always)]
    fn to_nearest_8(self, x: f32x8<Self>) -> i32x8<Self> {
        x.round_ties_even().to_int()
    }
    /// To the nearest integer, ties to even; it must fit.
    #[inline(always)]
    fn to_nearest_16(self, x: f32x16<Self>) -> i32x16<Self> {
        x.round_ties_even().to_int()
    }

    /// `u32::MAX` where `m`, else 0.
    #[inline(always)]
    fn ones_4(self, m: mask32x4<Self>) -> u32x4<Self> {
        m.select(u32x4::splat(self, u32::MAX), u32x4::splat(self, 0))
    }
    /// `u32::MAX` where `m`, else 0.
    #[inline(always)]
    fn ones_8(self, m: mask32x8<Self>) -> u32x8<Self> {
        m.select(u32x8::splat(self, u32::MAX), u32x8::splat(self, 0))
    }
    /// `u32::MAX` where `m`, else 0.
    #[inline(always)]
    fn ones_16(self, m: mask32x16<Self>) -> u32x16<Self> {
        m.select(u32x16::splat(self, u32::MAX), u32x16::splat(self, 0))
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::Instructions;
    use fearless_simd::prelude::*;
    use fearless_simd::{
        Avx2, Avx512, Sse4_2, f32x4, f32x8, f32x16, i32x4, i32x8, i32x16, kernel, mask32x4, mask32x8, u32x4,
        u32x8, u32x16,
    };
    use std::arch::x86_64::{
        __m128i, __m256i, _mm_cvtps_epi32, _mm256_castpd_ps, _mm256_castps_pd, _mm256_cvtps_epi32,
        _mm256_permutevar8x32_ps, _mm256_unpackhi_pd, _mm256_unpackhi_ps, _mm256_unpacklo_pd,
        _mm256_unpacklo_ps, _mm512_cvtps_epi32, _mm512_permutexvar_ps,
    };

    /// Implements a method by an intrinsic.
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
        // A mask's lanes are all ones or all zeros.
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

    /// Within the halves of a register.
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
}

#[cfg(target_arch = "aarch64")]
impl Instructions for fearless_simd::Neon {}

/// Four rows of four numbers, transposed.
#[inline(always)]
fn transpose4<S: Simd>([a, b, c, d]: [f32x4<S>; 4]) -> [f32x4<S>; 4] {
    let (ac_low, ac_high) = (a.zip_low(c), a.zip_high(c));
    let (bd_low, bd_high) = (b.zip_low(d), b.zip_high(d));
    [ac_low.zip_low(bd_low), ac_low.zip_high(bd_low), ac_high.zip_low(bd_high), ac_high.zip_high(bd_high)]
}

#[inline(always)]
fn gathered_row<S: Simd>(simd: S, rows: &[Row<f32>], index: u32, group: usize) -> f32x4<S> {
    f32x4::from_slice(simd, &rows[index as usize].0[4 * group..4 * group + 4])
}

/// Four columns of the rows that four indices name.
#[inline(always)]
fn gather4<S: Simd>(
    simd: S,
    rows: &[Row<f32>],
    indices: &WideU,
    first: usize,
    group: usize,
) -> [f32x4<S>; 4] {
    let a = gathered_row(simd, rows, indices.0[first], group);
    let b = gathered_row(simd, rows, indices.0[first + 1], group);
    let c = gathered_row(simd, rows, indices.0[first + 2], group);
    let d = gathered_row(simd, rows, indices.0[first + 3], group);
    transpose4([a, b, c, d])
}

#[inline(always)]
fn gather8<S: Instructions>(
    simd: S,
    rows: &[Row<f32>],
    indices: &WideU,
    first: usize,
    group: usize,
) -> [f32x8<S>; 4] {
    let a = gathered_row(simd, rows, indices.0[first], group);
    let b = gathered_row(simd, rows, indices.0[first + 1], group);
    let c = gathered_row(simd, rows, indices.0[first + 2], group);
    let d = gathered_row(simd, rows, indices.0[first + 3], group);
    let e = gathered_row(simd, rows, indices.0[first + 4], group);
    let f = gathered_row(simd, rows, indices.0[first + 5], group);
    let g = gathered_row(simd, rows, indices.0[first + 6], group);
    let h = gathered_row(simd, rows, indices.0[first + 7], group);
    simd.transpose_8([a.combine(e), b.combine(f), c.combine(g), d.combine(h)])
}

#[inline(always)]
fn gather16<S: Instructions>(
    simd: S,
    rows: &[Row<f32>],
    indices: &WideU,
    first: usize,
    group: usize,
) -> [f32x16<S>; 4] {
    let [a0, a1, a2, a3] = gather8(simd, rows, indices, first, group);
    let [b0, b1, b2, b3] = gather8(simd, rows, indices, first + 8, group);
    [a0.combine(b0), a1.combine(b1), a2.combine(b2), a3.combine(b3)]
}
