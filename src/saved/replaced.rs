//! Says what would be lost if a film were replaced.

use super::difference::same_job;
use crate::files::ShownPath;
use crate::film::{CheckpointError, SampleRanges, checkpoint};
use std::path::Path;

/// What is in the place where a film is to be written.
#[derive(Debug, PartialEq, Eq)]
pub enum Replaced {
    /// No file, an empty one, or a device.
    Nothing,
    /// A film of the same picture, with these samples.
    Same(SampleRanges),
    /// A film of another picture.
    Other {
        /// Samples per pixel.
        count: u64,
        /// The first difference between the two pictures.
        difference: String,
    },
    /// A film that this program cannot read, because it is damaged or of another version.
    Unreadable(CheckpointError),
    /// A file of another kind.
    NoFilm,
}

impl Replaced {
    /// Looks at the file. `recipe` is that of the film to be written.
    pub fn at(path: &Path, recipe: &str) -> Replaced {
        if !std::fs::metadata(path).is_ok_and(|found| found.is_file() && found.len() > 0) {
            return Replaced::Nothing;
        }
        match checkpoint::read_head(path) {
            Ok(head) => match same_job(recipe, head.description.recipe()) {
                Ok(()) => Replaced::Same(head.samples),
                Err(difference) => Replaced::Other { count: head.samples.count(), difference },
            },
            Err(CheckpointError::NotExr { .. } | CheckpointError::NotFilm { .. }) => Replaced::NoFilm,
            Err(error) => Replaced::Unreadable(error),
        }
    }

    /// A warning that `--out` replaces the film at `path`, if that loses samples: those for which `is_kept` is false, and
    /// those of other pictures.
    pub fn warning(&self, path: &Path, is_kept: impl FnOnce(&SampleRanges) -> bool) -> Option<String> {
        let path = path.shown();
        match self {
            Replaced::Same(samples) if !is_kept(samples) => Some(format!(
                "--out replaces {path}, which holds {} of this picture ({samples}); to keep them, name another file",
                per_pixel(samples.count())
            )),
            Replaced::Other { count, difference } => Some(format!(
                "--out replaces {path}, which holds {} of another picture ({difference}); to keep them, name another file",
                per_pixel(*count)
            )),
            // Rendering a damaged film again is the way to mend it.
            Replaced::Unreadable(CheckpointError::Damaged { .. }) => None,
            Replaced::Unreadable(error) => {
                Some(format!("--out replaces {path}, whose samples cannot be read: {error}"))
            }
            Replaced::Nothing | Replaced::Same(_) | Replaced::NoFilm => None,
        }
    }

    /// Why `--checkpoint` must not be the file at `path`, and what to do; `None` if nothing would be lost.
    pub fn refusal(&self, path: &Path) -> Option<String> {
        const REMEDY: &str = "name another file for --checkpoint, or move this one away";
        let path = path.shown();
        match self {
            Replaced::Nothing => None,
            Replaced::Same(samples) => Some(format!(
                "{path} already holds {} of this picture ({samples}); go on with them (--checkpoint {path} \
                 --continue), or {REMEDY}",
                per_pixel(samples.count())
            )),
            Replaced::Other { count, difference } => Some(format!(
                "{path} already holds {} of another picture: {difference}; {REMEDY}",
                per_pixel(*count)
            )),
            Replaced::Unreadable(error) => {
                Some(format!("{path} is there, but its samples cannot be read ({error}); {REMEDY}"))
            }
            Replaced::NoFilm => Some(format!("{path} is there, but it is not a film of Weekender; {REMEDY}")),
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
    use crate::recipe::{Recipe, file};

    #[test]
    fn what_would_be_lost_is_told_and_what_would_not_is_passed_over() {
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
        let told = found.warning(&path, |samples| samples.end() <= 8).unwrap();
        assert!(told.contains("a.exr, which holds 30 samples per pixel of this picture (2..32)"), "{told}");
        let told = found.refusal(&path).unwrap();
        assert!(told.contains("30 samples per pixel") && told.contains("--continue"), "{told}");

        let found = Replaced::at(&path, &other);
        for told in [found.warning(&path, |_| true).unwrap(), found.refusal(&path).unwrap()] {
            assert!(told.contains("another picture") && told.contains("seed is 5 here, 0 there"), "{told}");
            assert!(!told.contains("--continue"), "{told}");
        }

        std::fs::write(at("empty.exr"), "").unwrap();
        for name in ["empty.exr", "missing.exr", "."] {
            let found = Replaced::at(&at(name), &text);
            assert_eq!((found.warning(&path, |_| false), found.refusal(&path)), (None, None), "{name}");
        }
        std::fs::write(at("no.exr"), "a picture").unwrap();
        let found = Replaced::at(&at("no.exr"), &text);
        assert_eq!(found, Replaced::NoFilm);
        assert!(found.warning(&path, |_| false).is_none() && found.refusal(&path).is_some());
        let mut bytes = std::fs::read(&path).unwrap();
        bytes.truncate(100);
        std::fs::write(at("short.exr"), bytes).unwrap();
        let found = Replaced::at(&at("short.exr"), &text);
        let Replaced::Unreadable(CheckpointError::Damaged { .. }) = found else { panic!("{found:?}") };
        assert!(found.warning(&path, |_| false).is_none());
        assert!(found.refusal(&path).unwrap().contains("is damaged"));
    }

    #[test]
    fn samples_of_another_version_are_not_lost_without_a_word() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.exr");
        let mut recipe = Recipe::find("three-spheres").unwrap();
        (recipe.settings.width, recipe.settings.height) = (4, 3);
        let text = file::to_picture_toml(&recipe);
        let mut film = recipe.job().unwrap().new_film();
        film.record(0..1, 0).unwrap();
        checkpoint::save(&path, &film, &Description::new(&text)).unwrap();
        let told = Replaced::at(&path, &text).refusal(&path).unwrap();
        assert!(told.contains("a.exr already holds 1 sample per pixel of this picture (0..1)"), "{told}");

        let version = b"sample_version = 3";
        let mut bytes = std::fs::read(&path).unwrap();
        let place = bytes.windows(version.len()).position(|window| window == version).unwrap();
        bytes[place + version.len() - 1] = b'2';
        std::fs::write(&path, bytes).unwrap();
        let found = Replaced::at(&path, &text);
        let (warning, refusal) = (found.warning(&path, |_| true).unwrap(), found.refusal(&path).unwrap());
        assert!(warning.contains("a.exr, whose samples cannot be read: "), "{warning}");
        assert!(refusal.contains("a.exr is there, but its samples cannot be read ("), "{refusal}");
        for told in [warning, refusal] {
            assert!(told.contains("samples of version 2"), "{told}");
        }
    }
}
