//! Spheres inside spheres: shells and coats.

use super::build::{
    Ball, WHITE_SKY, around, counted, deep, eye, glass, in_front, matte, named, of_scene, picture, scene, sized,
};
use crate::scene::Sky;
use crate::measure::stress::case::{Case, Expected, Family};
use glam::DVec3;

/// Nested spheres.
pub const SHELLS: Family = Family {
    id: "shells",
    title: "Spheres inside spheres",
    lesson: "Concentric shells are the worst case for a hierarchy: every box contains all smaller ones, so the tree \
             can become as deep as there are shells.",
};

/// Thin coats.
pub const COATS: Family = Family {
    id: "coats",
    title: "A coat of glass over matte",
    lesson: "The coat's thickness is the difference of two radii. The thinner the coat and the farther from the \
             origin, the fewer of its digits remain.",
};

/// One to ten thousand shells.
pub fn shells() -> Vec<Case> {
    let nested = |count: usize| -> Vec<Ball> {
        (0..count).map(|index| (DVec3::ZERO, 1.0 - 0.9 * index as f64 / count as f64, matte(0.5))).collect()
    };
    let mut cases: Vec<Case> = [1, 50, 105, 108, 1000, 10_000]
        .into_iter()
        .map(|count| {
            let recipe =
                sized(picture(nested(count), in_front()), [24, 16], if count > 1000 { 4 } else { 32 });
            let stiff = format!("{}: no box lies beside another", counted(count, "concentric shell"));
            let why = "only the outermost shell is seen, a convex ball of albedo .5 under a sky of 1";
            Case::new(&SHELLS, count, stiff, recipe).every(0.5, why).quick_if(count <= 108)
        })
        .collect();
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
        let stiff = format!("{bubbles} of glass: long paths of nothing but reflections");
        let why = "glass absorbs nothing, and within 10,000 rays practically every path reaches a sky of 1";
        let case = Case::new(&SHELLS, format!("glass-{pairs}"), stiff, recipe);
        cases.push(case.expect(Expected::Mean(1.0), why, 1e-6));
    }
    cases
}

/// Coats of decreasing thickness, at the origin and far from it.
pub fn coats() -> Vec<Case> {
    let coat = |thickness: f64, offset: DVec3| {
        let balls = [(offset, 1.0, glass(1.5)), (offset, 1.0 - thickness, matte(0.5))];
        of_scene(scene(balls, Sky::default()), around(offset))
    };
    let why = "in f64, the thickness keeps nine digits";
    let mut cases: Vec<Case> = (3..=7)
        .map(|exponent| {
            let stiff = format!("a coat of 1e-{exponent} over a ball of radius 1");
            let recipe = coat(10.0_f64.powi(-exponent), DVec3::ZERO);
            Case::new(&COATS, format!("1e-{exponent}"), stiff, recipe)
                .expect(Expected::Reference, why, 2e-6)
                .beside(named(coat(0.1, DVec3::ZERO), "a coat of .1"))
        })
        .collect();
    for (exponent, distance) in [(3, 4), (3, 5), (4, 4), (4, 5)] {
        let offset = 10.0_f64.powi(distance) * DVec3::new(1.0, 0.5, -0.7);
        let stiff = format!("a coat of 1e-{exponent} close to the eye, 1e{distance} from the origin");
        let (name, recipe) =
            (format!("1e-{exponent}-at-1e{distance}"), coat(10.0_f64.powi(-exponent), offset));
        let why = "in f64, the thickness keeps seven digits";
        cases.push(Case::new(&COATS, name, stiff, recipe).expect(Expected::Reference, why, 2e-6));
    }
    let shell = 1e-4;
    let offset = DVec3::new(1e5, 2e4, -6e4);
    let balls = [(offset, 1.0, glass(1.5)), (offset, 1.0 - shell, glass(1.0 / 1.5))];
    let look = eye(offset + DVec3::new(0.0, 0.0, 3.0), offset, 50.0);
    let recipe = of_scene(scene(balls, Sky::default()), look);
    let stiff = "a bubble with a skin of 1e-4, close to the eye and 1e5 from the origin";
    cases.push(Case::new(&COATS, "bubble-at-1e5", stiff, recipe).expect(Expected::Reference, why, 2e-6));
    cases
}
