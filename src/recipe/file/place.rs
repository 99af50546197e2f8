//! Where in a scene file a value is, for error messages.

use crate::render::JobError;
use crate::scene::SceneError;
use std::collections::HashMap;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// Line and column of a byte, both from 1. Columns count characters.
pub(super) fn line_and_column(text: &str, byte: usize) -> (usize, usize) {
    let before = text.get(..byte).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (1 + before.matches('\n').count(), 1 + before[line_start..].chars().count())
}

/// One step of a path into a file, from a table or array to a value in it.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Step {
    Key(String),
    Index(usize),
}

/// The place of the value at `path`, or of the innermost value around it that the text has.
///
/// This parses the text again, so that reading a file without errors need not record places.
pub(super) fn find_place(text: &str, path: &[Step]) -> Range<usize> {
    let mut place = 0..0;
    let Ok(document) = DeTable::parse(text) else { return place };
    let Some((Step::Key(first), rest)) = path.split_first() else { return place };
    let Some((key, value)) = document.get_ref().get_key_value(first.as_str()) else { return place };
    place = narrower(key.span(), value.span());
    let mut value = value.get_ref();
    for step in rest {
        match (step, value) {
            (Step::Key(name), DeValue::Table(table)) => {
                let Some((key, inner)) = table.get_key_value(name.as_str()) else { return place };
                place = narrower(key.span(), inner.span());
                value = inner.get_ref();
            }
            (Step::Index(index), DeValue::Array(array)) => {
                let Some(inner) = array.get(*index) else { return place };
                place = inner.span();
                value = inner.get_ref();
            }
            _ => return place,
        }
    }
    place
}

/// The place of the key, because a reader looks for the key. A table whose header is part of a longer one, such as `a` in
/// `[a.b]`, has no key of its own.
fn narrower(key: Range<usize>, value: Range<usize>) -> Range<usize> {
    if key.is_empty() { value } else { key }
}

/// The names that inline materials were given, with the index of the sphere that holds each.
pub(super) type InlineNames = HashMap<String, usize>;

/// Errors name an inline material by the name that it was given. Replaces that by the sphere of the file that holds it.
pub(super) fn name_inline_materials(error: JobError, inline: &InlineNames) -> JobError {
    let renamed = |what: String| match split_material(&what) {
        Some((name, key)) => match inline.get(name) {
            Some(sphere) => format!("spheres[{sphere}].material.{key}"),
            None => what,
        },
        None => what,
    };
    match error {
        JobError::Scene(SceneError::NotFinite { what, value }) => {
            SceneError::NotFinite { what: renamed(what), value }.into()
        }
        JobError::Scene(SceneError::OutOfRange { what, value, limit, remedy }) => {
            SceneError::OutOfRange { what: renamed(what), value, limit, remedy }.into()
        }
        JobError::Scene(SceneError::Colour { what, value, limit }) => {
            SceneError::Colour { what: renamed(what), value, limit }.into()
        }
        other => other,
    }
}

/// Name and key of `materials.NAME.KEY`. The name may contain dots, and the key may end with an axis.
fn split_material(what: &str) -> Option<(&str, &str)> {
    let rest = what.strip_prefix("materials.")?;
    let key_start = ["albedo", "fuzz", "refraction_index"]
        .into_iter()
        .filter_map(|key| rest.rfind(&format!(".{key}")))
        .max()?;
    Some((&rest[..key_start], &rest[key_start + 1..]))
}

/// The path to the value that an error is about.
pub(super) fn path_of(error: &JobError) -> Vec<Step> {
    let keys = |keys: &[&str]| keys.iter().map(|key| Step::Key((*key).to_owned())).collect();
    match error {
        JobError::Size { what, .. } => keys(&["render", what]),
        JobError::Depth { .. } => keys(&["render", "max_depth"]),
        JobError::Scene(SceneError::NoDirection { .. }) => keys(&["camera", "look_at"]),
        JobError::Scene(SceneError::NoUp { .. }) => keys(&["camera", "vup"]),
        JobError::Scene(SceneError::DuplicateMaterial { name }) => keys(&["materials", name]),
        JobError::Scene(SceneError::MissingMaterial { sphere, .. }) => {
            vec![Step::Key("spheres".to_owned()), Step::Index(*sphere), Step::Key("material".to_owned())]
        }
        JobError::Scene(
            SceneError::NotFinite { what, .. }
            | SceneError::OutOfRange { what, .. }
            | SceneError::Colour { what, .. },
        ) => path_of_value(what),
    }
}

/// The same for `what` of a [`SceneError`].
fn path_of_value(what: &str) -> Vec<Step> {
    let key = |key: &str| Step::Key(key.to_owned());
    if let Some((name, rest)) = split_material(what) {
        let mut path = vec![key("materials"), key(name)];
        path.extend(rest.split('.').map(key));
        return path;
    }
    if let Some((index, rest)) = what.strip_prefix("spheres[").and_then(|rest| rest.split_once("].")) {
        let mut path = vec![key("spheres")];
        path.extend(index.parse().ok().map(Step::Index));
        path.extend(rest.split('.').map(key));
        return path;
    }
    if what.starts_with("sky.") {
        return what.split('.').map(key).collect();
    }
    // Such as "look_from.x", or "focus_distance (that from look_from to look_at)".
    let first = what.split(['.', ' ']).next().unwrap_or(what);
    vec![key("camera"), key(first)]
}
