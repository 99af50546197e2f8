//! The command palette: type part of a name, then press Enter.

use super::outcome::Outcome;
use crate::app::command::Command;
use crate::app::facts::Facts;
use crate::app::menu::line;
use eframe::egui::{self, Key, Modifiers, RichText, Ui};

/// The search text and the selected line.
#[derive(Default)]
pub struct Palette {
    text: String,
    chosen: usize,
}

/// Commands whose name or help contains every word of `text`, with their names. First comes the command with exactly this
/// name, then those with all words in their name, then the others.
fn matching(text: &str, commands: impl Iterator<Item = (Command, String)>) -> Vec<(Command, String)> {
    let words: Vec<String> = text.split_whitespace().map(str::to_lowercase).collect();
    let has = |place: &str| words.iter().all(|word| place.to_lowercase().contains(word.as_str()));
    let rank = |command: Command, name: &str| match name {
        _ if name == text => Some(0),
        _ if has(name) => Some(1),
        _ => has(&format!("{name} {}", command.help())).then_some(2),
    };
    let mut found: Vec<_> = commands
        .filter(|(command, _)| *command != Command::Palette)
        .filter_map(|(command, name)| Some((rank(command, &name)?, command, name)))
        .collect();
    found.sort_by_key(|(rank, ..)| *rank);
    found.into_iter().map(|(_, command, name)| (command, name)).collect()
}

/// All commands, the bookmarks, and the files that were opened or saved last.
fn listed(facts: &Facts) -> impl Iterator<Item = (Command, String)> {
    let further = facts.bookmarks().chain(facts.recent());
    Command::all().into_iter().chain(further).map(|command| (command, facts.name(command)))
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
                input.consume_key(Modifiers::NONE, Key::ArrowUp),
                input.consume_key(Modifiers::NONE, Key::ArrowDown),
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
        let found = matching(&self.text, listed(facts));
        let last = found.len().saturating_sub(1);
        if down {
            self.chosen = (self.chosen + 1).min(last);
        }
        if up {
            self.chosen = self.chosen.saturating_sub(1);
        }
        let mut run = enter.then(|| found.get(self.chosen)).flatten().map(|(command, _)| *command);
        ui.add_space(6.0);
        let list =
            egui::ScrollArea::vertical().min_scrolled_height(height).max_height(height).auto_shrink(false);
        list.show(ui, |ui| {
            if found.is_empty() {
                ui.label(RichText::new("No command matches").color(ui.visuals().weak_text_color()));
            }
            for (index, (command, name)) in found.iter().enumerate() {
                let disabled_reason = facts.disabled_reason(*command);
                let button = line(ui, *command, name.clone(), index == self.chosen);
                let response =
                    ui.add_enabled(disabled_reason.is_none(), button).on_hover_text(command.help());
                let response = response.on_disabled_hover_text(disabled_reason.unwrap_or_default());
                if index == self.chosen && (up || down) {
                    response.scroll_to_me(None);
                }
                if response.clicked() {
                    run = Some(*command);
                }
            }
        });
        match run {
            Some(command) => {
                commands.push(command);
                Outcome::Close
            }
            None => Outcome::Stay,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::Stage;

    fn found(text: &str) -> Vec<Command> {
        let all = Command::all().into_iter().map(|command| (command, command.name()));
        matching(text, all).into_iter().map(|(command, _)| command).collect()
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
}
