//! Marks a part of the picture: drags of its edges, its inside and anew, and how it looks.

use super::badge::badge;
use crate::app::command::Command;
use crate::app::model::crop::Crop;
use crate::app::theme;
use crate::job::output::OutputFormat;
use eframe::egui::{
    Align2, Color32, CursorIcon, Painter, PointerButton, Pos2, Rect, Response, Stroke, StrokeKind, TextStyle,
    Ui, pos2, vec2,
};

/// How close the pointer must be to an edge to grab it, in points.
const GRIP: f32 = 7.0;

/// What a drag does.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Drag {
    /// It marks a part that begins at this pixel.
    New([u32; 2]),
    /// It moves the part that was there, from this pixel.
    Move(Crop, [u32; 2]),
    /// It moves edges of the part that was there. Along each axis, the pixel that stays; `None` if neither edge moves.
    Edges(Crop, [Option<u32>; 2]),
}

/// The drag that marks a part of the picture.
#[derive(Default)]
pub(super) struct Cropping {
    drag: Option<Drag>,
}

impl Cropping {
    /// Handles drags with the primary button in the picture at `rect`, which has `size` pixels.
    pub(super) fn handle(
        &mut self,
        ui: &Ui,
        response: &Response,
        rect: Rect,
        size: [u32; 2],
        crop: &mut Option<Crop>,
    ) {
        *crop = crop.and_then(|crop| crop.within(size));
        let origin = ui.input(|input| input.pointer.press_origin());
        if response.drag_started_by(PointerButton::Primary)
            && !ui.input(|input| input.modifiers.shift)
            && let Some(at) = origin
        {
            self.drag = Some(drag_at(rect, size, *crop, at));
        }
        match (self.drag, response.interact_pointer_pos()) {
            (Some(drag), Some(at)) if response.dragged_by(PointerButton::Primary) => {
                *crop = Some(dragged(drag, nearest_pixel(rect, size, at), size));
                ui.ctx().set_cursor_icon(cursor(drag, true));
            }
            _ => {
                self.drag = None;
                if let Some(at) = response.hover_pos() {
                    ui.ctx().set_cursor_icon(cursor(drag_at(rect, size, *crop, at), false));
                }
            }
        }
    }
}

/// What a drag from this point of the screen does.
fn drag_at(rect: Rect, size: [u32; 2], crop: Option<Crop>, at: Pos2) -> Drag {
    let pixel = nearest_pixel(rect, size, at);
    let Some(crop) = crop else { return Drag::New(pixel) };
    let drawn = on_screen(rect, size, crop);
    let (low, high) = (drawn.min.to_vec2(), drawn.max.to_vec2());
    let kept = [0, 1].map(|axis| {
        let (from, to) = (at.to_vec2()[axis] - low[axis], high[axis] - at.to_vec2()[axis]);
        match (from.abs() < GRIP, to.abs() < GRIP) {
            (true, is_upper) if !is_upper || from < to => Some(crop.last()[axis]),
            (_, true) => Some(crop.first[axis]),
            _ => None,
        }
    });
    if !drawn.expand(GRIP).contains(at) {
        Drag::New(pixel)
    } else if kept == [None; 2] {
        Drag::Move(crop, pixel)
    } else {
        Drag::Edges(crop, kept)
    }
}

/// The part that is marked when the pointer has come to this pixel.
fn dragged(drag: Drag, pixel: [u32; 2], size: [u32; 2]) -> Crop {
    match drag {
        Drag::New(from) => Crop::between(from, pixel),
        Drag::Move(crop, from) => {
            crop.moved([0, 1].map(|axis| i64::from(pixel[axis]) - i64::from(from[axis])), size)
        }
        Drag::Edges(crop, kept) => {
            let (first, last) = (crop.first, crop.last());
            let a = [0, 1].map(|axis| kept[axis].unwrap_or(first[axis]));
            let b = [0, 1].map(|axis| if kept[axis].is_some() { pixel[axis] } else { last[axis] });
            Crop::between(a, b)
        }
    }
}

