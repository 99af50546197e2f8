//! The lines of the tracer that are new in a stage.

use super::facts::Facts;
use super::right::scrolling;
use super::theme;
use super::widgets::{About, hint, switch, tip};
use crate::page::companion::{Excerpt, excerpts_between};
use crate::stages::Stage;
use eframe::egui::text::{LayoutJob, TextFormat};
use eframe::egui::{FontSelection, Frame, Label, Margin, RichText, Sides, TextStyle, Ui};

/// Words of both languages.
const KEYWORDS: &[&str] = &[
    "as",
    "break",
    "const",
    "continue",
    "crate",
    "else",
    "enum",
    "false",
    "fn",
    "for",
    "if",
    "impl",
    "in",
    "let",
    "loop",
    "match",
    "mut",
    "override",
    "private",
    "pub",
    "ref",
    "return",
    "self",
    "Self",
    "static",
    "struct",
    "super",
    "trait",
    "true",
    "type",
    "use",
    "var",
    "where",
    "while",
    "workgroup",
];

/// Types that begin with a small letter.
const TYPES: &[&str] = &[
    "array", "atomic", "bool", "char", "f32", "f64", "i32", "i64", "ptr", "str", "u8", "u16", "u32", "u64",
    "usize", "vec2", "vec2f", "vec2u", "vec3", "vec3f", "vec3u", "vec4", "vec4f", "vec4u",
];

/// A language of the excerpts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
enum Language {
    #[default]
    Wgsl,
    Rust,
}

impl Language {
    fn is_of(self, excerpt: &Excerpt) -> bool {
        excerpt.file.ends_with(if self == Language::Wgsl { ".wgsl" } else { ".rs" })
    }
}

/// The code of one stage.
#[derive(Default)]
pub struct Code {
    /// The stage whose excerpts these are.
    stage: Option<&'static Stage>,
    excerpts: Vec<Excerpt>,
    language: Language,
}

impl Code {
    pub fn ui(&mut self, ui: &mut Ui, facts: &Facts) {
        let stage = facts.document().stage();
        if stage != self.stage {
            self.excerpts = stage.map(excerpts_of).unwrap_or_default();
            self.stage = stage;
        }
        scrolling(ui, |ui| match stage {
            None => _ = hint(ui, "This picture is no stage of the book, so there is no code to show."),
            Some(_) if self.excerpts.is_empty() => {
                _ = hint(ui, "This stage needs no new code: only its scene and settings are new.");
            }
            Some(stage) => self.stage_ui(ui, stage),
        });
    }

    fn stage_ui(&mut self, ui: &mut Ui, stage: &Stage) {
        let has_both =
            [Language::Wgsl, Language::Rust].iter().all(|one| self.excerpts.iter().any(|e| one.is_of(e)));
        Sides::new().height(24.0).show(
            ui,
            |ui| ui.label(RichText::new(format!("New in {}", stage.section)).strong()),
            |ui| {
                let wgsl = "The program of the graphics card; reads much like the book\u{2019}s C++";
                let rust = "The program of the processor, for many lanes at once";
                let options = [
                    (Language::Wgsl, About::new("GPU (WGSL)", wgsl)),
                    (Language::Rust, About::new("CPU (Rust)", rust)),
                ];
                if has_both {
                    self.language = switch(ui, 0.0, self.language, &options).unwrap_or(self.language);
                }
            },
        );
        for excerpt in self.excerpts.iter().filter(|excerpt| !has_both || self.language.is_of(excerpt)) {
            excerpt_ui(ui, excerpt);
        }
    }
}

/// The code that is new since the stage before.
fn excerpts_of(stage: &'static Stage) -> Vec<Excerpt> {
    let earlier = std::iter::successors(stage.previous(), |stage| stage.previous())
        .find(|earlier| earlier.section != stage.section);
    excerpts_between(earlier.map(|earlier| earlier.section), stage.section)
}

fn excerpt_ui(ui: &mut Ui, excerpt: &Excerpt) {
    let colours = theme::colours(ui);
    let place = format!("{}, line {}", excerpt.file, excerpt.first);
    Sides::new().shrink_left().truncate().show(
        ui,
        |ui| ui.label(RichText::new(place).small().color(colours.weak)),
        |ui| {
            let copy = ui.link(RichText::new("Copy").small());
            if tip(ui, copy, "Copies these lines", None).clicked() {
                ui.copy_text(excerpt.text.clone());
            }
        },
    );
    let well = Frame::new().fill(colours.well).stroke(ui.visuals().window_stroke).corner_radius(4);
    well.inner_margin(Margin::same(8)).show(ui, |ui| {
        ui.set_width(ui.available_width());
        let font = TextStyle::Monospace.resolve(ui.style());
        let letter = ui.fonts_mut(|fonts| fonts.glyph_width(&font, 'm'));
        let columns = ((ui.available_width() / letter) as usize).max(24);
        ui.add(Label::new(coloured(ui, &fitted(excerpt.text.trim_end(), columns))).extend());
    });
}

