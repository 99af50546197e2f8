//! Vectors whose components are rows: points, directions and colours.

use super::{Lanes, Wide};
use std::ops::{Add, Mul, Sub};

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
    /// Multiplies every component by `s`.
    #[inline(always)]
    pub fn scale(self, s: F) -> Self {
        V3 { x: self.x * s, y: self.y * s, z: self.z * s }
    }

    /// Multiplies component by component.
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

/// Loads one vector per lane from memory.
#[inline(always)]
pub fn load3<L: Lanes>(l: L, v: &[Wide<L::Real>; 3]) -> V3<L::F> {
    V3 { x: l.load(&v[0]), y: l.load(&v[1]), z: l.load(&v[2]) }
}

/// Dot product.
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
    // Negates the factor that changes most often: a negated direction would occupy registers of its own.
    V3 { x: L::neg_mul_add(s, a.x, b.x), y: L::neg_mul_add(s, a.y, b.y), z: L::neg_mul_add(s, a.z, b.z) }
}

/// `a` where `m` is true, else `b`.
#[inline(always)]
pub fn select3<L: Lanes>(m: L::M, a: V3<L::F>, b: V3<L::F>) -> V3<L::F> {
    V3 { x: L::select(m, a.x, b.x), y: L::select(m, a.y, b.y), z: L::select(m, a.z, b.z) }
}
