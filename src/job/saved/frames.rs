//! Checks whether the file of a frame exists and is right.

use crate::film::key;
use crate::job::output::{read_description, read_picture};
use crate::job::recipe::{Recipe, file};
use std::path::Path;

/// Whether the file is the whole frame that `recipe` describes, made by `software`, the program and its version.
pub fn is_whole_frame(path: &Path, recipe: &Recipe, software: &str) -> bool {
    let samples = recipe.samples_per_pixel.to_string();
    read_description(path).is_ok_and(|found| {
        found.recipe() == file::to_picture_toml(recipe)
            && found.get(key::SAMPLES) == Some(&samples)
            && found.get(key::SOFTWARE) == Some(software)
    }) && read_picture(path, None).is_ok()
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
        assert!(!is_whole_frame(&path, &recipe, "Weekender 1"));

        let mut film = recipe.job().unwrap().new_film();
        film.record(0..2, 0).unwrap();
        let mut description = Description::new(&file::to_picture_toml(&recipe));
        description.set(key::SOFTWARE, "Weekender 1");
        description.set(key::SAMPLES, 2);
        let write = |description: &Description| {
            write_image(&path, &film, recipe.rules.transfer, description).unwrap()
        };
        write(&description);
        assert!(is_whole_frame(&path, &recipe, "Weekender 1"));
        assert!(!is_whole_frame(&path, &recipe, "Weekender 2"));
        let mut other = recipe.clone();
        other.settings.seed = 5;
        assert!(!is_whole_frame(&path, &other, "Weekender 1"));
        description.set(key::SAMPLES, 1);
        write(&description);
        assert!(!is_whole_frame(&path, &recipe, "Weekender 1"));
        description.set(key::SAMPLES, 2);
        write(&description);
        let whole = std::fs::read(&path).unwrap();
        for damaged in [&whole[..whole.len() - 30], b"no picture"] {
            std::fs::write(&path, damaged).unwrap();
            assert!(!is_whole_frame(&path, &recipe, "Weekender 1"));
        }
    }
}