/// The code in lines of at most `columns` letters: comments are filled anew, and longer lines break after a comma.
fn fitted(code: &str, columns: usize) -> String {
    let (mut lines, mut was_comment) = (Vec::<String>::new(), false);
    for line in code.lines() {
        let text = line.trim_start();
        let indentation = &line[..line.len() - text.len()];
        let is_comment = text.starts_with("//");
        if is_comment {
            let mark = &text[..text.find(|c| c != '/').unwrap_or(text.len())];
            if !was_comment {
                lines.push(format!("{indentation}{mark}"));
            }
            for word in text[mark.len()..].split_whitespace() {
                match lines.last_mut() {
                    Some(last) if last.len() + 1 + word.len() <= columns => {
                        last.push(' ');
                        last.push_str(word);
                    }
                    _ => lines.push(format!("{indentation}{mark} {word}")),
                }
            }
        } else {
            let (mut rest, hanging) = (line.to_owned(), format!("{indentation}        "));
            while let Some((end, _)) = rest.char_indices().nth(columns) {
                let head = &rest[..end];
                let place = head.rfind(", ").map(|comma| comma + 1).filter(|at| *at > hanging.len());
                let place = place.or_else(|| head.rfind(' ').filter(|at| *at > hanging.len()));
                let Some(place) = place else { break };
                let tail = rest.split_off(place);
                lines.push(std::mem::replace(&mut rest, format!("{hanging}{}", tail.trim_start())));
            }
            lines.push(rest);
        }
        was_comment = is_comment;
    }
    lines.join("\n")
}

/// The code with colours for words of the language, types, numbers, comments, and what is called.
fn coloured(ui: &Ui, code: &str) -> LayoutJob {
    let colours = theme::colours(ui);
    let font_id = FontSelection::Style(TextStyle::Monospace).resolve(ui.style());
    let mut job = LayoutJob::default();
    let mut rest = code;
    while let Some(first) = rest.chars().next() {
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        let end = match first {
            '/' if rest.starts_with("//") => rest.find('\n'),
            '0'..='9' => {
                rest.find(|c| !is_word(c) && c != '.').map(|end| rest[..end].trim_end_matches('.').len())
            }
            _ if is_word(first) => rest.find(|c| !is_word(c)),
            _ => rest[first.len_utf8()..].find(|c| is_word(c) || c == '/').map(|at| at + first.len_utf8()),
        };
        let (word, after) = rest.split_at(end.unwrap_or(rest.len()));
        let color = match first {
            '/' if word.starts_with("//") => colours.weak,
            '0'..='9' => colours.warn,
            _ if KEYWORDS.contains(&word) => colours.accent,
            _ if TYPES.contains(&word) => colours.good,
            'A'..='Z' if word.chars().any(char::is_lowercase) => colours.good,
            _ if is_word(first) && after.starts_with(['(', '!']) => colours.strong,
            _ => colours.text,
        };
        let line_height = Some(18.0);
        job.append(
            word,
            0.0,
            TextFormat { font_id: font_id.clone(), color, line_height, ..TextFormat::default() },
        );
        rest = after;
    }
    job
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_code_of_a_stage_is_what_is_new_since_the_section_before() {
        let texts = |id: &str| {
            let excerpts = excerpts_of(Stage::find(id).unwrap());
            excerpts.iter().map(|excerpt| format!("{} {}", excerpt.file, excerpt.first)).collect::<Vec<_>>()
        };
        let [far, near] = ["view-distant", "view-close"].map(|id| Stage::find(id).unwrap());
        assert_eq!(far.section, near.section);
        assert_eq!(texts("view-distant"), texts("view-close"), "two stages of one section");
        assert!(!texts("glass-schlick").is_empty());
        let first = &Stage::ALL[0];
        let count = excerpts_between(None, first.section).len();
        assert_eq!(texts(first.id).len(), count, "nothing was there before the first stage");
    }

    #[test]
    fn code_fits_and_keeps_its_words() {
        let words = |text: &str| -> Vec<String> {
            text.split_whitespace().filter(|word| !word.starts_with("//")).map(str::to_owned).collect()
        };
        for excerpt in Stage::ALL.iter().flat_map(excerpts_of) {
            let broken = fitted(&excerpt.text, 62);
            assert_eq!(words(&broken), words(&excerpt.text), "{}", excerpt.file);
            for line in broken.lines() {
                assert!(line.chars().count() <= 62, "{}: {line}", excerpt.file);
            }
        }
        assert_eq!(fitted("// one two\n// three", 12), "// one two\n// three");
        assert_eq!(fitted("// one two\n// three", 9), "// one\n// two\n// three");
    }
}
