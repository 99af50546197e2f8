//! What panels show but do not change: a snapshot of the window at the start of the frame.

use super::command::{Command, SlotCommand};
use super::model::Model;
use super::model::device::Device;
use super::model::document::Document;
use super::model::further::Further;
use super::model::origin::Source;
use super::model::show::Show;
use super::model::slots::SlotNumber;
use super::model::view::Mode;
use crate::progressive::Status;
use crate::stages::{Shading, Stage};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A snapshot of the window at the start of the frame.
pub struct Facts {
    /// What the user has chosen.
    pub model: Model,
    /// The status of the render.
    pub status: Arc<Status>,
    /// Paths per second of tracing at present, if known.
    pub speed: Option<f64>,
    /// Seconds of tracing that the film's samples took before this run, if known.
    pub seconds_before: Option<f64>,
    /// Whether there is a change to undo.
    pub can_undo: bool,
    /// Whether there is a change to redo.
    pub can_redo: bool,
    /// Whether the pointer has been over the picture.
    pub has_pixel: bool,
    /// Whether there is a list of paths.
    pub has_paths: bool,
    /// Whether the stage's sight is shown.
    pub has_sight: bool,
    /// Why the document cannot be rendered, if so.
    pub invalid: Option<String>,
}

impl Facts {
    /// The document that is shown.
    pub fn document(&self) -> &Document {
        &self.model.document
    }

    /// The document of the picture on the screen, which may be one that was kept.
    pub fn shown(&self) -> &Document {
        self.model.view.shown_document(self.document())
    }

    /// The name of the picture on the screen.
    pub fn title(&self) -> String {
        let Model { view, document, .. } = &self.model;
        match view.slots.looked() {
            Some(number) => view.slots.title(number),
            None if view.compared_slot().is_some() => format!("live: {}", document.title()),
            None => document.title(),
        }
    }

