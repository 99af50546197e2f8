//! Rescues samples whose file cannot be written, by saving them wherever there is room.

use crate::files::{self, ShownPath, home_directory, state_directory};
use crate::film::{Description, Film, checkpoint, key};
use crate::recipe::plain_name;
use std::env;
use std::path::{Path, PathBuf};

/// Most characters of the picture's name in the name of the file.
const NAME_LENGTH: usize = 60;

/// Saves the film of the picture `name` at the first place that works, and returns its path: the directories `first`,
/// then those for temporary files, for the state of programs, and the home directory.
///
/// # Errors
/// What is lost, and why each place failed.
pub fn rescue(
    first: &[PathBuf],
    name: &str,
    film: &Film,
    description: &Description,
) -> Result<PathBuf, String> {
    if let Some(state) = state_directory() {
        // If it cannot be created, writing the file will say so.
        let _ = std::fs::create_dir_all(state);
    }
    keep_in(&places(first), name, film, description)
}

fn keep_in(
    places: &[PathBuf],
    name: &str,
    film: &Film,
    description: &Description,
) -> Result<PathBuf, String> {
    let mut reasons = Vec::new();
    for place in places {
        let Some(path) = free_name(place, name) else {
            reasons.push(format!("{} (no free name)", place.shown()));
            continue;
        };
        match checkpoint::save(&path, film, description) {
            Ok(()) => return Ok(path),
            Err(error) => reasons.push(format!("{} ({})", place.shown(), error.reason)),
        }
    }
    let seconds = description.get(key::SECONDS).and_then(|seconds| seconds.parse::<f64>().ok());
    let seconds = seconds.map_or_else(String::new, |seconds| format!(", {seconds:.0} s of tracing"));
    Err(format!(
        "the samples are lost ({} per pixel{seconds}); saving them elsewhere failed, too: {}",
        film.sample_count(),
        reasons.join(", ")
    ))
}

fn places(first: &[PathBuf]) -> Vec<PathBuf> {
    let others = [Some(env::temp_dir()), state_directory(), home_directory()];
    let mut places: Vec<PathBuf> = Vec::new();
    for place in first.iter().cloned().chain(others.into_iter().flatten()) {
        if !places.contains(&place) {
            places.push(place);
        }
    }
    places
}

fn free_name(directory: &Path, picture: &str) -> Option<PathBuf> {
    let picture: String = plain_name(picture).chars().take(NAME_LENGTH).collect();
    let process = std::process::id();
    files::free_name(|number| {
        directory.join(match number {
            1 => format!("weekender-{picture}-{process}.exr"),
            number => format!("weekender-{picture}-{process}-{number}.exr"),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::NAME_LIMIT;

    #[test]
    fn the_first_place_that_takes_it_has_it_and_else_it_is_said_what_is_lost() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        std::fs::write(at("file"), "").unwrap();
        std::fs::create_dir_all(at("made/deep")).unwrap();
        let mut film = Film::new(4, 3, 2);
        film.record(0..6, 0).unwrap();
        let mut description = Description::new("r");
        description.set(key::SECONDS, 7.2);
        let keep = |places: &[PathBuf]| keep_in(places, "a/b", &film, &description);

        let path = keep(&[at("file"), at("made/deep"), at("unused")]).unwrap();
        assert_eq!(path.parent(), Some(at("made/deep").as_path()));
        assert!(checkpoint::load(&path).unwrap().film == film);
        assert!(!at("unused").exists());
        let second = keep(&[at("made/deep")]).unwrap();
        assert!(second != path && second.exists() && path.exists());
        // No file system has names as long as a picture's name may be.
        assert!(keep_in(&[at("made")], &"long".repeat(200), &film, &description).unwrap().exists());

        let lost = keep(&[at("file"), at("file/x")]).unwrap_err();
        for part in ["lost", "6 per pixel", "7 s", "file/x"] {
            assert!(lost.contains(part), "{lost} should say {part}");
        }
    }

    #[test]
    fn the_given_places_come_first_and_each_once() {
        let [first, second] = [PathBuf::from("x"), env::temp_dir()];
        let places = places(&[first.clone(), second.clone(), first.clone()]);
        assert_eq!(places[..2], [first, second.clone()]);
        assert_eq!(places.iter().filter(|place| **place == second).count(), 1, "{places:?}");
    }

    #[test]
    fn a_place_without_a_free_name_is_passed_over() {
        let directory = tempfile::tempdir().unwrap();
        let [full, free] = ["full", "free"].map(|name| directory.path().join(name));
        for place in [&full, &free] {
            std::fs::create_dir(place).unwrap();
        }
        let process = std::process::id();
        std::fs::write(full.join(format!("weekender-a-{process}.exr")), "").unwrap();
        for number in 2..=NAME_LIMIT {
            std::fs::write(full.join(format!("weekender-a-{process}-{number}.exr")), "").unwrap();
        }
        let (mut film, description) = (Film::new(4, 3, 2), Description::new("r"));
        film.record(0..6, 0).unwrap();
        let kept = keep_in(&[full.clone(), free.clone()], "a", &film, &description).unwrap();
        assert_eq!(kept.parent(), Some(free.as_path()));
        let lost = keep_in(std::slice::from_ref(&full), "a", &film, &description).unwrap_err();
        assert!(lost.ends_with(&format!("failed, too: {} (no free name)", full.display())), "{lost}");
        assert!(lost.starts_with("the samples are lost (6 per pixel); saving them elsewhere"), "{lost}");
    }
}
