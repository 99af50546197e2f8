//! Describes in words how two jobs differ.

use crate::recipe::file;
use crate::render::RenderJob;

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
        file::parse(text, "its recipe").map_err(|error| format!("its recipe cannot be read: {error}"))?;
    recipe.job().map_err(|error| error.to_string())
}

/// The first difference between two jobs, in words that a user can act on; `None` if their samples are the same.
pub fn difference(first: &RenderJob, other: &RenderJob) -> Option<String> {
    let (a, b) = (first.settings(), other.settings());
    let half_words = |is_on: bool| if is_on { "on" } else { "off" };
    let values = [
        ("size", format!("{}x{}", a.width, a.height), format!("{}x{}", b.width, b.height)),
        ("depth", a.max_depth.to_string(), b.max_depth.to_string()),
        ("sampler", a.sampler.name().to_owned(), b.sampler.name().to_owned()),
        ("seed", a.seed.to_string(), b.seed.to_string()),
        ("estimate-error", half_words(a.estimate_error).into(), half_words(b.estimate_error).into()),
        ("camera", format!("{:?}", first.camera()), format!("{:?}", other.camera())),
        ("rules of the stage", format!("{:?}", first.rules()), format!("{:?}", other.rules())),
        (
            "number of spheres",
            first.scene().spheres.len().to_string(),
            other.scene().spheres.len().to_string(),
        ),
    ];
    if let Some((what, mine, theirs)) = values.into_iter().find(|(_, mine, theirs)| mine != theirs) {
        return Some(format!("{what} is {mine} here, {theirs} there"));
    }
    (first != other).then(|| "the spheres, materials or sky differ".to_owned())
}
