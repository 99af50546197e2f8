//! The model of the window: the document, the view, the device, and the remembered settings. It does not depend on
//! widgets or drawing.

pub mod changes;
mod checked;
mod command_line;
pub mod companion;
pub mod device;
mod document;
mod edit;
mod kept;
pub mod navigation;
mod origin;
mod remembered;
mod show;
mod sizing;
pub mod spheres;
mod view;

pub use checked::{CheckedScene, stamp_of};
pub use companion::file_url;
pub use device::{Device, DeviceOptions, adapter, best_isa, core_count, lane_counts};
pub use document::Document;
pub use edit::{Body, Edit};
pub use kept::{Kept, KeptList};
pub use origin::{Origin, Source};
pub use remembered::{Bookmark, Dock, Remembered, Stored, Tab};
pub use show::{Channel, Show, Tone};
pub use sizing::Sizing;
pub use view::{Mode, Other, ViewState, With, differ_in_camera, partner};

use crate::backends::BackendChoice;
use crate::progressive::Stop;

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
    /// The presentation, if there is one.
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

    /// The backend for the chosen device, lanes and threads.
    pub fn backend(&self) -> BackendChoice {
        let Remembered { device, lanes, threads, .. } = self.remembered;
        device.backend(&self.devices, lanes, threads)
    }
}
