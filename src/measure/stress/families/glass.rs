//! Extreme refraction indices, trapped light, the longest paths, and nested spheres.

use super::build::{
    Ball, WHITE_SKY, around, counted, deep, eye, glass, in_front, matte, metal, of_scene, picture, scene,
    sized, tame,
};
use crate::job::recipe::Recipe;
use crate::measure::stress::case::{Case, Expected, Family};
use crate::scene::Sky;
use glam::DVec3;

fn rays(depth: u32) -> String {
    counted(depth as usize, "ray")
}

/// Glass of many indices, from outside and inside.
pub fn indices(family: &'static Family) -> Vec<Case> {
    let ball = |index: f64, look_from: DVec3| -> Recipe {
        let balls = [(DVec3::ZERO, 1.0, glass(index)), (DVec3::new(0.0, -101.0, 0.0), 100.0, matte(0.5))];
        of_scene(scene(balls, Sky::default()), eye(look_from, DVec3::ZERO, 40.0))
    };
    let outside = DVec3::new(0.0, 0.3, 3.0);
    let mut cases = Vec::new();
    for index in [1.0 + 1e-6, 1.0 + 1e-3, 2.4, 10.0, 100.0, 1e4, 1e6, 1e-4] {
        let name = if index == 1.0 + 1e-6 { "1+1e-6".to_owned() } else { format!("{index}") };
        let stiff = format!("glass of index {index}, seen from outside");
        cases.push(Case::new(family, name, stiff, ball(index, outside)));
    }
    for (name, index) in [("1.5", 1.5), ("100", 100.0), ("1e4", 1e4)] {
        let stiff = format!("the eye inside glass of index {name}");
        // Near the centre, so that some rays fall within the cone through which light leaves.
        let recipe = ball(index, DVec3::new(0.0, 0.3 / index, 0.1 / index));
        cases.push(Case::new(family, format!("within-{name}"), stiff, recipe));
    }
    cases
}

/// The eye in a glass ball, far enough from the centre that much of the light it sees is trapped.
pub fn trapped(family: &'static Family) -> Vec<Case> {
    let within = |look_at: DVec3, vfov: f64| {
        picture([(DVec3::ZERO, 1.0, glass(1.5))], eye(DVec3::new(0.9, 0.0, 0.0), look_at, vfov))
    };
    let mut cases = Vec::new();
    for (depth, size, samples) in [(1000, [12, 8], 16), (10_000, [8, 6], 4)] {
        let along = sized(deep(within(DVec3::new(0.9, 0.0, -1.0), 50.0), depth), size, samples);
        let stiff = format!("the eye in glass, looking along its wall, up to {} per path", rays(depth));
        let why = "at 0.9 of the radius and at most 40 degrees off the tangent, the sine of the angle of incidence is \
                   above 0.68; the critical sine is 1/1.5, so nothing gets out";
        cases.push(Case::new(family, format!("along-{depth}"), stiff, along).every(0.0, why));
        let across = sized(deep(within(DVec3::new(0.4, 0.0, -1.0), 80.0), depth), size, samples);
        let stiff = format!("the same with the critical angle in view, up to {} per path", rays(depth));
        let why = "in f64, the angle drifts by 1e-13 in ten thousand reflections";
        let case = Case::new(family, format!("critical-{depth}"), stiff, across);
        cases.push(case.expect(Expected::Reference, why, 2e-6));
    }
    cases
}

/// Several maximum depths, and many samples.
pub fn depths(family: &'static Family) -> Vec<Case> {
    let mirrors = |gap: f64| {
        let balls = [
            (DVec3::new(-1.0 - gap, 0.0, 0.0), 1.0, metal(1.0, 0.0)),
            (DVec3::new(1.0 + gap, 0.0, 0.0), 1.0, metal(1.0, 0.0)),
            (DVec3::new(0.0, 1.7, 0.0), 1.0, metal(1.0, 0.0)),
        ];
        deep(picture(balls, eye(DVec3::new(0.0, 0.0, 3.0), DVec3::new(0.0, 0.5, 0.0), 40.0)), 10_000)
    };
    let why = "the mirrors reflect all light, and every path finds its way out to a sky of 1";
    let mut cases = Vec::new();
    for (name, gap) in [("mirrors", 0.05), ("mirrors-1e-6-apart", 1e-6), ("mirrors-touching", 0.0)] {
        let apart = if gap == 0.0 { "that touch".to_owned() } else { format!("{gap:e} apart") };
        let stiff = format!("three mirrors {apart}: each reflection multiplies errors");
        cases.push(Case::new(family, name, stiff, mirrors(gap)).expect(Expected::Mean(1.0), why, 2e-6));
    }
    let well = |depth: u32| {
        // A white ball, open at the top: its lid is slightly too small.
        let balls = [(DVec3::ZERO, 1.0, matte(0.9)), (DVec3::new(0.0, -101.0, 0.0), 100.0, matte(0.5))];
        deep(picture(balls, eye(DVec3::new(0.0, 0.2, 2.0), DVec3::new(0.0, -1.0, 0.0), 30.0)), depth)
    };
    for depth in [1, 2, 10_000] {
        let stiff = format!("a ball that touches the ground, up to {} per path", rays(depth));
        cases.push(Case::new(family, depth, stiff, well(depth)));
    }
    let many = sized(tame(), [4, 4], 65_536);
    let stiff = "65,536 samples of 16 pixels: more loop iterations than some drivers allow per invocation";
    cases.push(Case::new(family, "many-samples", stiff, many));
    let room = picture([(DVec3::ZERO, 1.0, matte(1.0))], eye(DVec3::new(0.1, 0.2, 0.3), DVec3::X, 90.0));
    let stiff = "a closed white room, up to 10,000 rays per path";
    let case = Case::new(family, "closed-10000", stiff, sized(deep(room, 10_000), [4, 4], 16));
    cases.push(case.every(0.0, "the room is closed: no path leaves it"));
    cases
}

