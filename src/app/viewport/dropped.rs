//! What is shown while files are dragged over the window.

use crate::app::theme;
use eframe::egui::{self, Align2, CornerRadius, Rect, Stroke, TextStyle, Ui};

/// Shows what will happen to files dragged over the window.
pub(super) fn paint_drop(ui: &Ui, room: Rect) {
    let Some(files) = ui.input(|input| words_for_files(&input.raw.hovered_files)) else { return };
    let painter =
        ui.ctx().layer_painter(egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop")));
    painter.rect_filled(room, CornerRadius::ZERO, ui.visuals().panel_fill.gamma_multiply(0.8));
    painter.rect_stroke(
        room.shrink(12.0),
        CornerRadius::same(8),
        Stroke::new(2.0, theme::accent(ui)),
        egui::StrokeKind::Inside,
    );
    let font = TextStyle::Heading.resolve(ui.style());
    painter.text(room.center(), Align2::CENTER_CENTER, files, font, ui.visuals().strong_text_color());
}

fn words_for_files(files: &[egui::HoveredFile]) -> Option<String> {
    let name = files.first()?.path.as_ref().and_then(|path| path.file_name());
    Some(
        name.map_or_else(
            || "Drop to open".to_owned(),
            |name| format!("Drop to open {}", name.to_string_lossy()),
        ),
    )
}
