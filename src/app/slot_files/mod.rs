//! Kept pictures on disk, so that the next window has them in its slots again.

mod bounded;
mod folder;
mod keeper;
mod note;
mod reader;

pub use folder::{Entry, Folder, Listing};
pub use keeper::{Keeper, News};
pub use reader::{Arrival, SlotReader};

/// What the kept pictures of all windows may take on disk together, bytes. Nine films of 1920x1080 pixels take about half
/// of it.
pub const DISK_LIMIT: u64 = 1_000_000_000;
