//! The command palette: type part of a name, then press Enter.

use super::outcome::Outcome;
use crate::app::command::{Command, ROWS};
use crate::app::facts::Facts;
use crate::app::menu::line;
use crate::app::theme;
use eframe::egui::accesskit::Toggled;
use eframe::egui::{
    self, Align2, CornerRadius, Key, Modifiers, Response, RichText, Sense, Stroke, StrokeKind, TextStyle, Ui,
    UiBuilder, vec2,
};

/// Where a row says whether a switch is on: so far from its right end, points.
const STATE: f32 = 130.0;

/// The search text and the selected line.
#[derive(Default)]
pub struct Palette {
    text: String,
    chosen: usize,
}

/// How well a text finds a command; less is better. `None` if a word of it is neither in the name nor in the help.
fn rank(text: &str, name: &str, help: &str) -> Option<usize> {
    let [text, name, help] = [text.trim(), name, help].map(str::to_lowercase);
    let (typed, of_name): (Vec<&str>, _) = (text.split_whitespace().collect(), words_of(&name));
    let everything = format!("{name} {help}");
    let begins = |words: &[&str]| typed.iter().all(|typed| words.iter().any(|word| word.starts_with(typed)));
    let contains = |place: &str| typed.iter().all(|typed| place.contains(typed));
    let initials: String = of_name.iter().filter_map(|word| word.chars().next()).collect();
    let is_at_a_word =
        || name.match_indices(&text).any(|(at, _)| !name[..at].ends_with(char::is_alphanumeric));
    let ways: [&dyn Fn() -> bool; 8] = [
        &|| name == text,
        &|| name.starts_with(&text),
        &is_at_a_word,
        // Beginnings of words, in any order.
        &|| begins(&of_name),
        &|| text.len() > 1 && initials.contains(&text),
        &|| contains(&name),
        &|| begins(&words_of(&everything)),
        &|| contains(&everything),
    ];
    ways.iter().position(|is_so| is_so())
}

/// The words of a name. Numbers of sections, such as 11.4, are words.
fn words_of(text: &str) -> Vec<&str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '.').filter(|word| !word.is_empty()).collect()
}

/// The commands that `text` finds, the best first; `is_enabled` decides between equally good ones, then the order of the
/// menus.
fn matching(
    text: &str,
    commands: impl Iterator<Item = (Command, String)>,
    is_enabled: impl Fn(Command) -> bool,
) -> Vec<(Command, String)> {
    let mut found: Vec<_> = commands
        .filter(|(command, _)| *command != Command::Palette)
        .filter_map(|(command, name)| Some((rank(text, &name, command.help())?, command, name)))
        .collect();
    if !text.trim().is_empty() {
        found.sort_by_cached_key(|(rank, command, _)| (*rank, !is_enabled(*command)));
    }
    found.into_iter().map(|(_, command, name)| (command, name)).collect()
}

/// All commands, the bookmarks, and the files that were opened or saved last.
fn listed(facts: &Facts) -> impl Iterator<Item = (Command, String)> {
    let further = facts.bookmarks().chain(facts.recent());
    ROWS.iter()
        .filter(|row| row.is_listed)
        .map(|row| row.command)
        .chain(further)
        .map(|command| (command, facts.name(command)))
}

impl Palette {
    /// Opens with the text that was typed in the opening frame.
    pub fn typed(context: &egui::Context) -> Self {
        let typed = |event: &egui::Event| match event {
            egui::Event::Text(text) => Some(text.clone()),
            _ => None,
        };
        let text = context.input(|input| input.events.iter().filter_map(typed).collect());
        Palette { text, chosen: 0 }
    }

