//! Which spheres are intersected how, and what coordinates are measured from: all in `f64`, before anything is
//! rounded.

use super::facts::Facts;
use crate::kernel::{HALF_EPSILON, Roots};
use crate::render::RenderJob;
use crate::scene::{Camera, Material, Sphere};
use crate::stages::Surface;
use glam::DVec3;

/// A sphere is anchored when rounding at its radius exceeds this share of the smallest length near its surface. At
/// that point the perpendicular form's distances are off by some `1e-4` of that length.
const ANCHOR_SHARE: f64 = 5e-5;

/// What touches a much larger sphere counts as so many times smaller than it is where one of the two is glass. A ray that
/// leaves the one near there may start beyond the other's surface by as much as rounding moves it, and then misses it.
const TOUCHING_SHARE: f64 = 50.0;

/// Spheres touch where they cross, or where so many units of rounding part them.
const TOUCHING_UNITS: f64 = 16.0;

/// Most spheres that are anchored for the sake of small lengths. Every ray tests them all, so they cost what a list
/// costs; those that gain most come first.
const ANCHORED_LIMIT: usize = 16;

/// Most spheres that are looked at for that.
const CANDIDATE_LIMIT: usize = 64;

/// Coordinates are measured from a point near the eye where the eye is farther from the world's origin than this
/// many times the smallest length about it: there they would be rounded to `8e-6` of that length.
const SHIFT_RATIO: f64 = 128.0;

/// That point lies on a grid as coarse as this many times the length, so that it stays while the eye moves a little.
const GRID_RATIO: f64 = 256.0;

/// The eye is on a surface when the distance between them is rounding in `f64`: this many units in the last place.
const ON_SURFACE_UNITS: f64 = 4.0;

/// A sphere that is seen from a point of its surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Anchored {
    /// Index in the scene.
    pub index: u32,
    /// Those that count.
    pub roots: Roots,
    /// Whether the eye is a point of the surface, so that rays from the camera start on it, on the outer side.
    pub under_eye: bool,
    /// Near which point the anchor lies.
    pub near: DVec3,
}

/// Which spheres are intersected how: indices in the scene, rising. Spheres that another covers are in none.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Groups {
    /// What coordinates are measured from.
    pub origin: DVec3,
    /// Of one root.
    pub opaque: Vec<u32>,
    /// Of two.
    pub two_root: Vec<u32>,
    /// Few.
    pub anchored: Vec<Anchored>,
    /// Whether a sphere is so small beside its distance that a hit's depth says little of where on it the hit lies.
    pub has_specks: bool,
}

/// The eye and its lens.
struct Eye {
    position: DVec3,
    /// Rays start within this distance of it.
    lens_radius: f64,
}

impl Eye {
    fn of(camera: &Camera) -> Self {
        let tangent = (camera.defocus_angle_degrees.to_radians() / 2.0).tan();
        Eye { position: camera.look_from, lens_radius: camera.effective_focus_distance() * tangent }
    }

    /// Distance to the surface: negative inside, 0 where it cannot be told from 0.
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
    pub fn of(job: &RenderJob, facts: &Facts) -> Self {
        let (scene, eye) = (job.scene(), Eye::of(job.camera()));
        let is_exact = job.rules().surface == Surface::Exact;
        let is_opaque = |s: &Sphere| !matches!(scene.material_of(s), Material::Dielectric { .. });
        let uncovered = || {
            let listed = scene.spheres.iter().enumerate();
            listed.filter(|(index, _)| !is_exact || !facts.covers(*index as u32))
        };
        let cavity = uncovered()
            .map(|(_, sphere)| sphere)
            .filter(|s| is_exact && is_opaque(s) && eye.is_inside(s))
            .min_by(|a, b| a.radius.total_cmp(&b.radius));
        let shown = || uncovered().filter(|(_, s)| cavity.is_none_or(|cavity| reaches_into(s, cavity)));
        let mut groups = Groups::default();
        if is_exact {
            groups.origin = origin(shown().map(|(_, sphere)| sphere), &eye);
            groups.anchored = anchored(shown, &eye, &is_opaque);
        }
        for (index, sphere) in shown() {
            let index = index as u32;
            if groups.anchored.binary_search_by_key(&index, |a| a.index).is_ok() {
                continue;
            }
            groups.has_specks |= is_exact && is_speck(sphere, &eye);
            // The margin is far above what rounding can move the eye by.
            let margin = 1e-5 * sphere.radius + 1e-6 * (eye.position - groups.origin).abs().max_element();
            let is_near = eye.height(sphere) <= eye.lens_radius * (1.0 + 1e-5) + margin;
            let group = if is_near || !is_opaque(sphere) { &mut groups.two_root } else { &mut groups.opaque };
            group.push(index);
        }
        groups
    }

    /// All but the anchored, those of one root first: of two at one distance the first is met.
    pub fn in_list_order(&self) -> Vec<u32> {
        self.opaque.iter().chain(&self.two_root).copied().collect()
    }

    /// Whether a hierarchy over these spheres is one over those.
    pub fn share_hierarchy(&self, other: &Groups) -> bool {
        let indices = |groups: &Groups| groups.anchored.iter().map(|a| a.index).collect::<Vec<_>>();
        (self.origin, &self.opaque, &self.two_root) == (other.origin, &other.opaque, &other.two_root)
            && indices(self) == indices(other)
    }
}

/// Whether a sphere can be met from within `cavity`, or is it.
fn reaches_into(sphere: &Sphere, cavity: &Sphere) -> bool {
    let apart = sphere.center.distance(cavity.center);
    sphere == cavity || (apart < sphere.radius + cavity.radius && apart + cavity.radius > sphere.radius)
}

