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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Description;
    use crate::job::recipe::{Recipe, file};

    #[test]
    fn only_real_losses_are_reported() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        let mut recipe = Recipe::find("three-spheres").unwrap();
        (recipe.settings.width, recipe.settings.height) = (4, 3);
        let text = file::to_picture_toml(&recipe);
        let mut film = recipe.job().unwrap().new_film();
        film.record(2..32, 0).unwrap();
        let path = at("a.exr");
        checkpoint::save(&path, &film, &Description::new(&text)).unwrap();
        recipe.settings.seed = 5;
        let other = file::to_picture_toml(&recipe);

        let found = Replaced::at(&path, &text);
        assert_eq!(found, Replaced::Same(film.samples().clone()));
        assert_eq!(found.warning(&path, |_| true), None);
        let message = found.warning(&path, |samples| samples.end() <= 8).unwrap();
        assert!(["a.exr", "30 samples", "2..32"].iter().all(|part| message.contains(part)), "{message}");
        let message = found.refusal(&path).unwrap();
        assert!(message.contains("30 samples") && message.contains("--continue"), "{message}");

        let found = Replaced::at(&path, &other);
        for message in [found.warning(&path, |_| true).unwrap(), found.refusal(&path).unwrap()] {
            assert!(
                message.contains("another picture") && message.contains("seed is 5 here, 0 there"),
                "{message}"
            );
            assert!(!message.contains("--continue"), "{message}");
        }

        std::fs::write(at("empty.exr"), "").unwrap();
        for name in ["empty.exr", "missing.exr", "."] {
            let found = Replaced::at(&at(name), &text);
            assert_eq!((found.warning(&path, |_| false), found.refusal(&path)), (None, None), "{name}");
        }
        let mut bytes = std::fs::read(&path).unwrap();
        bytes.truncate(100);
        for (content, part) in [(&b"a picture"[..], "is not an EXR file"), (&bytes, "is damaged")] {
            std::fs::write(at("no.exr"), content).unwrap();
            let found = Replaced::at(&at("no.exr"), &text);
            for message in [found.warning(&path, |_| true).unwrap(), found.refusal(&path).unwrap()] {
                assert!(message.contains(part), "{message}");
            }
        }
    }
}