    /// Draws the dialog. The list has the same `height`, however many commands match, so that nothing moves.
    pub(super) fn ui(
        &mut self,
        ui: &mut Ui,
        height: f32,
        facts: &Facts,
        commands: &mut Vec<Command>,
    ) -> Outcome {
        ui.set_width(ui.available_width());
        let (up, down, enter) = ui.input_mut(|input| {
            (
                input.count_and_consume_key(Modifiers::NONE, Key::ArrowUp),
                input.count_and_consume_key(Modifiers::NONE, Key::ArrowDown),
                input.key_pressed(Key::Enter),
            )
        });
        let edit = egui::TextEdit::singleline(&mut self.text)
            .hint_text("What do you want to do?")
            .desired_width(f32::INFINITY);
        let response = ui.add(edit).accessible_name("Command");
        response.request_focus();
        if response.changed() {
            self.chosen = 0;
        }
        let is_enabled = |command| facts.disabled_reason(command).is_none();
        let found = matching(&self.text, listed(facts), is_enabled);
        let last = found.len().saturating_sub(1);
        self.chosen = (self.chosen + down).min(last).saturating_sub(up);
        let mut run = enter.then(|| found.get(self.chosen)).flatten().map(|(command, _)| *command);
        ui.add_space(6.0);
        let mut told = found.get(self.chosen).map(|(command, _)| *command);
        let list =
            egui::ScrollArea::vertical().min_scrolled_height(height).max_height(height).auto_shrink(false);
        list.show(ui, |ui| {
            if found.is_empty() {
                ui.label(RichText::new("No command matches").color(ui.visuals().weak_text_color()));
            }
            for (index, (command, name)) in found.iter().enumerate() {
                let response = row(ui, facts, *command, name, index == self.chosen);
                if index == self.chosen && up + down > 0 {
                    response.scroll_to_me(None);
                }
                if response.hovered() {
                    told = Some(*command);
                }
                if response.clicked() {
                    run = Some(*command);
                }
            }
        });
        ui.add_space(4.0);
        about(ui, facts, told);
        match run {
            Some(command) => {
                commands.push(command);
                Outcome::Close
            }
            None => Outcome::Stay,
        }
    }
}

/// A command, whether it is on, and its keys.
fn row(ui: &mut Ui, facts: &Facts, command: Command, name: &str, is_chosen: bool) -> Response {
    let is_enabled = facts.disabled_reason(command).is_none();
    let is_filled = is_chosen && is_enabled;
    let response = ui.add_enabled(is_enabled, line(ui, command, name.to_owned(), is_filled));
    if is_chosen && !is_enabled {
        // Dimmed text would not be readable on the accent colour.
        let stroke = Stroke::new(1.5, theme::accent(ui));
        ui.painter().rect_stroke(response.rect, CornerRadius::same(5), stroke, StrokeKind::Inside);
    }
    if let Some(is_on) = facts.switch(command) {
        let visuals = ui.visuals();
        let colour = match (is_filled, is_on) {
            (true, _) => visuals.selection.stroke.color,
            (false, true) => visuals.strong_text_color(),
            (false, false) => visuals.weak_text_color(),
        };
        let at = response.rect.right_center() - vec2(STATE, 0.0);
        let font = TextStyle::Button.resolve(ui.style());
        ui.painter().text(at, Align2::LEFT_CENTER, if is_on { "on" } else { "off" }, font, colour);
        let toggled = if is_on { Toggled::True } else { Toggled::False };
        ui.ctx().accesskit_node_builder(response.id, |node| node.set_toggled(toggled));
    }
    response
}

/// What a command does, or why it is disabled. It has two lines, so that nothing moves.
fn about(ui: &mut Ui, facts: &Facts, command: Option<Command>) {
    let text = command.map_or_else(String::new, |command| {
        facts.disabled_reason(command).unwrap_or_else(|| command.help().to_owned())
    });
    let height = 2.0 * ui.text_style_height(&TextStyle::Body);
    let size = vec2(ui.available_width(), height);
    let (place, _) = ui.allocate_exact_size(size, Sense::hover());
    let mut within = ui.new_child(UiBuilder::new().max_rect(place));
    within.shrink_clip_rect(place);
    let text = RichText::new(text).color(ui.visuals().weak_text_color());
    within.add(egui::Label::new(text).wrap());
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::stages::Stage;

    fn found(text: &str) -> Vec<Command> {
        let all = Command::all().into_iter().map(|command| (command, command.name()));
        matching(text, all, |_| true).into_iter().map(|(command, _)| command).collect()
    }

    #[test]
    fn every_command_is_found_by_its_name() {
        for command in Command::all().into_iter().filter(|command| *command != Command::Palette) {
            assert!(found(&command.name()).contains(&command), "{command:?}");
        }
        assert!(found("xyzzy").is_empty());
    }

    #[test]
    fn names_come_before_help() {
        assert_eq!(found("undo").first(), Some(&Command::Undo));
        let stage = Stage::find("glass-schlick").unwrap();
        assert_eq!(found("11.4").first(), Some(&Command::Stage(stage)));
    }

    #[test]
    fn the_palette_begins_with_what_is_typed_in_the_frame_that_opens_it() {
        let text = |letters: &str| egui::Event::Text(letters.to_owned());
        let events = vec![text("zo"), egui::Event::PointerGone, text("om")];
        let context = egui::Context::default();
        let mut opened = Palette { text: "before".to_owned(), chosen: 3 };
        let _ = context.run_ui(egui::RawInput { events, ..egui::RawInput::default() }, |ui| {
            opened = Palette::typed(ui.ctx());
        });
        assert_eq!((opened.text.as_str(), opened.chosen), ("zoom", 0));
    }
}
