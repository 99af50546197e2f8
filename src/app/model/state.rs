//! Everything that the user has chosen.

use super::animation::Play;
use super::{Device, Document, Mode, Partner, Remembered, Show, Tab, ViewState};
use crate::backends::BackendChoice;
use crate::progressive::Stop;
use crate::stages::{Shading, Stage};

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
    /// The end that the user has chosen last, which other pictures take over; none in samples, which are a picture's own.
    pub own_stop: Option<Stop>,
    /// The selected sphere.
    pub selected: Option<usize>,
    /// The current view and comparison.
    pub view: ViewState,
    /// The window's settings, including the device.
    pub remembered: Remembered,
    /// The backend of the command line, with its options.
    pub given: BackendChoice,
    /// Whether tracing is paused.
    pub is_paused: bool,
    /// The animation that is played.
    pub playing: Option<Play>,
    /// Whether only the picture is shown.
    pub hides_panels: bool,
    /// Whether the window is in full-screen mode.
    pub is_full_screen: bool,
    /// The presentation in progress.
    pub presentation: Option<Presentation>,
}

impl Model {
    /// Whether panels are shown. A presentation has none.
    pub fn has_panels(&self) -> bool {
        !self.hides_panels && self.presentation.is_none()
    }

    /// Whether the right panel shows this tab.
    pub fn shows(&self, tab: Tab) -> bool {
        self.has_panels() && !self.remembered.hides_info && self.remembered.tab == tab
    }

    /// The backend for the chosen device.
    pub fn backend(&self) -> BackendChoice {
        self.backend_of(self.remembered.device)
    }

    /// Traces on this device. If the picture is compared with it, the two change sides.
    pub fn choose_device(&mut self, device: Device) {
        let before = std::mem::replace(&mut self.remembered.device, device);
        if self.view.partner == Partner::Device(device) && before != device {
            self.view.partner = Partner::Device(before);
        }
    }

    /// The backend for another device.
    pub fn backend_of(&self, device: Device) -> BackendChoice {
        device.backend(&self.given)
    }

    /// All partners to choose from, without the other stages: those with which the picture has something in common.
    pub fn partners(&self) -> Vec<Partner> {
        let (document, device) = (&self.document, self.remembered.device);
        let mut partners: Vec<Partner> =
            Partner::usual(document).map(|_| Partner::Usual).into_iter().collect();
        if document.no_rays().is_none() {
            let devices = [Device::Cpu, Device::Gpu].into_iter().filter(|other| *other != device);
            partners.extend(devices.filter(|other| other.unavailable().is_none()).map(Partner::Device));
            if Partner::usual(document) != Some(Partner::Book) && document.origin.is_other_by_the_book() {
                partners.push(Partner::Book);
            }
        }
        partners.extend(self.view.kept.mine.iter().map(|_| Partner::Mine));
        partners.extend(self.view.kept.iter().map(|kept| Partner::Kept(kept.number)));
        partners
    }

    /// The name of a partner, for [`Partner::Usual`] that of the picture.
    pub fn partner_name(&self, partner: Partner) -> String {
        let meant = match partner {
            Partner::Usual => Partner::usual(&self.document).unwrap_or_default(),
            _ => partner,
        };
        meant.names(&self.view.kept)[0].clone()
    }

    /// The names of both sides of a comparison, the other one first: on the picture, and in a column of numbers.
    pub fn side_names(&self) -> [[String; 2]; 2] {
        let partner = self.view.partner(&self.document).unwrap_or_default();
        [partner.names(&self.view.kept), partner.names_of_mine(&self.document, self.remembered.device)]
    }

    /// The other device, if the picture is compared with what that traces.
    pub fn other_device(&self) -> Option<Device> {
        match self.view.compared(&self.document)? {
            Partner::Device(device) => Some(device),
            _ => None,
        }
    }

    /// Why the picture cannot be compared; `None` if it can.
    pub fn nothing_to_compare(&self) -> Option<String> {
        let is_alone = self.view.partner(&self.document).is_none();
        is_alone.then(|| "There is nothing to compare this picture with; choose something".to_owned())
    }

    /// Why the two cannot be subtracted; `None` if they can.
    pub fn not_subtractable(&self) -> Option<String> {
        let ([a, b], [x, y]) = (self.view.kept_partner()?.size(), self.document.size());
        ([a, b] != [x, y]).then(|| format!("The other picture is {a} × {b} and this one {x} × {y}"))
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
        let shading = self.document.rules().shading;
        match show {
            Show::Normals | Show::Albedo | Show::Bounces if let Some(reason) = self.document.no_rays() => {
                no(reason)
            }
            Show::Bounces if shading != Shading::Path => {
                no("In this stage rays end at their first hit, so each path is one ray")
            }
            _ => None,
        }
    }
}
