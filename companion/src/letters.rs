//! The letters of formulas: each has one meaning in a chapter, and no other in the next.

use crate::chapter::Chapter;
use crate::library::Fault;
use std::collections::BTreeMap;

/// Lists the letters.
pub const FILE: &str = "docs/companion/letters.toml";

/// Commands with text inside, and letters of the Greek alphabet. π is always the number.
const TEXTS: [&str; 5] = ["text", "mathrm", "operatorname", "begin", "end"];
const GREEK: [(&str, char); 10] = [
    ("alpha", 'α'),
    ("beta", 'β'),
    ("eta", 'η'),
    ("theta", 'θ'),
    ("xi", 'ξ'),
    ("rho", 'ρ'),
    ("sigma", 'σ'),
    ("tau", 'τ'),
    ("omega", 'ω'),
    ("Omega", 'Ω'),
];

/// The meanings of letters by chapter; those of `common` hold in all.
pub type Letters = BTreeMap<String, BTreeMap<String, String>>;

/// Finds a letter with another meaning than in the chapter before or in `common`.
pub fn check(letters: &Letters, chapters: &[Chapter]) -> Result<(), Fault> {
    let of = |chapter: &str| letters.get(chapter).into_iter().flatten();
    for (place, chapter) in chapters.iter().enumerate() {
        let before = place.checked_sub(1).map_or("common", |before| &chapters[before].id);
        for (letter, meaning) in of(&chapter.id) {
            let mut known = of("common").chain(of(before));
            if let Some((_, other)) = known.find(|(known, other)| *known == letter && *other != meaning) {
                let message = format!(
                    "{letter} is {meaning:?} in the chapter {} and {other:?} before it; choose another letter",
                    chapter.id
                );
                return Err(Fault::new(FILE, 0, message));
            }
        }
    }
    Ok(())
}

/// The first letter of a formula without a meaning in a chapter.
pub fn unknown(letters: &Letters, chapter: &str, formula: &str) -> Option<String> {
    let is_known = |letter: &String| {
        ["common", chapter]
            .iter()
            .any(|name| letters.get(*name).is_some_and(|known| known.contains_key(letter)))
    };
    self::letters(formula).find(|letter| !is_known(letter))
}

/// The letters of a formula without those in indices: bold ones as the page shows them.
fn letters(formula: &str) -> impl Iterator<Item = String> {
    let mut found = Vec::new();
    let mut rest = formula;
    while let Some(c) = rest.chars().next() {
        rest = &rest[c.len_utf8()..];
        // The braces after a command or an index, or the one sign there.
        let argument = |rest: &mut &str| -> String {
            let end = if rest.starts_with('{') {
                rest.find('}').map_or(rest.len(), |end| end + 1)
            } else {
                rest.chars().next().map_or(0, char::len_utf8)
            };
            let (inside, after) = rest.split_at(end);
            *rest = after;
            inside.trim_matches(['{', '}']).to_owned()
        };
        if c == '_' {
            match rest.strip_prefix('\\') {
                Some(command) => rest = command.trim_start_matches(|c: char| c.is_ascii_alphabetic()),
                None => drop(argument(&mut rest)),
            }
        } else if c == '\\' {
            let end = rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len());
            let (command, after) = rest.split_at(end);
            rest = after;
            if command == "mathbf" {
                let bold = |c: char| {
                    char::from_u32(
                        if c.is_ascii_lowercase() { 0x1D41A - 97 } else { 0x1D400 - 65 } + c as u32,
                    )
                };
                found.extend(argument(&mut rest).chars().filter(char::is_ascii_alphabetic).filter_map(bold));
            } else if TEXTS.contains(&command) {
                argument(&mut rest);
            }
            found.extend(GREEK.iter().filter(|(name, _)| *name == command).map(|(_, letter)| *letter));
        } else if c.is_ascii_alphabetic() {
            found.push(c);
        }
    }
    found.into_iter().map(String::from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library::Library;

    #[test]
    fn letters_of_formulas() {
        for (formula, expected) in [
            (r"t\mathbf{d} - \mathbf{C}_x", "t𝐝𝐂"),
            (r"\mathrm{d}\omega \cos\theta_t", "ωθ"),
            (r"s_x\,u_{ab}^n\int_\Omega", "sun"),
            (r"\lfloor 256 \min(v, 0.999) \rfloor", "v"),
        ] {
            assert_eq!(letters(formula).collect::<String>(), expected, "{formula}");
        }
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
            let fault = check(&letters, &chapters).unwrap_err().to_string();
            assert!(fault.contains(&format!("{letter} is {meaning:?} in the chapter sphere")), "{fault}");
        }
        assert_eq!(unknown(&read(), "sphere", r"\mathbf{d} k"), None);
        assert_eq!(unknown(&read(), "rays", r"\mathbf{d} k").as_deref(), Some("k"));
    }
}
