//! Tests of opening files of each kind.

use super::*;
use crate::job::output::write_image;
use std::path::PathBuf;
use tempfile::TempDir;

/// A small recipe, its film of four samples, and the film's description with `entries`.
fn film(entries: &[(&str, &str)]) -> (Recipe, Film, Description) {
    let mut recipe = Recipe::builtin("three-spheres").unwrap();
    (recipe.settings.width, recipe.settings.height) = (4, 3);
    let mut film = recipe.job().unwrap().new_film();
    film.record(0..4, 0).unwrap();
    let mut description = Description::new(&file::to_toml(&recipe));
    entries.iter().for_each(|(key, value)| description.set(key, value));
    (recipe, film, description)
}

fn written(directory: &TempDir, name: &str, entries: &[(&str, &str)]) -> PathBuf {
    let (recipe, film, description) = film(entries);
    let path = directory.path().join(name);
    write_image(&path, &film, recipe.rules.transfer, &description).unwrap();
    path
}

#[test]
fn film_opens_with_samples_and_description() {
    let directory = tempfile::tempdir().unwrap();
    let entries =
        [(key::SCENE, "balls"), (key::STAGE, "metal"), (key::SECONDS, "2.5"), (key::BACKEND, "cpu")];
    let path = written(&directory, "a.exr", &entries);
    let saved = open(&path).unwrap();
    assert_eq!((saved.recipe.name.as_str(), saved.stage().map(|stage| stage.id)), ("balls", Some("metal")));
    let read = saved.film().unwrap();
    assert_eq!((read.film, read.seconds), (film(&[]).1, Some(2.5)));
    assert_eq!(saved.kind.text(key::BACKEND), Some("cpu"));
    assert_eq!(saved.job().unwrap(), film(&[]).0.job().unwrap());
    // The recipe's name does not matter.
    let renamed = directory.path().join("renamed.png");
    std::fs::rename(&path, &renamed).unwrap();
    assert!(open(&renamed).unwrap().film().is_ok());
}

#[test]
fn picture_has_samples_and_is_named_after_its_file() {
    let directory = tempfile::tempdir().unwrap();
    for (entry, samples) in [("7", Some(7)), ("0", None), ("many", None)] {
        let path = written(&directory, "plain.png", &[(key::SAMPLES, entry)]);
        let saved = open(&path).unwrap();
        assert!(matches!(saved.kind, Kind::Picture(_)), "{entry}");
        assert_eq!((saved.samples(), saved.recipe.name.as_str()), (samples, "plain"));
        assert!(matches!(saved.film(), Err(OpenError::Film(CheckpointError::NotExr { .. }))));
    }
}

#[test]
fn film_that_does_not_fit_its_recipe_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let (mut recipe, film, _) = film(&[]);
    let path = directory.path().join("a.exr");
    recipe.settings.width = 5;
    let description = Description::new(&file::to_toml(&recipe));
    write_image(&path, &film, recipe.rules.transfer, &description).unwrap();
    assert!(matches!(open(&path), Err(OpenError::Recipe(_))));
}

#[test]
fn refusal_depends_on_the_kind_of_file() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    for name in ["text.exr", "text.png"] {
        std::fs::write(at(name), "no film").unwrap();
    }
    exr::prelude::write_rgb_file(at("plain.exr"), 3, 2, |_, _| (0.1_f32, 0.2_f32, 0.3_f32)).unwrap();
    std::fs::copy(at("plain.exr"), at("plain.png")).unwrap();
    let error = |name: &str| open(&at(name)).unwrap_err();
    for name in ["text.exr", "plain.exr", "text.png", "plain.png"] {
        assert!(matches!(error(name), OpenError::Picture(_)), "{name}");
    }
    assert!(matches!(error("missing.exr"), OpenError::Film(CheckpointError::Input(_))));
    // A picture that has a description is a picture by any name, and a scene file by any case.
    std::fs::rename(written(&directory, "a.png", &[]), at("b.exr")).unwrap();
    assert!(matches!(open(&at("b.exr")).unwrap().kind, Kind::Picture(_)));
    std::fs::write(at("scene.TOML"), file::to_toml(&film(&[]).0)).unwrap();
    assert!(matches!(open(&at("scene.TOML")).unwrap().kind, Kind::Scene));
}

#[test]
fn frame_is_whole_only_if_all_inputs_match() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("frame.png");
    let mut recipe = Recipe::builtin("three-spheres").unwrap();
    (recipe.settings.width, recipe.settings.height, recipe.samples_per_pixel) = (4, 3, 2);
    let is_whole =
        |recipe: &Recipe, program: &str| is_whole_frame(&path, recipe, program, (key::SAMPLES, "2"));
    assert!(!is_whole(&recipe, "Weekender 1"), "there is none");
    let mut film = recipe.job().unwrap().new_film();
    film.record(0..2, 0).unwrap();
    let mut description = Description::new(&file::to_picture_toml(&recipe));
    description.set(key::SOFTWARE, "Weekender 1");
    for (samples, is_enough) in [("1", false), ("2", true)] {
        description.set(key::SAMPLES, samples);
        write_image(&path, &film, recipe.rules.transfer, &description).unwrap();
        assert_eq!(is_whole(&recipe, "Weekender 1"), is_enough);
    }
    assert!(!is_whole(&recipe, "Weekender 2"));
    let mut other = recipe.clone();
    other.settings.seed = 5;
    assert!(!is_whole(&other, "Weekender 1"));
    let whole = std::fs::read(&path).unwrap();
    for damaged in [&whole[..whole.len() - 30], b"no picture"] {
        std::fs::write(&path, damaged).unwrap();
        assert!(!is_whole(&recipe, "Weekender 1"));
    }
}
