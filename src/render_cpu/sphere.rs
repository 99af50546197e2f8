//! Ray-sphere intersection. (Book 1, section 5; docs/numerics.md describes the formulas.)
//!
//! Twin: shaders/sphere.wgsl

use super::lanes::{Float, Key, Lanes, Mask, Unsigned, V3, Wide, WideU, is_idle, load3, splat3};
use crate::kernel::{AnchoredSphere, Real, Roots};
pub use crate::kernel::{EYE, NONE};

/// Rays being traced. Directions have length 1.
#[derive(Clone, Copy)]
pub struct Rays<L: Lanes> {
    /// Ray origins.
    pub origin: V3<L::F>,
    /// Unit directions.
    pub direction: V3<L::F>,
    /// The sphere that the ray leaves outwards and cannot meet again, or [`NONE`]; [`EYE`] for rays that start at an
    /// eye on a surface.
    pub left: L::U,
    /// The sphere that the ray enters and meets again at the end of a chord, or [`NONE`].
    pub inside: L::U,
}

/// One sphere per lane, in the form that the root functions need.
#[derive(Clone, Copy)]
pub struct Spheres<L: Lanes> {
    /// Centre.
    pub center: V3<L::F>,
    /// Squared radius.
    pub radius2: L::F,
    /// The sphere's number.
    pub number: L::U,
}

impl<L: Lanes> Spheres<L> {
    /// Broadcasts one sphere, given as centre and squared radius, to all lanes.
    #[inline(always)]
    pub fn splat(l: L, [x, y, z, radius2]: [L::Real; 4], number: L::U) -> Self {
        Spheres { center: splat3(l, [x, y, z]), radius2: l.splat(radius2), number }
    }

    /// Loads a broadcast sphere. An instruction can use it as a memory operand, without a separate broadcast.
    #[inline(always)]
    pub fn load(l: L, sphere: &BroadcastSphere<L::Real>) -> Self {
        Spheres {
            center: load3(l, &sphere.center),
            radius2: l.load(&sphere.radius2),
            number: l.load_u(&sphere.number),
        }
    }
}

/// A sphere broadcast in memory, with one copy per lane.
#[derive(Clone, Copy, Debug)]
pub struct BroadcastSphere<R> {
    center: [Wide<R>; 3],
    radius2: Wide<R>,
    number: Wide<u32>,
}

impl<R: Copy> BroadcastSphere<R> {
    /// Broadcasts centre and squared radius.
    pub fn new([x, y, z, radius2]: [R; 4], number: u32) -> Self {
        BroadcastSphere {
            center: [x, y, z].map(Wide::splat),
            radius2: Wide::splat(radius2),
            number: Wide::splat(number),
        }
    }
}

/// The distance to a sphere; some lanes may miss it.
#[derive(Clone, Copy)]
pub struct Candidate<L: Lanes> {
    /// Distance, encoded as [`Lanes::key`].
    key: L::Key,
    /// Lanes whose ray leaves the sphere and cannot meet it again.
    excluded: L::M,
}

impl<L: Lanes> Candidate<L> {
    /// The distance, encoded as [`Lanes::key`], or 0, which stands for a miss, where the ray leaves the sphere.
    #[inline(always)]
    pub fn key(self, l: L) -> L::Key {
        l.exclude(self.excluded, self.key)
    }
}

/// The nearest hits found so far.
#[derive(Clone, Copy)]
pub struct Nearest<L: Lanes> {
    /// Distance, encoded as [`Lanes::key`].
    pub key: L::Key,
    /// The sphere's number, or [`NONE`].
    pub sphere: L::U,
}

impl<L: Lanes> Nearest<L> {
    /// The state before the search: no hits.
    #[inline(always)]
    pub fn nothing(l: L) -> Self {
        Nearest { key: L::key(l.constant(f64::NEG_INFINITY)), sphere: l.splat_u(NONE) }
    }

    /// Takes `candidate` where it is nearer. Of two spheres at the same distance, the one taken first stays.
    #[inline(always)]
    pub fn take(&mut self, l: L, candidate: Candidate<L>, sphere: L::U) {
        if L::MASKED {
            let allowed = !candidate.excluded;
            let is_nearer = candidate.key.lt(self.key) & allowed;
            self.sphere = is_nearer.select(sphere, self.sphere);
            self.key = allowed.select(candidate.key.min(self.key), self.key);
        } else {
            let key = candidate.key(l);
            self.sphere = key.lt(self.key).select(sphere, self.sphere);
            self.key = self.key.min(key);
        }
    }

    /// Takes `candidate` where it is nearer, for searches in any order: of two spheres at the same distance, the one of
    /// lower rank stays. `ranks` holds the ranks of the spheres from number 0 on. Results matter only for `active` lanes.
    #[inline(always)]
    pub fn take_in_any_order(
        &mut self,
        l: L,
        candidate: Candidate<L>,
        sphere: u32,
        ranks: &[u32],
        active: L::M,
    ) {
        let tied = (candidate.key.eq(self.key) & active & !candidate.excluded).bits();
        self.take(l, candidate, l.splat_u(sphere));
        if tied != 0 {
            self.settle(l, tied, sphere, ranks);
        }
    }

