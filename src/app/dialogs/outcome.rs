//! What a dialog comes to.

use super::purpose::Purpose;
use std::path::PathBuf;

/// What a dialog wants after a frame.
pub enum Outcome {
    /// It stays open.
    Stay,
    /// It is done.
    Close,
    /// It is done: a file was named.
    Named(Purpose, PathBuf),
}
