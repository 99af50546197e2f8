//! What the window remembers from one run to the next.

use super::device::{self, Device};
use crate::scene::Camera;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Colours of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Theme {
    /// As the desktop has it.
    #[default]
    System,
    /// Light on dark.
    Dark,
    /// Dark on light.
    Light,
}

impl Theme {
    /// All of them.
    pub const ALL: [Theme; 3] = [Theme::System, Theme::Dark, Theme::Light];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Theme::System => "System",
            Theme::Dark => "Dark",
            Theme::Light => "Light",
        }
    }
}

/// A camera to come back to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bookmark {
    /// What it is called.
    pub name: String,
    look_from: DVec3,
    look_at: DVec3,
    vup: DVec3,
    vfov_degrees: f64,
    defocus_angle_degrees: f64,
    focus_distance: Option<f64>,
}

impl Bookmark {
    /// A bookmark of a camera.
    pub fn new(name: String, camera: &Camera) -> Self {
        let Camera { look_from, look_at, vup, vfov_degrees, defocus_angle_degrees, focus_distance } = *camera;
        Bookmark { name, look_from, look_at, vup, vfov_degrees, defocus_angle_degrees, focus_distance }
    }

    /// The camera.
    pub fn camera(&self) -> Camera {
        let Bookmark { look_from, look_at, vup, vfov_degrees, defocus_angle_degrees, focus_distance, .. } =
            *self;
        Camera { look_from, look_at, vup, vfov_degrees, defocus_angle_degrees, focus_distance }
    }
}

/// The settings of the window, not of the picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Remembered {
    /// Colours.
    pub theme: Theme,
    /// Whether panels are shown at all.
    pub has_panels: bool,
    /// The panel at the left.
    pub has_controls: bool,
    /// The panel at the right.
    pub has_info: bool,
    /// The plot.
    pub has_plot: bool,
    /// Who traces.
    pub device: Device,
    /// Lanes of a packet; `None`: those of a register.
    pub lanes: Option<usize>,
    /// Threads; `None`: what keeps the window smooth.
    pub threads: Option<usize>,
    /// Cameras to come back to.
    pub bookmarks: Vec<Bookmark>,
    /// Where files were saved last.
    pub directory: Option<std::path::PathBuf>,
}

impl Default for Remembered {
    fn default() -> Self {
        Remembered {
            theme: Theme::System,
            has_panels: true,
            has_controls: true,
            has_info: true,
            has_plot: false,
            device: Device::Cpu,
            lanes: None,
            threads: None,
            bookmarks: Vec::new(),
            directory: None,
        }
    }
}

impl Remembered {
    /// Takes out what this machine does not have, be it of another run or another version.
    pub fn mended(mut self) -> Self {
        let lanes = device::lane_counts();
        self.lanes = self.lanes.filter(|count| lanes.contains(count));
        self.threads = self.threads.filter(|count| (1..=device::core_count()).contains(count));
        if self.device.unavailable().is_some() {
            self.device = Device::Cpu;
        }
        // A window that opens without any panel would be a riddle.
        self.has_panels = true;
        self.bookmarks.retain(|bookmark| bookmark.camera().validate().is_ok());
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_is_not_remembered() {
        let mut broken = Camera::BOOK;
        broken.look_at = broken.look_from;
        let strange = Remembered {
            lanes: Some(7),
            threads: Some(1_000_000),
            bookmarks: vec![Bookmark::new("a".into(), &Camera::BOOK), Bookmark::new("b".into(), &broken)],
            ..Remembered::default()
        };
        let mended = strange.mended();
        assert_eq!((mended.lanes, mended.threads, mended.bookmarks.len()), (None, None, 1));
        assert_eq!(mended.bookmarks[0].camera(), Camera::BOOK);
    }
}
