//! Words of a command as a shell takes them.

use std::borrow::Cow;

/// Which quotes a command gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shell {
    /// `sh`, for scripts everywhere.
    Posix,
    /// Both cmd and PowerShell.
    Windows,
}

impl Shell {
    /// What people type into on this system.
    pub const HERE: Shell = if cfg!(windows) { Shell::Windows } else { Shell::Posix };

    /// Quotes a word if necessary.
    pub fn quoted(self, word: &str) -> Cow<'_, str> {
        // A comma makes a list in PowerShell. shlex would quote one, but vectors such as `1,2,3` are easier to read bare.
        let special = match self {
            Shell::Posix => "-_./:,+=",
            Shell::Windows => "-_./:\\+=",
        };
        if !word.is_empty() && word.chars().all(|c| c.is_ascii_alphanumeric() || special.contains(c)) {
            return Cow::Borrowed(word);
        }
        match self {
            // Fails only for NUL, which no argument can hold.
            Shell::Posix => shlex::try_quote(word).unwrap_or(Cow::Borrowed(word)),
            Shell::Windows => {
                // A backslash before a quote would take its meaning.
                let end = &word[word.trim_end_matches('\\').len()..];
                Cow::Owned(format!("\"{}{end}\"", word.replace('"', "\\\"")))
            }
        }
    }

    /// Joins words into a command line.
    pub fn line<W: AsRef<str>>(self, words: impl IntoIterator<Item = W>) -> String {
        words.into_iter().map(|word| self.quoted(word.as_ref()).into_owned()).collect::<Vec<_>>().join(" ")
    }
}

/// A path that no program takes for a flag: `./` comes before a leading dash.
pub fn operand(path: &str) -> Cow<'_, str> {
    if path.starts_with('-') { Cow::Owned(format!("./{path}")) } else { Cow::Borrowed(path) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quoted_words_survive_a_shell() {
        let words = ["weekender", "--size=8x4", "a b", "it's", "$HOME", "", "back\\slash", "ö*?", "-1,2,3"];
        let line = Shell::Posix.line(words);
        assert_eq!(shlex::split(&line).unwrap(), words);
        assert!(line.starts_with("weekender --size=8x4 ") && line.ends_with(" -1,2,3"), "{line}");
    }

    #[test]
    fn windows_gets_double_quotes() {
        for (word, quoted) in [
            ("C:\\films\\a.exr", "C:\\films\\a.exr"),
            ("--size=8x4", "--size=8x4"),
            ("Köln und Umgebung\\", "\"Köln und Umgebung\\\\\""),
            ("1,2,3", "\"1,2,3\""),
            ("it's", "\"it's\""),
            ("", "\"\""),
            ("a\"b", "\"a\\\"b\""),
        ] {
            assert_eq!(Shell::Windows.quoted(word), quoted);
        }
    }

    #[test]
    fn a_path_is_no_flag() {
        for (path, word) in [("-d", "./-d"), ("--", "./--"), ("a-b", "a-b"), ("./-d", "./-d"), ("", "")] {
            assert_eq!(operand(path), word);
        }
    }
}
