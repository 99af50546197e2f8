//! Small changes of plain text.

/// A text with the apostrophes of print.
pub fn typographic(text: &str) -> String {
    text.replace('\'', "’")
}

/// Words as an anchor: `What a lane is` becomes `what-a-lane-is`.
pub fn slug(words: &str) -> String {
    let mut slug = String::new();
    for c in words.chars().filter(|c| !matches!(c, '\'' | '’' | '.')) {
        match c.to_lowercase().next() {
            Some(c) if c.is_ascii_alphanumeric() => slug.push(c),
            _ if slug.ends_with('-') || slug.is_empty() => {}
            _ => slug.push('-'),
        }
    }
    slug.trim_end_matches('-').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn anchors_are_plain() {
        for (words, anchor) in [
            ("What a lane is", "what-a-lane-is"),
            ("6.1 Snell's Law", "61-snells-law"),
            (" 1/(MSE s), äh ", "1-mse-s-h"),
        ] {
            assert_eq!(slug(words), anchor);
        }
        assert_eq!(typographic("Snell's"), "Snell’s");
    }
}
