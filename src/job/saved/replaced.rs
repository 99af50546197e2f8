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

        let found = Replaced::at(&path, &text).unwrap();
        assert_eq!(found.samples.as_ref(), Some(film.samples()));
        assert_eq!(found.warning(&path, |_| true), None);
        let message = found.warning(&path, |samples| samples.end() <= 8).unwrap();
        assert!(["a.exr", "30 samples", "2..32"].iter().all(|part| message.contains(part)), "{message}");
        let message = found.refusal(&path);
        assert!(message.contains("30 samples") && message.contains("--continue"), "{message}");

        let found = Replaced::at(&path, &other).unwrap();
        for message in [found.warning(&path, |_| true).unwrap(), found.refusal(&path)] {
            assert!(
                message.contains("another picture") && message.contains("seed is 5 here, 0 there"),
                "{message}"
            );
            assert!(!message.contains("--continue"), "{message}");
        }

        std::fs::write(at("empty.exr"), "").unwrap();
        for name in ["empty.exr", "missing.exr", "."] {
            assert_eq!(Replaced::at(&at(name), &text), None, "{name}");
        }
        let mut bytes = std::fs::read(&path).unwrap();
        bytes.truncate(100);
        for (content, part) in [(&b"a picture"[..], "is not an EXR file"), (&bytes, "is damaged")] {
            std::fs::write(at("no.exr"), content).unwrap();
            let found = Replaced::at(&at("no.exr"), &text).unwrap();
            for message in [found.warning(&path, |_| true).unwrap(), found.refusal(&path)] {
                assert!(message.contains(part), "{message}");
            }
        }
    }
}
