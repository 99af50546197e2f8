//! The letters of formulas: each has one meaning in a chapter, and no other in the next.

use crate::chapter::Chapter;
use crate::library::{Fault, line_of};
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

/// Finds a letter without a meaning, and one with another meaning than in the chapter before or in `common`.
pub fn check(letters: &Letters, chapters: &[Chapter]) -> Result<(), Fault> {
    let none = BTreeMap::new();
    let of = |chapter: &str| letters.get(chapter).unwrap_or(&none);
    let (common, mut before) = (of("common"), &none);
    for chapter in chapters {
        let own = of(&chapter.id);
        let clash = own.iter().find_map(|(letter, meaning)| {
            let known = [common, before].into_iter().filter_map(|known| known.get(letter));
            known.into_iter().find(|other| *other != meaning).map(|other| (letter, meaning, other))
        });
        if let Some((letter, meaning, other)) = clash {
            let message = format!(
                "{letter} is {meaning:?} in the chapter {} and {other:?} before it; choose another letter",
                chapter.id
            );
            return Err(Fault::new(FILE, 0, message));
        }
        for (place, formula) in formulas(&chapter.body) {
            let is_unknown = |letter: &String| !own.contains_key(letter) && !common.contains_key(letter);
            if let Some(letter) = self::letters(formula).find(is_unknown) {
                let line = chapter.lines_before + line_of(&chapter.body, place);
                return Err(Fault::new(
                    &chapter.file,
                    line,
                    format!("{letter} has no meaning in {FILE}; add it"),
                ));
            }
        }
        before = own;
    }
    Ok(())
}

/// The formulas of a text with their positions; code has none.
fn formulas(text: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    let (mut at, mut is_code) = (0, false);
    for line in text.split("\n\n") {
        is_code |= line.starts_with("```");
        if !is_code {
            let mut place = at;
            for (number, part) in line.split('$').enumerate() {
                if number % 2 == 1 || (line.starts_with("$$") && number % 4 == 2) {
                    found.push((place, part));
                }
                place += part.len() + 1;
            }
        }
        is_code &= !line.ends_with("```");
        at += line.len() + 2;
    }
    found
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
        let mut letters = read();
        letters.get_mut("sphere").unwrap().remove("k");
        let fault = check(&letters, &chapters).unwrap_err().to_string();
        assert!(fault.contains("05-sphere.md:") && fault.contains("k has no meaning"), "{fault}");
    }
}
