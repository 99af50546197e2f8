//! Balls that are small compared with their distance.

use super::build::{eye, glass, matte, of_scene, scene, sized};
use crate::scene::{Material, Sky};
use crate::stress::case::{Case, Expected, Family};
use glam::DVec3;

/// Distant balls.
pub const FAR: Family = Family {
    id: "far",
    title: "A ball that is tiny for its distance",
    lesson: "The hit point is the eye plus a vector of up to millions of radii, and the normal is what remains of \
             its digits. The book's quadratic subtracts two squares that agree in all their digits.",
};

/// Down to the narrowest view. The less of the view the ball fills, the more samples are taken.
pub fn far() -> Vec<Case> {
    let materials: [(&str, Material); 2] = [("matte", matte(0.5)), ("glass", glass(1.5))];
    let ratios = [
        (1e-2, 16.0, [24, 16], 32),
        (1e-4, 0.012, [24, 16], 32),
        (1e-5, 0.01, [8, 8], 1024),
        (5e-7, 0.01, [1, 1], 1 << 21),
    ];
    let mut cases = Vec::new();
    for (name, material) in materials {
        for (ratio, vfov, size, samples) in ratios {
            let offset = DVec3::new(0.36, 0.48, -0.8) / ratio;
            let camera = eye(DVec3::ZERO, offset, vfov);
            let sky = Sky { bottom: DVec3::ZERO, top: DVec3::ONE };
            let recipe = sized(of_scene(scene([(offset, 1.0, material)], sky), camera), size, samples);
            // `share` is the part of the view that the ball fills; a thousandth of its light may be wrong.
            let half_height = (0.5 * vfov.to_radians()).tan();
            let aspect = f64::from(size[0]) / f64::from(size[1]);
            let view = 4.0 * half_height * half_height * aspect;
            let share = (std::f64::consts::PI * ratio * ratio / view).min(1.0);
            let stiff = format!("a {name} ball of radius 1 at a distance of {:e}", (1.0 / ratio).round());
            let why = "in f64, the hit point keeps nine digits of the radius";
            let case = Case::new(&FAR, format!("{name}-{ratio:e}"), stiff, recipe)
                .expect(Expected::Reference { why }, 2e-6_f64.min(1e-3 * share));
            cases.push(case);
        }
    }
    cases
}
