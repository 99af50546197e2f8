//! One unusual sphere among many, which must not slow the others down.

use super::build::{named, sized};
use crate::recipe::Recipe;
use crate::scene::Scene;
use crate::stress::case::{Case, Family};
use glam::DVec3;
use std::sync::Arc;

/// One unusual thing in a large field.
pub const ODD: Family = Family {
    id: "odd",
    title: "One odd thing among four thousand balls",
    lesson: "If one sphere needs more precision, only that sphere should pay for it. Anchoring all spheres would turn \
             the hierarchy into a list.",
};

/// The field with each of several changes.
pub fn odd_ones() -> Vec<Case> {
    let Some(field) = Recipe::builtin("field:4000") else { return Vec::new() };
    let field = named(sized(field, [48, 32], 16), "field:4000");
    let with = |change: &dyn Fn(&mut Scene, &mut Recipe)| {
        let mut recipe = field.clone();
        let mut scene = Scene::clone(&recipe.scene);
        change(&mut scene, &mut recipe);
        Recipe { scene: Arc::new(scene), ..recipe }
    };
    let cases = [
        (
            "tiny",
            "one ball of radius 1e-4 among 4,000 of about .3",
            with(&|scene, recipe| scene.add_sphere(recipe.camera.look_at + 2.0 * DVec3::Y, 1e-4, 0)),
        ),
        (
            "focus",
            "a focus 1e-4 in front of the eye",
            with(&|_, recipe| recipe.camera.focus_distance = Some(1e-4)),
        ),
        (
            "eye",
            "the eye 1e-4 from a ball",
            with(&|scene, recipe| {
                let eye = recipe.camera.look_from;
                scene.add_sphere(eye + 0.3001 * DVec3::Y, 0.3, 0);
            }),
        ),
        (
            "huge",
            "a second ground of radius 1e9 below",
            with(&|scene, _| scene.add_sphere(DVec3::new(0.0, -1e9 - 50.0, 0.0), 1e9, 0)),
        ),
        (
            "copies",
            "a hundred copies of one ball",
            with(&|scene, _| {
                let ball = scene.spheres[1];
                scene.spheres.extend(vec![ball; 100]);
            }),
        ),
    ];
    cases
        .into_iter()
        .map(|(name, stiff, recipe)| Case::new(&ODD, name, stiff, recipe).beside(field.clone()))
        .collect()
}
