//! The lines of the tracer that are new in a stage, in three languages, and what their words mean.

use super::facts::Facts;
use super::right::scrolling;
use super::theme;
use super::widgets::{About, hint, small, switch, tip};
use crate::measure::baseline;
use crate::page::companion::{Excerpt, excerpts_between};
use crate::stages::Stage;
use eframe::egui::text::{LayoutJob, TextFormat};
use eframe::egui::{FontSelection, Frame, Grid, Label, Margin, RichText, ScrollArea, Sides, TextStyle, Ui};

/// Words of the three languages.
const KEYWORDS: &str = "as break const continue crate else enum false fn for if impl in let loop match mut override \
                        private pub ref return self Self static struct super trait true type typedef use var where \
                        while workgroup NULL";

/// Types that begin with a small letter.
const TYPES: &str = "array atomic bool char double f32 f64 float i32 i64 int long ptr size_t str u8 u16 u32 u64 unsigned \
                     usize vec2 vec2f vec2u vec3 vec3f vec3u vec4 vec4f vec4u void";

/// The functions of the C program that belong to a section.
const IN_C: [(&str, &[&str]); 20] = [
    ("2.1", &["write_ppm"]),
    ("2.2", &["write_ppm"]),
    ("4.2", &["unit", "ray_color"]),
    ("5.2", &["nearest_hit"]),
    ("6.1", &["nearest_hit"]),
    ("6.5", &["nearest_hit"]),
    ("8.2", &["random_unit", "render"]),
    ("9.1", &["random_unit_vector", "ray_color"]),
    ("9.2", &["ray_color"]),
    ("9.3", &["nearest_hit"]),
    ("9.4", &["random_unit_vector", "scatter"]),
    ("9.5", &["to_byte"]),
    ("10.5", &["reflect", "scatter"]),
    ("10.6", &["scatter"]),
    ("11.2", &["refract"]),
    ("11.3", &["scatter"]),
    ("11.4", &["reflectance", "scatter"]),
    ("12.1", &["render"]),
    ("12.2", &["cross", "render"]),
    ("13.2", &["random_in_unit_disk", "render"]),
];

/// What words of the code mean that are not in the book.
const WORDS: [(&str, &str); 18] = [
    ("coin", "a random number from 0 to 1"),
    ("f0", "the share that is reflected head on: 4 % for glass"),
    ("fma", "fma(a, b, c) is a · b + c, rounded only once"),
    ("mul_add", "a.mul_add(b, c) is a · b + c, rounded only once"),
    ("select", "one of two values, chosen without a branch; the condition comes last in WGSL, first in Rust"),
    ("splat", "the same number in every lane"),
    ("simd", "the level of vector instructions that the processor has"),
    ("mask", "one yes or no for each lane"),
    ("throughput", "the share of its light that a path still carries"),
    ("radiance", "the light that a path has gathered"),
    ("attenuation", "the share of light that is left after all bounces so far"),
    ("scramble", "makes other numbers of a sequence without spoiling how evenly they spread"),
    ("inverse_index", "one divided by the refraction index"),
    ("sine2", "the square of a sine"),
    ("refracted_sine2", "the square of the sine of the refracted angle: above 1 there is no such angle"),
    ("chord", "the part of a ray that is inside of the sphere"),
    ("T_MIN", "hits nearer than this do not count, so that a ray leaves the sphere that it starts on"),
    ("HUGE_VAL", "infinity, in C"),
];

#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
enum Language {
    #[default]
    C,
    Wgsl,
    Rust,
}

impl Language {
    const ALL: [(Language, &str, &str); 3] = [
        (Language::C, "C", "The book\u{2019}s program in plain C, one ray at a time"),
        (Language::Wgsl, "WGSL", "The program of the graphics card; reads much like the book\u{2019}s C++"),
        (Language::Rust, "Rust", "The program of the processor, for many lanes at once"),
    ];

    fn of(excerpt: &Excerpt) -> Self {
        match excerpt.file.rsplit('.').next() {
            Some("c") => Language::C,
            Some("wgsl") => Language::Wgsl,
            _ => Language::Rust,
        }
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
        let is_there = |(language, ..): &(Language, &str, &str)| {
            self.excerpts.iter().any(|excerpt| Language::of(excerpt) == *language)
        };
        let there = Language::ALL.into_iter().filter(is_there);
        let options: Vec<_> =
            there.map(|(language, name, help)| (language, About::new(name, help))).collect();
        let is_shown = options.iter().any(|(language, _)| *language == self.language);
        let mut shown = if is_shown { self.language } else { options[0].0 };
        Sides::new().height(24.0).show(
            ui,
            |ui| ui.label(RichText::new(format!("New in {}", stage.section)).strong()),
            |ui| {
                if let Some(chosen) = switch(ui, 48.0, shown, &options) {
                    (self.language, shown) = (chosen, chosen);
                }
            },
        );
        let excerpts = || self.excerpts.iter().filter(|excerpt| Language::of(excerpt) == shown);
        excerpts().for_each(|excerpt| excerpt_ui(ui, excerpt));
        words_ui(ui, excerpts());
    }
}

