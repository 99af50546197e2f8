//! Whether a text speaks of the code beside it: names in a section that shows code must be in the excerpts that are open
//! when the page loads, or the chapter says that they are found elsewhere.

use crate::chapter::Chapter;
use crate::library::{Fault, Library, line_of};
use std::collections::BTreeSet;
use weekender::excerpt::Excerpt;

pub fn check(library: &Library, chapter: &Chapter) -> Result<(), Fault> {
    let mut start = 0;
    for section in chapter.body.split("\n## ") {
        let blocks = section.split("\n\n").filter(|text| text.trim().starts_with("{{code"));
        let open: Vec<Excerpt> = blocks.flat_map(|wanted| open_excerpts(library, wanted)).collect();
        let mut seen: BTreeSet<&str> =
            open.iter().flat_map(|excerpt| excerpt.text.split(is_no_word)).collect();
        seen.extend(chapter.facts.elsewhere.iter().map(String::as_str).chain([""]));
        let mut at = start;
        for (place, code) in section.split('`').enumerate() {
            let name = code.split('(').next().unwrap_or_default();
            if place % 2 == 1 && !open.is_empty() && !name.contains(is_no_word) && !seen.contains(name) {
                let line = chapter.lines_before + line_of(&chapter.body, at);
                let remedy = "put the language that has it first, correct the name, or add it to the chapter's list `elsewhere`";
                let message = format!("`{name}` is not in the code that this section shows first; {remedy}");
                return Err(Fault::new(&chapter.file, line, message));
            }
            at += code.len() + 1;
        }
        start += section.len() + "\n## ".len();
    }
    Ok(())
}

fn is_no_word(c: char) -> bool {
    !c.is_alphanumeric() && c != '_'
}

/// The excerpts of a block in its first language. Faulty ones are reported where they are shown.
fn open_excerpts(library: &Library, wanted: &str) -> Vec<Excerpt> {
    let mut excerpts: Vec<Excerpt> =
        wanted.trim().lines().skip(1).filter_map(|line| library.excerpt(line).ok()).collect();
    let first = excerpts.first().map(|excerpt| excerpt.language().to_owned());
    excerpts.retain(|excerpt| Some(excerpt.language()) == first.as_deref());
    excerpts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_in_open_excerpts() {
        let c = "reference/rt_weekend.c: static double dot";
        let wgsl = "shaders/lanes.wgsl: fn dot3";
        let library = Library::of_checkout();
        let mut chapter = Chapter::read_all(&library).unwrap().remove(0);
        (chapter.lines_before, chapter.facts.elsewhere) = (10, vec!["other".to_owned()]);
        let mut line_of_fault = |text: &str, [first, second]: [&str; 2]| {
            chapter.body = format!("\n`anything`\n\n## A\n\n{text}\n\n{{{{code\n{first}\n{second}\n}}}}\n");
            check(&library, &chapter).err().map(|fault| fault.line)
        };
        for (text, of_wgsl, of_c) in [
            ("a\n`dot3` b", None, Some(17)),
            ("`dot(a, b)`", Some(16), None),
            ("`fma`\n\n`a`", None, Some(16)),
            ("`other` `--flag` ``", None, None),
        ] {
            assert_eq!(line_of_fault(text, [wgsl, c]), of_wgsl, "{text}");
            assert_eq!(line_of_fault(text, [c, wgsl]), of_c, "{text}");
        }
    }
}
