//! Merging films and film files.

use super::common::{RECIPE, description, noisy_film, same_recipe_text};
use std::ops::Range;
use std::path::PathBuf;
use weekender::film::{CheckpointError, Description, Film, FilmError, FilmSum, checkpoint, key};

fn merged(paths: &[&PathBuf], same_job: fn(&str, &str) -> Result<(), String>) -> anyhow::Result<FilmSum> {
    let mut sum = FilmSum::read(paths[0])?;
    paths[1..].iter().try_for_each(|path| sum.add(path, same_job))?;
    Ok(sum)
}

#[test]
fn rejected_samples_add_up() {
    let mut film = Film::new(1, 1);
    film.record(0..4, 3).unwrap();
    let mut other = Film::new(1, 1);
    other.record(4..6, 2).unwrap();
    film.merge(&other).unwrap();
    assert_eq!((film.rejected(), film.sample_count()), (5, 6));
}

#[test]
fn mismatched_films_are_unchanged() {
    let mut film = noisy_film(4, 3, &[0..10]);
    let before = film.clone();
    let error = film.merge(&noisy_film(4, 3, &[20..30, 8..12])).unwrap_err();
    assert_eq!(error, FilmError::Overlap { range: 8..10 });
    assert!(matches!(film.merge(&Film::new(3, 4)), Err(FilmError::Size { .. })));
    assert!(film.record(9..11, 5).is_err());
    assert_eq!(film, before);
}

#[test]
fn merged_files_are_the_film_of_one_run() {
    let directory = tempfile::tempdir().unwrap();
    let paths: Vec<_> = [0..4, 9..12, 4..9]
        .into_iter()
        .map(|range: Range<u64>| {
            let path = directory.path().join(format!("{}.exr", range.start));
            let mut description = description();
            description.set(key::BACKEND, if range.start == 9 { "gpu" } else { "cpu" });
            checkpoint::save(&path, &noisy_film(5, 3, &[range]), &description).unwrap();
            path
        })
        .collect();
    let sum = merged(&[&paths[0], &paths[1], &paths[2]], same_recipe_text).unwrap();
    assert!(*sum.film() == noisy_film(5, 3, &[0..12]));
    let of_sum = sum.description();
    assert_eq!(of_sum.get(key::SAMPLES), Some("12"));
    assert_eq!(of_sum.get(key::SECONDS), Some("4.5"));
    assert_eq!(of_sum.get(key::BACKEND), Some("cpu; gpu"));
    assert_eq!(of_sum.recipe(), RECIPE);

    // Overlap: the message names both files and the samples.
    let overlapping = directory.path().join("overlapping.exr");
    checkpoint::save(&overlapping, &noisy_film(5, 3, &[100..101, 10..20]), &description()).unwrap();
    let error = merged(&[&paths[0], &paths[1], &overlapping], same_recipe_text).unwrap_err();
    let words = error.to_string();
    for part in ["9.exr", "overlapping.exr", "10..12"] {
        assert!(words.contains(part), "{words}");
    }

    // Different jobs, different sizes.
    let stranger = directory.path().join("stranger.exr");
    let recipe = RECIPE.replace("width = 7", "width = 8");
    checkpoint::save(&stranger, &noisy_film(5, 3, &[50..51]), &Description::new(&recipe)).unwrap();
    let error = merged(&[&paths[0], &stranger], same_recipe_text).unwrap_err().to_string();
    assert!(error.contains("stranger.exr") && error.contains("width = 7") && error.contains("width = 8"));
    let trusting = merged(&[&paths[0], &stranger], |_, _| Ok(())).unwrap();
    assert_eq!(trusting.film().sample_count(), 5);
    assert_eq!(trusting.description().get(key::SAMPLES), Some("5"), "with a gap");
    checkpoint::save(&stranger, &noisy_film(3, 5, &[50..51]), &description()).unwrap();
    let error = merged(&[&paths[0], &stranger], same_recipe_text).unwrap_err();
    assert!(matches!(error.downcast_ref(), Some(FilmError::Size { .. })), "{error:#}");
}

/// A sum that leaves one of them out would be too short.
#[test]
fn merged_time_is_unknown_if_any_is() {
    let directory = tempfile::tempdir().unwrap();
    let paths = ["known.exr", "unknown.exr"].map(|name| directory.path().join(name));
    checkpoint::save(&paths[0], &noisy_film(2, 2, &[0..2]), &description()).unwrap();
    checkpoint::save(&paths[1], &noisy_film(2, 2, &[2..4]), &Description::new(RECIPE)).unwrap();
    let mut sum = FilmSum::read(&paths[0]).unwrap();
    assert_eq!(sum.description().get(key::SECONDS), Some("1.5"));
    sum.add(&paths[1], same_recipe_text).unwrap();
    assert_eq!(sum.description().get(key::SECONDS), None);
}

/// Each thread that reads the film has several of its 25 bands, and the last one is damaged.
#[test]
fn damaged_film_leaves_the_sum_unchanged() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    for (name, range) in [("a.exr", 0..2), ("b.exr", 2..4)] {
        checkpoint::save(&path(name), &noisy_film(3, 400, &[range]), &description()).unwrap();
    }
    let whole = std::fs::read(path("b.exr")).unwrap();
    let mut bytes = whole.clone();
    bytes[whole.len() - 5] ^= 1;
    std::fs::write(path("b.exr"), bytes).unwrap();
    let mut sum = FilmSum::read(&path("a.exr")).unwrap();
    let refused = sum.add(&path("b.exr"), same_recipe_text).unwrap_err();
    assert!(matches!(refused.downcast_ref(), Some(CheckpointError::Damaged { .. })), "{refused}");
    assert!(sum.film() == &noisy_film(3, 400, &[0..2]));
    std::fs::write(path("b.exr"), whole).unwrap();
    sum.add(&path("b.exr"), same_recipe_text).unwrap();
    assert!(sum.film() == &noisy_film(3, 400, &[0..4]) && sum.description().get(key::SECONDS) == Some("3"));
}