fn cursor(drag: Drag, is_held: bool) -> CursorIcon {
    match drag {
        Drag::New(_) => CursorIcon::Crosshair,
        Drag::Move(..) if is_held => CursorIcon::Grabbing,
        Drag::Move(..) => CursorIcon::Grab,
        Drag::Edges(_, [Some(_), None]) => CursorIcon::ResizeHorizontal,
        Drag::Edges(_, [None, Some(_)]) => CursorIcon::ResizeVertical,
        Drag::Edges(crop, [Some(x), Some(y)]) => {
            let is_falling = (x == crop.first[0]) == (y == crop.first[1]);
            if is_falling { CursorIcon::ResizeNwSe } else { CursorIcon::ResizeNeSw }
        }
        Drag::Edges(_, [None, None]) => CursorIcon::Default,
    }
}

/// The pixel that is nearest to a point of the screen.
fn nearest_pixel(rect: Rect, size: [u32; 2], at: Pos2) -> [u32; 2] {
    let along = (at - rect.min) / rect.size();
    [0, 1].map(|axis| {
        let pixels = size[axis] as f32;
        ((along[axis] * pixels).floor().clamp(0.0, pixels - 1.0)) as u32
    })
}

/// Where a part of the picture at `rect` is on the screen.
fn on_screen(rect: Rect, size: [u32; 2], crop: Crop) -> Rect {
    let point = |pixel: [u32; 2]| {
        let share = vec2(pixel[0] as f32 / size[0] as f32, pixel[1] as f32 / size[1] as f32);
        rect.min + share * rect.size()
    };
    Rect::from_min_max(point(crop.first), point(crop.last().map(|last| last + 1)))
}

/// Draws the part of the picture at `rect`, with its size and place, and says how to mark one.
pub(super) fn paint(ui: &Ui, painter: &Painter, rect: Rect, size: [u32; 2], crop: Option<Crop>) {
    let seen = rect.intersect(painter.clip_rect());
    let font = TextStyle::Body.resolve(ui.style());
    let Some(crop) = crop else {
        painter.rect_filled(seen, 0.0, Color32::from_black_alpha(70));
        let words = "Drag over the part to copy or save; Escape leaves";
        badge(ui, painter, seen.center_top() + vec2(0.0, 36.0), Align2::CENTER_TOP, words, &font);
        return;
    };
    let part = on_screen(rect, size, crop);
    let shade = Color32::from_black_alpha(140);
    let inner = part.intersect(seen);
    for beside in [
        Rect { max: pos2(seen.right(), inner.top()), ..seen },
        Rect { min: pos2(seen.left(), inner.bottom()), ..seen },
        Rect { min: pos2(seen.left(), inner.top()), max: pos2(inner.left(), inner.bottom()) },
        Rect { min: pos2(inner.right(), inner.top()), max: pos2(seen.right(), inner.bottom()) },
    ] {
        if beside.is_positive() {
            painter.rect_filled(beside, 0.0, shade);
        }
    }
    painter.rect_stroke(part, 0.0, Stroke::new(3.0, Color32::from_black_alpha(150)), StrokeKind::Outside);
    painter.rect_stroke(part, 0.0, Stroke::new(1.5, Color32::WHITE), StrokeKind::Outside);
    for corner in [part.left_top(), part.right_top(), part.left_bottom(), part.right_bottom()] {
        let handle = Rect::from_center_size(corner, vec2(7.0, 7.0));
        painter.rect(handle, 1.0, Color32::WHITE, Stroke::new(1.0, theme::accent(ui)), StrokeKind::Outside);
    }
    // Above the part if there is room, else in it.
    let words = crop.words();
    let (at, anchor) = if part.top() - seen.top() > 30.0 {
        (part.center_top() - vec2(0.0, 8.0), Align2::CENTER_BOTTOM)
    } else {
        (pos2(part.center().x, part.top().max(seen.top()) + 8.0), Align2::CENTER_TOP)
    };
    badge(ui, painter, at, anchor, &words, &font);
    let keys = |command: Command| command.keys(ui.ctx()).unwrap_or_default();
    let hint = format!(
        "{} copies it, {} saves it as PNG, Escape leaves",
        keys(Command::CopyPicture),
        keys(Command::Save(OutputFormat::Png))
    );
    badge(ui, painter, seen.left_bottom() + vec2(8.0, -8.0), Align2::LEFT_BOTTOM, &hint, &font);
}
