//! Spheres in the form that hierarchies are built from.

use crate::kernel::BOX_MARGIN;
use crate::scene::Sphere;
use glam::DVec3;
use obvhs::Boundable;
use obvhs::aabb::Aabb;

/// A sphere relative to an origin, with its box widened by the rounding error of the intersection test. The box is
/// computed on demand, because storing millions of boxes would take most of a build's time.
pub(super) struct Bounded<'a> {
    sphere: &'a Sphere,
    origin: &'a DVec3,
}

impl<'a> Bounded<'a> {
    /// Wraps all `spheres`, with coordinates relative to `origin`.
    pub(super) fn all<'scene: 'a>(
        spheres: impl IntoIterator<Item = &'scene Sphere>,
        origin: &'a DVec3,
    ) -> Vec<Self> {
        spheres.into_iter().map(|sphere| Bounded { sphere, origin }).collect()
    }

    pub(super) fn center(&self) -> DVec3 {
        self.sphere.center - *self.origin
    }

    pub(super) fn radius(&self) -> f64 {
        self.sphere.radius
    }
}

impl Boundable for Bounded<'_> {
    fn aabb(&self) -> Aabb {
        let (center, radius) = (self.center(), self.radius());
        let reach = radius + BOX_MARGIN * (radius + center.abs().max_element());
        let below = |x: f64| (x as f32).next_down();
        let above = |x: f64| (x as f32).next_up();
        let vector = |v: DVec3, f: fn(f64) -> f32| glam::Vec3A::new(f(v.x), f(v.y), f(v.z));
        Aabb::new(vector(center - reach, below), vector(center + reach, above))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_allow_for_rounding() {
        for (place, radius) in [(0.0, 3.0), (5.0, 0.1), (-7.0, 7.0)] {
            let (center, origin) = (DVec3::new(0.0, place, 0.0), DVec3::ZERO);
            let sphere = Sphere { center, radius, material: 0 };
            let aabb = Bounded::all([&sphere], &origin)[0].aabb();
            let room = BOX_MARGIN * place.abs().max(radius);
            for axis in 0..3 {
                let [low, high] = [aabb.min[axis], aabb.max[axis]].map(f64::from);
                assert!(
                    low <= center[axis] - radius - room && high >= center[axis] + radius + room,
                    "{aabb:?}"
                );
            }
        }
    }
}
