//! The dock under the picture: a path, and the error over time.

use super::Tools;
use crate::app::commands::{Command, PanelContext};
use crate::app::model::{Dock, Model};
use crate::app::panels::plot;
use crate::app::toolkit::theme;
use crate::app::toolkit::widgets::{sign_button, tabs, tip};
use eframe::egui::{self, Frame, Margin, Ui};

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
            let has_paths = dock == Dock::Path || cx.has_paths;
            let shown = [Dock::Path, Dock::Error].into_iter().filter(|of| *of != Dock::Path || has_paths);
            let shown: Vec<_> = shown.map(|of| (of, of.name())).collect();
            let chosen = tabs(ui, &shown, dock, |ui| {
                let close = sign_button(ui, "×", 24.0, "Close dock");
                if tip(ui, close, "Closes the dock (Escape)", None).clicked() {
                    cx.send(if dock == Dock::Path { Command::ClearPaths } else { Command::ErrorDock });
                }
            });
            model.remembered.dock = Some(chosen);
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
