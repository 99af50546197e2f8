//! Decides how to intersect each sphere and which origin coordinates are relative to, in `f64`, before anything is
//! rounded.

use super::overlaps::Overlaps;
use crate::job::render::RenderJob;
use crate::kernel::{HALF_EPSILON, Roots};
use crate::scene::{Camera, Sphere};
use crate::stages::SurfaceRule;
use glam::DVec3;

/// A sphere is anchored when rounding at its radius exceeds this share of the smallest length near its surface. At this
/// limit, distances in the perpendicular form are wrong by about `1e-4` of that length.
const ANCHOR_SHARE: f64 = 5e-5;

/// Where one of two touching spheres is glass, the smaller counts as this many times smaller. A ray that leaves one
/// near the contact may, by rounding, start beyond the other's surface and miss it.
const TOUCHING_SHARE: f64 = 50.0;

/// Spheres touch if they cross or are at most this many rounding units apart.
const TOUCHING_UNITS: f64 = 16.0;

/// Maximum number of anchored spheres, since every ray tests all of them. Those that gain most come first.
const ANCHORED_LIMIT: usize = 16;

/// Maximum number of spheres examined for anchoring.
const CANDIDATE_LIMIT: usize = 64;

/// Coordinates are relative to a point near the eye if the eye's distance from the world's origin exceeds the smallest
/// length near it by this factor. At that ratio, rounding reaches `8e-6` of that length.
const SHIFT_RATIO: f64 = 128.0;

/// Spheres are near the eye up to this many times the distance of the nearest one.
const NEIGHBOUR_RATIO: f64 = 4.0;

/// Grid spacing for that point, as a multiple of the length. On a grid, small movements of the eye leave the point
/// fixed.
const GRID_RATIO: f64 = 256.0;

/// The eye is on a surface if it is within `f64` rounding of it: this many units in the last place.
const ON_SURFACE_UNITS: f64 = 4.0;

/// A sphere described relative to a point on its surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Anchored {
    /// Index of the sphere in the scene.
    pub index: u32,
    pub roots: Roots,
    /// Whether the eye is on the outer side of the surface, so that camera rays start on it.
    pub under_eye: bool,
    /// A point that the anchor is close to.
    pub near: DVec3,
}

/// How to intersect each sphere: indices in the scene, ascending. Covered spheres are in no group.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Groups {
    /// The point that coordinates are relative to.
    pub origin: DVec3,
    /// Spheres whose nearer root alone counts.
    pub opaque: Vec<u32>,
    /// Spheres whose roots both count.
    pub two_root: Vec<u32>,
    /// Few.
    pub anchored: Vec<Anchored>,
    /// Whether a sphere is so small for its distance that a hit's depth hardly determines where on it the hit is.
    pub has_specks: bool,
}

/// The eye and its lens.
struct Eye {
    position: DVec3,
    /// Rays start within this distance of the eye.
    lens_radius: f64,
}

impl Eye {
    fn of(camera: &Camera) -> Self {
        Eye { position: camera.look_from, lens_radius: camera.lens_radius() }
    }

    /// Distance to the surface: negative inside, 0 within rounding.
    fn height(&self, sphere: &Sphere) -> f64 {
        let height = self.position.distance(sphere.center) - sphere.radius;
        let size = self.position.abs().max_element() + sphere.center.abs().max_element() + sphere.radius;
        if height.abs() <= ON_SURFACE_UNITS * f64::EPSILON * size { 0.0 } else { height }
    }

    /// Whether rays can start inside the sphere.
    fn may_be_inside(&self, sphere: &Sphere) -> bool {
        self.height(sphere) <= self.lens_radius * (1.0 + 1e-5)
    }

    /// Whether all rays start inside the sphere.
    fn is_inside(&self, sphere: &Sphere) -> bool {
        self.height(sphere) < -self.lens_radius * (1.0 + 1e-5)
    }
}

