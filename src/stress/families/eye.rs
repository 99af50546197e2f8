//! The eye on a surface or next to it.

use super::build::{eye, glass, matte, metal, picture};
use crate::scene::Material;
use crate::stress::case::{Case, Expected, Family};
use glam::DVec3;

/// The eye near surfaces.
pub const EYE: Family = Family {
    id: "eye",
    title: "The eye on a surface",
    lesson: "Only the camera's rays start where no ray has arrived. Exactly on a surface, they must \
             leave it like any other rays.",
};

/// The eye at several heights above several surfaces, looking away and down.
pub fn eye_near_a_surface() -> Vec<Case> {
    let mut cases = Vec::new();
    let heights = [("0", 0.0), ("1e-12", 1e-12), ("1e-9", 1e-9), ("1e-6", 1e-6), ("1e-3", 1e-3)];
    let ball = DVec3::new(0.2, -0.3, 0.1);
    // Its length is exactly 1 in f64.
    let tilted = DVec3::new(0.48, 0.6, 0.64);
    let surfaces: [(&str, &str, DVec3, f64, DVec3, Material); 4] = [
        ("ball", "a matte ball", ball, 1.0, tilted, matte(0.5)),
        ("ground", "the ground", DVec3::new(0.0, -1000.0, 0.0), 1000.0, DVec3::Y, matte(0.5)),
        ("glass", "a glass ball", ball, 1.0, tilted, glass(1.5)),
        ("metal", "a metal ball", ball, 1.0, tilted, metal(0.5, 0.0)),
    ];
    for (surface, words, center, radius, up, material) in surfaces {
        for (name, height) in heights {
            let look_from = center + (radius + height) * up;
            let away = picture([(center, radius, material)], eye(look_from, look_from + up, 90.0));
            let place = if height == 0.0 { "on".to_owned() } else { format!("{height:e} above") };
            let stiff = format!("the eye {place} {words}, looking away from it");
            let why = "nothing but a sky of 1 is in view";
            let case = Case::new(&EYE, format!("{surface}-{name}-away"), stiff, away).every(1.0, why);
            cases.push(if surface == "ball" { case.quick() } else { case });
            if height > 0.0 && surface != "glass" {
                let down = picture([(center, radius, material)], eye(look_from, center, 90.0));
                let stiff = format!("the eye {place} {words}, looking at it");
                let why = "a convex surface that reflects half the light fills the view, and each path bounces once";
                cases.push(Case::new(&EYE, format!("{surface}-{name}-down"), stiff, down).every(0.5, why));
            }
        }
    }
    let glass_down = |height: f64| {
        let look_from = ball + (1.0 + height) * tilted;
        picture([(ball, 1.0, glass(1.5))], eye(look_from, ball, 90.0))
    };
    for (name, height) in [("1e-9", 1e-9), ("1e-3", 1e-3)] {
        let stiff = format!("the eye {height:e} above a glass ball, looking into it");
        let why = "glass absorbs nothing: a sky of 1 is seen through it or reflected in it";
        cases.push(
            Case::new(&EYE, format!("glass-{name}-down"), stiff, glass_down(height))
                .expect(Expected::Mean { value: 1.0, why }, 1e-6),
        );
    }
    cases
}