    /// How a render that has ended can go on.
    pub fn further(&self) -> Option<Further> {
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

    /// Whether menus list the command: those for empty slots are left out.
    pub fn is_listed(&self, command: Command) -> bool {
        match command {
            Command::Slot(SlotCommand::Look(number)) | Command::Slot(SlotCommand::KeepIn(number)) => {
                self.model.view.slots.get(number).is_some()
            }
            _ => true,
        }
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

    /// The name of a command, with the file that it opens or the bookmark that it goes to.
    pub fn name(&self, command: Command) -> String {
        if let Command::Slot(SlotCommand::Look(number)) = command
            && let Some(slot) = self.model.view.slots.get(number)
        {
            return format!("{}: {}", command.name(), shortened(&slot.name));
        }
        if let Command::Bookmark(place) = command
            && let Some(bookmark) = self.model.remembered.bookmarks.get(place)
        {
            return format!("Go to {}", bookmark.name);
        }
        let Some(path) = self.path(command) else { return command.name() };
        let name = path.file_name().unwrap_or(path.as_os_str()).display();
        let is_same = |other: &&PathBuf| other.file_name() == path.file_name();
        let is_alone = self.model.remembered.recent.iter().filter(is_same).count() == 1;
        match path.parent() {
            // Files of the same name are told apart by their directories.
            Some(directory) if !is_alone => format!("Open {name} in {}", directory.display()),
            _ => format!("Open {name}"),
        }
    }

    /// Why a command is disabled, in words; `None` if it is enabled.
    pub fn disabled_reason(&self, command: Command) -> Option<String> {
        let no = |reason: &str| Some(reason.to_owned());
        let document = self.document();
        match command {
            Command::Undo if !self.can_undo => no("Nothing has been changed yet"),
            Command::Redo if !self.can_redo => no("Nothing has been undone"),
            Command::Brighter | Command::Darker | Command::NoExposure
                if self.model.view.show() != Show::Picture
                    || self.model.view.mode() == Some(Mode::Difference) =>
            {
                no("Exposure changes the picture, which is not shown now; press Ctrl+1 first")
            }
            Command::NoExposure if self.model.view.tone.exposure == 0.0 => {
                no("The picture is already shown as bright as it is saved")
            }
            Command::Reload if !matches!(document.origin.source, Source::File(_)) => {
                no("This picture is not from a scene file; open one first")
            }
            Command::NextRay | Command::PreviousRay | Command::ClearPaths if !self.has_paths => {
                no("No paths are listed; point at a pixel and press T first")
            }
            Command::ListPaths if self.model.view.slots.looked().is_some() => {
                no("A slot is shown, whose paths are not at hand; press Escape to return to the live picture")
            }
            Command::ListPaths
            | Command::AddSphere
            | Command::ViewFrom(_)
            | Command::AddBookmark
            | Command::Bookmark(_)
            | Command::FlyBookmarks
            | Command::SaveFlight
                if let Some(reason) = self.no_rays() =>
            {
                no(reason)
            }
            Command::ListPaths if !self.has_pixel => no("Move the pointer over the picture first"),
            Command::GoOn if self.further().is_none() => {
                no("The render has not ended, or more samples would change nothing")
            }
            Command::NextSphere | Command::PreviousSphere if document.scene().spheres.is_empty() => {
                no("There is no sphere in this scene")
            }
            Command::Deselect
            | Command::DuplicateSphere
            | Command::DeleteSphere
            | Command::FocusSphere
            | Command::LookAtSphere
                if self.model.selected.is_none() =>
            {
                no("No sphere is selected; click one in the picture, or press Period to go through them")
            }
            Command::ResetSpheres if !document.has_changed_scene() => {
                no("The spheres are those of the stage")
            }
            Command::Home if document.camera == document.origin.recipe.camera => {
                no("This is already the stage's camera")
            }
            Command::FlyBookmarks | Command::SaveFlight if self.model.remembered.bookmarks.len() < 2 => {
                no("A path needs two bookmarks; press Ctrl+B where it begins and where it ends")
            }
            Command::Blank if self.model.presentation.is_none() => {
                no("Only a presentation can be blanked; press F5 first")
            }
            Command::ShowMe => match document.stage() {
                Some(stage) => self.useless_show(Show::of_means(stage.sight.means)),
                None => no("Only the stages of the book name something to look for; choose one"),
            },
            Command::Stages
            | Command::Controls
            | Command::Info
            | Command::Plot
            | Command::Packet
            | Command::Code
            | Command::NextPanel
            | Command::FirstSteps
                if self.model.presentation.is_some() =>
            {
                no("A presentation has no panels; press Escape first")
            }
            Command::Device(device) => device.unavailable(),
            Command::SwitchDevice => Device::Gpu.unavailable(),
            Command::Show(show) => self.useless_show(show),
            Command::CopyPlot | Command::SavePlot if self.status.history.is_empty() => {
                no("No error has been estimated yet")
            }
            Command::ReferenceSize => match &self.model.view.reference {
                None => no("Load a reference film first (File > Load reference film)"),
                Some(film) => ([film.width, film.height] == document.size())
                    .then(|| "The picture has the reference's size already".to_owned()),
            },
            Command::Slot(command) => self.useless_slot(command),
            Command::CopyCrop | Command::SaveCrop if self.model.view.crop.flatten().is_none() => {
                no("No part of the picture is marked; choose Crop and drag over the picture first")
            }
            Command::Wipe | Command::WipeDifference
                if document.stage().is_none() && !document.origin.is_other_by_the_book() =>
            {
                no("There is nothing to compare this picture with; choose a stage of the book")
            }
            Command::BookArithmetic if !document.origin.is_other_by_the_book() => {
                no("This picture already has the book's arithmetic, or traces no rays; choose another")
            }
            Command::PreviousStage if neighbour(document, false).is_none() => no("This is the first stage"),
            Command::NextStage if neighbour(document, true).is_none() => no("This is the last stage"),
            _ => None,
        }
    }

    /// Why a command for slots has nothing to do now, if so.
    fn useless_slot(&self, command: SlotCommand) -> Option<String> {
        let no = |reason: &str| Some(reason.to_owned());
        let slots = &self.model.view.slots;
        match command {
            SlotCommand::Keep | SlotCommand::KeepIn(_) if let Some(number) = slots.looked() => Some(format!(
                "Slot {number} is shown, which is kept already; press Escape to return to the live picture"
            )),
            SlotCommand::Keep if slots.free().next().is_none() => {
                no("All nine slots are in use; delete one, or replace one with Shift, Alt and its digit")
            }
            SlotCommand::Look(number) | SlotCommand::KeepIn(number) if slots.coming(number).is_some() => {
                Some(format!("Slot {number} is still being read from disk; try again in a moment"))
            }
            SlotCommand::Look(number) if slots.get(number).is_none() => {
                Some(format!("Slot {number} is empty; press M to keep the picture in the first free slot"))
            }
            SlotCommand::LookLive if slots.looked().is_none() => no("The live picture is already shown"),
            SlotCommand::BringBack => match (slots.gone(), slots.place_back()) {
                (None, _) => no("No slot has been deleted or replaced yet"),
                (Some(number), None) => Some(format!(
                    "Slot {number} is still being read from disk, and no other slot is free; try again in a moment"
                )),
                (Some(_), Some(_)) => None,
            },
            SlotCommand::Keep | SlotCommand::KeepIn(_) | SlotCommand::Look(_) | SlotCommand::LookLive => None,
            _ => match slots.chosen() {
                None => no("No picture is kept; press M to keep this one"),
                Some(number) if command == SlotCommand::Difference => self.slot_of_other_size(number),
                Some(number) if command == SlotCommand::TakeSize => {
                    let size = slots.get(number).map(|slot| slot.kept.size());
                    (size == Some(self.document().size()))
                        .then(|| format!("The picture has the size of slot {number} already"))
                }
                Some(number) if command == SlotCommand::OnlyNoise => {
                    let is_live = slots.looked().is_none_or(|looked| looked == number);
                    let is_early = is_live && self.status.samples_per_pixel == 0;
                    let early = || "Nothing has been traced yet; try again in a moment".to_owned();
                    self.slot_of_other_size(number).or_else(|| is_early.then(early))
                }
                Some(_) => None,
            },
        }
    }

    /// Why the picture on the screen cannot be subtracted from a slot's, if so. A slot that is shown itself is compared with
    /// the live picture.
    pub fn slot_of_other_size(&self, number: SlotNumber) -> Option<String> {
        let slots = &self.model.view.slots;
        let other = slots.looked().filter(|looked| *looked != number);
        let mine = if other.is_some() { self.shown() } else { self.document() }.size();
        let theirs = slots.get(number)?.kept.size();
        (mine != theirs).then(|| {
            let ([a, b], [x, y]) = (theirs, mine);
            let name = other.map_or_else(|| "the picture".to_owned(), |other| format!("slot {other}"));
            let to_do = match other {
                Some(_) => "a wipe scales one to the other",
                None => "choose Slots > Set the picture to the slot's size, or a wipe, which scales it",
            };
            format!(
                "Slot {number} is {a}x{b} and {name} is {x}x{y}, so a difference would show the scaling; {to_do}"
            )
        })
    }

    /// Why a view has nothing to show now, if so.
    pub fn useless_show(&self, show: Show) -> Option<String> {
        let no = |reason: &str| Some(reason.to_owned());
        let (settings, shading) = (self.shown().settings, self.shown().rules().shading);
        match show {
            Show::Error if !settings.estimate_error => no("The film has one half; switch on Estimate error"),
            Show::Difference => match &self.model.view.reference {
                None => no("Load a reference film first (File > Load reference film)"),
                Some(film) if (film.width, film.height) != (settings.width, settings.height) => {
                    Some(format!(
                        "The reference film is {}x{} and the picture is {}x{}, so a difference would show the scaling; \
                         choose File > Set the picture to the reference's size",
                        film.width, film.height, settings.width, settings.height
                    ))
                }
                Some(_) => None,
            },
            Show::Normals | Show::Albedo | Show::Bounces | Show::Occupancy
                if let Some(reason) = self.shown().no_rays() =>
            {
                no(reason)
            }
            Show::Bounces if shading != Shading::Path => {
                no("In this stage rays end at their first hit, so each path is one ray")
            }
            Show::Occupancy if self.model.view.slots.looked().is_some() => {
                no("A slot keeps no lanes; press Escape to return to the live picture")
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

/// A name that fits into a line of a menu.
fn shortened(name: &str) -> String {
    const MOST: usize = 22;
    match name.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}…", name[..end].trim_end()),
        None => name.to_owned(),
    }
}

/// The stage after or before the document's. If the document is not a stage, this is the first stage.
pub fn neighbour(document: &Document, is_next: bool) -> Option<&'static Stage> {
    match document.stage() {
        Some(stage) if is_next => stage.next(),
        Some(stage) => stage.previous(),
        None => Stage::ALL.first().filter(|_| is_next),
    }
}

#[cfg(test)]
mod tests;
