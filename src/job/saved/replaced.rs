//! Determines what would be lost if a film were replaced.

use super::difference::same_job;
use crate::film::{FilmHead, SampleRanges, checkpoint};
use crate::system::files::ShownPath;
use std::path::Path;

/// An existing file that a film would replace.
#[derive(Debug, PartialEq, Eq)]
pub struct Replaced {
    /// The samples of a film of the same picture; `None` for anything else.
    pub samples: Option<SampleRanges>,
    /// What would be lost: `holds ...` or `cannot be read as a film (...)`.
    what: String,
}

impl Replaced {
    /// Examines the file; `None` if there is none, an empty one, or a device. `recipe` is that of the film to be written.
    pub fn at(path: &Path, recipe: &str) -> Option<Replaced> {
        std::fs::metadata(path).ok().filter(|found| found.is_file() && found.len() > 0)?;
        let (samples, what) = match checkpoint::read_head(path) {
            Ok(FilmHead { samples, description, .. }) => {
                let plural = if samples.count() == 1 { "" } else { "s" };
                let held = format!("holds {} sample{plural} per pixel of", samples.count());
                match same_job(recipe, description.recipe()) {
                    Ok(()) => (Some(samples.clone()), format!("{held} this picture ({samples})")),
                    Err(difference) => (None, format!("{held} another picture ({difference})")),
                }
            }
            Err(error) => (None, format!("cannot be read as a film ({error})")),
        };
        Some(Replaced { samples, what })
    }

    /// A warning that `--out` replaces the file at `path`, unless it is a film of this picture whose samples `are_kept`.
    pub fn warning(&self, path: &Path, are_kept: impl FnOnce(&SampleRanges) -> bool) -> Option<String> {
        let is_kept = self.samples.as_ref().is_some_and(are_kept);
        let (path, what) = (path.shown(), &self.what);
        (!is_kept).then(|| format!("--out replaces {path}, which {what}; to keep it, name another file"))
    }

    /// Why `--checkpoint` must not be the file at `path`, and what to do.
    pub fn refusal(&self, path: &Path) -> String {
        let (path, what) = (path.shown(), &self.what);
        let go_on = format!("resume them (--checkpoint {path} --continue), or ");
        let go_on = self.samples.as_ref().map_or("", |_| &go_on);
        format!(
            "{path} already exists and {what}; {go_on}name another file for --checkpoint, or move this one away"
        )
    }
}