/// The code that is new since the stage before.
fn excerpts_of(stage: &'static Stage) -> Vec<Excerpt> {
    let earlier = std::iter::successors(stage.previous(), |stage| stage.previous())
        .find(|earlier| earlier.section != stage.section);
    let in_c = IN_C.iter().filter(|(section, _)| *section == stage.section).flat_map(|(_, names)| *names);
    let mut excerpts: Vec<_> = in_c.filter_map(|name| function_in_c(name)).collect();
    excerpts.extend(excerpts_between(earlier.map(|earlier| earlier.section), stage.section));
    excerpts
}

/// A function of the C program with the comment above it.
fn function_in_c(name: &str) -> Option<Excerpt> {
    let lines: Vec<&str> = baseline::SOURCE.lines().collect();
    let head = format!(" {name}(");
    let at = lines.iter().position(|line| {
        let line = line.replace('*', "");
        line.starts_with("static") && line.contains(&head) && !line.ends_with(';')
    })?;
    let first = if at > 0 && lines[at - 1].starts_with("/*") { at - 1 } else { at };
    let last =
        (at..lines.len()).find(|end| lines[*end].ends_with('}') && (*end == at || lines[*end] == "}"))?;
    let text = lines[first..=last].join("\n");
    Some(Excerpt { file: "reference/rt_weekend.c".to_owned(), first: first + 1, last: last + 1, text })
}

fn words_ui<'a>(ui: &mut Ui, excerpts: impl Iterator<Item = &'a Excerpt>) {
    let texts: Vec<&str> = excerpts.map(|excerpt| excerpt.text.as_str()).collect();
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let is_used = |(name, _): &&(&str, &str)| {
        texts.iter().any(|text| text.split(|c| !is_word(c)).any(|word| word == *name))
    };
    let used: Vec<_> = WORDS.iter().filter(is_used).collect();
    if used.is_empty() {
        return;
    }
    let colours = theme::colours(ui);
    ui.add_space(4.0);
    small(ui, "Words");
    let width = ui.available_width() - 120.0;
    Grid::new("words").num_columns(2).min_col_width(104.0).spacing([8.0, 4.0]).show(ui, |ui| {
        for (name, meaning) in used {
            ui.label(RichText::new(*name).color(colours.strong));
            ui.scope(|ui| {
                ui.set_max_width(width);
                ui.add(Label::new(*meaning).wrap());
            });
            ui.end_row();
        }
    });
}

fn excerpt_ui(ui: &mut Ui, excerpt: &Excerpt) {
    let colours = theme::colours(ui);
    let place = format!("{}, line {}", excerpt.file, excerpt.first);
    Sides::new().shrink_left().truncate().show(
        ui,
        |ui| small(ui, place),
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
        let id = (&excerpt.file, excerpt.first);
        ScrollArea::horizontal().id_salt(id).show(ui, |ui| {
            ui.add(Label::new(coloured(ui, excerpt.text.trim_end())).extend());
        });
    });
}

/// The code with colours for words of the language, types, numbers, comments, and what is called.
fn coloured(ui: &Ui, code: &str) -> LayoutJob {
    let colours = theme::colours(ui);
    let font_id = FontSelection::Style(TextStyle::Monospace).resolve(ui.style());
    let mut job = LayoutJob::default();
    let mut rest = code;
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let is_among = |words: &str, word: &str| words.split_whitespace().any(|known| known == word);
    while let Some(first) = rest.chars().next() {
        let end = match first {
            '/' if rest.starts_with("//") => rest.find('\n'),
            '/' if rest.starts_with("/*") => rest.find("*/").map(|at| at + 2),
            '0'..='9' => {
                rest.find(|c| !is_word(c) && c != '.').map(|end| rest[..end].trim_end_matches('.').len())
            }
            _ if is_word(first) => rest.find(|c| !is_word(c)),
            _ => rest[first.len_utf8()..].find(|c| is_word(c) || c == '/').map(|at| at + first.len_utf8()),
        };
        let (word, after) = rest.split_at(end.unwrap_or(rest.len()));
        let color = match first {
            '/' if word.starts_with("//") || word.starts_with("/*") => colours.weak,
            '0'..='9' => colours.warn,
            _ if is_among(KEYWORDS, word) => colours.accent,
            _ if is_among(TYPES, word) => colours.good,
            'A'..='Z' if word.chars().any(char::is_lowercase) => colours.good,
            _ if is_word(first) && after.starts_with(['(', '!']) => colours.strong,
            _ => colours.text,
        };
        let format = TextFormat { line_height: Some(18.0), ..TextFormat::simple(font_id.clone(), color) };
        job.append(word, 0.0, format);
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
    }

    #[test]
    fn the_c_program_has_the_functions_of_each_section() {
        for (section, names) in IN_C {
            assert!(Stage::ALL.iter().any(|stage| stage.section == section), "{section}");
            for name in names {
                let text = function_in_c(name).unwrap_or_else(|| panic!("{name}")).text;
                assert!(
                    text.contains(name) && text.matches('{').count() == text.matches('}').count(),
                    "{text}"
                );
            }
        }
    }
}
