//! Films that go on, and whether two recipes make the same film.

use crate::cli::RenderOptions;
use crate::film::{Film, checkpoint, key};
use crate::recipe::{Recipe, file};
use crate::render::RenderJob;
use anyhow::{Context, Result, bail};

/// A film that goes on.
pub(super) struct Resumed {
    pub film: Film,
    /// What its samples took, if it says so.
    pub seconds: Option<f64>,
}

/// Reads the film that `render` resumes.
pub(super) fn load(render: &RenderOptions) -> Result<Option<Resumed>> {
    let Some(path) = &render.resume else { return Ok(None) };
    let read = checkpoint::load(path)?;
    let name = path.display().to_string();
    let job = parse(read.description.recipe(), &name)?.job()?;
    if let Some(difference) = difference(&render.job, &job) {
        bail!(
            "{name} is a film of another picture: {difference}; leave out the flags that differ, \
             or render without --resume"
        );
    }
    if !render.job.fits(&read.film) {
        bail!("{name} holds a film of another shape than its recipe says; render without --resume");
    }
    let seconds = read.description.get(key::SECONDS).and_then(|seconds| seconds.parse().ok());
    Ok(Some(Resumed { film: read.film, seconds }))
}

/// Whether two recipes have the same samples.
///
/// # Errors
/// What differs, in words.
pub(super) fn same_job(first: &str, other: &str) -> Result<(), String> {
    let job = |text: &str| parse(text, "its recipe").and_then(|recipe| Ok(recipe.job()?));
    let first = job(first).map_err(|error| format!("{error:#}"))?;
    let other = job(other).map_err(|error| format!("{error:#}"))?;
    difference(&first, &other).map_or(Ok(()), Err)
}

fn parse(text: &str, name: &str) -> Result<Recipe> {
    file::parse(text, name).with_context(|| format!("the recipe in {name} cannot be read"))
}

/// The first thing in which two jobs differ, that of `first` said first.
fn difference(first: &RenderJob, other: &RenderJob) -> Option<String> {
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
