//! File names of frames.

use std::path::{Path, PathBuf};

/// Where an animation's frames are: a directory, and a name with a place for the number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameNames {
    pub directory: PathBuf,
    before: String,
    /// Minimum number of digits.
    digits: usize,
    after: String,
}

impl FrameNames {
    /// `frame-0000.png`, `frame-0001.png` and so on in a directory.
    pub fn in_directory(directory: &Path) -> FrameNames {
        let (before, after) = ("frame-".to_owned(), ".png".to_owned());
        FrameNames { directory: directory.to_owned(), before, digits: 4, after }
    }

    /// Names from a pattern such as `shots/turn-####.png`, whose `#` signs stand for the number and its minimum digits.
    /// `None` unless the file name has exactly one run of them.
    pub fn of_pattern(pattern: &Path) -> Option<FrameNames> {
        let name = pattern.file_name()?.to_str()?;
        let (before, rest) = name.split_once('#')?;
        let after = rest.trim_start_matches('#');
        if after.contains('#') {
            return None;
        }
        Some(FrameNames {
            directory: pattern.parent().map(Path::to_owned).unwrap_or_default(),
            before: before.to_owned(),
            digits: name.len() - before.len() - after.len(),
            after: after.to_owned(),
        })
    }

    pub fn path(&self, frame: u32) -> PathBuf {
        let FrameNames { directory, before, digits, after } = self;
        directory.join(format!("{before}{frame:0digits$}{after}"))
    }
}