pub fn shells(family: &'static Family) -> Vec<Case> {
    let nested = |count: usize| -> Vec<Ball> {
        (0..count).map(|index| (DVec3::ZERO, 1.0 - 0.9 * index as f64 / count as f64, matte(0.5))).collect()
    };
    let mut cases = Vec::new();
    for count in [1, 50, 105, 108, 1000, 10_000] {
        let recipe = sized(picture(nested(count), in_front()), [24, 16], if count > 1000 { 4 } else { 32 });
        let stiff = format!("{}: no box lies beside another", counted(count, "concentric shell"));
        let why = "only the outermost shell is seen, a convex ball of albedo 0.5 under a sky of 1";
        cases.push(Case::new(family, count, stiff, recipe).every(0.5, why));
    }
    for pairs in [1, 5, 50] {
        let mut balls: Vec<Ball> = Vec::new();
        for pair in 0..pairs {
            let outer = 1.0 - 0.9 * f64::from(pair) / f64::from(pairs);
            balls.push((DVec3::ZERO, outer, glass(1.5)));
            balls.push((DVec3::ZERO, outer - 0.45 / f64::from(pairs), glass(1.0 / 1.5)));
        }
        let size = if pairs < 50 { [24, 16] } else { [12, 8] };
        let recipe = sized(deep(of_scene(scene(balls, WHITE_SKY), in_front()), 10_000), size, 16);
        let bubbles = if pairs == 1 { "one bubble".to_owned() } else { format!("{pairs} nested bubbles") };
        let stiff = format!("{bubbles} of glass: long paths of reflections alone");
        let why = "glass absorbs nothing, and within 10,000 rays practically every path reaches a sky of 1";
        let case = Case::new(family, format!("glass-{pairs}"), stiff, recipe);
        cases.push(case.expect(Expected::Mean(1.0), why, 1e-6));
    }
    cases
}

/// Coats of decreasing thickness, at the origin and far from it.
pub fn coats(family: &'static Family) -> Vec<Case> {
    let coat = |thickness: f64, offset: DVec3| {
        let balls = [(offset, 1.0, glass(1.5)), (offset, 1.0 - thickness, matte(0.5))];
        of_scene(scene(balls, Sky::default()), around(offset))
    };
    let why = "in f64, the thickness keeps nine digits";
    let mut cases = Vec::new();
    for exponent in 3..=7 {
        let stiff = format!("a coat of 1e-{exponent} over a ball of radius 1");
        let case =
            Case::new(family, format!("1e-{exponent}"), stiff, coat(10.0_f64.powi(-exponent), DVec3::ZERO));
        cases.push(case.expect(Expected::Reference, why, 2e-6));
    }
    for (exponent, distance) in [(3, 4), (3, 5), (4, 4), (4, 5)] {
        let offset = 10.0_f64.powi(distance) * DVec3::new(1.0, 0.5, -0.7);
        let stiff = format!("a coat of 1e-{exponent} close to the eye, 1e{distance} from the origin");
        let (name, recipe) =
            (format!("1e-{exponent}-at-1e{distance}"), coat(10.0_f64.powi(-exponent), offset));
        let why = "in f64, the thickness keeps seven digits";
        cases.push(Case::new(family, name, stiff, recipe).expect(Expected::Reference, why, 2e-6));
    }
    let shell = 1e-4;
    let offset = DVec3::new(1e5, 2e4, -6e4);
    let balls = [(offset, 1.0, glass(1.5)), (offset, 1.0 - shell, glass(1.0 / 1.5))];
    let look = eye(offset + DVec3::new(0.0, 0.0, 3.0), offset, 50.0);
    let recipe = of_scene(scene(balls, Sky::default()), look);
    let stiff = "a bubble with a skin of 1e-4, close to the eye and 1e5 from the origin";
    cases.push(Case::new(family, "bubble-at-1e5", stiff, recipe).expect(Expected::Reference, why, 2e-6));
    cases
}
