//! Merging films and film files.

use super::common::{RECIPE, description, noisy_film, same_recipe_text};
use std::ops::Range;
use std::path::Path;
use weekender::film::{
    CheckpointError, Description, Film, FilmError, FilmSum, MergeError, checkpoint, key, merge_files,
};

#[test]
fn merged_films_have_rejected_the_samples_of_both() {
    let mut film = Film::new(1, 1, 2);
    film.record(0..4, 3).unwrap();
    let mut other = Film::new(1, 1, 2);
    other.record(4..6, 2).unwrap();
    let directory = tempfile::tempdir().unwrap();
    let paths = ["a.exr", "b.exr"].map(|name| directory.path().join(name));
    for (path, film) in paths.iter().zip([&film, &other]) {
        checkpoint::save(path, film, &description()).unwrap();
    }
    assert_eq!(merge_files(&paths, same_recipe_text).unwrap().film.rejected(), 5);
    film.merge(&other).unwrap();
    assert_eq!((film.rejected(), film.sample_count()), (5, 6));
}

#[test]
fn films_that_do_not_go_together_are_left_as_they_were() {
    let mut film = noisy_film(4, 3, 2, &[0..10]);
    let before = film.clone();
    let error = film.merge(&noisy_film(4, 3, 2, &[20..30, 8..12])).unwrap_err();
    assert_eq!(error, FilmError::Overlap { range: 8..10 });
    for (width, height, halves) in [(3, 4, 2), (4, 3, 1)] {
        assert!(matches!(film.merge(&Film::new(width, height, halves)), Err(FilmError::Size { .. })));
    }
    assert!(film.record(9..11, 5).is_err());
    assert_eq!(film, before);
}

#[test]
fn more_rejected_samples_than_can_be_counted_are_an_error() {
    let mut film = Film::new(1, 1, 1);
    film.record(0..1, u64::MAX).unwrap();
    let before = film.clone();
    assert!(matches!(film.record(1..2, 1), Err(FilmError::Parts { .. })));
    let mut other = Film::new(1, 1, 1);
    other.record(1..2, 1).unwrap();
    assert!(matches!(film.merge(&other), Err(FilmError::Parts { .. })));
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
            checkpoint::save(&path, &noisy_film(5, 3, 2, &[range]), &description).unwrap();
            path
        })
        .collect();
    let merged = merge_files(&paths, same_recipe_text).unwrap();
    assert_eq!(merged.film, noisy_film(5, 3, 2, &[0..12]));
    assert_eq!(merged.description.get(key::SAMPLES), Some("12"));
    assert_eq!(merged.description.get(key::SECONDS), Some("4.5"));
    assert_eq!(merged.description.get(key::BACKEND), Some("cpu; gpu"));
    assert_eq!(merged.description.recipe(), RECIPE);

    // Overlap: the message names both files and the samples.
    let overlapping = directory.path().join("overlapping.exr");
    checkpoint::save(&overlapping, &noisy_film(5, 3, 2, &[100..101, 10..20]), &description()).unwrap();
    let error = merge_files(&[&paths[0], &paths[1], &overlapping], same_recipe_text).unwrap_err();
    let (first, other) = (paths[1].clone(), overlapping);
    assert_eq!(error, MergeError::Overlap { first, other, range: 10..12 });

    // Different jobs, different sizes, no files.
    let stranger = directory.path().join("stranger.exr");
    let recipe = RECIPE.replace("width = 7", "width = 8");
    checkpoint::save(&stranger, &noisy_film(5, 3, 2, &[50..51]), &Description::new(&recipe)).unwrap();
    let error = merge_files(&[&paths[0], &stranger], same_recipe_text).unwrap_err().to_string();
    assert!(error.contains("stranger.exr") && error.contains("`width = 7`") && error.contains("`width = 8`"));
    let trusting = merge_files(&[&paths[0], &stranger], |_, _| Ok(())).unwrap();
    assert_eq!(trusting.film.sample_count(), 5);
    assert_eq!(trusting.description.get(key::SAMPLES), Some("5"), "with a gap");
    checkpoint::save(&stranger, &noisy_film(3, 5, 2, &[50..51]), &description()).unwrap();
    let error = merge_files(&[&paths[0], &stranger], same_recipe_text).unwrap_err();
    assert!(matches!(error, MergeError::Film { reason: FilmError::Size { .. }, .. }));
    assert_eq!(merge_files::<&Path>(&[], same_recipe_text), Err(MergeError::NoFiles));
}

