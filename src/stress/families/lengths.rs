//! The whole scene moved or scaled, and extreme cameras.

use super::build::{eye, glass, matte, moved, of_scene, scene, tame};
use crate::recipe::Recipe;
use crate::scene::{Camera, Sky};
use crate::stress::case::{Case, Expected, Family};
use glam::DVec3;

/// Translations.
pub const MOVED: Family = Family {
    id: "moved",
    title: "The whole scene far from the origin",
    lesson: "A picture does not depend on where the origin is. In f32, a scene at 1e7 has no digits left for \
             lengths below 1, unless its coordinates are measured from near the eye.",
};

/// Scalings.
pub const SCALED: Family = Family {
    id: "scaled",
    title: "The whole scene larger or smaller",
    lesson: "A picture does not depend on the unit of length; a threshold that is a length does.",
};

/// Extreme cameras.
pub const LENSES: Family = Family {
    id: "lens",
    title: "Extreme angles, lenses and focus",
    lesson: "The narrowest view turns a pixel into a hundred-thousandth of a degree; the widest lens sends rays \
             almost parallel to its own plane.",
};

/// The tame scene, moved by ten to a billion units.
pub fn moved_scenes() -> Vec<Case> {
    [1, 3, 5, 7, 9]
        .into_iter()
        .map(|exponent| {
            let distance = 10.0_f64.powi(exponent);
            let offset = distance * DVec3::new(0.6, -0.48, 0.64);
            let stiff = format!("three balls on a ground, moved by 1e{exponent} units");
            // Positions at 1e9 have only seven digits after the point, even in f64.
            let tolerance = 2e-6 + 1e-15 * distance;
            let why = "a picture does not depend on where the origin is";
            let expected = Expected::Same { other: Box::new(tame()), why };
            let case = Case::new(&MOVED, format!("1e{exponent}"), stiff, moved(&tame(), 1.0, offset));
            let case = case.expect(expected, tolerance).beside(tame());
            let case = if exponent == 1 { case.quick() } else { case };
            if exponent == 5 {
                case.watched("A hundred thousand units from the origin", "The balls are round and their edges sharp, as at the origin. Here the book's f32 has only one or two digits after the point.")
            } else {
                case
            }
        })
        .collect()
}

/// The tame scene, scaled from a picometre to a light second or so.
pub fn scaled_scenes() -> Vec<Case> {
    [-12, -6, -3, 3, 6, 12]
        .into_iter()
        .map(|exponent| {
            let factor = 10.0_f64.powi(exponent);
            let stiff = format!("three balls on a ground, scaled by 1e{exponent}");
            let why = "a picture does not depend on the unit of length";
            let expected = Expected::Same { other: Box::new(tame()), why };
            let recipe = moved(&tame(), factor, DVec3::ZERO);
            let case = Case::new(&SCALED, format!("1e{exponent}"), stiff, recipe).of_unit(factor);
            let case = case.expect(expected, 2e-6).beside(tame()).quick();
            match exponent {
                -3 => case.watched(
"Balls of half a millimetre",
                    "Three balls of half a millimetre. The book's threshold of .001 is twice their radius, so \
                     they cast no shadows and the glass is empty.",
                ),
                6 => case.watched(
"Balls of five hundred kilometres",
"The same scene, a billion times as large. Here .001 is less than a rounding error, and with the \
                     book's arithmetic, rays hit the surface that they leave.",
                ),
                _ => case,
            }
        })
        .collect()
}

/// Extreme fields of view, lenses and focus distances.
pub fn lenses() -> Vec<Case> {
    let with = |change: fn(&mut Camera)| -> Recipe {
        let mut recipe = tame();
        change(&mut recipe.camera);
        recipe
    };
    let cases: [(&str, &str, Recipe); 6] = [
        ("narrowest", "a field of view of .01 degrees", with(|camera| camera.vfov_degrees = 0.01)),
        ("widest", "a field of view of 179 degrees", with(|camera| camera.vfov_degrees = 179.0)),
        (
            "wide-lens",
            "a lens of 178 degrees: most rays are almost parallel to its plane",
            with(|camera| camera.defocus_angle_degrees = 178.0),
        ),
        (
            "near-focus",
            "a focus 1e-4 in front of the eye, through a lens of 20 degrees",
            with(|camera| {
                camera.defocus_angle_degrees = 20.0;
                camera.focus_distance = Some(1e-4);
            }),
        ),
        (
            "far-focus",
            "a focus at 1e9, through a lens of 1e-7 degrees",
            with(|camera| {
                camera.defocus_angle_degrees = 1e-7;
                camera.focus_distance = Some(1e9);
            }),
        ),
        (
            "up-almost-along-the-view",
            "the up vector is a millionth off the view",
            with(|camera| camera.vup = camera.look_at - camera.look_from + 1e-6 * DVec3::Y),
        ),
    ];
    let mut cases: Vec<Case> = cases
        .into_iter()
        .map(|(name, stiff, recipe)| Case::new(&LENSES, name, stiff, recipe).beside(tame()).quick())
        .collect();
    let balls = [
        (DVec3::new(0.0, -1e6, 0.0), 1e6, matte(0.5)),
        (DVec3::new(0.0, 2e-4, 0.0), 1e-4, glass(1.5)),
        (DVec3::new(3e-4, 1e-4, 0.0), 1e-4, matte(0.7)),
    ];
    let look = eye(DVec3::new(0.0, 3e-4, 1.5e-3), DVec3::new(1e-4, 1e-4, 0.0), 30.0);
    let recipe = of_scene(scene(balls, Sky::default()), look);
    let stiff = "balls of 1e-4 on a ground of 1e6: ten orders of magnitude in one view";
    cases.push(Case::new(&LENSES, "marbles-on-a-planet", stiff, recipe).of_unit(1e-3).watched(
        "Marbles on a planet",
        "Two marbles cast shadows on a smooth ground. The book's arithmetic loses shadows shorter than its \
         threshold and rounds the ground to steps.",
    ));
    cases
}
