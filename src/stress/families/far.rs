//! Balls that are small beside their distance.

use super::build::{eye, glass, matte, of_scene, scene, sized};
use crate::scene::{Material, Sky};
use crate::stress::case::{Case, Expected, Family};
use glam::DVec3;

/// Balls far away.
pub const FAR: Family = Family {
    id: "far",
    title: "A ball that is tiny beside its distance",
    lesson: "The hit is the eye plus a distance that is millions of radii long, and the normal is what is left of \
             it. The book's quadratic subtracts two squares that agree in all their digits.",
};

/// The narrowest view there is, with more and more samples the less of it the ball fills.
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
            // Of the view, the ball fills so much; what is asked for is that share of a thousandth of its light.
            let half_height = (0.5 * vfov.to_radians()).tan();
            let aspect = f64::from(size[0]) / f64::from(size[1]);
            let view = 4.0 * half_height * half_height * aspect;
            let share = (std::f64::consts::PI * ratio * ratio / view).min(1.0);
            let stiff = format!("a {name} ball of 1 at a distance of {:e}", 1.0 / ratio);
            let why = "in f64 the hit keeps nine digits of the radius";
            let case = Case::new(&FAR, format!("{name}-{ratio:e}"), stiff, recipe)
                .expect(Expected::Reference { why }, 2e-6_f64.min(1e-3 * share));
            cases.push(case);
        }
    }
    cases
}
