//! What a picture says about itself.

use std::fmt::Display;

/// The name under which a picture's recipe stands in a file.
pub const RECIPE_KEY: &str = "Weekender recipe";

/// Keys that Weekender writes; others may stand beside them.
pub mod key {
    /// Program and version.
    pub const SOFTWARE: &str = "Software";
    /// The scene's name.
    pub const SCENE: &str = "Scene";
    /// The stage's id.
    pub const STAGE: &str = "Stage";
    /// Where the camera stands and how it looks.
    pub const CAMERA: &str = "Camera";
    /// The sampler's name.
    pub const SAMPLER: &str = "Sampler";
    /// The seed.
    pub const SEED: &str = "Seed";
    /// Samples per pixel.
    pub const SAMPLES: &str = "Samples";
    /// Seconds of tracing.
    pub const SECONDS: &str = "Seconds";
    /// What rendered it.
    pub const BACKEND: &str = "Backend";
}

/// Longest key, bytes: PNG's limit.
const KEY_BYTES: usize = 79;

/// A list of keys and values in order, and the recipe that the picture was made from, as TOML.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Description {
    recipe: String,
    entries: Vec<(String, String)>,
}

impl Description {
    /// A description that says nothing but the recipe. Line ends become `\n`.
    pub fn new(recipe_toml: &str) -> Self {
        Description { recipe: recipe_toml.replace("\r\n", "\n").replace('\r', "\n"), entries: Vec::new() }
    }

    /// The recipe's TOML text.
    pub fn recipe(&self) -> &str {
        &self.recipe
    }

    /// Says `key: value`, in place of what was said under that key, else at the end.
    ///
    /// Every kind of file must be able to hold it and give it back. So in a key, whatever is not printable
    /// ASCII and each colon becomes `_`, and 79 bytes are kept; in a value, control characters become spaces;
    /// both lose the spaces around them. An empty key is not taken.
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

    /// What is said under `key`.
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

    /// Reads a line of [`Description::lines`]; any other is left out.
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
    fn a_key_said_again_keeps_its_place() {
        let mut description = Description::new("");
        description.set(key::SAMPLES, 1);
        description.set(key::SEED, 7);
        description.set(key::SAMPLES, 2);
        assert_eq!(description.entries().collect::<Vec<_>>(), [("Samples", "2"), ("Seed", "7")]);
        assert_eq!(description.get(key::SEED), Some("7"));
        assert_eq!(description.get(key::SCENE), None);
    }

    #[test]
    fn what_no_file_can_hold_is_not_taken() {
        let mut description = Description::new("a\r\nb\rc\n");
        description.set("", "x");
        description.set(RECIPE_KEY, "x");
        assert_eq!(description.entries().count(), 0);
        assert_eq!(description.recipe(), "a\nb\nc\n");
        description.set(&"k".repeat(100), "two\nlines");
        assert_eq!(description.entries().next(), Some(("k".repeat(79).as_str(), "two lines")));
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
