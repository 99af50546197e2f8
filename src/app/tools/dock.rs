//! The dock under the picture: a path, and the error over time.

use super::Tools;
use crate::app::commands::{Command, PanelContext};
use crate::app::model::{Dock, Model};
use crate::app::panels::plot;
use crate::app::toolkit::theme;
use crate::app::toolkit::widgets::{TABS, panel_line, sign_button, tab, tip};
use eframe::egui::{self, Frame, Margin, Sides, Ui};

/// Height at first, at least, and in low windows, points.
const HEIGHT: f32 = 276.0;
const LEAST: f32 = 160.0;
const LOW: f32 = 200.0;

/// Draws the dock.
pub fn ui(ui: &mut Ui, model: &mut Model, tools: &mut Tools, cx: &PanelContext) {
    let Some(dock) = model.remembered.dock else { return };
    let height = ui.ctx().content_rect().height();
    let usual = if height < 700.0 { LOW } else { HEIGHT };
    egui::Panel::bottom("dock")
        .frame(theme::panel(Margin::ZERO))
        .resizable(true)
        .default_size(usual)
        .size_range(LEAST..=(0.5 * height).max(LEAST))
        .show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            let row = Frame::new().inner_margin(Margin::symmetric(16, 0));
            row.show(ui, |ui| tabs(ui, dock, model, cx));
            panel_line(ui);
            Frame::new().inner_margin(Margin { left: 16, right: 16, top: 8, bottom: 8 }).show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 8.0;
                match dock {
                    Dock::Path => tools.paths.ui(ui),
                    Dock::Error => plot::ui(ui, cx),
                }
                ui.take_available_space();
            });
        });
}

fn tabs(ui: &mut Ui, dock: Dock, model: &mut Model, cx: &PanelContext) {
    let shown = &mut model.remembered.dock;
    let tabs = [(Dock::Path, Command::ClearPaths), (Dock::Error, Command::ErrorDock)];
    let left = |ui: &mut Ui| {
        ui.spacing_mut().item_spacing.x = 16.0;
        for (of, command) in tabs {
            if of != Dock::Path || dock == of || cx.has_paths {
                let response = tab(ui, of.name(), dock == of);
                if tip(ui, response, command.help(), None).clicked() {
                    *shown = Some(of);
                }
            }
        }
    };
    let right = |ui: &mut Ui| {
        let close = sign_button(ui, "×", 24.0, "Close dock");
        if tip(ui, close, "Closes the dock (Escape)", None).clicked() {
            tabs.iter().filter(|(of, _)| *of == dock).for_each(|(_, command)| cx.send(*command));
        }
    };
    Sides::new().height(TABS).shrink_left().show(ui, left, right);
}