impl Groups {
    pub fn of(job: &RenderJob, overlaps: &Overlaps) -> Self {
        let (scene, eye) = (job.scene(), Eye::of(job.camera()));
        let is_exact = job.rules().surface == SurfaceRule::Exact;
        let is_opaque = |s: &Sphere| !scene.material_of(s).is_transparent();
        let uncovered = || {
            let listed = scene.spheres.iter().enumerate();
            listed.filter(|(index, _)| !is_exact || !overlaps.covers(*index as u32))
        };
        let cavity = uncovered()
            .map(|(_, sphere)| sphere)
            .filter(|s| is_exact && is_opaque(s) && eye.is_inside(s))
            .min_by(|a, b| a.radius.total_cmp(&b.radius));
        let shown = || uncovered().filter(|(_, s)| cavity.is_none_or(|cavity| reaches_into(s, cavity)));
        let mut groups = Groups::default();
        if is_exact {
            groups.origin = origin(shown().map(|(_, sphere)| sphere), &eye);
            groups.anchored = anchored(shown(), &eye, &is_opaque);
        }
        for (index, sphere) in shown() {
            let index = index as u32;
            if groups.anchored.binary_search_by_key(&index, |a| a.index).is_ok() {
                continue;
            }
            groups.has_specks |= is_exact && is_speck(sphere, &eye);
            // The margin is far larger than the distance by which rounding can move the eye.
            let margin = 1e-5 * sphere.radius + 1e-6 * (eye.position - groups.origin).abs().max_element();
            let is_near = eye.height(sphere) <= eye.lens_radius * (1.0 + 1e-5) + margin;
            let group = if is_near || !is_opaque(sphere) { &mut groups.two_root } else { &mut groups.opaque };
            group.push(index);
        }
        groups
    }

    /// All spheres but the anchored ones, those with one root first. At equal distance, the first in this order is hit.
    pub fn in_list_order(&self) -> Vec<u32> {
        self.opaque.iter().chain(&self.two_root).copied().collect()
    }

    /// Whether a hierarchy over these spheres also serves `other`.
    pub fn share_hierarchy(&self, other: &Groups) -> bool {
        let indices = |groups: &Groups| groups.anchored.iter().map(|a| a.index).collect::<Vec<_>>();
        (self.origin, &self.opaque, &self.two_root) == (other.origin, &other.opaque, &other.two_root)
            && indices(self) == indices(other)
    }
}

/// Whether a sphere is `cavity` or can be hit from inside it.
fn reaches_into(sphere: &Sphere, cavity: &Sphere) -> bool {
    let apart = sphere.center.distance(cavity.center);
    sphere == cavity || (apart < sphere.radius + cavity.radius && apart + cavity.radius > sphere.radius)
}

/// Whether the surfaces cross or are closer than rounding can resolve.
fn touch(a: &Sphere, b: &Sphere) -> bool {
    let apart = a.center.distance(b.center);
    let margin = TOUCHING_UNITS * HALF_EPSILON * a.radius.max(b.radius);
    apart <= a.radius + b.radius + margin && apart >= (a.radius - b.radius).abs() - margin
}

/// Whether rounding moves a hit by a visible share of the sphere.
fn is_speck(sphere: &Sphere, eye: &Eye) -> bool {
    HALF_EPSILON * eye.position.distance(sphere.center) > 5e-4 * sphere.radius
}

