//! Outcomes of dialogs.

use crate::job::output::OutputFormat;
use std::path::PathBuf;

/// The outcome of a dialog after a frame.
pub enum Outcome {
    Stay,
    Close,
    /// It closes: the user chose a file.
    Named(Purpose, PathBuf),
    /// It closes: this is saved.
    Save(Wanted),
}

/// The choices of the dialog of saving.
#[derive(Clone)]
pub struct Wanted {
    pub what: What,
    /// Width and height of the picture.
    pub size: [u32; 2],
    /// Frames of an animation, and samples per pixel of each.
    pub frames: u32,
    pub samples: u32,
    /// The file, or the folder of an animation.
    pub path: PathBuf,
}

/// The content to save.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    Picture(OutputFormat),
    Scene,
    Animation,
}

impl What {
    /// All of them, with name, use and ending.
    pub(super) const ALL: [(What, &str, &str, &str); 5] = [
        (What::Picture(OutputFormat::Png), "PNG picture", "To look at; remembers how it was made", "png"),
        (What::Picture(OutputFormat::P6), "PPM picture (P6)", "The format of the book", "ppm"),
        (What::Picture(OutputFormat::Exr), "Film (EXR)", "All light and samples; can be resumed", "exr"),
        (What::Scene, "Scene (TOML)", "Text to edit; no picture in it", "toml"),
        (What::Animation, "Animation", "A folder of pictures, along the bookmarks", ""),
    ];

    pub(super) fn ending(self) -> &'static str {
        What::ALL.into_iter().find(|(what, ..)| *what == self).map_or("", |(_, _, _, ending)| ending)
    }
}

/// The purpose of choosing a file or folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    Open,
    /// To check the picture of the user's own program.
    Check,
    /// To compare the traced picture with another one.
    Compare,
    /// The folder in which the dialog of saving saves.
    Folder,
}

impl Purpose {
    pub(super) fn title(self) -> &'static str {
        match self {
            Purpose::Open => "Open",
            Purpose::Check => "Check my picture",
            Purpose::Compare => "Compare with a file",
            Purpose::Folder => "Folder",
        }
    }
}
