//! The purposes for which the user chooses files.

use crate::job::output::OutputFormat;
use std::path::PathBuf;

/// What the chosen file is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// To open it.
    Open,
    /// To save the picture in this format.
    Save(OutputFormat),
    /// A picture of the user's own program, to check.
    Check,
    /// To save the scene.
    SaveScene,
    /// To save the plot's points.
    SavePlot,
    /// To load it as a film to compare with.
    ReferenceFilm,
}

impl Purpose {
    /// The title of the dialog.
    pub fn title(self) -> &'static str {
        match self {
            Purpose::Open => "Open",
            Purpose::Save(OutputFormat::Png) => "Save picture as PNG",
            Purpose::Save(OutputFormat::P6) => "Save picture as PPM",
            Purpose::Save(OutputFormat::Exr) => "Save film as EXR",
            Purpose::Check => "Check my picture",
            Purpose::SaveScene => "Save scene file",
            Purpose::SavePlot => "Save error against time as CSV",
            Purpose::ReferenceFilm => "Load reference film",
        }
    }

    /// The label of the dialog's button.
    pub fn button(self) -> &'static str {
        match self {
            Purpose::Open | Purpose::ReferenceFilm | Purpose::Check => "Open",
            _ => "Save",
        }
    }

    /// Whether the file will be written.
    pub fn is_saving(self) -> bool {
        use Purpose::{Save, SavePlot, SaveScene};
        matches!(self, Save(_) | SaveScene | SavePlot)
    }

    /// The possible file endings, without the dot.
    pub fn endings(self) -> &'static [&'static str] {
        match self {
            Purpose::Check => &["png", "ppm"],
            Purpose::Open => &["png", "ppm", "exr", "toml"],
            Purpose::Save(OutputFormat::Png) => &["png"],
            Purpose::Save(OutputFormat::P6) => &["ppm"],
            Purpose::Save(OutputFormat::Exr) | Purpose::ReferenceFilm => &["exr"],
            Purpose::SaveScene => &["toml"],
            Purpose::SavePlot => &["csv"],
        }
    }
}

impl Purpose {
    /// Adds the ending to `path` if it is missing.
    pub fn with_ending(self, path: PathBuf) -> PathBuf {
        let is_known = path
            .extension()
            .is_some_and(|ending| self.endings().iter().any(|known| ending.eq_ignore_ascii_case(known)));
        match self.endings() {
            [ending] if self.is_saving() && !is_known => {
                let mut name = path.into_os_string();
                name.push(format!(".{ending}"));
                PathBuf::from(name)
            }
            _ => path,
        }
    }
}
