//! Quotes the words of a command for a shell.

use std::borrow::Cow;
use std::ffi::OsStr;

/// Which quotes a command gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shell {
    /// `sh`, for scripts everywhere.
    Posix,
    /// Both cmd and PowerShell.
    Windows,
}

impl Shell {
    /// The shell of this system.
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
                // A backslash before a quote would escape it.
                let end = &word[word.trim_end_matches('\\').len()..];
                Cow::Owned(format!("\"{}{end}\"", word.replace('"', "\\\"")))
            }
        }
    }

    /// Joins words into a command line.
    pub fn line<W: AsRef<OsStr>>(self, words: impl IntoIterator<Item = W>) -> String {
        let quoted = |word: &OsStr| match word.to_str() {
            Some(word) => self.quoted(word).into_owned(),
            None => with_bytes(word),
        };
        words.into_iter().map(|word| quoted(word.as_ref())).collect::<Vec<_>>().join(" ")
    }
}

/// A word that is not UTF-8, in the quotes of bash and zsh that can hold any byte.
#[cfg(unix)]
fn with_bytes(word: &OsStr) -> String {
    use std::os::unix::ffi::OsStrExt;
    format!("$'{}'", word.as_bytes().escape_ascii())
}

/// No Windows shell can express such a word.
#[cfg(not(unix))]
fn with_bytes(word: &OsStr) -> String {
    Shell::HERE.quoted(&word.to_string_lossy()).into_owned()
}

/// A path that no program mistakes for a flag: `./` precedes a leading dash.
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

    #[cfg(unix)]
    #[test]
    fn bytes_that_are_not_utf_8_survive_bash() {
        use std::os::unix::ffi::OsStrExt;
        let word = OsStr::from_bytes(b"K\xf6ln it's\\a.exr");
        let line = Shell::Posix.line([OsStr::new("printf"), OsStr::new("%s"), word]);
        match std::process::Command::new("bash").args(["-c", &line]).output() {
            Ok(output) => assert_eq!(output.stdout, word.as_bytes(), "{line}"),
            Err(error) => crate::system::console::note(&format!("bash was not run: {error}")),
        }
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
    fn paths_are_not_flags() {
        for (path, word) in [("-d", "./-d"), ("--", "./--"), ("a-b", "a-b"), ("./-d", "./-d"), ("", "")] {
            assert_eq!(operand(path), word);
        }
    }
}
