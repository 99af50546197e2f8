//! What panels get: a snapshot of the window, and a place for their commands.

use super::snapshot::Snapshot;
use super::table::Command;
use std::cell::RefCell;
use std::ops::Deref;

/// Everything that a panel needs: the snapshot to show, and a place for its requests.
pub struct PanelContext {
    pub snapshot: Snapshot,
    /// The window carries them out once everything is drawn.
    pub requests: RefCell<Vec<Command>>,
}

impl PanelContext {
    pub fn new(snapshot: Snapshot) -> Self {
        PanelContext { snapshot, requests: RefCell::default() }
    }

    /// Requests a command.
    pub fn send(&self, command: Command) {
        self.requests.borrow_mut().push(command);
    }
}

impl Deref for PanelContext {
    type Target = Snapshot;

    fn deref(&self) -> &Snapshot {
        &self.snapshot
    }
}
