//! Rays against spheres. (Book 1, section 5; the forms are described in docs/numerics.md.)
//!
//! Twin: shaders/sphere.wgsl

use super::lanes::{Lanes, V3, dot, mul_add3, neg_mul_add3, splat3};
use crate::tables::AnchoredSphere;
pub use crate::tables::NONE;

/// Rays on their way. Directions have length 1.
#[derive(Clone, Copy)]
pub struct Rays<L: Lanes> {
    /// Where they start.
    pub origin: V3<L::F>,
    /// Where they go; unit vectors.
    pub direction: V3<L::F>,
    /// The sphere that they leave outwards, which they cannot meet again, or [`NONE`].
    pub left: L::U,
    /// The sphere that they enter, which they meet again at the end of a chord, or [`NONE`].
    pub inside: L::U,
}

/// The nearest hits so far.
#[derive(Clone, Copy)]
pub struct Nearest<L: Lanes> {
    /// Distance, as [`Lanes::key`].
    pub key: L::Key,
    /// Which sphere, or [`NONE`].
    pub sphere: L::U,
}

impl<L: Lanes> Nearest<L> {
    /// Nothing hit.
    #[inline(always)]
    pub fn nothing(l: L) -> Self {
        Nearest { key: L::key(l.constant(f64::INFINITY)), sphere: l.splat_u(NONE) }
    }

    /// Takes `key` where it is nearer. Of two spheres at one distance the first taken stays.
    #[inline(always)]
    pub fn take(&mut self, key: L::Key, sphere: L::U) {
        let nearest = L::min_key(self.key, key);
        self.sphere = L::select_u(L::eq_key(nearest, self.key), self.sphere, sphere);
        self.key = nearest;
    }

    /// Takes `key` where it is nearer. Of two spheres at one distance that with the smaller number stays, so
    /// that the order of the search does not show.
    #[inline(always)]
    pub fn take_in_any_order(&mut self, key: L::Key, sphere: L::U) {
        let nearest = L::min_key(self.key, key);
        let kept = L::eq_key(nearest, self.key);
        let tied = kept & L::eq_key(nearest, key);
        let winner = L::select_u(kept, self.sphere, sphere);
        self.sphere = L::select_u(tied, L::min_u(self.sphere, sphere), winner);
        self.key = nearest;
    }
}

/// Half the chord and the distance to its middle, by the perpendicular form: `l = f - (d.f) d` is the way from
/// the ray to the centre, and `sqrt(r^2 - l.l)` half the chord (NaN for a miss). The book's `h^2 - a c` cancels
/// for a sphere that is small beside its distance.
///
/// Source: Haines et al., "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems, 2019.
#[inline(always)]
fn chord<L: Lanes>(l: L, rays: &Rays<L>, sphere: &[L::Real; 4]) -> (L::F, L::F) {
    let f = splat3(l, [sphere[0], sphere[1], sphere[2]]) - rays.origin;
    let h = dot::<L>(rays.direction, f);
    let across = neg_mul_add3::<L>(rays.direction, h, f);
    let r2 = l.splat(sphere[3]);
    let d = L::neg_mul_add(across.z, across.z, r2);
    let d = L::neg_mul_add(across.y, across.y, d);
    let d = L::neg_mul_add(across.x, across.x, d);
    (h, L::sqrt(d))
}

/// Distance to a sphere that no ray is inside of.
#[inline(always)]
pub fn near_root<L: Lanes>(l: L, rays: &Rays<L>, sphere: &[L::Real; 4], number: L::U) -> L::Key {
    let (h, s) = chord(l, rays, sphere);
    let own = L::eq_u(rays.left, number);
    L::key(L::select(own, l.constant(-1.0), h - s))
}

/// Distance to a sphere from within or without.
#[inline(always)]
pub fn nearest_root<L: Lanes>(l: L, rays: &Rays<L>, sphere: &[L::Real; 4], number: L::U) -> L::Key {
    let (h, s) = chord(l, rays, sphere);
    let leaves = L::eq_u(rays.left, number);
    let enters = L::eq_u(rays.inside, number);
    let never = l.constant(-1.0);
    let near = L::select(leaves | enters, never, h - s);
    // From its own surface inwards a ray runs the chord 2h.
    let far = L::select(leaves, never, h + L::select(enters, L::abs(h), s));
    L::min_key(L::key(near), L::key(far))
}

