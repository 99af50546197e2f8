//! Vectors whose components are rows: points, directions and colours.

use super::{Float, Lanes, Select, Wide};
use std::ops::{Add, Sub};

/// Three rows: a point, a direction or a colour.
#[derive(Clone, Copy)]
pub struct V3<F> {
    /// First component: x, or red.
    pub x: F,
    /// Second component: y, or green.
    pub y: F,
    /// Third component: z, or blue.
    pub z: F,
}

impl<F: Copy + Add<Output = F>> Add for V3<F> {
    type Output = Self;
    inlined! {
        fn add(self, o: Self) -> Self { V3 { x: self.x + o.x, y: self.y + o.y, z: self.z + o.z } }
    }
}

impl<F: Copy + Sub<Output = F>> Sub for V3<F> {
    type Output = Self;
    inlined! {
        fn sub(self, o: Self) -> Self { V3 { x: self.x - o.x, y: self.y - o.y, z: self.z - o.z } }
    }
}

impl<F: Float> V3<F> {
    inlined! {
        /// The same row in every component.
        pub fn splat(row: F) -> Self { V3 { x: row, y: row, z: row } }

        /// Multiplies every component by `s`.
        pub fn scale(self, s: F) -> Self { V3 { x: self.x * s, y: self.y * s, z: self.z * s } }

        /// Multiplies component by component.
        pub fn times(self, o: Self) -> Self { V3 { x: self.x * o.x, y: self.y * o.y, z: self.z * o.z } }

        /// Dot product.
        pub fn dot(self, o: Self) -> F { self.x.mul_add(o.x, self.y.mul_add(o.y, self.z * o.z)) }

        /// `self s + b`.
        pub fn mul_add(self, s: F, b: Self) -> Self {
            V3 { x: self.x.mul_add(s, b.x), y: self.y.mul_add(s, b.y), z: self.z.mul_add(s, b.z) }
        }

        /// `b - self s`.
        pub fn neg_mul_add(self, s: F, b: Self) -> Self {
            // Negates the factor that changes most often: a negated direction would occupy registers of its own.
            V3 { x: s.neg_mul_add(self.x, b.x), y: s.neg_mul_add(self.y, b.y), z: s.neg_mul_add(self.z, b.z) }
        }
    }

    /// The opposite vector where `m` is true, else this one.
    #[inline(always)]
    pub fn negate_where<L: Lanes<F = F>>(self, l: L, m: L::M) -> Self {
        V3 { x: l.negate_where(m, self.x), y: l.negate_where(m, self.y), z: l.negate_where(m, self.z) }
    }
}

impl<M: Copy, F: Select<M>> Select<M> for V3<F> {
    inlined! {
        fn select(m: M, a: Self, b: Self) -> Self {
            V3 { x: F::select(m, a.x, b.x), y: F::select(m, a.y, b.y), z: F::select(m, a.z, b.z) }
        }
    }
}

/// The same vector in every lane.
#[inline(always)]
pub fn splat3<L: Lanes>(l: L, v: [L::Real; 3]) -> V3<L::F> {
    V3 { x: l.splat(v[0]), y: l.splat(v[1]), z: l.splat(v[2]) }
}

/// Loads one vector per lane from memory.
#[inline(always)]
pub fn load3<L: Lanes>(l: L, v: &[Wide<L::Real>; 3]) -> V3<L::F> {
    V3 { x: l.load(&v[0]), y: l.load(&v[1]), z: l.load(&v[2]) }
}
