//! Errors in scenes, worded so that the reader can fix them.

use glam::DVec3;
use std::borrow::Cow;
use thiserror::Error;

#[derive(Clone, Debug, Error, PartialEq)]
pub enum SceneError {
    #[error("{what} is {value}, but must be a finite number")]
    NotFinite { what: String, value: f64 },
    #[error("{what} is {value:?}, but must be {limit}; {remedy}")]
    OutOfRange {
        what: String,
        value: f64,
        /// The range, spelled out.
        limit: Cow<'static, str>,
        /// What the user should change.
        remedy: &'static str,
    },
    #[error("{what} is {:?}, but each component must be within 0 and {limit}", value.to_array())]
    Colour {
        what: String,
        /// Linear RGB.
        value: DVec3,
        limit: f64,
    },
    /// A sphere names a material that does not exist.
    #[error(
        "spheres[{sphere}].material is {}, which is not among the materials; add [materials.{}] or use one that exists",
        toml_string(material),
        toml_key(material)
    )]
    MissingMaterial {
        sphere: usize,
        /// The name that the sphere gives.
        material: String,
    },
    #[error("two materials are called {name:?}; rename one")]
    DuplicateMaterial { name: String },
    #[error(
        "look_from and look_at are both {:?}, so there is no direction to look in; move one of them",
        at.to_array()
    )]
    NoDirection {
        /// Scene units.
        at: DVec3,
    },
    /// The up vector has no direction, or the view's.
    #[error(
        "vup is {:?}, {}; use another, such as {:?}",
        vup.to_array(),
        if *vup == DVec3::ZERO { "which has no direction" } else { "which is parallel to the view, so nothing is up in the picture" },
        remedy.to_array()
    )]
    NoUp {
        vup: DVec3,
        /// A valid up vector for this view.
        remedy: DVec3,
    },
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
    if value.is_finite() { Ok(()) } else { Err(SceneError::NotFinite { what: what(), value }) }
}

/// A finite number that `is_allowed`, or an error that names the `limit` and the `remedy`.
pub(super) fn allowed(
    what: impl Fn() -> String,
    value: f64,
    is_allowed: bool,
    limit: impl Into<Cow<'static, str>>,
    remedy: &'static str,
) -> Result<(), SceneError> {
    finite(&what, value)?;
    let error = || SceneError::OutOfRange { what: what(), value, limit: limit.into(), remedy };
    if is_allowed { Ok(()) } else { Err(error()) }
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
        allowed(what, x, x.abs() <= LENGTH_LIMIT, "within -1e18 and 1e18", "scale the scene down")
    })
}

pub(super) fn colour(what: impl Fn() -> String, value: DVec3, limit: f64) -> Result<(), SceneError> {
    finite_vector(&what, value)?;
    if value.min_element() < 0.0 || value.max_element() > limit {
        return Err(SceneError::Colour { what: what(), value, limit });
    }
    Ok(())
}

fn components(v: DVec3) -> [(char, f64); 3] {
    [('x', v.x), ('y', v.y), ('z', v.z)]
}
