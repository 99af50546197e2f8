//! The whole scene moved or scaled, and extreme cameras.

use super::build::{eye, glass, matte, moved, of_scene, scene, sized, tame};
use crate::measure::stress::case::{Case, Expected, Family};
use crate::scene::{Camera, Material, Sky};
use glam::DVec3;

/// The tame scene, moved by ten to a billion units.
pub fn moved_scenes(family: &'static Family) -> Vec<Case> {
    [1, 3, 5, 7, 9]
        .into_iter()
        .map(|exponent| {
            let distance = 10.0_f64.powi(exponent);
            let offset = distance * DVec3::new(0.6, -0.48, 0.64);
            let stiff = format!("three balls on a ground, moved by 1e{exponent} units");
            // At 1e9, even f64 positions have only seven decimal places.
            let tolerance = 2e-6 + 1e-15 * distance;
            let why = "a picture does not depend on where the origin is";
            let expected = Expected::Same(Box::new(tame()));
            let case = Case::new(family, format!("1e{exponent}"), stiff, moved(&tame(), 1.0, offset));
            let case = case.expect(expected, why, tolerance);
            if exponent == 5 {
                case.watched(
                    "A hundred thousand units from the origin",
                    "The balls are round and their edges sharp, as at the origin. Here the book's f32 has only one or \
                     two digits after the point.",
                )
            } else {
                case
            }
        })
        .collect()
}

/// The tame scene, scaled from about a picometre to a light second.
pub fn scaled_scenes(family: &'static Family) -> Vec<Case> {
    [-12, -6, -3, 3, 6, 12]
        .into_iter()
        .map(|exponent| {
            let factor = 10.0_f64.powi(exponent);
            let stiff = format!("three balls on a ground, scaled by 1e{exponent}");
            let why = "a picture does not depend on the unit of length";
            let expected = Expected::Same(Box::new(tame()));
            let recipe = moved(&tame(), factor, DVec3::ZERO);
            let case = Case::new(family, format!("1e{exponent}"), stiff, recipe).of_unit(factor);
            let case = case.expect(expected, why, 2e-6);
            match exponent {
                -3 => case.watched(
                    "Balls of half a millimetre",
                    "Three balls of half a millimetre. The book's threshold of 0.001 is twice their radius, so \
                     they cast no shadows and the glass is empty.",
                ),
                6 => case.watched(
                    "Balls of five hundred kilometres",
                    "The same scene, a billion times as large. Here 0.001 is less than a rounding error, and with the \
                     book's arithmetic, rays hit the surface that they leave.",
                ),
                _ => case,
            }
        })
        .collect()
}

/// Extreme fields of view, lenses and focus distances.
pub fn lenses(family: &'static Family) -> Vec<Case> {
    type Change = (&'static str, &'static str, fn(&mut Camera));
    let changes: [Change; 6] = [
        ("narrowest", "a field of view of 0.01 degrees", |camera| camera.vfov_degrees = 0.01),
        ("widest", "a field of view of 179 degrees", |camera| camera.vfov_degrees = 179.0),
        ("wide-lens", "a lens of 178 degrees: most rays are almost parallel to its plane", |camera| {
            camera.defocus_angle_degrees = 178.0;
        }),
        ("near-focus", "a focus 1e-4 in front of the eye, through a lens of 20 degrees", |camera| {
            camera.defocus_angle_degrees = 20.0;
            camera.focus_distance = Some(1e-4);
        }),
        ("far-focus", "a focus at 1e9, through a lens of 1e-7 degrees", |camera| {
            camera.defocus_angle_degrees = 1e-7;
            camera.focus_distance = Some(1e9);
        }),
        ("up-almost-along-the-view", "the up vector is a millionth off the view", |camera| {
            camera.vup = camera.look_at - camera.look_from + 1e-6 * DVec3::Y;
        }),
    ];
    let mut cases = Vec::new();
    for (name, stiff, change) in changes {
        let mut recipe = tame();
        change(&mut recipe.camera);
        cases.push(Case::new(family, name, stiff, recipe));
    }
    let balls = [
        (DVec3::new(0.0, -1e6, 0.0), 1e6, matte(0.5)),
        (DVec3::new(0.0, 2e-4, 0.0), 1e-4, glass(1.5)),
        (DVec3::new(3e-4, 1e-4, 0.0), 1e-4, matte(0.7)),
    ];
    let look = eye(DVec3::new(0.0, 3e-4, 1.5e-3), DVec3::new(1e-4, 1e-4, 0.0), 30.0);
    let recipe = of_scene(scene(balls, Sky::default()), look);
    let stiff = "balls of 1e-4 on a ground of 1e6: ten orders of magnitude in one view";
    cases.push(Case::new(family, "marbles-on-a-planet", stiff, recipe).of_unit(1e-3).watched(
        "Marbles on a planet",
        "Two marbles cast shadows on a smooth ground. The book's arithmetic loses shadows shorter than its \
         threshold and rounds the ground to steps.",
    ));
    cases
}

/// Down to the narrowest view. The less of the view the ball fills, the more samples are taken.
pub fn far(family: &'static Family) -> Vec<Case> {
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
            let case = Case::new(family, format!("{name}-{ratio:e}"), stiff, recipe);
            cases.push(case.expect(Expected::Reference, why, 2e-6_f64.min(1e-3 * share)));
        }
    }
    cases
}
