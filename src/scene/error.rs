//! What can be wrong with a scene, said so that the reader can mend it.

use glam::DVec3;
use thiserror::Error;

/// A scene or camera that no picture can be made of.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SceneError {
    /// NaN or infinite.
    #[error("{what} is {value}, but must be a finite number")]
    NotFinite {
        /// Where the value stands.
        what: String,
        /// The value.
        value: f64,
    },
    /// A number outside its range.
    #[error("{what} is {value}, but must be {limit}; {remedy}")]
    OutOfRange {
        /// Where the value stands.
        what: String,
        /// The value.
        value: f64,
        /// The range, in words.
        limit: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// A colour with a component outside its range.
    #[error("{what} is [{}, {}, {}], but each component must be within 0 and {limit}", value.x, value.y, value.z)]
    Colour {
        /// Where the colour stands.
        what: String,
        /// Linear RGB.
        value: DVec3,
        /// Largest component.
        limit: f64,
    },
    /// A sphere names a material that does not exist.
    #[error(
        "spheres[{sphere}].material is {material:?}, which is not among the materials; add [materials.{material}] or use one that exists"
    )]
    MissingMaterial {
        /// Index of the sphere.
        sphere: usize,
        /// The name it gives.
        material: String,
    },
    /// Two materials of one name.
    #[error("two materials are called {name:?}; rename one")]
    DuplicateMaterial {
        /// The name.
        name: String,
    },
    /// The camera stands where it looks.
    #[error("look_from and look_at are both [{}, {}, {}], so there is no direction to look in; move one of them", at.x, at.y, at.z)]
    NoDirection {
        /// The point.
        at: DVec3,
    },
}

impl SceneError {
    pub(crate) fn range(what: String, value: f64, limit: &'static str, remedy: &'static str) -> Self {
        SceneError::OutOfRange { what, value, limit, remedy }
    }
}

/// Largest coordinate or radius. Squares of it, and sums of three of those, must be finite in `f32`.
pub(super) const LENGTH_LIMIT: f64 = 1e18;

// The checks are run on millions of values; where one stands is put into words only if it is refused.

pub(super) fn finite(what: impl FnOnce() -> String, value: f64) -> Result<(), SceneError> {
    if value.is_finite() { Ok(()) } else { Err(SceneError::NotFinite { what: what(), value }) }
}

pub(super) fn finite_vector(what: impl Fn() -> String, value: DVec3) -> Result<(), SceneError> {
    components(value)
        .into_iter()
        .try_for_each(|(axis, component)| finite(|| format!("{}.{axis}", what()), component))
}

pub(super) fn position(what: impl Fn() -> String, value: DVec3) -> Result<(), SceneError> {
    finite_vector(&what, value)?;
    match components(value).into_iter().find(|(_, component)| component.abs() > LENGTH_LIMIT) {
        None => Ok(()),
        Some((axis, component)) => Err(SceneError::range(
            format!("{}.{axis}", what()),
            component,
            "within -1e18 and 1e18",
            "scale the scene down",
        )),
    }
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
