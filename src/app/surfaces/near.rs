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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Material;

    #[test]
    fn a_fast_move_does_not_jump_over_a_sphere() {
        let mut scene = Scene::default();
        let grey = scene.add_material("grey", Material::Lambertian { albedo: DVec3::splat(0.5) });
        scene.add_sphere(DVec3::new(0.0, 0.0, -5.0), 0.1, grey);
        let near = Near { scene: &scene, tree: None };
        let stopped = near.slide(DVec3::ZERO, DVec3::new(0.0, 0.0, -100.0), 0.01, None);
        assert!((stopped.z + 4.89).abs() < 1e-12, "{stopped}");
        // Inside, there is no obstacle, and outside of the gap neither.
        let inside = DVec3::new(0.0, 0.0, -5.0);
        assert_eq!(near.slide(inside, DVec3::X, 0.01, None), DVec3::X);
        assert_eq!(near.slide(DVec3::ZERO, DVec3::Z, 0.01, None), DVec3::Z);
        // Nearer than the gap, the camera can move away and along.
        let close = DVec3::new(0.0, 0.0, -4.899);
        assert_eq!(near.slide(close, DVec3::ZERO, 0.01, None), DVec3::ZERO);
        let along = near.slide(close, close + DVec3::X, 0.01, None);
        assert!(along.distance(close + DVec3::X) < 1e-9, "{along}");
        let towards = near.slide(close, close - 0.0005 * DVec3::Z, 0.01, None);
        assert!(towards.distance(close) < 1e-9, "it is not pushed away: {towards}");
    }

    #[test]
    fn a_move_ends_before_the_sphere_that_it_is_towards_and_slides_along_others() {
        let mut scene = Scene::default();
        let grey = scene.add_material("grey", Material::Lambertian { albedo: DVec3::splat(0.5) });
        scene.add_sphere(DVec3::new(0.0, 0.0, -5.0), 1.0, grey);
        let near = Near { scene: &scene, tree: None };
        let to = DVec3::new(0.5, 0.0, -8.0);
        let slid = near.slide(DVec3::ZERO, to, 0.01, None);
        let stopped = near.slide(DVec3::ZERO, to, 0.01, Some(DVec3::new(0.0, 0.0, -4.0)));
        let reached = |at: DVec3| at.distance(DVec3::new(0.0, 0.0, -5.0));
        assert!((reached(stopped) - 1.01).abs() < 1e-9 && (stopped.x / stopped.z + 0.0625).abs() < 1e-9);
        assert!(slid.x > 1.5 * stopped.x && reached(slid) >= 1.01 - 1e-9, "{slid} {stopped}");
        // A point on the surface counts as on it in spite of rounding, and one above it does not.
        let target = |radius: f64| Some(DVec3::new(0.0, radius, -5.0));
        assert_eq!(
            near.slide(DVec3::ZERO, to, 0.0, target(1.0 + 5e-10)),
            near.slide(DVec3::ZERO, to, 0.0, target(1.0))
        );
        for off in [1.0 + 2e-9, 1.1, 1.3] {
            assert_eq!(near.slide(DVec3::ZERO, to, 0.0, target(off)), near.slide(DVec3::ZERO, to, 0.0, None));
        }
    }

    #[test]
    fn a_move_ends_before_a_sphere_that_only_its_gap_reaches() {
        let mut scene = Scene::default();
        let grey = scene.add_material("grey", Material::Lambertian { albedo: DVec3::splat(0.5) });
        scene.add_sphere(DVec3::new(0.0, 0.0, -5.0), 1.0, grey);
        let near = Near { scene: &scene, tree: None };
        // The move would end 5 thousandths before the surface.
        let stopped = near.slide(DVec3::ZERO, DVec3::new(0.0, 0.0, -3.995), 0.01, None);
        assert!((stopped.z + 3.99).abs() < 1e-12, "{stopped}");
    }

    #[test]
    fn a_point_of_a_surface_is_not_inside_in_spite_of_rounding() {
        let mut scene = Scene::default();
        let grey = scene.add_material("grey", Material::Lambertian { albedo: DVec3::splat(0.5) });
        let center = DVec3::new(123.4, -1000.0, 56.7);
        scene.add_sphere(center, 1000.0, grey);
        let near = Near { scene: &scene, tree: None };
        for step in 0..100 {
            let (sine, cosine) = (0.1 * f64::from(step)).sin_cos();
            let outwards = DVec3::new(0.6 * cosine, 0.8, 0.6 * sine);
            let at = |radius: f64| near.innermost(center + radius * outwards);
            assert_eq!([at(1000.0), at(1000.0 - 1e-9)], [None, Some(0)], "{outwards}");
        }
    }

    #[test]
    fn the_share_of_a_move_up_to_a_sphere() {
        let share = |from: [f64; 3], by: [f64; 3]| share_to(DVec3::from(from), 2.0, DVec3::from(by));
        assert_eq!(share([5.0, 0.0, 0.0], [-6.0, 0.0, 0.0]), Some(0.5));
        assert_eq!(share([5.0, 0.0, 0.0], [-3.0, 0.0, 0.0]), Some(1.0), "just so far");
        assert_eq!(share([5.0, 0.0, 0.0], [-2.9, 0.0, 0.0]), None, "not so far");
        assert_eq!(share([5.0, 0.0, 0.0], [6.0, 0.0, 0.0]), None, "away from it");
        assert_eq!(share([5.0, 2.5, 0.0], [-9.0, 0.0, 0.0]), None, "past it");
        assert_eq!(share([0.0, 2.0, 0.0], [9.0, 0.0, 0.0]), None, "along it");
        assert_eq!(share([0.0, 2.0, 0.0], [9.0, -1.0, 0.0]), Some(0.0), "into it");
        assert_eq!(share([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]), Some(0.0), "from within");
    }

    #[test]
    fn the_smallest_of_several_spheres_around_a_point_is_the_innermost() {
        let mut scene = Scene::default();
        let grey = scene.add_material("grey", Material::Lambertian { albedo: DVec3::splat(0.5) });
        for radius in [3.0, 1.0, 2.0] {
            scene.add_sphere(DVec3::ZERO, radius, grey);
        }
        let near = Near { scene: &scene, tree: None };
        let at = [0.0, 0.999, 1.0, 1.5, 2.5, 3.5].map(|x| near.innermost(DVec3::new(x, 0.0, 0.0)));
        assert_eq!(at, [Some(1), Some(1), Some(2), Some(2), Some(0), None]);
        let mut seen = Vec::new();
        near.each(DVec3::new(4.0, 0.0, 0.0), 1.0, |index, _| seen.push(index));
        assert_eq!(seen, [0], "the cube touches it");
        seen.clear();
        near.each(DVec3::new(4.0, 0.0, 0.0), 0.9, |index, _| seen.push(index));
        assert!(seen.is_empty());
    }

    #[test]
    fn a_sphere_is_no_obstacle_to_moves_within_it_and_out_of_it() {
        let mut scene = Scene::default();
        let grey = scene.add_material("grey", Material::Lambertian { albedo: DVec3::splat(0.5) });
        scene.add_sphere(DVec3::ZERO, 2.0, grey);
        let near = Near { scene: &scene, tree: None };
        for to in [DVec3::new(0.5, 0.0, 0.0), DVec3::new(-1.5, 0.5, 0.0), DVec3::new(-9.0, 0.0, 0.0)] {
            let reached = near.slide(DVec3::X, to, 0.01, None);
            assert!(reached.distance(to) < 1e-12, "{reached} {to}");
        }
    }
}
