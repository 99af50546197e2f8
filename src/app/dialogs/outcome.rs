//! The result of a dialog.

use super::purpose::Purpose;
use std::path::PathBuf;

/// What happens to a dialog after a frame.
pub enum Outcome {
    /// It stays open.
    Stay,
    /// It closes.
    Close,
    /// It closes: the user chose a file.
    Named(Purpose, PathBuf),
}
