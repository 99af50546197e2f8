//! Closed rooms, which no light enters or leaves, and eyes on or near a surface.

use super::build::{Ball, deep, eye, glass, matte, metal, moved, picture, sized};
use crate::job::recipe::Recipe;
use crate::measure::stress::case::{Case, Expected, Family};
use crate::scene::Material;
use glam::DVec3;

/// Alone, touching the ground, and cut by it; near the origin and far from it.
pub fn cavities(family: &'static Family) -> Vec<Case> {
    let materials = [
        ("white", matte(1.0)),
        ("matte", matte(0.5)),
        ("metal", metal(0.9, 0.0)),
        ("fuzzy", metal(0.9, 0.3)),
    ];
    let mut cases = Vec::new();
    for (material_name, material) in materials {
        let phrase = if material_name == "fuzzy" { "fuzzy metal" } else { material_name };
        for (place, ground) in [("alone", None), ("touching", Some(-1001.0)), ("cut", Some(-1000.4))] {
            let stiff = match place {
                "alone" => format!("the eye in a closed {phrase} ball"),
                "touching" => format!("the eye in a {phrase} ball that stands on the ground"),
                _ => format!("the eye in a {phrase} ball that the ground cuts"),
            };
            let name = format!("{material_name}-{place}");
            cases.push(Case::new(family, name, stiff, room(material, ground)));
        }
    }
    let touching = room(matte(1.0), Some(-1001.0));
    let away = |recipe: &Recipe| moved(recipe, 1.0, DVec3::new(800.0, 0.0, 600.0));
    let many_rays = |recipe: Recipe| sized(deep(recipe, 2000), [8, 8], 8);
    let stiff = "a white ball that touches the ground, up to 2,000 rays per path: each bounce is a chance to slip out";
    cases.push(Case::new(family, "white-touching-deep", stiff, many_rays(touching.clone())));
    let stiff = "a white ball that touches the ground, 1,000 units from the origin";
    cases.push(Case::new(family, "white-touching-at-1000", stiff, away(&touching)).watched(
        "A closed room, a thousand units from the origin",
        "Nothing: the room is closed and black. With the book's arithmetic in f32, some paths slip through the wall, \
         each of them a bright speck.",
    ));
    let stiff = "the same, up to 2,000 rays per path";
    cases.push(Case::new(family, "white-touching-at-1000-deep", stiff, many_rays(away(&touching))));
    let stiff = "a white ball alone, 1,000 units from the origin";
    cases.push(Case::new(family, "white-at-1000", stiff, away(&room(matte(1.0), None))));
    for factor in [1e-6, 1e-3, 1e6] {
        let recipe = moved(&touching, factor, DVec3::ZERO);
        let stiff = format!("a white ball of radius {factor:e} that touches the ground");
        let name = format!("white-touching-of-{factor:e}");
        cases.push(Case::new(family, name, stiff, recipe).of_unit(factor));
    }
    cases.into_iter().map(|case| case.every(0.0, "the room is closed: no path leaves it")).collect()
}

/// A unit ball at the origin around the eye, and a ground of radius 1000 centred at this height.
fn room(material: Material, ground: Option<f64>) -> Recipe {
    let ground = ground.map(|y| (DVec3::new(0.0, y, 0.0), 1000.0, matte(1.0)));
    let balls: Vec<Ball> = [(DVec3::ZERO, 1.0, material)].into_iter().chain(ground).collect();
    picture(balls, eye(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.3, -1.0, -0.2), 90.0))
}

/// Eyes at several heights above several surfaces, looking away and down.
pub fn eye_near_a_surface(family: &'static Family) -> Vec<Case> {
    let mut cases = Vec::new();
    let heights = [("0", 0.0), ("1e-12", 1e-12), ("1e-9", 1e-9), ("1e-6", 1e-6), ("1e-3", 1e-3)];
    let ball = DVec3::new(0.2, -0.3, 0.1);
    // Exactly unit length in f64.
    let tilted = DVec3::new(0.48, 0.6, 0.64);
    let surfaces: [(&str, &str, DVec3, f64, DVec3, Material); 4] = [
        ("ball", "a matte ball", ball, 1.0, tilted, matte(0.5)),
        ("ground", "the ground", DVec3::new(0.0, -1000.0, 0.0), 1000.0, DVec3::Y, matte(0.5)),
        ("glass", "a glass ball", ball, 1.0, tilted, glass(1.5)),
        ("metal", "a metal ball", ball, 1.0, tilted, metal(0.5, 0.0)),
    ];
    for (surface, phrase, center, radius, up, material) in surfaces {
        for (name, height) in heights {
            let look_from = center + (radius + height) * up;
            let away = picture([(center, radius, material)], eye(look_from, look_from + up, 90.0));
            let place = if height == 0.0 { "on".to_owned() } else { format!("{height:e} above") };
            let stiff = format!("the eye {place} {phrase}, looking away from it");
            let why = "only a sky of 1 is in view";
            cases.push(Case::new(family, format!("{surface}-{name}-away"), stiff, away).every(1.0, why));
            if height > 0.0 && surface != "glass" {
                let down = picture([(center, radius, material)], eye(look_from, center, 90.0));
                let stiff = format!("the eye {place} {phrase}, looking at it");
                let why = "a convex surface that reflects half the light fills the view, and each path bounces once";
                cases.push(Case::new(family, format!("{surface}-{name}-down"), stiff, down).every(0.5, why));
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
        let case = Case::new(family, format!("glass-{name}-down"), stiff, glass_down(height));
        cases.push(case.expect(Expected::Mean(1.0), why, 1e-6));
    }
    cases
}
