//! What files are named for.

use crate::output::OutputFormat;
use std::path::PathBuf;

/// What the file is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// To be opened.
    Open,
    /// To be written.
    Save(OutputFormat),
    /// To be written with the scene.
    SaveScene,
    /// To be written with the plot's points.
    SavePlot,
    /// To be compared with.
    Reference,
}

impl Purpose {
    /// The heading of the dialog.
    pub fn title(self) -> &'static str {
        match self {
            Purpose::Open => "Open",
            Purpose::Save(OutputFormat::Png) => "Save picture as PNG",
            Purpose::Save(OutputFormat::P6) => "Save picture as PPM",
            Purpose::Save(OutputFormat::Exr) => "Save film as EXR",
            Purpose::SaveScene => "Save scene file",
            Purpose::SavePlot => "Save error against time as CSV",
            Purpose::Reference => "Load reference film",
        }
    }

    /// What its button says.
    pub fn button(self) -> &'static str {
        match self {
            Purpose::Open | Purpose::Reference => "Open",
            _ => "Save",
        }
    }

    /// Whether a file is written.
    pub fn is_saving(self) -> bool {
        matches!(self, Purpose::Save(_) | Purpose::SaveScene | Purpose::SavePlot)
    }

    /// What names end in, without the dot.
    pub fn endings(self) -> &'static [&'static str] {
        match self {
            Purpose::Open => &["png", "ppm", "exr", "toml"],
            Purpose::Save(OutputFormat::Png) => &["png"],
            Purpose::Save(OutputFormat::P6) => &["ppm"],
            Purpose::Save(OutputFormat::Exr) | Purpose::Reference => &["exr"],
            Purpose::SaveScene => &["toml"],
            Purpose::SavePlot => &["csv"],
        }
    }
}

impl Purpose {
    /// A name with the ending that belongs to it.
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