#[test]
fn guests_of_a_sum_leave_it_to_the_bit_even_if_their_files_are_gone() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    let save = |name: &str, ranges: &[Range<u64>]| {
        checkpoint::save(&path(name), &noisy_film(5, 40, 2, ranges), &description()).unwrap();
    };
    save("a.exr", &[0..4]);
    save("b.exr", &[4..7]);
    save("c.exr", &[9..12]);
    let mut sum = FilmSum::new(5, 40, 2, description(), Path::new("plan")).unwrap();
    sum.add(&path("a.exr"), same_recipe_text, |_| false).unwrap();
    for guest in ["b.exr", "c.exr"] {
        sum.add(&path(guest), same_recipe_text, |_| true).unwrap();
    }
    assert_eq!(sum.film(), &noisy_film(5, 40, 2, &[0..7, 9..12]));
    assert_eq!(sum.description().get(key::SECONDS), Some("4.5"));
    // A newer checkpoint has taken the place of one of them.
    save("b.exr", &[4..9]);
    sum.take_back().unwrap();
    assert_eq!(sum.film(), &noisy_film(5, 40, 2, &[0..4]));
    assert_eq!(sum.description().get(key::SECONDS), Some("1.5"));
    sum.add(&path("b.exr"), same_recipe_text, |_| true).unwrap();
    sum.add(&path("c.exr"), same_recipe_text, |_| true).unwrap();
    assert_eq!(sum.film(), &noisy_film(5, 40, 2, &[0..12]));
    let overlap = sum.add(&path("c.exr"), same_recipe_text, |_| false).unwrap_err();
    assert!(matches!(overlap, MergeError::Overlap { range: Range { start: 9, end: 12 }, .. }), "{overlap}");
}

/// A copy into the place of a guest does not make a new file, so the guest cannot be read again.
#[test]
fn a_guest_whose_file_was_overwritten_is_lost_and_not_taken_for_another() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    for (name, range) in [("host", 0..4), ("guest", 4..7), ("longer", 4..9)] {
        checkpoint::save(&path(name), &noisy_film(5, 40, 2, &[range]), &description()).unwrap();
    }
    let mut sum = FilmSum::new(5, 40, 2, description(), Path::new("plan")).unwrap();
    sum.add(&path("host"), same_recipe_text, |_| false).unwrap();
    let mut copy = sum.try_copy().unwrap();
    copy.add(&path("guest"), same_recipe_text, |_| true).unwrap();
    std::fs::copy(path("longer"), path("guest")).unwrap();
    let lost = copy.take_back().unwrap_err();
    assert!(matches!(lost, MergeError::Lost { reason: CheckpointError::Changed { .. } }), "{lost}");
    assert_eq!(sum.film(), &noisy_film(5, 40, 2, &[0..4]), "the copy is another sum");
    copy.clear();
    copy.add(&path("longer"), same_recipe_text, |_| true).unwrap();
    assert_eq!(copy.film(), &noisy_film(5, 40, 2, &[4..9]));
    assert_eq!(copy.description().get(key::SECONDS), Some("1.5"));
    copy.take_back().unwrap();
    assert_eq!(copy.film(), &Film::new(5, 40, 2));
}

#[test]
fn a_guest_takes_its_rejected_samples_with_it() {
    let directory = tempfile::tempdir().unwrap();
    let mut sum = FilmSum::new(1, 1, 2, description(), Path::new("plan")).unwrap();
    for (name, range, rejected) in [("host.exr", 0..4, 1), ("guest.exr", 4..8, 2)] {
        let mut film = Film::new(1, 1, 2);
        film.record(range, rejected).unwrap();
        let path = directory.path().join(name);
        checkpoint::save(&path, &film, &description()).unwrap();
        sum.add(&path, same_recipe_text, |_| name == "guest.exr").unwrap();
    }
    assert_eq!(sum.film().rejected(), 3);
    sum.take_back().unwrap();
    assert_eq!(sum.film().rejected(), 1);
}

/// A sum that leaves one of them out would be too short.
#[test]
fn the_time_of_a_merged_film_is_unknown_if_that_of_one_film_is() {
    let directory = tempfile::tempdir().unwrap();
    let paths = ["known.exr", "unknown.exr"].map(|name| directory.path().join(name));
    checkpoint::save(&paths[0], &noisy_film(2, 2, 2, &[0..2]), &description()).unwrap();
    checkpoint::save(&paths[1], &noisy_film(2, 2, 2, &[2..4]), &Description::new(RECIPE)).unwrap();
    let mut sum = FilmSum::new(2, 2, 2, Description::new(RECIPE), Path::new("plan")).unwrap();
    sum.add(&paths[0], same_recipe_text, |_| false).unwrap();
    assert_eq!(sum.description().get(key::SECONDS), Some("1.5"));
    sum.add(&paths[1], same_recipe_text, |_| false).unwrap();
    assert_eq!(sum.description().get(key::SECONDS), None);
}

