//! The description of a picture that is stored in its file.

use std::fmt::Display;

/// The program and its version, as files and messages name them.
pub const SOFTWARE: &str = concat!("Weekender ", env!("CARGO_PKG_VERSION"));

/// The key of the recipe in a picture file.
pub const RECIPE_KEY: &str = "Weekender recipe";

/// Keys that Weekender writes. Other keys are allowed.
pub mod key {
    pub const SOFTWARE: &str = "Software";
    pub const SCENE: &str = "Scene";
    pub const STAGE: &str = "Stage";
    pub const CAMERA: &str = "Camera";
    pub const SAMPLER: &str = "Sampler";
    pub const SEED: &str = "Seed";
    /// Samples per pixel.
    pub const SAMPLES: &str = "Samples";
    /// Seconds of tracing.
    pub const SECONDS: &str = "Seconds";
    pub const FRAME: &str = "Frame";
    /// When a frame was to end and what was to be made of it: see `--samples` and its neighbours.
    pub const UNTIL: &str = "Until";
    pub const COMMAND: &str = "Command";
    pub const BACKEND: &str = "Backend";
    /// That the picture is denoised, with its estimated error.
    pub const DENOISED: &str = "Denoised";
}

/// Longest key, bytes: PNG's limit.
const KEY_BYTES: usize = 79;

/// An ordered list of keys and values, and the recipe of the picture as TOML.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Description {
    recipe: String,
    entries: Vec<(String, String)>,
}

impl Description {
    /// A description that has only the recipe. Line ends become `\n`.
    pub fn new(recipe_toml: &str) -> Self {
        Description { recipe: recipe_toml.replace("\r\n", "\n").replace('\r', "\n"), entries: Vec::new() }
    }

    /// The recipe's TOML text.
    pub fn recipe(&self) -> &str {
        &self.recipe
    }

    /// Sets `key` to `value`: replaces the old value, or appends an entry.
    ///
    /// Every file format must be able to store the entry and return it unchanged. So in a key, each character that is
    /// not printable ASCII and each colon becomes `_`, and the key is cut to 79 bytes. In a value, control characters
    /// become spaces. Spaces at both ends are removed. An empty key is ignored.
    pub fn set(&mut self, key: &str, value: impl Display) {
        let key: String = key
            .trim()
            .chars()
            .map(|c| if (c.is_ascii_graphic() && c != ':') || c == ' ' { c } else { '_' })
            .take(KEY_BYTES)
            .collect();
        let key = key.trim_end().to_owned();
        let value = value.to_string().replace(|c: char| c.is_control(), " ").trim().to_owned();
        if key.is_empty() || key == RECIPE_KEY {
            return;
        }
        match self.entries.iter_mut().find(|(known, _)| *known == key) {
            Some((_, old)) => *old = value,
            None => self.entries.push((key, value)),
        }
    }

    pub fn get(&self, key: &str) -> Option<&str> {
        self.entries.iter().find(|(known, _)| known == key).map(|(_, value)| value.as_str())
    }

    /// Keys and values in order, without the recipe.
    pub fn entries(&self) -> impl Iterator<Item = (&str, &str)> {
        self.entries.iter().map(|(key, value)| (key.as_str(), value.as_str()))
    }

    /// Keys and values as lines `key: value`.
    pub fn lines(&self) -> impl Iterator<Item = String> + '_ {
        self.entries.iter().map(|(key, value)| format!("{key}: {value}"))
    }

    /// Removes an entry, if there is one.
    pub fn remove(&mut self, key: &str) {
        self.entries.retain(|(known, _)| known != key);
    }

    /// Parses a line of [`Description::lines`]; other lines are ignored.
    pub fn set_line(&mut self, line: &str) {
        if let Some((key, value)) = line.split_once(':') {
            self.set(key, value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn unstorable_entries_are_changed_or_ignored() {
        let mut description = Description::new("a\r\nb\rc\n");
        description.set("", "x");
        description.set(RECIPE_KEY, "x");
        assert_eq!(description.entries().count(), 0);
        assert_eq!(description.recipe(), "a\nb\nc\n");
        description.set(&"k".repeat(100), "two\nlines");
        assert_eq!(description.entries().next(), Some(("k".repeat(79).as_str(), "two lines")));
        description.set(" Ort: Köln 1 ", " a: b ü ");
        assert_eq!(description.entries().nth(1), Some(("Ort_ K_ln 1", "a: b ü")));
    }

    proptest! {
        #[test]
        fn lines_are_read_back(pairs in prop::collection::vec((".{0,90}", ".{0,40}"), 0..6)) {
            let mut written = Description::new("r");
            for (key, value) in &pairs {
                written.set(key, value);
            }
            let mut read = Description::new("r");
            for line in written.lines() {
                prop_assert!(!line.contains(['\n', '\r', '\0']));
                read.set_line(&line);
            }
            prop_assert_eq!(read, written);
        }
    }
}
