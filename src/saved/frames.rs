//! Tells whether the file of a frame is there and right.

use super::difference::same_job;
use crate::film::{Description, key};
use crate::output::{check_frame, read_description};
use crate::recipe::{Recipe, file};
use std::path::Path;

/// What is there of a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FrameState {
    /// The whole picture.
    Whole,
    /// No file.
    Missing,
    /// A file that is damaged, of another picture, or from another version of the program: why, in words.
    Wrong(String),
}

impl FrameState {
    /// What is there of the frame that `recipe` describes. `software` is the program and its version.
    pub fn of(path: &Path, recipe: &Recipe, software: &str) -> FrameState {
        if path.symlink_metadata().is_err() {
            return FrameState::Missing;
        }
        let settings = &recipe.settings;
        let found = match read_description(path) {
            Ok(found) => found,
            Err(error) => return FrameState::Wrong(error.to_string()),
        };
        let wanted = Description::new(&file::to_picture_toml(recipe));
        let samples = recipe.samples_per_pixel.to_string();
        let is_of = |value: &str| format!("{} is {value}", path.display());
        if found.recipe() != wanted.recipe() {
            let difference = same_job(wanted.recipe(), found.recipe()).err();
            let difference = difference.map_or_else(String::new, |words| format!(": {words}"));
            return FrameState::Wrong(is_of(&format!("of another picture{difference}")));
        }
        if found.get(key::SAMPLES) != Some(&samples) {
            let theirs = found.get(key::SAMPLES).unwrap_or("no");
            return FrameState::Wrong(is_of(&format!("of {theirs} samples per pixel, not {samples}")));
        }
        if found.get(key::SOFTWARE) != Some(software) {
            let theirs = found.get(key::SOFTWARE).unwrap_or("another program");
            return FrameState::Wrong(is_of(&format!("from {theirs}, not {software}")));
        }
        match check_frame(path, [settings.width, settings.height]) {
            Ok(()) => FrameState::Whole,
            Err(error) => FrameState::Wrong(error.to_string()),
        }
    }
}
