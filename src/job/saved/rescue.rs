//! Rescues samples whose file cannot be written by saving them wherever there is room.

use crate::film::{Description, Film, checkpoint, key};
use crate::job::recipe::plain_name;
use crate::system::files::{ShownPath, home_directory, state_directory, sync_directory, temporary_directory};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Longest part of the picture's name in the file name, characters.
const NAME_LENGTH: usize = 60;

/// Saves the film at the first place that works, and returns its path: the directories `first`,
/// then those for temporary files, for the state of programs, and the home directory.
///
/// # Errors
/// The loss, and why each place failed.
pub fn rescue(first: &[PathBuf], film: &Film, description: &Description) -> Result<PathBuf, String> {
    let state = state_directory();
    // If this fails, writing the file will report it.
    let _ = state.as_ref().map(std::fs::create_dir_all);
    let others = [Some(temporary_directory()), state, home_directory()];
    let places: Vec<PathBuf> = first.iter().cloned().chain(others.into_iter().flatten()).collect();
    keep_in(&places, film, description)
}

fn keep_in(places: &[PathBuf], film: &Film, description: &Description) -> Result<PathBuf, String> {
    let name = plain_name(description.get(key::SCENE).unwrap_or("film"));
    let name: String = name.chars().take(NAME_LENGTH).collect();
    let save_in = |directory: &Path| -> io::Result<PathBuf> {
        let prefix = format!("weekender-{name}-");
        let file = tempfile::Builder::new().prefix(&prefix).suffix(".exr").tempfile_in(directory)?;
        let mut writer = BufWriter::new(file.as_file());
        checkpoint::write(film, None, description, &mut writer)?;
        writer.flush()?;
        drop(writer);
        file.as_file().sync_data()?;
        let path = file.into_temp_path().keep()?;
        sync_directory(directory)?;
        Ok(path)
    };
    let mut reasons = Vec::new();
    for place in places {
        match save_in(place) {
            Ok(path) => return Ok(path),
            Err(error) => reasons.push(format!("{} ({error})", place.shown())),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_working_place_is_used_or_the_loss_is_reported() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        std::fs::write(at("file"), "").unwrap();
        std::fs::create_dir_all(at("made/deep")).unwrap();
        let mut film = Film::new(4, 3);
        film.record(0..6, 0).unwrap();
        let mut description = Description::new("r");
        description.set(key::SECONDS, 7.2);
        description.set(key::SCENE, "a/b");
        let keep = |places: &[PathBuf]| keep_in(places, &film, &description);

        let path = keep(&[at("file"), at("made/deep"), at("unused")]).unwrap();
        assert_eq!(path.parent(), Some(at("made/deep").as_path()));
        assert!(checkpoint::load(&path).unwrap().film == film);
        assert!(!at("unused").exists());
        let second = keep(&[at("made/deep")]).unwrap();
        assert!(second != path && second.exists() && path.exists());
        // A picture's name can be longer than any file name.
        let mut long = description.clone();
        long.set(key::SCENE, "long".repeat(200));
        assert!(keep_in(&[at("made")], &film, &long).unwrap().exists());

        let lost = keep(&[at("file"), at("file/x")]).unwrap_err();
        for part in ["lost", "6 per pixel", "7 s", "file/x"] {
            assert!(lost.contains(part), "{lost} should say {part}");
        }
    }
}
