//! Checks whether the file of a frame exists and is right.

use super::difference::same_job;
use crate::film::key;
use crate::job::output::{check_frame, read_description};
use crate::job::recipe::{Recipe, file};
use crate::system::files::ShownPath;
use std::path::Path;

/// State of a frame's file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FrameState {
    /// The whole picture.
    Whole,
    /// No file.
    Missing,
    /// A file that is damaged, of another picture, or from another version of the program, with the reason.
    Wrong(String),
}

impl FrameState {
    /// Checks the file against the frame that `recipe` describes. `software` is the program and its version.
    pub fn of(path: &Path, recipe: &Recipe, software: &str) -> FrameState {
        if path.symlink_metadata().is_err() {
            return FrameState::Missing;
        }
        let found = match read_description(path) {
            Ok(found) => found,
            Err(error) => return FrameState::Wrong(error.to_string()),
        };
        let wrong = |what: String| FrameState::Wrong(format!("{} is {what}", path.shown()));
        let wanted = file::to_picture_toml(recipe);
        if found.recipe() != wanted {
            let difference = same_job(&wanted, found.recipe()).err();
            let difference = difference.unwrap_or_else(|| "its recipe is written in another way".to_owned());
            return wrong(format!("of another picture: {difference}"));
        }
        let entry = |key| found.get(key).unwrap_or("unknown");
        let samples = recipe.samples_per_pixel.to_string();
        if entry(key::SAMPLES) != samples {
            return wrong(format!("of {} samples per pixel, not {samples}", entry(key::SAMPLES)));
        }
        if entry(key::SOFTWARE) != software {
            return wrong(format!("from {}, not {software}", entry(key::SOFTWARE)));
        }
        match check_frame(path, [recipe.settings.width, recipe.settings.height]) {
            Ok(()) => FrameState::Whole,
            Err(error) => FrameState::Wrong(error.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Description;
    use crate::job::output::write_image;

    #[test]
    fn frame_is_whole_only_if_all_inputs_match() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("frame.png");
        let mut recipe = Recipe::builtin("three-spheres").unwrap();
        (recipe.settings.width, recipe.settings.height, recipe.samples_per_pixel) = (4, 3, 2);
        let of = |recipe: &Recipe, software: &str| FrameState::of(&path, recipe, software);
        assert_eq!(of(&recipe, "Weekender 1"), FrameState::Missing);

        let mut film = recipe.job().unwrap().new_film();
        film.record(0..2, 0).unwrap();
        let mut description = Description::new(&file::to_picture_toml(&recipe));
        description.set(key::SOFTWARE, "Weekender 1");
        description.set(key::SAMPLES, 2);
        let write = |description: &Description| {
            write_image(&path, &film, recipe.rules.transfer, description).unwrap()
        };
        write(&description);
        assert_eq!(of(&recipe, "Weekender 1"), FrameState::Whole);

        let refused = |recipe: &Recipe, software: &str, part: &str| match of(recipe, software) {
            FrameState::Wrong(reason) => assert!(reason.contains(part), "{reason} should say {part}"),
            other => panic!("{other:?}, but should say {part}"),
        };
        refused(&recipe, "Weekender 2", "from Weekender 1, not Weekender 2");
        let mut other = recipe.clone();
        other.settings.seed = 5;
        refused(&other, "Weekender 1", "of another picture: seed is 5 here, 0 there");
        description.set(key::SAMPLES, 1);
        write(&description);
        refused(&recipe, "Weekender 1", "of 1 samples per pixel, not 2");
        std::fs::write(&path, "no picture").unwrap();
        refused(&recipe, "Weekender 1", "frame.png");
    }
}
