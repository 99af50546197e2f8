//! Resetting a group of controls to the stage's values.

use crate::app::model::document::Document;

/// How a group is compared with the stage and reset to it.
pub(super) struct Reset {
    /// Whether any value of the group differs from the stage's.
    pub is_changed: fn(&Document) -> bool,
    /// Resets the group to the stage's values.
    pub reset: fn(&mut Document),
}
