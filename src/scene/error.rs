//! Errors in scenes, worded so that the reader can fix them.

use glam::DVec3;
use thiserror::Error;

/// An error in a scene: the value, its limit and a remedy.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{0}")]
pub struct SceneError(pub String);

/// Sphere `index` names a material that does not exist.
pub(crate) fn missing_material(index: usize, name: &str) -> SceneError {
    let key = toml_key(name);
    let name = toml_string(name);
    SceneError(format!(
        "spheres[{index}].material is {name}, which is not among the materials; add [materials.{key}] or use one that exists"
    ))
}

/// A name as a scene file's key, quoted if necessary.
pub(crate) fn toml_key(name: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if !name.is_empty() && name.chars().all(is_bare) { name.to_owned() } else { toml_string(name) }
}

/// A quoted string for a scene file, with invisible characters escaped.
pub(crate) fn toml_string(text: &str) -> String {
    let mut quoted = String::from('"');
    for c in text.chars() {
        let is_seen = c == '\'' || c.escape_debug().count() == 1;
        match u32::from(c) {
            _ if matches!(c, '"' | '\\') => quoted.extend(['\\', c]),
            _ if is_seen => quoted.push(c),
            code @ ..0x1_0000 => quoted.push_str(&format!("\\u{code:04X}")),
            code => quoted.push_str(&format!("\\U{code:08X}")),
        }
    }
    quoted.push('"');
    quoted
}

/// Largest absolute coordinate or radius. Its square, and the sum of three, must be finite in `f32`.
pub const LENGTH_LIMIT: f64 = 1e18;

// These checks run on millions of values, so the location's text is only built for an error.

pub(super) fn finite(what: impl FnOnce() -> String, value: f64) -> Result<(), SceneError> {
    if value.is_finite() {
        return Ok(());
    }
    Err(SceneError(format!("{} is {value}, but must be a finite number", what())))
}

/// A finite number that `is_allowed`, or an error that names the `limit` and the `remedy`.
pub(super) fn allowed(
    what: impl Fn() -> String,
    value: f64,
    is_allowed: bool,
    limit: &str,
    remedy: &str,
) -> Result<(), SceneError> {
    finite(&what, value)?;
    if is_allowed {
        return Ok(());
    }
    Err(SceneError(format!("{} is {value:?}, but must be {limit}; {remedy}", what())))
}

pub(super) fn finite_vector(what: impl Fn() -> String, value: DVec3) -> Result<(), SceneError> {
    components(value)
        .into_iter()
        .try_for_each(|(axis, component)| finite(|| format!("{}.{axis}", what()), component))
}

pub(super) fn position(what: impl Fn() -> String, value: DVec3) -> Result<(), SceneError> {
    finite_vector(&what, value)?;
    components(value).into_iter().try_for_each(|(axis, x)| {
        let what = || format!("{}.{axis}", what());
        allowed(what, x, x.abs() <= LENGTH_LIMIT, "between -1e18 and 1e18", "scale the scene down")
    })
}

pub(super) fn colour(what: impl Fn() -> String, value: DVec3, limit: f64) -> Result<(), SceneError> {
    finite_vector(&what, value)?;
    if value.min_element() < 0.0 || value.max_element() > limit {
        let (what, value) = (what(), value.to_array());
        return Err(SceneError(format!(
            "{what} is {value:?}, but each component must be between 0 and {limit}"
        )));
    }
    Ok(())
}

fn components(v: DVec3) -> [(char, f64); 3] {
    [('x', v.x), ('y', v.y), ('z', v.z)]
}
