//! The spheres near a point, and along a ray or a move.

use crate::prepared::hierarchy::Hierarchy;
use crate::scene::{NearestHit, Pick, Scene, Sphere};
use glam::DVec3;

/// The rounding of a picked point's distance from its sphere's centre, relative to the radius.
const ROUNDING: f64 = 1e-9;

/// The most surfaces that one move slides along.
const SLIDES: usize = 8;

/// A hierarchy over the spheres of a scene, with coordinates relative to `origin`.
pub(super) struct Tree {
    pub hierarchy: Hierarchy<f32>,
    pub origin: DVec3,
}

/// The spheres of a scene by place.
pub(super) struct Near<'a> {
    pub scene: &'a Scene,
    pub tree: Option<&'a Tree>,
}

impl Near<'_> {
    /// Calls `each` for every sphere that may touch a cube.
    pub fn each(&self, middle: DVec3, reach: f64, mut each: impl FnMut(usize, &Sphere)) {
        let spheres = &self.scene.spheres;
        match self.tree {
            Some(Tree { hierarchy, origin }) => {
                let middle = middle - *origin;
                hierarchy.near(middle - reach, middle + reach, |index| each(index, &spheres[index]));
            }
            None => {
                for (index, sphere) in spheres.iter().enumerate() {
                    let far = (sphere.center - middle).abs().max_element();
                    if far <= sphere.radius + reach {
                        each(index, sphere);
                    }
                }
            }
        }
    }

    /// The first hit of a ray, as [`Scene::pick`] finds it.
    pub fn pick(&self, eye: DVec3, direction: DVec3) -> Option<Pick> {
        let Some(Tree { hierarchy, origin }) = self.tree else { return self.scene.pick(eye, direction) };
        let mut nearest = NearestHit::default();
        hierarchy.along(eye - *origin, direction, |sphere| {
            nearest.take(self.scene, sphere, eye, direction);
            nearest.distance()
        });
        self.scene.picked(nearest, eye, direction)
    }

    /// The smallest sphere that `point` is inside of.
    pub fn innermost(&self, point: DVec3) -> Option<usize> {
        let mut found: Option<(usize, f64)> = None;
        self.each(point, 0.0, |index, sphere| {
            let is_smaller = found.is_none_or(|(_, radius)| sphere.radius < radius);
            if is_smaller && is_inside(sphere, point) {
                found = Some((index, sphere.radius));
            }
        });
        found.map(|(index, _)| index)
    }

    /// Where a straight move ends that stops `gap` in front of each sphere and slides along it. Where `from` is nearer
    /// to a sphere than that, it may come no nearer. Spheres that `from` is inside of are no obstacle. A
    /// move towards a `target` on a sphere ends in front of that sphere.
    pub fn slide(&self, from: DVec3, to: DVec3, gap: f64, target: Option<DVec3>) -> DVec3 {
        let mut obstacles = Vec::new();
        self.each(from, from.distance(to) + gap, |_, sphere| {
            if !is_inside(sphere, from) {
                let clearance = from.distance(sphere.center) - sphere.radius;
                obstacles.push((sphere.center, sphere.radius + clearance.clamp(0.0, gap)));
            }
        });
        let (mut at, mut left) = (from, to - from);
        for _ in 0..SLIDES {
            let hit = obstacles
                .iter()
                .filter_map(|(center, radius)| {
                    Some((share_to(at - *center, *radius, left)?, *center, *radius))
                })
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((share, center, radius)) = hit else { return at + left };
            at += share * left;
            let Some(normal) = (at - center).try_normalize() else { return at };
            at += normal * (radius - at.distance(center)).max(0.0);
            if target.is_some_and(|target| target.distance(center) <= radius * (1.0 + ROUNDING)) {
                return at;
            }
            left *= 1.0 - share;
            left -= normal * left.dot(normal);
        }
        at
    }
}

/// Whether a point is inside a sphere by more than the rounding of its distance.
fn is_inside(sphere: &Sphere, point: DVec3) -> bool {
    let size = sphere.center.abs().max_element() + sphere.radius + point.abs().max_element();
    point.distance(sphere.center) - sphere.radius < -4.0 * f64::EPSILON * size
}

/// The share of the move `by` up to a sphere; `from` is relative to its centre. `None` if the move does not lead there.
fn share_to(from: DVec3, radius: f64, by: DVec3) -> Option<f64> {
    /// Moves at a smaller sine to the surface than this go along it.
    const ALONG: f64 = 1e-12;
    let (distance, length) = (from.length(), by.length());
    let towards = -from.dot(by);
    if towards <= ALONG * distance * length {
        return None;
    }
    let outside = (distance - radius) * (distance + radius);
    if outside <= 0.0 {
        return Some(0.0);
    }
    let squared = towards * towards - length * length * outside;
    let share = outside / (towards + squared.max(0.0).sqrt());
    (squared >= 0.0 && share <= 1.0).then_some(share)
}
