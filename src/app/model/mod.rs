//! What the window is about: the document, what of it is looked at, who traces it, and what is remembered. Nothing here
//! knows of controls or of drawing.

pub mod command_line;
pub mod device;
pub mod document;
pub mod origin;
pub mod remembered;
pub mod show;
pub mod view;

use crate::backends::BackendChoice;
use device::DeviceOptions;
use document::Document;
use remembered::Remembered;
use view::ViewState;

/// All that the user has chosen.
#[derive(Clone, Debug)]
pub struct Model {
    /// The picture.
    pub document: Document,
    /// What of it is looked at, and what it is compared with.
    pub view: ViewState,
    /// The window's settings, the device that traces among them.
    pub remembered: Remembered,
    /// What the command line said of the devices.
    pub devices: DeviceOptions,
    /// Tracing waits.
    pub is_paused: bool,
    /// The window takes the whole screen.
    pub is_full_screen: bool,
}

impl Model {
    /// Who traces: the chosen device, with lanes and threads as chosen.
    pub fn backend(&self) -> BackendChoice {
        let Remembered { device, lanes, threads, .. } = self.remembered;
        device.backend(&self.devices, lanes, threads)
    }
}
