//! Words of a command as a shell takes them.

use std::borrow::Cow;

/// Quotes a word if necessary. Vectors such as `1,2,3` stay bare, though shlex would quote their commas.
pub fn quoted(word: &str) -> Cow<'_, str> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./:,+=".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return Cow::Borrowed(word);
    }
    // Fails only for NUL, which no argument can hold.
    shlex::try_quote(word).unwrap_or(Cow::Borrowed(word))
}

/// A path that no program takes for a flag: `./` comes before a leading dash.
pub fn operand(path: &str) -> Cow<'_, str> {
    if path.starts_with('-') { Cow::Owned(format!("./{path}")) } else { Cow::Borrowed(path) }
}

/// Joins words into a command line.
pub fn line<W: AsRef<str>>(words: impl IntoIterator<Item = W>) -> String {
    words.into_iter().map(|word| quoted(word.as_ref()).into_owned()).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quoted_words_survive_a_shell() {
        let words = ["weekender", "--size=8x4", "a b", "it's", "$HOME", "", "back\\slash", "ö*?", "-1,2,3"];
        let line = line(words);
        assert_eq!(shlex::split(&line).unwrap(), words);
        assert!(line.starts_with("weekender --size=8x4 ") && line.ends_with(" -1,2,3"), "{line}");
    }

    #[test]
    fn a_path_is_no_flag() {
        for (path, word) in [("-d", "./-d"), ("--", "./--"), ("a-b", "a-b"), ("./-d", "./-d"), ("", "")] {
            assert_eq!(operand(path), word);
        }
    }
}
