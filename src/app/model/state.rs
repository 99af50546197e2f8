//! Everything that the user has chosen.

use super::{Device, DeviceOptions, Document, Mode, Remembered, Show, Tab, ViewState, partner};
use crate::backends::BackendChoice;
use crate::progressive::Stop;
use crate::stages::{Shading, Stage};
use std::sync::Arc;

/// A presentation: full screen, the picture with large captions, no panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Presentation {
    /// The window was in full-screen mode before, and stays in it.
    pub was_full_screen: bool,
    /// Whether titles and texts are shown.
    pub has_captions: bool,
    /// Whether the screen is black.
    pub is_blank: bool,
}

/// Everything that the user has chosen.
#[derive(Clone)]
pub struct Model {
    /// The picture being edited.
    pub document: Document,
    /// The user's own way to stop, which other stages take over.
    pub own_stop: Option<Stop>,
    /// The selected sphere.
    pub selected: Option<usize>,
    /// The current view and comparison.
    pub view: ViewState,
    /// The window's settings, including the device.
    pub remembered: Remembered,
    /// Device options from the command line.
    pub devices: DeviceOptions,
    /// Whether tracing is paused.
    pub is_paused: bool,
    /// Whether the window is in full-screen mode.
    pub is_full_screen: bool,
    /// Whether the card with the first steps is shown.
    pub has_first_steps: bool,
    /// Which of them were done: the camera moved, a sphere selected, another picture opened.
    pub steps_done: [bool; 3],
    /// The presentation in progress.
    pub presentation: Option<Presentation>,
}

impl Model {
    /// Whether panels are shown. A presentation has none.
    pub fn has_panels(&self) -> bool {
        self.remembered.has_panels && self.presentation.is_none()
    }

    /// Whether the right panel shows this tab.
    pub fn shows(&self, tab: Tab) -> bool {
        self.has_panels() && self.remembered.has_info && self.remembered.tab == tab
    }

    /// Notes which of the first steps were done since the document was as `before`.
    pub fn note_steps(&mut self, before: &Document) {
        let is_same = Arc::ptr_eq(&self.document.origin, &before.origin);
        let done = [is_same && self.document.camera != before.camera, self.selected.is_some(), !is_same];
        self.steps_done.iter_mut().zip(done).for_each(|(step, is_done)| *step |= is_done);
    }

    /// The backend for the chosen device, lanes and threads.
    pub fn backend(&self) -> BackendChoice {
        let Remembered { device, lanes, threads, .. } = self.remembered;
        device.backend(&self.devices, lanes, threads)
    }

    /// Why this picture cannot be compared; `None` if it can.
    pub fn nothing_to_compare(&self) -> Option<String> {
        let document = &self.document;
        let has_other = match document.stage() {
            Some(stage) => partner(stage).is_some(),
            None => document.origin.is_other_by_the_book(),
        };
        (!has_other).then(|| "There is nothing to compare this picture with".to_owned())
    }

    /// Why the difference from the kept picture is unavailable; `None` if it is available.
    pub fn not_subtractable(&self) -> Option<String> {
        let Some(kept) = self.view.kept.meant() else {
            return Some("No picture is kept; M keeps this one".to_owned());
        };
        let ([a, b], [x, y]) = (kept.size(), self.document.size());
        ([a, b] != [x, y]).then(|| format!("The kept picture is {a} × {b} and this one {x} × {y}"))
    }

    /// Why exposure and channels have no effect; `None` if they have one.
    pub fn no_exposure(&self) -> Option<String> {
        let view = &self.view;
        let is_shown = view.show() == Show::Picture && view.mode() != Some(Mode::Difference);
        (!is_shown).then(|| "It changes the picture, which is not shown now; Ctrl+1 shows it".to_owned())
    }

    /// The stage before or after this one in the book.
    pub fn neighbour(&self, is_next: bool) -> Option<&'static Stage> {
        match self.document.stage() {
            Some(stage) if is_next => stage.next(),
            Some(stage) => stage.previous(),
            None => Stage::ALL.first().filter(|_| is_next),
        }
    }

    /// Why a view has nothing to show; `None` if it has something.
    pub fn useless_show(&self, show: Show) -> Option<String> {
        let no = |reason: &str| Some(reason.to_owned());
        let (has_error, shading) = (self.document.settings.estimate_error, self.document.rules().shading);
        match show {
            Show::Error if !has_error => no("The film has one half; switch on Estimate error"),
            Show::Normals | Show::Albedo | Show::Bounces | Show::Occupancy
                if let Some(reason) = self.document.no_rays() =>
            {
                no(reason)
            }
            Show::Bounces if shading != Shading::Path => {
                no("In this stage rays end at their first hit, so each path is one ray")
            }
            Show::Occupancy => match self.remembered.device {
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
