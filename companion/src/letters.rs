//! The letters of formulas: each has one meaning in a chapter, and no other in the next.

use std::collections::BTreeMap;

/// Lists the letters.
pub const FILE: &str = "docs/companion/letters.toml";

/// The meanings of letters by chapter; those of `common` hold in all.
pub type Letters = BTreeMap<String, BTreeMap<String, String>>;

/// The first letter of a formula, given as MathML, without a meaning in a chapter. Upright letters are words.
pub fn unknown<'a>(letters: &Letters, chapter: &str, mathml: &'a str) -> Option<&'a str> {
    let is_known = |letter: &str| {
        let mut known = ["common", chapter].into_iter().filter_map(|name| letters.get(name));
        known.any(|known| known.contains_key(letter))
    };
    let names = mathml.split("<mi>").skip(1).filter_map(|rest| rest.split("</mi>").next());
    let is_letter = |name: &&str| name.chars().count() == 1 && name.chars().all(char::is_alphabetic);
    names.filter(is_letter).find(|letter| !is_known(letter))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chapter::Chapter;
    use crate::library::Library;

    /// Finds a letter with another meaning than in the chapter before or in `common`.
    fn check(letters: &Letters, chapters: &[Chapter]) -> Result<(), String> {
        let of = |chapter: &str| letters.get(chapter).into_iter().flatten();
        for (place, chapter) in chapters.iter().enumerate() {
            let before = place.checked_sub(1).map_or("common", |before| &chapters[before].id);
            for (letter, meaning) in of(&chapter.id) {
                let mut known = of("common").chain(of(before));
                if let Some((_, other)) = known.find(|(known, other)| *known == letter && *other != meaning) {
                    return Err(format!(
                        "{letter} is {meaning:?} in the chapter {} and {other:?} before it",
                        chapter.id
                    ));
                }
            }
        }
        Ok(())
    }

    #[test]
    fn contradictions_are_found() {
        let library = Library::of_checkout();
        let chapters = Chapter::read_all(&library).unwrap();
        let read = || library.toml::<Letters>(FILE).unwrap();
        check(&read(), &chapters).unwrap();
        for (letter, meaning) in [("s", "half the chord"), ("r", "a ratio")] {
            let mut letters = read();
            letters.get_mut("sphere").unwrap().insert(letter.to_owned(), meaning.to_owned());
            let fault = check(&letters, &chapters).unwrap_err();
            assert!(fault.contains(&format!("{letter} is {meaning:?} in the chapter sphere")), "{fault}");
        }
        let formula = "<mi>𝐝</mi><mi>cos</mi><mi mathvariant=\"normal\">d</mi><mi>k</mi>";
        assert_eq!(unknown(&read(), "sphere", formula), None);
        assert_eq!(unknown(&read(), "rays", formula), Some("k"));
    }
}