/// Whether the surfaces cross, or are closer than rounding tells.
fn touch(a: &Sphere, b: &Sphere) -> bool {
    let apart = a.center.distance(b.center);
    let margin = TOUCHING_UNITS * HALF_EPSILON * a.radius.max(b.radius);
    apart <= a.radius + b.radius + margin && apart >= (a.radius - b.radius).abs() - margin
}

/// Whether rounding moves a hit by more than a share of the sphere that shows.
fn is_speck(sphere: &Sphere, eye: &Eye) -> bool {
    HALF_EPSILON * eye.position.distance(sphere.center) > 5e-4 * sphere.radius
}

/// A point near what the eye is nearest to, on a grid; 0 where coordinates are small enough as they are.
fn origin<'a>(spheres: impl Iterator<Item = &'a Sphere> + Clone, eye: &Eye) -> DVec3 {
    let by_height = spheres.clone().map(|sphere| (eye.height(sphere).abs(), sphere));
    let Some((height, nearest)) = by_height.min_by(|a, b| a.0.total_cmp(&b.0)) else { return DVec3::ZERO };
    // Layers about or in the nearest sphere are lengths, too.
    let layers = spheres.filter_map(|other| {
        let gap = (other.radius - nearest.radius).abs() - other.center.distance(nearest.center);
        (gap > 0.0).then_some(gap)
    });
    let length = layers.fold(height.min(nearest.radius), f64::min);
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

/// Spheres that are seen from a point of their surface, by rising index: those that all rays start in or on, and those
/// so large beside what is near their surface that rounding at their radius would show.
fn anchored<'a, I: Iterator<Item = (usize, &'a Sphere)>>(
    shown: impl Fn() -> I + Copy,
    eye: &Eye,
    is_opaque: &impl Fn(&Sphere) -> bool,
) -> Vec<Anchored> {
    let needs_anchor = |radius: f64, length: f64| HALF_EPSILON * radius > ANCHOR_SHARE * length;
    let is_special = |s: &Sphere| (is_opaque(s) && eye.is_inside(s)) || eye.height(s) == 0.0;
    let has_glass = shown().any(|(_, s)| !is_opaque(s));
    let share = if has_glass { TOUCHING_SHARE } else { 1.0 };
    let smallest = shown().map(|(_, s)| s.radius / share).fold(f64::INFINITY, f64::min);
    let mut candidates: Vec<(usize, &Sphere)> = shown()
        .filter(|(_, s)| is_special(s) || needs_anchor(s.radius, smallest.min(positive(eye.height(s).abs()))))
        .collect();
    let gain = |s: &Sphere, length: f64| {
        if is_special(s) { f64::INFINITY } else { s.radius / length.min(positive(eye.height(s).abs())) }
    };
    candidates.sort_by(|(_, a), (_, b)| gain(b, smallest).total_cmp(&gain(a, smallest)));
    candidates.truncate(CANDIDATE_LIMIT);
    let mut chosen: Vec<(f64, Anchored)> = candidates
        .into_iter()
        .filter_map(|(index, sphere)| {
            let height = positive(eye.height(sphere).abs());
            let detail = Detail::near(shown, sphere, |_, size| size);
            let contact = Detail::near(shown, sphere, |other, size| {
                let leaks = !(is_opaque(other) && is_opaque(sphere)) && touch(sphere, other);
                if leaks { size / TOUCHING_SHARE } else { f64::INFINITY }
            });
            let lengths = [detail, contact].into_iter().flatten().map(|detail| detail.length);
            let length = lengths.fold(f64::INFINITY, f64::min);
            let detail = detail.or(contact);
            if !is_special(sphere) && !needs_anchor(sphere.radius, length.min(height)) {
                return None;
            }
            let under_eye = eye.height(sphere) == 0.0 && eye.lens_radius == 0.0;
            let may_be_inside = eye.may_be_inside(sphere) && !under_eye;
            let roots = match (is_opaque(sphere), eye.is_inside(sphere), may_be_inside) {
                (true, true, _) => Roots::Farther,
                (true, false, false) => Roots::Nearer,
                _ => Roots::Both,
            };
            let near = detail.filter(|detail| !under_eye && detail.length <= height);
            let near = near.map_or(eye.position, |detail| detail.place);
            Some((gain(sphere, length), Anchored { index: index as u32, roots, under_eye, near }))
        })
        .collect();
    chosen.sort_by(|a, b| b.0.total_cmp(&a.0));
    chosen.truncate(ANCHORED_LIMIT);
    let mut chosen: Vec<Anchored> = chosen.into_iter().map(|(_, anchored)| anchored).collect();
    chosen.sort_by_key(|anchored| anchored.index);
    chosen
}

/// What rounding at a sphere's radius could show in.
#[derive(Clone, Copy, Debug)]
struct Detail {
    /// The smallest length near the surface: the radius of a sphere there, or its distance from the surface where that
    /// is larger.
    length: f64,
    /// The middle of the spheres whose lengths are hardly larger.
    place: DVec3,
}

impl Detail {
    /// `None` where all lengths are so large that they leave the sphere as it is. `counted` says what a sphere's length
    /// counts as.
    fn near<'a, I: Iterator<Item = (usize, &'a Sphere)>>(
        shown: impl Fn() -> I,
        sphere: &Sphere,
        counted: impl Fn(&Sphere, f64) -> f64,
    ) -> Option<Self> {
        let relevant = HALF_EPSILON / ANCHOR_SHARE * sphere.radius;
        let lengths = || {
            shown().filter(|(_, other)| other.radius < TOUCHING_SHARE * relevant).map(|(_, other)| {
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

/// Infinity in place of 0.
fn positive(length: f64) -> f64 {
    if length > 0.0 { length } else { f64::INFINITY }
}
