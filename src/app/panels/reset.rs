//! How a group of controls is made as the stage has it.

use crate::app::model::document::Document;

/// How a group is made as the stage has it.
pub(super) struct Reset {
    /// Whether anything in it differs from the stage.
    pub is_changed: fn(&Document) -> bool,
    /// Makes it as the stage has it.
    pub reset: fn(&mut Document),
}
