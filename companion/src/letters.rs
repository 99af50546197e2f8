//! The letters of formulas: each has its meaning in a chapter's facts, and no other in the next chapter.

use crate::chapter::Chapter;
use crate::library::{Fault, line_of};
use std::collections::BTreeMap;

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

/// Finds a letter without a meaning, and one whose meaning differs from that in the chapter before or in the first one.
pub fn check(chapters: &[Chapter]) -> Result<(), Fault> {
    let none = BTreeMap::new();
    let common = chapters.first().map_or(&none, |chapter| &chapter.facts.letters);
    let mut before = common;
    for chapter in chapters {
        let own = &chapter.facts.letters;
        for (letter, meaning) in own {
            let others = [common, before].into_iter().filter_map(|known| known.get(letter));
            if let Some(other) = others.into_iter().find(|other| *other != meaning) {
                let message = format!(
                    "{letter} is {meaning:?} here and {other:?} in a chapter before; choose another letter"
                );
                return Err(Fault::new(&chapter.file, 1, message));
            }
        }
        for (place, formula) in formulas(&chapter.body) {
            if let Some(letter) =
                letters(formula).find(|letter| ![own, common].iter().any(|known| known.contains_key(letter)))
            {
                let line = chapter.lines_before + line_of(&chapter.body, place);
                let message = format!("{letter} has no meaning; add it to the chapter's table `letters`");
                return Err(Fault::new(&chapter.file, line, message));
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
        let chapters = || Chapter::read_all(&Library::of_checkout()).unwrap();
        check(&chapters()).unwrap();
        let fault = |change: &dyn Fn(&mut Chapter)| {
            let mut chapters = chapters();
            let place = chapters.iter().position(|chapter| chapter.id == "sphere").unwrap();
            change(&mut chapters[place]);
            check(&chapters).unwrap_err().to_string()
        };
        let twice =
            fault(&|chapter| drop(chapter.facts.letters.insert("s".to_owned(), "half the chord".to_owned())));
        assert!(twice.contains("05-sphere.md:1: s is"), "{twice}");
        let common =
            fault(&|chapter| drop(chapter.facts.letters.insert("r".to_owned(), "a ratio".to_owned())));
        assert!(common.contains("r is"), "{common}");
        let unknown = fault(&|chapter| chapter.body.push_str("\n\nSo $\\xi$.\n"));
        assert!(unknown.contains("ξ has no meaning"), "{unknown}");
    }
}
