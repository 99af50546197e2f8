//! What panels show but do not change: a snapshot of the window at the start of the frame, which also takes what they
//! ask for.

use super::table::Command;
use crate::app::model::{Device, Document, Edit, Mode, Model, Show, partner};
use crate::progressive::{Status, Stop};
use crate::stages::{Shading, Stage};
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A snapshot of the window at the start of the frame.
pub struct Facts {
    /// What the user has chosen.
    pub model: Model,
    /// The status of the render.
    pub status: Arc<Status>,
    /// Seconds of tracing that the film's samples took before this run, if known.
    pub seconds_before: Option<f64>,
    /// What Undo and Redo would change, if anything.
    pub undo: Option<&'static str>,
    pub redo: Option<&'static str>,
    /// The render is a preview, and the camera or a sphere is being moved.
    pub is_coarse: bool,
    /// There is a picture of the document, at any size.
    pub has_picture: bool,
    pub is_moving: bool,
    /// The render began during the pause that lasts, and stops early.
    pub is_held: bool,
    /// Nothing but sky and ground is in sight, unlike from the camera of the stage.
    pub is_lost: bool,
    /// What was checked, in words.
    pub checked: Option<String>,
    /// Whether the pointer has been over the picture.
    pub has_pixel: bool,
    /// Whether there is a list of paths.
    pub has_paths: bool,
    /// Whether the stage's sight is shown.
    pub has_sight: bool,
    /// Why the document cannot be rendered, if so.
    pub invalid: Option<String>,
    /// What panels have asked for.
    pub commands: RefCell<Vec<Command>>,
    pub edits: RefCell<Vec<Edit>>,
}

impl Facts {
    /// Asks for a command, which is carried out once all is drawn.
    pub fn send(&self, command: Command) {
        self.commands.borrow_mut().push(command);
    }

    /// Asks for a change of the scene, which is part of a move if there is one.
    pub fn edit(&self, edit: Edit) {
        self.edits.borrow_mut().push(edit);
    }

    /// The document that is shown.
    pub fn document(&self) -> &Document {
        &self.model.document
    }

    /// How a render that has ended can go on.
    pub fn further(&self) -> Option<Stop> {
        self.document().further(&self.status).filter(|_| !self.model.is_paused)
    }

    /// Whether samples are being added.
    pub fn is_working(&self) -> bool {
        self.status.phase.is_working()
    }

    /// Why the document's camera has no effect, if so.
    pub fn no_rays(&self) -> Option<&'static str> {
        self.document().no_rays()
    }

    /// The commands for the files that were opened or saved last, newest first.
    pub fn recent(&self) -> impl Iterator<Item = Command> {
        (0..self.model.remembered.recent.len()).map(Command::Recent)
    }

    /// The commands that go to the bookmarks, in their order.
    pub fn bookmarks(&self) -> impl Iterator<Item = Command> {
        (0..self.model.remembered.bookmarks.len()).map(Command::Bookmark)
    }

    /// The file that a command opens, if it was opened or saved before.
    pub fn path(&self, command: Command) -> Option<&Path> {
        let Command::Recent(place) = command else { return None };
        self.model.remembered.recent.get(place).map(PathBuf::as_path)
    }

    /// The name of a command, with the change that it undoes, the file that it opens or the bookmark that it goes to.
    pub fn name(&self, command: Command) -> String {
        let Model { view, remembered, .. } = &self.model;
        let named = match command {
            Command::Undo => self.undo.map(|change| format!("Undo: {change}")),
            Command::Redo => self.redo.map(|change| format!("Redo: {change}")),
            Command::Kept(place) => view.kept.get(place).map(|kept| kept.document.title()),
            Command::Bookmark(place) => remembered.bookmarks.get(place).map(|bookmark| bookmark.name.clone()),
            Command::Recent(_) => {
                self.path(command).and_then(Path::file_name).map(|name| name.display().to_string())
            }
            _ => None,
        };
        named.unwrap_or_else(|| command.name())
    }

    /// Why there is nothing to compare this picture with, if so.
    pub fn nothing_to_compare(&self) -> Option<String> {
        let document = self.document();
        let has_other = match document.stage() {
            Some(stage) => partner(stage).is_some(),
            None => document.origin.is_other_by_the_book(),
        };
        (!has_other).then(|| "There is nothing to compare this picture with".to_owned())
    }

    /// Why the chosen kept picture cannot be subtracted from the picture, if so.
    pub fn not_subtractable(&self) -> Option<String> {
        let Some(kept) = self.model.view.kept.meant() else {
            return Some("No picture is kept; M keeps this one".to_owned());
        };
        let ([a, b], [x, y]) = (kept.size(), self.document().size());
        ([a, b] != [x, y]).then(|| format!("The kept picture is {a} × {b} and this one {x} × {y}"))
    }

    /// Why exposure and channels would change nothing, if so.
    pub fn no_exposure(&self) -> Option<String> {
        let view = &self.model.view;
        let is_shown = view.show() == Show::Picture && view.mode() != Some(Mode::Difference);
        (!is_shown).then(|| "It changes the picture, which is not shown now; Ctrl+1 shows it".to_owned())
    }

    /// The stage before or after this one in the book.
    pub fn neighbour(&self, is_next: bool) -> Option<&'static Stage> {
        match self.document().stage() {
            Some(stage) if is_next => stage.next(),
            Some(stage) => stage.previous(),
            None => Stage::ALL.first().filter(|_| is_next),
        }
    }

    /// Why a view has nothing to show now, if so.
    pub fn useless_show(&self, show: Show) -> Option<String> {
        let no = |reason: &str| Some(reason.to_owned());
        let (has_error, shading) = (self.document().settings.estimate_error, self.document().rules().shading);
        match show {
            Show::Error if !has_error => no("The film has one half; switch on Estimate error"),
            Show::Normals | Show::Albedo | Show::Bounces | Show::Occupancy
                if let Some(reason) = self.no_rays() =>
            {
                no(reason)
            }
            Show::Bounces if shading != Shading::Path => {
                no("In this stage rays end at their first hit, so each path is one ray")
            }
            Show::Occupancy => match self.model.remembered.device {
                Device::Gpu => no("The graphics adapter traces without packets; switch to the CPU"),
                Device::Reference => {
                    no("The reference traces one ray at a time, without packets; switch to the CPU")
                }
                Device::Cpu | Device::Both => None,
            },
            _ => None,
        }
    }
}
