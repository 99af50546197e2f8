//! The outline of a sphere as the camera sees it: the circle in which its rays touch the sphere. In the picture this is
//! an ellipse, or for a sphere that surrounds half the view, such as the ground, a hyperbola: the horizon.

use crate::scene::{Camera, Scene};
use glam::DVec3;

/// Points of an outline; a multiple of four.
const POINTS: usize = 180;

/// A point of an outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlinePoint {
    /// Position in the picture, as in [`Camera::place_of`]; `None` if it is behind the eye.
    pub place: Option<[f64; 2]>,
    /// Whether nothing hides it.
    pub is_visible: bool,
}

/// The outline of a sphere.
#[derive(Clone, Debug, Default)]
pub struct Outline {
    /// Its points in order, around the sphere. The first one is to the right of the centre, the others follow
    /// counterclockwise. Empty if the eye is in or on the sphere, which then has no outline.
    pub points: Vec<OutlinePoint>,
}

impl Outline {
    /// The outline of a sphere of the scene in the picture of a camera.
    pub fn new(camera: &Camera, aspect: f64, center: DVec3, radius: f64, scene: &Scene) -> Self {
        let eye = camera.look_from;
        let touched = touched(camera, center, radius);
        let hiding = in_front(scene, eye, center, radius);
        let point = |at: DVec3| OutlinePoint {
            place: camera.place_of(at, aspect),
            is_visible: !is_hidden(&hiding, eye, at),
        };
        Outline { points: touched.into_iter().map(point).collect() }
    }

    /// The smallest rectangle around the outline, as its lower and upper corner; `None` if a part of it is behind the
    /// eye or there is no outline.
    pub fn bounds(&self) -> Option<[[f64; 2]; 2]> {
        let places: Option<Vec<[f64; 2]>> = self.points.iter().map(|point| point.place).collect();
        let mut places = places?.into_iter();
        let first = places.next()?;
        Some(places.fold([first, first], |[low, high], place| {
            [[0, 1].map(|axis| low[axis].min(place[axis])), [0, 1].map(|axis| high[axis].max(place[axis]))]
        }))
    }

    /// The points to the right, above, to the left and below the centre.
    pub fn quarters(&self) -> impl Iterator<Item = [f64; 2]> {
        let step = (self.points.len() / 4).max(1);
        self.points.iter().step_by(step).filter_map(|point| point.place)
    }
}

/// Points at which rays from the eye touch the sphere; none if the eye is in or on it.
fn touched(camera: &Camera, center: DVec3, radius: f64) -> Vec<DVec3> {
    let to_center = center - camera.look_from;
    let distance = to_center.length();
    if distance <= radius * (1.0 + 1e-12) {
        return Vec::new();
    }
    let axis = to_center / distance;
    let tangent_squared = (distance - radius) * (distance + radius);
    let middle = camera.look_from + axis * (tangent_squared / distance);
    let round = radius * tangent_squared.sqrt() / distance;
    let basis = camera.basis();
    // To the right in the picture, unless the sphere is exactly beside the eye.
    let right = basis.u - axis * basis.u.dot(axis);
    let right = right.try_normalize().unwrap_or(basis.v);
    let up = right.cross(axis);
    let around = (0..POINTS).map(|index| std::f64::consts::TAU * index as f64 / POINTS as f64);
    around.map(|angle| middle + round * (angle.cos() * right + angle.sin() * up)).collect()
}

/// The spheres that may hide a part of the outline, as a scene.
fn in_front(scene: &Scene, eye: DVec3, center: DVec3, radius: f64) -> Scene {
    let to_center = center - eye;
    let distance = to_center.length();
    let half_angle = (radius / distance).min(1.0).asin();
    let may_hide = |sphere: &&crate::scene::Sphere| {
        let to_other = sphere.center - eye;
        let other = to_other.length();
        if (sphere.center, sphere.radius) == (center, radius) || other - sphere.radius > distance {
            return false;
        }
        other <= sphere.radius
            || to_other.angle_between(to_center) <= half_angle + (sphere.radius / other).min(1.0).asin()
    };
    Scene { spheres: scene.spheres.iter().filter(may_hide).copied().collect(), ..Scene::default() }
}

fn is_hidden(hiding: &Scene, eye: DVec3, at: DVec3) -> bool {
    let distance = eye.distance(at);
    let direction = (at - eye) / distance;
    hiding.pick(eye, direction).is_some_and(|pick| pick.distance < distance * (1.0 - 1e-6))
}

#[cfg(test)]
mod tests {
    use super::*;

    use proptest::prelude::*;

    proptest! {
        /// Rays a little within the outline hit the sphere, and rays a little outside of it miss.
        #[test]
        fn an_outline_is_where_rays_begin_to_hit(
            x in -2.0..2.0f64, y in -1.0..1.0f64, z in -9.0..-2.0f64, radius in 0.01..0.9f64, vfov in 20.0..120.0f64,
        ) {
            let camera = Camera { vfov_degrees: vfov, ..Camera::BOOK };
            let center = DVec3::new(x, y, z);
            let mut scene = Scene::default();
            scene.add_sphere(center, radius, 0);
            let outline = Outline::new(&camera, 1.5, center, radius, &scene);
            let middle = camera.place_of(center, 1.5).unwrap();
            prop_assert_eq!(outline.points.len(), POINTS);
            for point in &outline.points {
                prop_assert!(point.is_visible);
                let place = point.place.unwrap();
                for (share, hits) in [(0.99, true), (1.01, false)] {
                    let at = [0, 1].map(|axis| middle[axis] + share * (place[axis] - middle[axis]));
                    // The centre is not the middle of the ellipse, but it is within it.
                    let hit = scene.pick(DVec3::ZERO, camera.direction_through(at, 1.5)).is_some();
                    prop_assert_eq!(hit, hits, "{:?} {}", place, share);
                }
            }
            let [low, high] = outline.bounds().unwrap();
            prop_assert!(low[0] < middle[0] && middle[0] < high[0] && low[1] < middle[1] && middle[1] < high[1]);
            let quarters: Vec<_> = outline.quarters().collect();
            prop_assert!(quarters[0][0] > middle[0] && quarters[1][1] < middle[1], "{:?}", quarters);
        }
    }
}
