//! The right panel: its tabs, and the view and the pixel at its foot.

use crate::app::model::Tab;
use crate::app::toolkit::theme;
use eframe::egui::{CentralPanel, Margin, Panel, Rangef, ScrollArea, Ui};

/// Points that are left for the picture.
const PICTURE: f32 = 240.0;

impl Tab {
    fn width(self) -> f32 {
        match self {
            Tab::Stage | Tab::Controls => 272.0,
            Tab::Code => 536.0,
            Tab::Check => 360.0,
        }
    }
}

/// The panel for a tab, within `room`. The width of each tab is remembered.
pub fn panel(tab: Tab, room: f32) -> Panel {
    let widest = (room - PICTURE).max(272.0);
    Panel::right(tab.name())
        .default_size(tab.width().min(widest))
        .size_range(Rangef::new(240.0, widest))
        .frame(theme::panel(Margin::ZERO))
}

/// The foot of the panel, at the same height for all stages.
pub fn foot(ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    let frame = theme::panel(Margin::symmetric(16, 4));
    Panel::bottom("foot").resizable(false).frame(frame).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 8.0;
        content(ui);
    });
}

/// The scrolling part above the foot.
pub fn scrolling(ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    CentralPanel::default().frame(theme::panel(Margin::ZERO)).show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            theme::panel(Margin::same(16)).show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 8.0;
                content(ui);
            });
        });
    });
}
