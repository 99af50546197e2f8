//! The marker of a click on the picture.

use super::badge::badge;
use eframe::egui::{Align2, Color32, Rect, Stroke, TextStyle, Ui, vec2};
use std::time::{Duration, Instant};

/// How long a click's marker stays.
const MARK: Duration = Duration::from_millis(1600);

/// The result of a click, shown for a moment.
pub(super) struct Mark {
    /// Position in the picture, `0..=1` from the upper left.
    pub place: [f64; 2],
    /// The text beside the marker.
    pub text: String,
    /// The time of the click.
    pub since: Instant,
}

impl Mark {
    /// Draws the marker; returns false once its time is over.
    pub fn paint(&self, ui: &Ui, room: Rect, rect: Rect) -> bool {
        let age = self.since.elapsed();
        if age > MARK {
            return false;
        }
        let painter = &ui.painter().with_clip_rect(room);
        let at = rect.min + vec2(self.place[0] as f32, self.place[1] as f32) * rect.size();
        painter.circle_stroke(at, 9.0, Stroke::new(3.0, Color32::from_black_alpha(130)));
        painter.circle_stroke(at, 9.0, Stroke::new(1.5, Color32::WHITE));
        painter.circle_filled(at, 1.5, Color32::WHITE);
        let font = TextStyle::Body.resolve(ui.style());
        badge(ui, painter, at + vec2(14.0, 0.0), Align2::LEFT_CENTER, &self.text, &font);
        ui.ctx().request_repaint_after(MARK - age);
        true
    }
}
