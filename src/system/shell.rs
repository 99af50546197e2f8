//! Quotes the words of a command for a shell.

use std::borrow::Cow;
use std::ffi::OsStr;

/// Quotes a word if necessary: for `sh`, or for both cmd and PowerShell.
pub fn quoted(word: &str) -> Cow<'_, str> {
    quoted_for(cfg!(windows), word)
}

fn quoted_for(is_windows: bool, word: &str) -> Cow<'_, str> {
    // A comma makes a list in PowerShell. shlex would quote one, but vectors such as `1,2,3` are easier to read bare.
    let special = if is_windows { "-_./:\\+=" } else { "-_./:,+=" };
    if !word.is_empty() && word.chars().all(|c| c.is_ascii_alphanumeric() || special.contains(c)) {
        return Cow::Borrowed(word);
    }
    if is_windows {
        // A backslash before a quote would escape it.
        let end = &word[word.trim_end_matches('\\').len()..];
        return Cow::Owned(format!("\"{}{end}\"", word.replace('"', "\\\"")));
    }
    // Fails only for NUL, which no argument can hold.
    shlex::try_quote(word).unwrap_or(Cow::Borrowed(word))
}

/// Joins words into a command line.
pub fn line<W: AsRef<OsStr>>(words: impl IntoIterator<Item = W>) -> String {
    let text = |word: W| {
        word.as_ref().to_str().map_or_else(|| with_bytes(word.as_ref()), |word| quoted(word).into_owned())
    };
    words.into_iter().map(text).collect::<Vec<_>>().join(" ")
}

/// A word that is not UTF-8, in the quotes of bash and zsh that can hold any byte.
fn with_bytes(word: &OsStr) -> String {
    #[cfg(unix)]
    return format!("$'{}'", std::os::unix::ffi::OsStrExt::as_bytes(word).escape_ascii());
    // No Windows shell can express such a word.
    #[cfg(not(unix))]
    quoted(&word.to_string_lossy()).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quoted_words_survive_a_shell() {
        let words = ["weekender", "--size=8x4", "a b", "it's", "$HOME", "", "back\\slash", "ö*?", "-1,2,3"];
        let line = words.map(|word| quoted_for(false, word)).join(" ");
        assert_eq!(shlex::split(&line).unwrap(), words);
        assert!(line.starts_with("weekender --size=8x4 ") && line.ends_with(" -1,2,3"), "{line}");
    }

    #[cfg(unix)]
    #[test]
    fn bytes_that_are_not_utf_8_survive_bash() {
        use std::os::unix::ffi::OsStrExt;
        let word = OsStr::from_bytes(b"K\xf6ln it's\\a.exr");
        let line = line([OsStr::new("printf"), OsStr::new("%s"), word]);
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
            assert_eq!(quoted_for(true, word), quoted);
        }
    }
}
