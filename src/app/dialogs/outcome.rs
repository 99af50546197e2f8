//! The result of a dialog.

use super::Purpose;
use std::path::PathBuf;

/// What happens to a dialog after a frame.
pub enum Outcome {
    Stay,
    Close,
    /// It closes: the user chose a file.
    Named(Purpose, PathBuf),
    /// It closes: the picture gets this size.
    Size([u32; 2]),
}