/// Each thread that reads the film has several of its 25 bands, and the last one is damaged.
#[test]
fn what_was_added_of_a_film_before_its_damage_is_taken_away_again() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    for (name, range) in [("a.exr", 0..2), ("b.exr", 2..4)] {
        checkpoint::save(&path(name), &noisy_film(3, 400, 2, &[range]), &description()).unwrap();
    }
    let whole = std::fs::read(path("b.exr")).unwrap();
    let mut bytes = whole.clone();
    bytes[whole.len() - 5] ^= 1;
    std::fs::write(path("b.exr"), bytes).unwrap();
    let mut sum = FilmSum::new(3, 400, 2, description(), Path::new("plan")).unwrap();
    sum.add(&path("a.exr"), same_recipe_text, |_| false).unwrap();
    let refused = sum.add(&path("b.exr"), same_recipe_text, |_| false).unwrap_err();
    assert!(matches!(refused, MergeError::File(CheckpointError::Damaged { .. })), "{refused}");
    assert!(sum.film() == &noisy_film(3, 400, 2, &[0..2]));
    std::fs::write(path("b.exr"), whole).unwrap();
    sum.add(&path("b.exr"), same_recipe_text, |_| false).unwrap();
    assert!(sum.film() == &noisy_film(3, 400, 2, &[0..4]));
}

#[test]
fn a_guest_of_the_last_version_leaves_to_the_bit_too() {
    let old = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/film/data/version-3.exr"));
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("host.exr");
    let guest = checkpoint::load(old).unwrap();
    let [width, height] = [guest.film.width(), guest.film.height()];
    let host = noisy_film(width, height, 2, &[10..13]);
    checkpoint::save(&path, &host, &guest.description).unwrap();
    let mut sum = FilmSum::new(width, height, 2, guest.description, Path::new("plan")).unwrap();
    sum.add(&path, same_recipe_text, |_| false).unwrap();
    sum.add(old, same_recipe_text, |_| true).unwrap();
    let mut both = host.clone();
    both.merge(&guest.film).unwrap();
    assert!(sum.film() == &both);
    sum.take_back().unwrap();
    assert!(sum.film() == &host);
}

#[test]
fn a_copy_of_a_sum_says_and_keeps_what_the_sum_has_and_an_emptied_sum_has_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.exr");
    let mut film = noisy_film(2, 2, 2, &[0..3]);
    film.record(3..4, 3).unwrap();
    let mut told = description();
    told.set(key::BACKEND, "cpu");
    checkpoint::save(&path, &film, &told).unwrap();
    let mut sum = FilmSum::new(2, 2, 2, Description::new(RECIPE), Path::new("plan")).unwrap();
    sum.add(&path, same_recipe_text, |_| true).unwrap();
    let mut copy = sum.try_copy().unwrap();
    for (name, value) in [(key::SAMPLES, "4"), (key::SECONDS, "1.5"), (key::BACKEND, "cpu")] {
        assert_eq!(copy.description().get(name), Some(value));
    }
    assert_eq!(copy.description(), sum.description());
    // What came with the copy is no guest there, but still one of the sum.
    copy.take_back().unwrap();
    assert!(copy.film() == &film);
    copy.clear();
    assert!(copy.film() == &Film::new(2, 2, 2), "{} rejected", copy.film().rejected());
    copy.add(&path, same_recipe_text, |_| false).unwrap();
    assert!(copy.film() == &film);
    sum.take_back().unwrap();
    assert!(sum.film() == &Film::new(2, 2, 2));
}

#[test]
fn films_of_other_shapes_are_told_with_both_shapes() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("other.exr");
    checkpoint::save(&path, &noisy_film(3, 5, 1, &[0..2]), &description()).unwrap();
    let mut sum = FilmSum::new(5, 3, 2, description(), Path::new("plan")).unwrap();
    let told = sum.add(&path, same_recipe_text, |_| false).unwrap_err().to_string();
    let shapes = "the films differ in shape: 5x3 with 2 halves and 3x5 with 1";
    assert_eq!(told, format!("plan and {} cannot be merged: {shapes}", path.display()));
    let told = Film::new(5, 3, 2).merge(&Film::new(3, 5, 1)).unwrap_err().to_string();
    assert_eq!(told, shapes);
}