    /// Gives the lanes `tied` the sphere of lower rank. Ties are rare.
    #[inline(always)]
    fn settle(&mut self, l: L, tied: u32, sphere: u32, ranks: &[u32]) {
        let mut held = WideU::default();
        L::store_u(self.sphere, &mut held);
        for (lane, number) in held.0.iter_mut().enumerate().take(L::WIDTH) {
            let rank = |number: u32| ranks.get(number as usize);
            // Spheres without a rank come last in the list.
            let comes_first = rank(*number).is_none_or(|held| rank(sphere).is_some_and(|rank| rank < held));
            if tied >> lane & 1 != 0 && *number != NONE && comes_first {
                *number = sphere;
            }
        }
        self.sphere = l.load_u(&held);
    }

    /// Distances of the hits; infinity where there is none.
    #[inline(always)]
    pub fn distance(&self) -> L::F {
        -L::from_key(self.key)
    }
}

/// Computes the negated distance to the middle of the chord, and half the chord's length (NaN for a miss), by the
/// perpendicular form: with `g = o - C`, the vector from the centre to the ray is `l = g - (d.g) d`, and half the chord
/// is `sqrt(r^2 - l.l)`. The book's `h^2 - a c` suffers cancellation for a sphere that is small relative to its
/// distance.
///
/// Source: Haines et al., "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems, 2019.
#[inline(always)]
fn chord<L: Lanes>(l: L, rays: &Rays<L>, sphere: &Spheres<L>) -> (L::F, L::F) {
    let g = rays.origin - sphere.center;
    let h = rays.direction.dot(g);
    let across = rays.direction.neg_mul_add(h, g);
    let d = across.z.neg_mul_add(across.z, sphere.radius2);
    let d = across.y.neg_mul_add(across.y, d);
    let d = across.x.neg_mul_add(across.x, d);
    let s = if is_idle::<L>(!d.is_negative()) { l.constant(f64::NAN) } else { d.sqrt() };
    (h, s)
}

/// Distance to a sphere that no ray is inside of.
#[inline(always)]
pub fn near_root<L: Lanes>(l: L, rays: &Rays<L>, sphere: &Spheres<L>) -> Candidate<L> {
    near_end(rays, sphere.number, chord(l, rays, sphere))
}

/// Distance to a sphere from inside or outside.
#[inline(always)]
pub fn nearest_root<L: Lanes>(l: L, rays: &Rays<L>, sphere: &Spheres<L>) -> Candidate<L> {
    nearest_end(rays, sphere.number, chord(l, rays, sphere))
}

/// Whether only the nearer root of a sphere of a hierarchy counts: its squared radius is negative.
#[inline(always)]
fn has_one_root<R: Real>(sphere: &[R; 4]) -> bool {
    sphere[3] < R::default()
}

/// Distance to a sphere of a hierarchy, given as centre and squared radius. Of two spheres at the same place, a ray that
/// leaves one must not meet the far side of the other.
#[inline(always)]
pub fn signed_root<L: Lanes>(l: L, rays: &Rays<L>, sphere: &[L::Real; 4], number: L::U) -> Candidate<L> {
    let signed = Spheres::splat(l, *sphere, number);
    // What both kinds share comes before the jump, so that the broadcasts are memory operands.
    let chord = chord(l, rays, &Spheres { radius2: signed.radius2.abs(), ..signed });
    if has_one_root(sphere) { near_end(rays, number, chord) } else { nearest_end(rays, number, chord) }
}

/// Distance to the nearer end of a [`chord`].
#[inline(always)]
fn near_end<L: Lanes>(rays: &Rays<L>, number: L::U, (h, s): (L::F, L::F)) -> Candidate<L> {
    Candidate { key: L::key(h + s), excluded: rays.left.eq(number) }
}

/// Distance to the nearest end of a [`chord`] in front of the ray.
#[inline(always)]
fn nearest_end<L: Lanes>(rays: &Rays<L>, number: L::U, (h, s): (L::F, L::F)) -> Candidate<L> {
    // A ray that enters the sphere from its surface travels the chord 2h. For it, h + s is not negative and hence a miss.
    let s = rays.inside.eq(number).select(h.abs(), s);
    // The negation comes last, so that a chord of length 0 is a hit at -0.
    let (near, far) = (L::key(h + s), L::key(-(s - h)));
    Candidate { key: near.min(far), excluded: rays.left.eq(number) }
}

