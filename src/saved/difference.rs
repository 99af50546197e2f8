//! Describes in words how two jobs differ.

use crate::recipe::file;
use crate::render::{RenderJob, RenderSettings};

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
    let (a, b) = (first.settings(), other.settings());
    let size = ("size", format!("{}x{}", a.width, a.height), format!("{}x{}", b.width, b.height));
    let settings = RenderSettings::NAMED
        .iter()
        .map(|named| (named.flag, (named.value)(a).to_string(), (named.value)(b).to_string()));
    let others = [
        ("camera", format!("{:?}", first.camera()), format!("{:?}", other.camera())),
        ("rules of the stage", format!("{:?}", first.rules()), format!("{:?}", other.rules())),
        (
            "number of spheres",
            first.scene().spheres.len().to_string(),
            other.scene().spheres.len().to_string(),
        ),
    ];
    let mut values = std::iter::once(size).chain(settings).chain(others);
    if let Some((what, mine, theirs)) = values.find(|(_, mine, theirs)| mine != theirs) {
        return Some(format!("{what} is {mine} here, {theirs} there"));
    }
    (first != other).then(|| "the spheres, materials or sky differ".to_owned())
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
        let camera = told(|recipe| recipe.camera.vfov_degrees = 20.0).unwrap();
        assert!(camera.starts_with("camera is ") && camera.contains("vfov_degrees: 20.0"), "{camera}");
        let rules = told(|recipe| recipe.rules.transfer = Transfer::Linear).unwrap();
        assert!(rules.starts_with("rules of the stage is ") && rules.contains("Linear"), "{rules}");
        let fewer = told(|recipe| Arc::make_mut(&mut recipe.scene).spheres.truncate(4)).unwrap();
        assert_eq!(fewer, "number of spheres is 5 here, 4 there");
        let moved = told(|recipe| Arc::make_mut(&mut recipe.scene).spheres[0].radius *= 0.5).unwrap();
        assert_eq!(moved, "the spheres, materials or sky differ");
    }
}
