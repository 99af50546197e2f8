//! The outline of a sphere as the camera sees it: the circle in which its rays touch the sphere. In the picture this is
//! an ellipse, or for a sphere that surrounds half the view, such as the ground, a hyperbola: the horizon.

use crate::scene::Camera;
use glam::DVec3;

/// Points of an outline; a multiple of four.
const POINTS: usize = 180;

/// The points of an outline in order, as in [`Camera::place_of`]; `None` behind the eye. The first one is to the right of
/// the centre, the others follow counterclockwise. There is none if the eye is in or on the sphere.
pub struct Outline(pub Vec<Option<[f64; 2]>>);

impl Outline {
    pub fn new(camera: &Camera, aspect: f64, center: DVec3, radius: f64) -> Self {
        let to_center = center - camera.look_from;
        let distance = to_center.length();
        if distance <= radius * (1.0 + 1e-12) {
            return Outline(Vec::new());
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
        let touched = around.map(|angle| middle + round * (angle.cos() * right + angle.sin() * up));
        Outline(touched.map(|point| camera.place_of(point, aspect)).collect())
    }

    /// The smallest rectangle around the outline, as its lower and upper corner; `None` if a part of it is behind the
    /// eye or there is no outline.
    pub fn bounds(&self) -> Option<[[f64; 2]; 2]> {
        let places: Option<Vec<[f64; 2]>> = self.0.iter().copied().collect();
        let pairs = places?.into_iter().map(|place| [place, place]);
        let corner = |a: [f64; 2], b: [f64; 2], choose: fn(f64, f64) -> f64| {
            [0, 1].map(|axis| choose(a[axis], b[axis]))
        };
        pairs.reduce(|[low, high], [a, b]| [corner(low, a, f64::min), corner(high, b, f64::max)])
    }

    /// The points to the right, above, to the left and below the centre.
    pub fn quarters(&self) -> impl Iterator<Item = [f64; 2]> {
        self.0.iter().step_by(POINTS / 4).copied().flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
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
            let outline = Outline::new(&camera, 1.5, center, radius);
            let middle = camera.place_of(center, 1.5).unwrap();
            prop_assert_eq!(outline.0.len(), POINTS);
            for place in outline.0.iter().map(|place| place.unwrap()) {
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