/// Distance to a huge sphere. Everything is measured from the anchor, so that no number is as large as the
/// radius; as the curvature goes to 0 this is the distance to a plane.
#[inline(always)]
pub fn anchored_root<L: Lanes>(
    l: L,
    rays: &Rays<L>,
    sphere: &AnchoredSphere<L::Real>,
    number: L::U,
) -> L::Key {
    let d = rays.direction;
    let m = splat3(l, sphere.inward);
    let k = l.splat(sphere.curvature);
    let two = l.constant(2.0);
    let x = rays.origin - splat3(l, sphere.anchor);
    let (x_along, m_along) = (dot::<L>(x, d), dot::<L>(m, d));
    let (x_across, m_across) = (neg_mul_add3::<L>(d, x_along, x), neg_mul_add3::<L>(d, m_along, m));
    let b = L::neg_mul_add(k, x_along, m_along);
    let c = L::neg_mul_add(two, dot::<L>(x, m), k * dot::<L>(x, x));
    let bend = L::neg_mul_add(two, dot::<L>(x_across, m_across), k * dot::<L>(x_across, x_across));
    let s = L::sqrt(L::neg_mul_add(k, bend, m_along * m_along));
    let q = b + L::copysign(s, b);
    let leaves = L::eq_u(rays.left, number);
    let enters = L::eq_u(rays.inside, number);
    let never = l.constant(-1.0);
    let first = L::select(leaves | enters, never, c / q);
    let second = L::select(leaves, never, L::select(enters, b + L::abs(b), q) / k);
    L::min_key(L::key(first), L::key(second))
}

/// The book's own arithmetic with 0 as the smallest distance and no memory of the surface left: what the
/// *shadow acne* stage shows.
#[inline(always)]
pub fn acne_root<L: Lanes>(l: L, rays: &Rays<L>, sphere: &[L::Real; 4]) -> L::Key {
    let f = splat3(l, [sphere[0], sphere[1], sphere[2]]) - rays.origin;
    let a = dot::<L>(rays.direction, rays.direction);
    let h = dot::<L>(rays.direction, f);
    let c = dot::<L>(f, f) - l.splat(sphere[3]);
    let s = L::sqrt(h * h - a * c);
    let positive = |t: L::F| L::select(L::lt(l.constant(0.0), t), t, l.constant(-1.0));
    L::min_key(L::key(positive((h - s) / a)), L::key(positive((h + s) / a)))
}

/// A point on a surface.
pub struct SurfacePoint<L: Lanes> {
    /// Where, moved onto the sphere.
    pub position: V3<L::F>,
    /// Unit normal, away from the centre.
    pub outward: V3<L::F>,
}

/// The point at distance `t` on a sphere: `reference` is its centre, `curvature` the inverse of `radius`.
///
/// The point is moved onto the sphere along the normal, whose length one Newton step makes 1.
#[inline(always)]
pub fn surface_point<L: Lanes>(
    l: L,
    rays: &Rays<L>,
    t: L::F,
    center: V3<L::F>,
    curvature: L::F,
    radius: L::F,
) -> SurfacePoint<L> {
    let w = mul_add3::<L>(rays.direction, t, rays.origin - center).scale(curvature);
    let outward = w.scale(L::neg_mul_add(l.constant(0.5), dot::<L>(w, w), l.constant(1.5)));
    SurfacePoint { position: mul_add3::<L>(outward, radius, center), outward }
}

/// The same on an anchored sphere.
#[inline(always)]
pub fn anchored_surface_point<L: Lanes>(
    l: L,
    rays: &Rays<L>,
    t: L::F,
    anchor: V3<L::F>,
    inward: V3<L::F>,
    curvature: L::F,
) -> SurfacePoint<L> {
    let one = l.constant(1.0);
    let x = mul_add3::<L>(rays.direction, t, rays.origin - anchor);
    let away = x.scale(curvature) - inward;
    let length = L::sqrt(dot::<L>(away, away));
    let outward = away.scale(one / length);
    let c = L::neg_mul_add(l.constant(2.0), dot::<L>(x, inward), curvature * dot::<L>(x, x));
    let height = c / (one + length);
    SurfacePoint { position: neg_mul_add3::<L>(outward, height, x) + anchor, outward }
}
