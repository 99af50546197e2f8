//! Finds the sphere at a point of the picture, with one exact `f64` ray through the middle of the lens.

use super::{Camera, Scene, Sphere};
use glam::DVec3;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    pub sphere: usize,
    /// Along the ray, scene units.
    pub distance: f64,
    /// Hit point, scene units.
    pub point: DVec3,
    /// Unit normal on the ray's side.
    pub normal: DVec3,
}

impl Camera {
    /// Unit direction from the eye through the point `at` of the picture, from `[0, 0]` at the upper left to `[1, 1]`
    /// at the lower right. `aspect` is width over height.
    pub fn direction_through(&self, at: [f64; 2], aspect: f64) -> DVec3 {
        let basis = self.basis();
        let half_height = (self.vfov_degrees.to_radians() / 2.0).tan();
        let right = (2.0 * at[0] - 1.0) * half_height * aspect;
        let up = (1.0 - 2.0 * at[1]) * half_height;
        (right * basis.u + up * basis.v - basis.w).normalize()
    }

    /// Distance from the eye to `point` along the view: the focus distance that makes `point` sharp.
    pub fn depth_of(&self, point: DVec3) -> f64 {
        (self.look_from - point).dot(self.basis().w)
    }

    /// Position of `point` in the picture, in the coordinates of [`Camera::direction_through`]; `None` if it is behind
    /// the eye.
    pub fn place_of(&self, point: DVec3, aspect: f64) -> Option<[f64; 2]> {
        let basis = self.basis();
        let depth = self.depth_of(point);
        if depth <= 0.0 {
            return None;
        }
        let half_height = (self.vfov_degrees.to_radians() / 2.0).tan() * depth;
        let offset = point - self.look_from;
        let right = offset.dot(basis.u) / (half_height * aspect);
        let up = offset.dot(basis.v) / half_height;
        Some([(right + 1.0) / 2.0, (1.0 - up) / 2.0])
    }
}

impl Scene {
    /// Finds the first sphere hit; at equal distance, the one that comes first in the scene. `direction` must have length 1.
    pub fn pick(&self, origin: DVec3, direction: DVec3) -> Option<Pick> {
        let distance = |sphere: &Sphere| root(sphere.center - origin, sphere.radius, direction);
        let hits =
            self.spheres.iter().enumerate().filter_map(|(index, sphere)| Some((index, distance(sphere)?)));
        let (sphere, distance) = hits.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let point = origin + distance * direction;
        let outward = (point - self.spheres[sphere].center) / self.spheres[sphere].radius;
        let normal = if outward.dot(direction) > 0.0 { -outward } else { outward };
        Some(Pick { sphere, distance, point, normal })
    }
}

/// The nearest root in front of the eye. A surface that the eye is on is invisible.
fn root(to_center: DVec3, radius: f64, direction: DVec3) -> Option<f64> {
    const ON_SURFACE: f64 = 1e-9;
    let along = to_center.dot(direction);
    // Distance from the centre to the ray, without the cancellation in the book's discriminant.
    let beside = to_center - along * direction;
    let squared = radius * radius - beside.length_squared();
    if squared < 0.0 {
        return None;
    }
    let half = squared.sqrt();
    [along - half, along + half].into_iter().find(|distance| *distance > ON_SURFACE * radius)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Material;

    fn two() -> Scene {
        let mut scene = Scene::default();
        let grey = scene.add_material("grey", Material::Lambertian { albedo: DVec3::splat(0.5) });
        scene.add_sphere(DVec3::new(0.0, 0.0, -3.0), 0.5, grey);
        scene.add_sphere(DVec3::new(0.0, 0.0, -1.0), 0.5, grey);
        scene
    }

    #[test]
    fn the_nearest_sphere_is_picked() {
        let pick = two().pick(DVec3::ZERO, DVec3::NEG_Z).unwrap();
        assert_eq!((pick.sphere, pick.distance, pick.normal), (1, 0.5, DVec3::Z));
        assert_eq!(two().pick(DVec3::ZERO, DVec3::Y), None);
    }

    #[test]
    fn inside_eye_sees_far_side() {
        let pick = two().pick(DVec3::NEG_Z, DVec3::NEG_Z).unwrap();
        assert_eq!((pick.sphere, pick.distance, pick.normal), (1, 0.5, DVec3::Z));
        let on_surface = two().pick(DVec3::new(0.0, 0.0, -0.5), DVec3::Z);
        assert_eq!(on_surface, None);
        // Rounding may put the eye slightly below the surface of a large sphere.
        let mut earth = Scene::default();
        let ground = earth.add_material("ground", Material::Lambertian { albedo: DVec3::splat(0.5) });
        earth.add_sphere(DVec3::ZERO, 1e9, ground);
        assert_eq!(earth.pick(DVec3::Y * (1e9 - 1e-3), DVec3::Y), None);
        assert_eq!(earth.pick(DVec3::Y * (1e9 - 10.0), DVec3::Y).unwrap().distance, 10.0);
    }

    #[test]
    fn place_inverts_direction() {
        let camera = Camera { look_from: DVec3::new(3.0, 2.0, 1.0), ..Camera::BOOK };
        for at in [[0.0, 0.0], [0.5, 0.5], [1.0, 0.25]] {
            let point = camera.look_from + 7.0 * camera.direction_through(at, 1.5);
            let back = camera.place_of(point, 1.5).unwrap();
            assert!((back[0] - at[0]).abs() < 1e-9 && (back[1] - at[1]).abs() < 1e-9, "{at:?} {back:?}");
        }
        let middle = Camera::BOOK.direction_through([0.5, 0.5], 2.0);
        assert_eq!(middle, DVec3::NEG_Z);
        assert_eq!(Camera::BOOK.depth_of(DVec3::new(5.0, 5.0, -2.0)), 2.0);
        assert_eq!(Camera::BOOK.place_of(DVec3::Z, 1.0), None);
    }

    #[test]
    fn first_sphere_wins_tie() {
        let mut scene = two();
        scene.spheres.push(scene.spheres[1]);
        let pick = scene.pick(DVec3::ZERO, DVec3::NEG_Z).unwrap();
        assert_eq!((pick.sphere, pick.point), (1, DVec3::new(0.0, 0.0, -0.5)));
    }
}
