//! Settings that the window keeps from one run to the next.

use super::{Device, Sizing, ViewState};
use eframe::Storage;
use eframe::egui::ThemePreference;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// How many files are remembered.
pub const RECENT_LIMIT: usize = 8;

/// The tabs of the dock under the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Dock {
    Path,
    Error,
}

/// The tabs of the right panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Tab {
    #[default]
    Stage,
    Code,
    Check,
    /// The controls, if the window is too narrow for two panels.
    Controls,
}

impl Dock {
    pub fn name(self) -> &'static str {
        match self {
            Dock::Path => "Path",
            Dock::Error => "Error",
        }
    }
}

impl Tab {
    pub fn name(self) -> &'static str {
        match self {
            Tab::Stage => "Stage",
            Tab::Code => "Code",
            Tab::Check => "Check",
            Tab::Controls => "Controls",
        }
    }
}

/// Settings of the window, as opposed to those of the picture.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Remembered {
    /// The colour theme.
    pub theme: ThemePreference,
    /// Whether the left panel is hidden.
    pub hides_controls: bool,
    /// Whether the right panel is hidden.
    pub hides_info: bool,
    /// The open tab of the dock under the picture.
    pub dock: Option<Dock>,
    /// The open tab of the right panel.
    pub tab: Tab,
    /// The size of pictures that have no size of their own.
    pub sizing: Sizing,
    /// The device that traces.
    pub device: Device,
    /// The files that were opened or saved last, newest first.
    pub recent: Vec<PathBuf>,
    /// The picture of another program that is being checked.
    pub mine: Option<PathBuf>,
    /// The id of the stage that the user has chosen for it.
    pub mine_stage: Option<String>,
    /// The ids of the stages whose picture by another program was right.
    pub done: BTreeSet<String>,
}

/// What eframe stores for the next window: settings and view. Those of another version are not read.
#[derive(Serialize, Deserialize)]
pub struct Stored {
    version: u32,
    remembered: Remembered,
    view: ViewState,
}

impl Stored {
    const VERSION: u32 = 3;
    const KEY: &str = "settings";

    /// Settings and view of the last window, or the usual ones.
    pub fn read(storage: Option<&dyn Storage>) -> (Remembered, ViewState) {
        let stored: Option<Stored> = storage.and_then(|storage| eframe::get_value(storage, Stored::KEY));
        let stored = stored.filter(|stored| stored.version == Stored::VERSION);
        stored.map_or_else(Default::default, |stored| (stored.remembered.mended(), stored.view))
    }

    pub fn write(remembered: Remembered, view: ViewState, storage: &mut dyn Storage) {
        eframe::set_value(storage, Stored::KEY, &Stored { version: Stored::VERSION, remembered, view });
        // The next window does not begin in full screen, where one would look for its title bar in vain. The entry is
        // eframe's own, in RON.
        if let Some(window) = storage.get_string("window") {
            storage.set_string("window", window.replace("fullscreen:true", "fullscreen:false"));
        }
    }
}

impl Remembered {
    /// Remembers a file that was opened or saved. A path that is not Unicode is not remembered: it could not be stored.
    pub fn note_recent(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.recent.retain(|recent| *recent != path);
        if path.to_str().is_some() {
            self.recent.insert(0, path);
            self.recent.truncate(RECENT_LIMIT);
        }
    }

    /// Replaces settings that are not available on this machine; they may come from another machine or version.
    pub fn mended(mut self) -> Self {
        if self.device.unavailable().is_some() {
            self.device = Device::Cpu;
        }
        self.recent.truncate(RECENT_LIMIT);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_that_this_machine_lacks_becomes_the_cpu() {
        for device in Device::ALL {
            let mended = Remembered { device, ..Remembered::default() }.mended();
            let expected = if device.unavailable().is_some() { Device::Cpu } else { device };
            assert_eq!(mended.device, expected);
        }
    }

    #[test]
    fn the_newest_files_are_remembered_once() {
        let mut remembered = Remembered::default();
        let path = |number: u32| std::env::temp_dir().join(format!("{number}.png"));
        for number in (0..10).chain([4]) {
            remembered.note_recent(&path(number));
        }
        let expected = [4, 9, 8, 7, 6, 5, 3, 2].map(path);
        assert_eq!(remembered.recent, expected);
    }
}