/// A grid point near the surface closest to the eye, or 0 if coordinates are small enough.
fn origin<'a>(spheres: impl Iterator<Item = &'a Sphere> + Clone, eye: &Eye) -> DVec3 {
    let by_height = spheres.clone().map(|sphere| (eye.height(sphere).abs(), sphere));
    let Some((height, nearest)) = by_height.min_by(|a, b| a.0.total_cmp(&b.0)) else { return DVec3::ZERO };
    // Layers around or inside the nearest sphere count as lengths, too.
    let layers = spheres.clone().filter_map(|other| {
        let gap = (other.radius - nearest.radius).abs() - other.center.distance(nearest.center);
        (gap > 0.0).then_some(gap)
    });
    let neighbours = spheres.filter(|other| eye.height(other).abs() <= NEIGHBOUR_RATIO * height);
    let lengths = layers.chain(neighbours.map(|other| other.radius));
    let length = lengths.fold(height.min(nearest.radius), f64::min);
    let away = (eye.position - nearest.center).try_normalize().unwrap_or_default();
    let foot = if height == 0.0 { eye.position } else { nearest.center + away * nearest.radius };
    if foot.abs().max_element() <= SHIFT_RATIO * length {
        return DVec3::ZERO;
    }
    let cell = GRID_RATIO * length;
    if cell < f64::MIN_POSITIVE {
        return foot;
    }
    let cell = cell.log2().floor().exp2();
    (foot / cell).round() * cell
}

/// Spheres to anchor, by ascending index: those that all rays start in or on, and those so large for the details near
/// their surface that rounding at their radius would show.
fn anchored<'a>(
    shown: impl Iterator<Item = (usize, &'a Sphere)> + Clone,
    eye: &'a Eye,
    is_opaque: &impl Fn(&Sphere) -> bool,
) -> Vec<Anchored> {
    let has_glass = shown.clone().any(|(_, sphere)| !is_opaque(sphere));
    let share = if has_glass { TOUCHING_SHARE } else { 1.0 };
    let smallest = shown.clone().map(|(_, sphere)| sphere.radius / share).fold(f64::INFINITY, f64::min);
    let candidate = |(index, sphere): (usize, &'a Sphere)| Candidate {
        index: index as u32,
        sphere,
        eye,
        is_opaque: is_opaque(sphere),
        length: smallest,
        detail: None,
    };
    let mut candidates: Vec<Candidate> =
        shown.clone().map(candidate).filter(Candidate::needs_anchor).collect();
    keep_best(&mut candidates, CANDIDATE_LIMIT);
    candidates.iter_mut().for_each(|candidate| candidate.examine(shown.clone(), is_opaque));
    candidates.retain(Candidate::needs_anchor);
    keep_best(&mut candidates, ANCHORED_LIMIT);
    candidates.sort_by_key(|candidate| candidate.index);
    candidates.iter().map(Candidate::anchored).collect()
}

/// Keeps the candidates that gain most from an anchor.
fn keep_best(candidates: &mut Vec<Candidate>, limit: usize) {
    candidates.sort_by(|a, b| b.gain().total_cmp(&a.gain()));
    candidates.truncate(limit);
}

/// A sphere that may need an anchor.
struct Candidate<'a> {
    index: u32,
    sphere: &'a Sphere,
    eye: &'a Eye,
    is_opaque: bool,
    /// A lower bound of the lengths near the surface; once examined, the smallest of them.
    length: f64,
    detail: Option<Detail>,
}

