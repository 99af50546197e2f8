//! Controls for the size of the picture, and for saving it.

use super::reset::Reset;
use crate::app::command::Command;
use crate::app::facts::Facts;
use crate::app::model::document::Document;
use crate::app::model::sizing::Sizing;
use crate::app::tips;
use crate::app::widgets::{About, explained, whole_number};
use crate::job::output::OutputFormat;
use crate::job::render::SIZE_LIMIT;
use eframe::egui::{self, Ui, vec2};

pub(super) const RESET: Reset = Reset { is_changed, reset };

fn is_changed(document: &Document) -> bool {
    document.has_own_size != document.origin.keeps_size()
        || (document.has_own_size && document.size() != document.origin.size())
}

fn reset(document: &mut Document) {
    document.has_own_size = document.origin.keeps_size();
    if document.has_own_size {
        document.set_size(document.origin.size());
    }
}

pub(super) fn ui(ui: &mut Ui, document: &mut Document, facts: &Facts, commands: &mut Vec<Command>) {
    sizing(ui, document, facts, commands);
    size(ui, document);
    let command = Command::CopyCommand;
    let width = ui.available_width();
    let button = egui::Button::new(command.name()).min_size(egui::vec2(width, 0.0));
    let response = ui.add(button);
    if tips::beside(ui, response, command.help()).clicked() {
        commands.push(command);
    }
}

/// What decides the size.
fn sizing(ui: &mut Ui, document: &mut Document, facts: &Facts, commands: &mut Vec<Command>) {
    ui.label(egui::RichText::new("Size").small().color(ui.visuals().weak_text_color()));
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let width = (ui.available_width() - 8.0) / 3.0;
        let button = |name: &str, is_on| egui::Button::new(name).selected(is_on).min_size(vec2(width, 0.0));
        let help = "This picture keeps its size, which can be typed below. Pictures from files and from --size have \
                    their own size, too; the next stage follows the viewport or the book again";
        let response = ui.add(button("Own", document.has_own_size));
        let response = explained(ui, response, About::new("Own size", help));
        if response.accessible_name("Own size").clicked() {
            document.has_own_size = true;
        }
    });
}

fn size(ui: &mut Ui, document: &mut Document) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let place = vec2((ui.available_width() - 4.0) / 2.0, ui.spacing().interact_size.y);
        let mut size = document.size();
        for (name, pixels) in ["Width", "Height"].into_iter().zip(&mut size) {
            let (mut count, range) = (u64::from(*pixels), 1..=u64::from(SIZE_LIMIT));
            let response = whole_number(ui, (name, place), &mut count, range, |drag| drag.speed(2.0));
            *pixels = u32::try_from(count).unwrap_or(SIZE_LIMIT);
            explained(
                ui,
                response,
                About::new(name, &format!("{name}, pixels; a typed size is the picture's own")),
            );
        }
        if size != document.size() {
            document.give_size(size);
        }
    });
    ui.add_space(5.0);
}
