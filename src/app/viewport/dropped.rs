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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::tests::{Drawings, part};
    use eframe::egui::pos2;

    #[test]
    fn files_over_the_window_are_named() {
        let mut drawings = Drawings::default();
        let room = Rect::from_min_max(pos2(20.0, 10.0), pos2(420.0, 290.0));
        let mut harness = part([440.0, 300.0], |ui| paint_drop(ui, room));
        for (name, files) in [
            ("no file", vec![]),
            ("a file", vec![Some("/of/a.png".into())]),
            ("two files", vec![Some("/of/b.png".into()), Some("/of/a.png".into())]),
            ("a file without a name", vec![None]),
        ] {
            let file = |path| egui::HoveredFile { path, ..egui::HoveredFile::default() };
            harness.input_mut().hovered_files = files.into_iter().map(file).collect();
            harness.run_steps(1);
            drawings.add(name, &harness);
        }
        drawings.keep("dropped_files");
    }
}
