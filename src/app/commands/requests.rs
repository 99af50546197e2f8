//! Requests of panels, collected while they are drawn.

use super::snapshot::Snapshot;
use super::table::Command;
use crate::app::model::Edit;
use std::cell::RefCell;
use std::ops::Deref;

/// Requests of panels. The window carries them out once everything is drawn.
#[derive(Default)]
pub struct Requests {
    pub commands: Vec<Command>,
    pub edits: Vec<Edit>,
}

/// Everything that a panel needs: the snapshot to show, and a place for its requests.
pub struct PanelContext {
    pub snapshot: Snapshot,
    pub requests: RefCell<Requests>,
}

impl PanelContext {
    pub fn new(snapshot: Snapshot) -> Self {
        PanelContext { snapshot, requests: RefCell::default() }
    }

    /// Requests a command.
    pub fn send(&self, command: Command) {
        self.requests.borrow_mut().commands.push(command);
    }

    /// Requests a change of the scene, which joins a move in progress.
    pub fn edit(&self, edit: Edit) {
        self.requests.borrow_mut().edits.push(edit);
    }
}

impl Deref for PanelContext {
    type Target = Snapshot;

    fn deref(&self) -> &Snapshot {
        &self.snapshot
    }
}