/// Distance to an anchored sphere. Everything is measured from the anchor, so no number is as large as the radius. As
/// the curvature goes to 0, this becomes the distance to a plane.
#[inline(always)]
pub fn anchored_root<L: Lanes>(
    l: L,
    rays: &Rays<L>,
    sphere: &AnchoredSphere<L::Real>,
    number: L::U,
) -> Candidate<L> {
    let d = rays.direction;
    let m = splat3(l, sphere.inward);
    let k = l.splat(sphere.curvature);
    let two = l.constant(2.0);
    let x = rays.origin - splat3(l, sphere.anchor);
    let (x_along, m_along) = (x.dot(d), m.dot(d));
    let (x_across, m_across) = (d.neg_mul_add(x_along, x), d.neg_mul_add(m_along, m));
    let b = k.neg_mul_add(x_along, m_along);
    let c = two.neg_mul_add(x.dot(m), k * x.dot(x));
    let bend = two.neg_mul_add(x_across.dot(m_across), k * x_across.dot(x_across));
    let zero = l.constant(0.0);
    let discriminant = k.neg_mul_add(bend, m_along * m_along);
    let mut leaves = rays.left.eq(number);
    let enters = rays.inside.eq(number);
    if sphere.is_under_eye() {
        leaves = leaves | (rays.left.eq(l.splat_u(EYE)) & m_along.lt(zero));
    }
    // A ray that enters the sphere from its surface travels the chord 2b.
    let own_chord = (b + b.abs()) / k;
    match sphere.roots() {
        Roots::Nearer => {
            let q = b + discriminant.sqrt().copysign(b);
            Candidate { key: L::key(-(c.max(zero) / q)), excluded: leaves }
        }
        Roots::Both => {
            let q = b + discriminant.sqrt().copysign(b);
            let first = l.exclude(enters, L::key(-(c / q)));
            let second = L::key(-enters.select(own_chord, q / k));
            Candidate { key: first.min(second), excluded: leaves }
        }
        Roots::Farther => {
            let q = b + discriminant.max(zero).sqrt().copysign(b);
            let farther = (c / q).max(q / k).max(zero);
            Candidate { key: L::key(-enters.select(own_chord, farther)), excluded: l.mask(0) }
        }
    }
}

/// The book's own quadratic, which does not track the surface that a ray leaves: the nearer root beyond `t_min`.
/// (Sections 5.1, 6.2 and 9.3.)
#[inline(always)]
pub fn book_root<L: Lanes>(l: L, rays: &Rays<L>, sphere: &Spheres<L>, t_min: L::F) -> Candidate<L> {
    let f = sphere.center - rays.origin;
    let a = rays.direction.dot(rays.direction);
    let h = rays.direction.dot(f);
    let c = f.dot(f) - sphere.radius2;
    let s = (h * h - a * c).sqrt();
    let beyond = |t: L::F| L::key(-t_min.lt(t).select(t, l.constant(-1.0)));
    Candidate { key: beyond((h - s) / a).min(beyond((h + s) / a)), excluded: l.mask(0) }
}

/// A point on a surface.
pub struct SurfacePoint<L: Lanes> {
    /// The position, moved onto the sphere.
    pub position: V3<L::F>,
    /// Unit normal, pointing away from the centre.
    pub outward: V3<L::F>,
}

/// The point at distance `t` on a sphere with centre `center`; `curvature` is the inverse of `radius`.
///
/// The point is moved onto the sphere along the normal, which one Newton step normalises.
#[inline(always)]
pub fn surface_point<L: Lanes>(
    l: L,
    rays: &Rays<L>,
    t: L::F,
    center: V3<L::F>,
    curvature: L::F,
    radius: L::F,
) -> SurfacePoint<L> {
    let w = rays.direction.mul_add(t, rays.origin - center).scale(curvature);
    let outward = w.scale(l.constant(0.5).neg_mul_add(w.dot(w), l.constant(1.5)));
    SurfacePoint { position: outward.mul_add(radius, center), outward }
}

/// Like [`surface_point`], with the book's own arithmetic: rounding may leave the point off the surface. (Section 6.2.)
#[inline(always)]
pub fn book_point<L: Lanes>(rays: &Rays<L>, t: L::F, center: V3<L::F>, curvature: L::F) -> SurfacePoint<L> {
    let position = rays.direction.mul_add(t, rays.origin);
    SurfacePoint { position, outward: (position - center).scale(curvature) }
}

/// Like [`surface_point`], for a sphere so far away that the rounding of `t` is a sizeable part of its radius. The
/// point is found from the vector between the centre and the ray, and half the chord from there.
#[inline(always)]
pub fn speck_surface_point<L: Lanes>(
    l: L,
    rays: &Rays<L>,
    t: L::F,
    center: V3<L::F>,
    curvature: L::F,
    radius: L::F,
) -> SurfacePoint<L> {
    let g = rays.origin - center;
    let h = rays.direction.dot(g);
    let across = rays.direction.neg_mul_add(h, g).scale(curvature);
    let along2 = (l.constant(1.0) - across.dot(across)).max(l.constant(0.0));
    let w = rays.direction.mul_add(along2.sqrt().copysign(t + h), across);
    let outward = w.scale(l.constant(1.0) / w.dot(w).sqrt());
    SurfacePoint { position: outward.mul_add(radius, center), outward }
}

/// Like [`surface_point`], on an anchored sphere.
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
    let x = rays.direction.mul_add(t, rays.origin - anchor);
    let away = x.scale(curvature) - inward;
    let length = away.dot(away).sqrt();
    let outward = away.scale(one / length);
    let c = l.constant(2.0).neg_mul_add(x.dot(inward), curvature * x.dot(x));
    let height = c / (one + length);
    SurfacePoint { position: outward.neg_mul_add(height, x) + anchor, outward }
}
