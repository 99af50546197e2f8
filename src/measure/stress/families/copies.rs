//! Spheres at the same place, or almost.

use super::build::{Ball, around, grouped, in_front, matte, named, of_scene, picture, scene, sized};
use crate::job::recipe::Recipe;
use crate::measure::stress::case::{Case, Expected, Family};
use crate::scene::{Camera, Material, Scene, Sky};
use glam::DVec3;
use std::sync::Arc;

const WHY: &str = "a convex ball of albedo 0.5 under a sky of 1: one bounce, whatever the copies";

/// Identical balls, up to a hundred thousand.
pub fn copies(family: &'static Family) -> Vec<Case> {
    let counts = [2, 3, 10, 110, 1000, 10_000, 20_000, 100_000];
    let identical = counts.into_iter().map(|count| {
        let balls = vec![(DVec3::ZERO, 1.0, matte(0.5)); count];
        let stiff = format!(
            "{} identical balls: no plane separates them, and every hit is a tie between all of them",
            grouped(count as u64)
        );
        // Large counts test the build and depth of the hierarchy, so few samples suffice.
        let (size, samples) = match count {
            0..=1000 => ([24, 16], 32),
            1001..=20_000 => ([24, 16], 4),
            _ => ([12, 8], 4),
        };
        let recipe = sized(picture(balls, in_front()), size, samples);
        Case::new(family, count, stiff, recipe).every(0.5, WHY)
    });
    let mut cases: Vec<Case> = identical.collect();

    let red = Material::Lambertian { albedo: DVec3::new(0.5, 0.0, 0.0) };
    let green = Material::Lambertian { albedo: DVec3::new(0.0, 0.5, 0.0) };
    for (name, first, second, value) in
        [("red-green", red, green, [0.5, 0.0, 0.0]), ("green-red", green, red, [0.0, 0.5, 0.0])]
    {
        let recipe = picture([(DVec3::ZERO, 1.0, first), (DVec3::ZERO, 1.0, second)], in_front());
        let why =
            "of two surfaces at the same place, the first in the scene is seen, in a list as in a hierarchy";
        let stiff = "two balls of different colours at the same place: which one is seen must not depend on the search";
        cases.push(Case::new(family, name, stiff, recipe).expect(Expected::Every(value), why, 1e-6));
    }

    let mut balls: Vec<Ball> = (0..5000).map(|index| scattered(index, 0.4)).collect();
    balls.extend(vec![balls[0]; 120]);
    let look = in_front();
    let recipe = sized(of_scene(scene(balls.clone(), Sky::default()), look), [24, 16], 8);
    balls.truncate(5000);
    let other = sized(of_scene(scene(balls, Sky::default()), look), [24, 16], 8);
    let why = "a copy of a matte ball adds neither a surface nor a random number";
    let expected = Expected::Same(Box::new(named(other, "without copies")));
    let stiff = "5,000 balls and 120 copies of one of them";
    cases.push(Case::new(family, "one-of-5000", stiff, recipe).expect(expected, why, 1e-9));
    cases
}

/// Ball `index` of a cloud, in a cube around the origin.
fn scattered(index: u32, half_width: f64) -> Ball {
    let [a, b, c, d] =
        crate::kernel::sampling::pcg4d([index, 1, 2, 3]).map(|word| f64::from(word) / 4_294_967_296.0);
    let place = DVec3::new(a, b, c) * 2.0 - DVec3::ONE;
    (half_width * place, 0.004 + 0.004 * d, matte(0.5))
}

/// Two balls, one of them shifted along the view or across it.
pub fn shifts(family: &'static Family) -> Vec<Case> {
    let mut cases = Vec::new();
    for exponent in [9, 8, 7, 6, 5, 4, 3] {
        for (axis, direction) in [("z", DVec3::Z), ("x", DVec3::X)] {
            let shift = 10.0_f64.powi(-exponent);
            let balls = [(DVec3::ZERO, 1.0, matte(0.5)), (shift * direction, 1.0, matte(0.5))];
            let stiff = format!("two balls {shift:e} apart along {axis}: too close for any threshold");
            let why = "the two balls are convex, except for a crease as shallow as the shift";
            let case = Case::new(family, format!("1e-{exponent}-{axis}"), stiff, picture(balls, in_front()));
            cases.push(case.expect(Expected::Mean(0.5), why, 1e-6 + shift));
        }
    }
    cases.push(overlapping(family));
    cases
}

/// Twenty overlapping balls far from the origin.
fn overlapping(family: &'static Family) -> Case {
    let offset = DVec3::new(1e4, 1e4, 1e4);
    let ball = |index: u32| {
        let (center, _, material) = scattered(index, 0.7);
        (center + offset, 0.5, material)
    };
    let recipe = of_scene(scene((0..20).map(ball), Sky::default()), around(offset));
    let stiff =
        "20 overlapping balls at 1e4: by rounding, a ray that leaves one of them starts inside others";
    let why = "in f64, positions at 1e4 have twelve digits after the point";
    Case::new(family, "overlapping-at-1e4", stiff, recipe).expect(Expected::Reference, why, 5e-6)
}

/// The field with each of several changes.
pub fn odd_ones(family: &'static Family) -> Vec<Case> {
    let Some(field) = Recipe::builtin("field:4000") else { return Vec::new() };
    let field = named(sized(field, [48, 32], 16), "field:4000");
    type Change = (&'static str, &'static str, fn(&mut Scene, &mut Camera));
    let changes: [Change; 5] = [
        ("tiny", "one ball of radius 1e-4 among 4,000 of about 0.3", |scene, camera| {
            scene.add_sphere(camera.look_at + 2.0 * DVec3::Y, 1e-4, 0);
        }),
        ("focus", "a focus 1e-4 in front of the eye", |_, camera| camera.focus_distance = Some(1e-4)),
        ("eye", "the eye 1e-4 from a ball", |scene, camera| {
            scene.add_sphere(camera.look_from + 0.3001 * DVec3::Y, 0.3, 0);
        }),
        ("huge", "a second ground of radius 1e9 below", |scene, _| {
            scene.add_sphere(DVec3::new(0.0, -1e9 - 50.0, 0.0), 1e9, 0);
        }),
        ("copies", "a hundred copies of one ball", |scene, _| {
            scene.spheres.extend(vec![scene.spheres[1]; 100]);
        }),
    ];
    let case = |(name, stiff, change): Change| {
        let mut recipe = field.clone();
        change(Arc::make_mut(&mut recipe.scene), &mut recipe.camera);
        Case::new(family, name, stiff, recipe)
    };
    changes.into_iter().map(case).collect()
}
