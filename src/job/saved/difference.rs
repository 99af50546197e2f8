//! Describes how two jobs differ.

use crate::job::recipe::file;
use crate::job::render::RenderJob;
use serde_json::{Value, to_value};

/// Checks whether two recipes, given as text, describe the same samples.
///
/// # Errors
/// What differs, or what is wrong with one of the recipes.
pub fn same_job(first: &str, other: &str) -> Result<(), String> {
    if first == other {
        return Ok(());
    }
    let (first, other) = (job(first)?, job(other)?);
    difference(&first, &other).map_or(Ok(()), Err)
}

fn job(text: &str) -> Result<RenderJob, String> {
    let recipe =
        file::parse(text, "its recipe").map_err(|error| format!("cannot read its recipe: {error}"))?;
    recipe.job().map_err(|error| error.to_string())
}

/// The first difference between two jobs, worded so that a user can act on it; `None` if their samples are the same.
pub fn difference(first: &RenderJob, other: &RenderJob) -> Option<String> {
    if first == other {
        return None;
    }
    let [mine, theirs] = [first, other].map(named_values);
    let differing = mine.into_iter().zip(theirs).find(|((_, mine), (_, theirs))| mine != theirs);
    Some(differing.map_or_else(
        || "the spheres, materials or sky differ".to_owned(),
        |((what, mine), (_, theirs))| format!("{what} is {mine} here, {theirs} there"),
    ))
}

/// All values of a job except its scene, by their names in scene files.
fn named_values(job: &RenderJob) -> Vec<(String, Value)> {
    let tables = [to_value(job.settings()), to_value(job.camera()), to_value(job.rules())];
    let tables = tables.into_iter().filter_map(|table| table.ok()?.as_object().cloned());
    let spheres = ("number of spheres".to_owned(), job.scene().spheres.len().into());
    tables.flatten().chain([spheres]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::recipe::Recipe;
    use crate::stages::{SurfaceRule, Transfer};
    use std::sync::Arc;

    #[test]
    fn first_difference_is_named_with_both_values() {
        let recipe = Recipe::builtin("three-spheres").unwrap();
        let difference_with = |change: fn(&mut Recipe)| {
            let mut other = recipe.clone();
            change(&mut other);
            difference(&recipe.job().unwrap(), &other.job().unwrap())
        };
        assert_eq!(difference_with(|recipe| recipe.samples_per_pixel += 1), None);
        // Zeros are equal whatever their signs.
        assert_eq!(difference_with(|recipe| recipe.camera.look_from.x = -0.0), None);
        type Change = fn(&mut Recipe);
        let sky = "the spheres, materials or sky differ";
        let cases: [(Change, &str); 12] = [
            (|recipe| recipe.settings.width = 7, "width is 800 here, 7 there"),
            (|recipe| recipe.settings.max_depth = 7, "max_depth is 24 here, 7 there"),
            (|recipe| recipe.rules.surface = SurfaceRule::Book, "surface is \"exact\" here, \"book\" there"),
            (
                |recipe| recipe.rules.transfer = Transfer::Linear,
                "transfer is \"gamma2\" here, \"linear\" there",
            ),
            (|recipe| Arc::make_mut(&mut recipe.scene).sky.top *= 0.5, sky),
            (|recipe| recipe.settings.seed = 5, "seed is 0 here, 5 there"),
            (|recipe| recipe.camera.vfov_degrees = 20.0, "vfov_degrees is 90.0 here, 20.0 there"),
            (
                |recipe| recipe.camera.look_from.y = -2.5,
                "look_from is [0.0,0.0,0.0] here, [0.0,-2.5,0.0] there",
            ),
            (|recipe| recipe.camera.focus_distance = Some(3.4), "focus_distance is null here, 3.4 there"),
            (|recipe| recipe.rules.antialiasing = false, "antialiasing is true here, false there"),
            (
                |recipe| Arc::make_mut(&mut recipe.scene).spheres.truncate(4),
                "number of spheres is 5 here, 4 there",
            ),
            (|recipe| Arc::make_mut(&mut recipe.scene).spheres[0].radius *= 0.5, sky),
        ];
        for (change, expected) in cases {
            assert_eq!(difference_with(change).as_deref(), Some(expected));
        }
    }
}
