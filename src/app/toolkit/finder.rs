//! A field to search in, and the list of what it finds.

use super::widgets::hint;
use eframe::egui::{Align, Context, Event, Key, Modifiers, Response, ScrollArea, TextEdit, Ui, vec2};

/// Rows per Page Up or Page Down.
const PAGE: usize = 8;

/// How well a text finds what has this name; less is better. `None` if it does not.
pub fn rank(text: &str, name: &str, synonyms: &str, help: &str) -> Option<usize> {
    let [text, name, synonyms, help] = [text.trim(), name, synonyms, help].map(str::to_lowercase);
    let typed = words_of(&text);
    let all = |words: &[&str], is_found: fn(&str, &str) -> bool| {
        typed.iter().all(|typed| words.iter().any(|word| is_found(word, typed)))
    };
    let whole = |word: &str, typed: &str| word == typed;
    let begins = |word: &str, typed: &str| word.starts_with(typed);
    let [of_name, of_synonyms, of_help] = [&name, &synonyms, &help].map(|text| words_of(text));
    let everything = [of_name.clone(), of_synonyms.clone(), of_help].concat();
    let ways: [bool; 6] = [
        name.trim_end_matches('…') == text,
        all(&of_name, whole),
        all(&of_name, begins),
        all(&of_synonyms, whole),
        all(&of_synonyms, begins),
        all(&everything, begins),
    ];
    ways.into_iter().position(|is_so| is_so)
}

/// The words of a name. Numbers of sections, such as 11.4, are words.
fn words_of(text: &str) -> Vec<&str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '.').filter(|word| !word.is_empty()).collect()
}

/// The typed text, and the chosen row.
#[derive(Clone, Default)]
pub struct Finder {
    text: String,
    chosen: Option<usize>,
    has_moved: bool,
}

impl Finder {
    /// With a row chosen.
    pub fn at(row: usize) -> Self {
        Finder { chosen: Some(row), has_moved: true, ..Finder::default() }
    }

    /// With the text that was typed in the opening frame, which would be lost.
    pub fn typed(context: &Context) -> Self {
        let typed = |event: &Event| match event {
            Event::Text(text) => Some(text.clone()),
            _ => None,
        };
        let text: String = context.input(|input| input.events.iter().filter_map(typed).collect());
        Finder { chosen: (!text.is_empty()).then_some(0), text, has_moved: false }
    }

    pub fn has_text(&self) -> bool {
        !self.text.is_empty()
    }

    /// The chosen one of what is found.
    pub fn chosen<'a, T>(&self, found: &'a [T]) -> Option<&'a T> {
        found.get(self.chosen?)
    }

    /// Draws field and list; `rows` are drawn by `row`, which knows whether its row is chosen. Returns what was found, and
    /// the row that was clicked, or chosen when Enter was pressed.
    pub fn ui<T>(
        &mut self,
        ui: &mut Ui,
        (name, example, nothing): (&str, &str, &str),
        height: f32,
        find: impl FnOnce(&str) -> Vec<T>,
        mut row: impl FnMut(&mut Ui, &T, bool) -> Response,
    ) -> (Vec<T>, Option<usize>) {
        let presses = |key| ui.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key));
        let down = presses(Key::ArrowDown) + PAGE * presses(Key::PageDown);
        let up = presses(Key::ArrowUp) + PAGE * presses(Key::PageUp);
        let is_enter = presses(Key::Enter) > 0;
        let edit = TextEdit::singleline(&mut self.text).hint_text(example).margin(vec2(8.0, 8.0));
        let response = ui.add(edit.desired_width(f32::INFINITY)).accessible_name(name);
        response.request_focus();
        if response.changed() {
            (self.chosen, self.has_moved) = ((!self.text.trim().is_empty()).then_some(0), true);
        }
        let found = find(&self.text);
        if up + down > 0 {
            // Before the first row there is none.
            let place = self.chosen.map_or(0, |chosen| chosen + 1) + down;
            let place = place.min(found.len()).saturating_sub(up).max(1);
            (self.chosen, self.has_moved) = (Some(place - 1), true);
        }
        let mut run = self.chosen.filter(|chosen| is_enter && *chosen < found.len());
        let area = ScrollArea::vertical().min_scrolled_height(height).max_height(height);
        let area = area.auto_shrink([false, true]);
        area.show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            if found.is_empty() {
                hint(ui, nothing);
            }
            for (index, item) in found.iter().enumerate() {
                let is_chosen = self.chosen == Some(index);
                let response = row(ui, item, is_chosen);
                if is_chosen && self.has_moved {
                    response.scroll_to_me(Some(Align::Center));
                }
                if response.clicked() {
                    run = Some(index);
                }
            }
        });
        // The area has its final size only in its second frame.
        self.has_moved = std::mem::take(&mut self.has_moved) && ui.is_sizing_pass();
        (found, run)
    }
}