impl Candidate<'_> {
    /// Finds the details near the surface. Where glass touches another sphere, smaller ones count.
    fn examine<'a>(
        &mut self,
        shown: impl Iterator<Item = (usize, &'a Sphere)> + Clone,
        is_opaque: &impl Fn(&Sphere) -> bool,
    ) {
        let detail = Detail::near(shown.clone(), self.sphere, |_, size| size);
        let contact = Detail::near(shown, self.sphere, |other, size| {
            let leaks = !(is_opaque(other) && self.is_opaque) && touch(self.sphere, other);
            if leaks { size / TOUCHING_SHARE } else { f64::INFINITY }
        });
        let lengths = [detail, contact].into_iter().flatten().map(|detail| detail.length);
        self.length = lengths.fold(f64::INFINITY, f64::min);
        self.detail = detail.or(contact);
    }

    /// Whether rounding at the radius would show, or all rays start in or on the sphere.
    fn needs_anchor(&self) -> bool {
        self.holds_all_rays() || HALF_EPSILON * self.sphere.radius > ANCHOR_SHARE * self.smallest_length()
    }

    fn roots(&self) -> Roots {
        let may_be_inside = self.eye.may_be_inside(self.sphere) && !self.is_under_eye();
        match (self.is_opaque, self.eye.is_inside(self.sphere), may_be_inside) {
            (true, true, _) => Roots::Farther,
            (true, false, false) => Roots::Nearer,
            _ => Roots::Both,
        }
    }

    /// A point that the anchor should be close to: the details, unless the eye needs it more.
    fn place(&self) -> DVec3 {
        let height = self.height();
        // A distant anchor would leave the eye itself unresolved.
        let is_eye_resolved =
            |place: DVec3| HALF_EPSILON * self.eye.position.distance(place) <= ANCHOR_SHARE * height;
        let is_close = |detail: &Detail| detail.length <= height && is_eye_resolved(detail.place);
        let detail = self.detail.filter(|detail| !self.is_under_eye() && is_close(detail));
        detail.map_or(self.eye.position, |detail| detail.place)
    }

    fn anchored(&self) -> Anchored {
        let (index, under_eye) = (self.index, self.is_under_eye());
        Anchored { index, roots: self.roots(), under_eye, near: self.place() }
    }

    /// How much an anchor improves.
    fn gain(&self) -> f64 {
        if self.holds_all_rays() { f64::INFINITY } else { self.sphere.radius / self.smallest_length() }
    }

    fn holds_all_rays(&self) -> bool {
        (self.is_opaque && self.eye.is_inside(self.sphere)) || self.eye.height(self.sphere) == 0.0
    }

    fn is_under_eye(&self) -> bool {
        self.eye.height(self.sphere) == 0.0 && self.eye.lens_radius == 0.0
    }

    fn smallest_length(&self) -> f64 {
        self.length.min(self.height())
    }

    /// Distance of the eye from the surface; infinity if the eye is on it.
    fn height(&self) -> f64 {
        let height = self.eye.height(self.sphere).abs();
        if height > 0.0 { height } else { f64::INFINITY }
    }
}

/// What rounding at a sphere's radius could affect.
#[derive(Clone, Copy, Debug)]
struct Detail {
    /// The smallest length near the surface: the radius of a nearby sphere or, if larger, its distance from the
    /// surface.
    length: f64,
    /// The middle of the spheres whose lengths are hardly larger.
    place: DVec3,
}

impl Detail {
    /// `None` if all lengths are so large that the sphere needs no anchor. `counted` maps a sphere and its length to
    /// the length that counts.
    fn near<'a>(
        shown: impl Iterator<Item = (usize, &'a Sphere)> + Clone,
        sphere: &Sphere,
        counted: impl Fn(&Sphere, f64) -> f64,
    ) -> Option<Self> {
        let relevant = HALF_EPSILON / ANCHOR_SHARE * sphere.radius;
        let lengths = || {
            let small = shown.clone().filter(|(_, other)| other.radius < TOUCHING_SHARE * relevant);
            small.map(|(_, other)| {
                let away = (other.center.distance(sphere.center) - sphere.radius).abs();
                (counted(other, other.radius.max(away)), other.center)
            })
        };
        let length = lengths().map(|(length, _)| length).fold(relevant, f64::min);
        let (mut sum, mut count) = (DVec3::ZERO, 0.0);
        for (_, center) in lengths().filter(|(other, _)| length < relevant && *other <= 2.0 * length) {
            sum += center;
            count += 1.0;
        }
        (count > 0.0).then(|| Detail { length, place: sum / count })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eye_within_rounding_is_on_surface() {
        for far in [1e8, -1e8] {
            let position = DVec3::splat(far);
            let eye = Eye { position, lens_radius: 0.0 };
            let ball = |radius: f64| Sphere { center: position - 0.1 * DVec3::X, radius, material: 0 };
            let distance = position.distance(ball(0.1).center);
            assert!(distance != 0.1, "rounding moves the centre");
            assert_eq!(eye.height(&ball(0.1)), 0.0, "{far}");
            assert_eq!(eye.height(&ball(0.1 - 1e-6)), distance - (0.1 - 1e-6), "{far}");
        }
    }
}
