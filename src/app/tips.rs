//! Tips that do not cover the next control: they stand outside of the part of the window that holds what they explain.

use eframe::egui::{Rangef, Rect, RectAlign, Response, Tooltip, Ui};

/// Free space around a tip, points.
const GAP: f32 = 8.0;

/// Space between a row of a list or menu and the edge of that, points.
const EDGE: f32 = 8.0;

/// A tip narrower than this would be a column of single words, points.
const LEAST_WIDTH: f32 = 120.0;

/// Where a tip stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// At the left or right, where there is more room: for columns of controls.
    Beside,
    /// Above, or below if there is no room: for rows of controls at the bottom of the window.
    Above,
    /// Below: for rows of controls at the top of the window.
    Below,
}

/// Gives a control a tip outside of the panel `ui`. A disabled control also tells the `reason`.
pub fn explain(ui: &Ui, response: Response, side: Side, help: &str, reason: Option<&str>) -> Response {
    // The clip rectangle is the panel's, except along the direction in which something scrolls within it.
    let clip = ui.clip_rect();
    let around = match side {
        Side::Beside => Rect::from_x_y_ranges(clip.x_range(), response.rect.y_range()),
        Side::Above | Side::Below => Rect::from_x_y_ranges(response.rect.x_range(), clip.y_range()),
    };
    explain_around(response, side, around, help, reason)
}

/// Gives a control of a column a tip beside the panel `ui`.
pub fn beside(ui: &Ui, response: Response, help: &str) -> Response {
    explain(ui, response, Side::Beside, help, None)
}

/// Gives a row of a list or menu a tip beside that; `column` is where its rows are.
pub fn explain_in_column(response: Response, column: Rangef, help: &str, reason: Option<&str>) -> Response {
    let around = Rect::from_x_y_ranges(column.expand(EDGE), response.rect.y_range());
    explain_around(response, Side::Beside, around, help, reason)
}

fn explain_around(
    response: Response,
    side: Side,
    around: Rect,
    help: &str,
    reason: Option<&str>,
) -> Response {
    let window = response.ctx.content_rect();
    let usual = response.ctx.global_style().spacing.tooltip_width;
    let free = [around.left() - window.left(), window.right() - around.right()].map(|room| room - 2.0 * GAP);
    let is_right = free[1] >= usual.min(free[0]);
    let aligns: &'static [RectAlign; 2] = match side {
        Side::Beside if is_right => &[RectAlign::RIGHT_START, RectAlign::RIGHT_END],
        Side::Beside => &[RectAlign::LEFT_START, RectAlign::LEFT_END],
        Side::Above => &[RectAlign::TOP_START, RectAlign::TOP_END],
        Side::Below => &[RectAlign::BOTTOM_START, RectAlign::BOTTOM_END],
    };
    let width = match side {
        Side::Beside => usual.min(free[usize::from(is_right)]),
        Side::Above | Side::Below => usual,
    };
    if width < LEAST_WIDTH {
        return response;
    }
    let show = |mut tip: Tooltip<'_>, text: &str| {
        tip.popup = tip.popup.anchor(around).align(aligns[0]).align_alternatives(aligns).width(width);
        tip.show(|ui| ui.label(text));
    };
    if response.enabled() {
        if !help.is_empty() {
            show(Tooltip::for_enabled(&response), help);
        }
    } else {
        let parts: Vec<&str> =
            [Some(help).filter(|help| !help.is_empty()), reason].into_iter().flatten().collect();
        show(Tooltip::for_disabled(&response), &parts.join("\n\n"));
    }
    response
}
