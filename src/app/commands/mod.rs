//! Commands of the window: the table of all commands, the snapshot of the window that decides which are available, and
//! the requests of panels. A command is data; only the window knows how to carry it out.

mod context;
mod snapshot;
mod table;

pub use context::PanelContext;
pub use snapshot::{Films, Snapshot, Verdict};
pub use table::{Command, MENUS, ROWS, Row};
