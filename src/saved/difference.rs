//! Describes in words how two jobs differ.

use crate::recipe::file;
use crate::render::{RenderJob, RenderSettings};
use glam::DVec3;

/// Checks whether two recipes, given as text, describe the same samples.
///
/// # Errors
/// What differs, or what is wrong with one of the recipes, in words.
pub fn same_job(first: &str, other: &str) -> Result<(), String> {
    let (first, other) = (job(first)?, job(other)?);
    difference(&first, &other).map_or(Ok(()), Err)
}

fn job(text: &str) -> Result<RenderJob, String> {
    let recipe =
        file::parse(text, "its recipe").map_err(|error| format!("cannot read its recipe: {error}"))?;
    recipe.job().map_err(|error| error.to_string())
}

/// The first difference between two jobs, in words that a user can act on; `None` if their samples are the same.
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

/// What a user chooses of a job, with the names of the flags and as these accept it; then the rules of the stage.
fn named_values(job: &RenderJob) -> Vec<(String, String)> {
    let (settings, camera) = (job.settings(), job.camera());
    let mut values = vec![("size".to_owned(), format!("{}x{}", settings.width, settings.height))];
    values.extend(
        RenderSettings::NAMED
            .iter()
            .map(|named| (named.flag.to_owned(), (named.value)(settings).to_string())),
    );
    let vector = |v: DVec3| format!("{},{},{}", v.x, v.y, v.z);
    let distance = camera.focus_distance.map_or("that to the point looked at".to_owned(), |d| d.to_string());
    let of_camera = [
        ("look-from", vector(camera.look_from)),
        ("look-at", vector(camera.look_at)),
        ("vup", vector(camera.vup)),
        ("vfov", format!("{} degrees", camera.vfov_degrees)),
        ("defocus-angle", format!("{} degrees", camera.defocus_angle_degrees)),
        ("focus-distance", distance),
    ];
    values.extend(of_camera.map(|(flag, value)| (flag.to_owned(), value)));
    // Their names in scene files.
    if let Ok(serde_json::Value::Object(rules)) = serde_json::to_value(job.rules()) {
        values.extend(
            rules.into_iter().map(|(name, value)| (format!("the stage's rule {name}"), plain(&value))),
        );
    }
    values.push(("number of spheres".to_owned(), job.scene().spheres.len().to_string()));
    values
}

/// A value without quotation marks.
fn plain(value: &serde_json::Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recipe::Recipe;
    use crate::stages::Transfer;
    use std::sync::Arc;

    #[test]
    fn what_differs_first_is_named_with_both_values() {
        let recipe = Recipe::builtin("three-spheres").unwrap();
        let told = |change: fn(&mut Recipe)| {
            let mut other = recipe.clone();
            change(&mut other);
            difference(&recipe.job().unwrap(), &other.job().unwrap())
        };
        assert_eq!(told(|_| {}), None);
        assert_eq!(told(|recipe| recipe.settings.width = 7).unwrap(), "size is 800x450 here, 7x450 there");
        assert_eq!(told(|recipe| recipe.settings.seed = 5).unwrap(), "seed is 0 here, 5 there");
        for (change, expected) in [
            (
                (|recipe| recipe.camera.vfov_degrees = 20.0) as fn(&mut Recipe),
                "vfov is 90 degrees here, 20 degrees there",
            ),
            (
                |recipe| recipe.camera.look_from = DVec3::new(13.0, -2.5, 1e-3),
                "look-from is 0,0,0 here, 13,-2.5,0.001 there",
            ),
            (
                |recipe| recipe.camera.look_at = DVec3::new(0.0, 0.5, -2.0),
                "look-at is 0,0,-1 here, 0,0.5,-2 there",
            ),
            (|recipe| recipe.camera.vup.z = 0.25, "vup is 0,1,0 here, 0,1,0.25 there"),
            (
                |recipe| recipe.camera.defocus_angle_degrees = 0.6,
                "defocus-angle is 0 degrees here, 0.6 degrees there",
            ),
            (
                |recipe| recipe.camera.focus_distance = Some(3.4),
                "focus-distance is that to the point looked at here, 3.4 there",
            ),
            (
                |recipe| recipe.rules.transfer = Transfer::Linear,
                "the stage's rule transfer is gamma2 here, linear there",
            ),
            (
                |recipe| recipe.rules.antialiasing = false,
                "the stage's rule antialiasing is true here, false there",
            ),
            // Equal numbers are no difference, whatever their signs.
            (|recipe| recipe.camera.look_from.x = -0.0, ""),
        ] {
            assert_eq!(told(change).unwrap_or_default(), expected);
        }
        let fewer = told(|recipe| Arc::make_mut(&mut recipe.scene).spheres.truncate(4)).unwrap();
        assert_eq!(fewer, "number of spheres is 5 here, 4 there");
        let moved = told(|recipe| Arc::make_mut(&mut recipe.scene).spheres[0].radius *= 0.5).unwrap();
        assert_eq!(moved, "the spheres, materials or sky differ");
    }
}
