//! Determines what would be lost if a film were replaced.

use super::difference::same_job;
use crate::film::{SampleRanges, checkpoint};
use crate::system::files::ShownPath;
use std::path::Path;

/// An existing file that a film would replace.
#[derive(Debug, PartialEq, Eq)]
pub enum Replaced {
    /// No file, an empty one, or a device.
    Nothing,
    /// A film of the same picture, with these samples.
    Same(SampleRanges),
    /// Anything else: `holds ...` or `cannot be read as a film (...)`.
    Other(String),
}

impl Replaced {
    /// Examines the file. `recipe` is that of the film to be written.
    pub fn at(path: &Path, recipe: &str) -> Replaced {
        if !std::fs::metadata(path).is_ok_and(|found| found.is_file() && found.len() > 0) {
            return Replaced::Nothing;
        }
        match checkpoint::read_head(path) {
            Ok(head) => match same_job(recipe, head.description.recipe()) {
                Ok(()) => Replaced::Same(head.samples),
                Err(difference) => {
                    let count = per_pixel(head.samples.count());
                    Replaced::Other(format!("holds {count} of another picture ({difference})"))
                }
            },
            Err(error) => Replaced::Other(format!("cannot be read as a film ({error})")),
        }
    }

    /// A warning that `--out` replaces the file at `path`, unless it is a film of this picture whose samples `are_kept`.
    pub fn warning(&self, path: &Path, are_kept: impl FnOnce(&SampleRanges) -> bool) -> Option<String> {
        if matches!(self, Replaced::Same(samples) if are_kept(samples)) {
            return None;
        }
        Some(format!(
            "--out replaces {}, which {}; to keep it, name another file",
            path.shown(),
            self.what()?
        ))
    }

    /// Why `--checkpoint` must not be the file at `path`, and what to do; `None` if nothing would be lost.
    pub fn refusal(&self, path: &Path) -> Option<String> {
        let (path, what) = (path.shown(), self.what()?);
        let go_on = match self {
            Replaced::Same(_) => format!("resume them (--checkpoint {path} --continue), or "),
            _ => String::new(),
        };
        Some(format!(
            "{path} already exists and {what}; {go_on}name another file for --checkpoint, or move this one away"
        ))
    }

    /// The samples that would be lost.
    fn what(&self) -> Option<String> {
        match self {
            Replaced::Nothing => None,
            Replaced::Same(samples) => {
                Some(format!("holds {} of this picture ({samples})", per_pixel(samples.count())))
            }
            Replaced::Other(what) => Some(what.clone()),
        }
    }
}

fn per_pixel(count: u64) -> String {
    format!("{count} sample{} per pixel", if count == 1 { "" } else { "s" })
}
