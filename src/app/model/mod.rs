//! The model of the window: the document, the view, the device, and the remembered settings. It does not depend on
//! widgets or drawing.

pub mod checked;
pub mod command_line;
pub mod companion;
pub mod crop;
pub mod device;
pub mod document;
pub mod edit;
pub mod first_steps;
pub mod fitted;
pub mod framing;
pub mod further;
pub mod kept;
pub mod kept_view;
pub mod origin;
pub mod presentation;
pub mod reload;
pub mod remembered;
#[cfg(test)]
mod saved_fields;
pub mod session;
pub mod show;
pub mod sizing;
pub mod slot_number;
pub mod slots;
pub mod tone;
pub mod view;
pub mod viewpoint;

use crate::backends::BackendChoice;
use device::DeviceOptions;
use document::Document;
use presentation::Presentation;
use remembered::Remembered;
use view::ViewState;

/// Everything that the user has chosen.
#[derive(Clone, Debug)]
pub struct Model {
    /// The picture being edited.
    pub document: Document,
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
    /// Whether the card with what other windows left is shown.
    pub has_recovered: bool,
}

impl Model {
    /// Whether panels are shown. A presentation has none.
    pub fn has_panels(&self) -> bool {
        self.remembered.has_panels && self.presentation.is_none()
    }

    /// The backend for the chosen device, lanes and threads.
    pub fn backend(&self) -> BackendChoice {
        let Remembered { device, lanes, threads, .. } = self.remembered;
        device.backend(&self.devices, lanes, threads)
    }
}

#[cfg(test)]
mod tests {
    use super::device::Device;
    use super::*;
    use crate::app::tests::facts_of;

    #[test]
    fn the_backend_has_the_chosen_lanes_and_threads() {
        let mut model = facts_of("--stage metal --size 16x9").model;
        (model.remembered.lanes, model.remembered.threads) = (Some(4), Some(2));
        let BackendChoice::Cpu(options) = model.backend() else { panic!("not the CPU") };
        assert_eq!((options.lanes, options.threads), (Some(4), Some(2)));
        model.remembered.device = Device::Reference;
        assert_eq!(model.backend(), BackendChoice::Reference { threads: Some(2) });
    }

    #[test]
    fn there_are_panels_unless_they_are_hidden_or_in_a_presentation() {
        let mut model = facts_of("--stage metal --size 16x9").model;
        let presentation = Presentation { was_full_screen: false, has_captions: true, is_blank: false };
        for (has_panels, presentation, expected) in [
            (true, None, true),
            (false, None, false),
            (true, Some(presentation), false),
            (false, Some(presentation), false),
        ] {
            (model.remembered.has_panels, model.presentation) = (has_panels, presentation);
            assert_eq!(model.has_panels(), expected);
        }
    }
}
