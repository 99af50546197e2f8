//! Marks a part of the picture: drags of its edges, its inside and anew, and how it looks.

use super::badge::badge;
use crate::app::command::Command;
use crate::app::model::crop::Crop;
use crate::app::theme;
use crate::output::OutputFormat;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::tests::dressed;
    use eframe::egui::{Event, Modifiers, Sense, Shape};
    use egui_kittest::Harness;

    const RECT: Rect = Rect { min: pos2(100.0, 50.0), max: pos2(420.0, 230.0) };
    const SIZE: [u32; 2] = [32, 18];

    /// The middle of a pixel on the screen, where each has 10 points.
    fn at(x: u32, y: u32) -> Pos2 {
        RECT.min + vec2(x as f32 + 0.5, y as f32 + 0.5) * 10.0
    }

    #[test]
    fn drags_mark_move_and_resize() {
        let go = |crop: Option<Crop>, from: Pos2, to: Pos2| {
            let drag = drag_at(RECT, SIZE, crop, from);
            dragged(drag, nearest_pixel(RECT, SIZE, to), SIZE)
        };
        let crop = go(None, at(4, 3), at(13, 8));
        assert_eq!((crop.first, crop.size), ([4, 3], [10, 6]));
        assert_eq!(on_screen(RECT, SIZE, crop), Rect::from_min_max(pos2(140.0, 80.0), pos2(240.0, 140.0)));
        let moved = go(Some(crop), at(8, 5), at(10, 4));
        assert_eq!((moved.first, moved.size), ([6, 2], [10, 6]));
        // The right edge is between the pixels 13 and 14.
        let wider = go(Some(crop), pos2(240.0, 110.0), at(20, 0));
        assert_eq!((wider.first, wider.size), ([4, 3], [17, 6]));
        let corner = go(Some(crop), pos2(140.0, 80.0), at(2, 1));
        assert_eq!((corner.first, corner.last()), ([2, 1], [13, 8]));
        let over = go(Some(crop), pos2(140.0, 110.0), at(15, 0));
        assert_eq!((over.first, over.last()), ([13, 3], [15, 8]), "an edge over the other one");
        let anew = go(Some(crop), at(25, 15), pos2(9e3, 9e3));
        assert_eq!((anew.first, anew.last()), ([25, 15], [31, 17]), "no pixel beyond the last");
    }

    #[test]
    fn the_pointer_shows_what_a_drag_does() {
        let crop = Some(Crop { first: [4, 3], size: [10, 6] });
        let over = |x: f32, y: f32| cursor(drag_at(RECT, SIZE, crop, pos2(x, y)), false);
        assert_eq!(over(350.0, 200.0), CursorIcon::Crosshair);
        assert_eq!(over(190.0, 110.0), CursorIcon::Grab);
        assert_eq!([over(140.0, 110.0), over(240.0, 110.0)], [CursorIcon::ResizeHorizontal; 2]);
        assert_eq!([over(190.0, 80.0), over(190.0, 140.0)], [CursorIcon::ResizeVertical; 2]);
        assert_eq!([over(140.0, 80.0), over(240.0, 140.0)], [CursorIcon::ResizeNwSe; 2]);
        assert_eq!([over(240.0, 80.0), over(140.0, 140.0)], [CursorIcon::ResizeNeSw; 2]);
    }

    #[test]
    fn the_size_of_a_part_is_told_within_what_is_seen_of_it() {
        // The picture is larger than the viewport.
        let (seen, rect) = (RECT, RECT.expand(200.0));
        let crop = Crop { first: [0, 0], size: SIZE };
        let harness = Harness::builder().with_size([600.0, 300.0]).build_ui(|ui| {
            paint(ui, &ui.painter().with_clip_rect(seen), rect, SIZE, Some(crop));
        });
        let top = harness.output().shapes.iter().find_map(|clipped| match &clipped.shape {
            Shape::Text(text) if text.galley.text() == crop.words() => Some(text.pos.y),
            _ => None,
        });
        assert!(seen.y_range().contains(top.unwrap()), "{top:?}");
    }

    #[test]
    fn the_nearest_edge_within_reach_is_grabbed() {
        let crop = Crop { first: [4, 3], size: [10, 6] };
        // The part covers 140 to 240 points across and 80 to 140 points down.
        for (at, expected) in [
            (pos2(140.0 - GRIP + 0.5, 110.0), Drag::Edges(crop, [Some(13), None])),
            (pos2(140.0 - GRIP - 0.5, 110.0), Drag::New([3, 6])),
            (pos2(140.0 + GRIP + 0.5, 110.0), Drag::Move(crop, [4, 6])),
            (pos2(240.0 + GRIP - 0.5, 110.0), Drag::Edges(crop, [Some(4), None])),
            (pos2(240.0 + GRIP + 0.5, 110.0), Drag::New([14, 6])),
            (pos2(190.0, 80.0 - GRIP + 0.5), Drag::Edges(crop, [None, Some(8)])),
            (pos2(190.0, 80.0 - GRIP - 0.5), Drag::New([9, 2])),
            (pos2(190.0, 140.0 + GRIP - 0.5), Drag::Edges(crop, [None, Some(3)])),
        ] {
            assert_eq!(drag_at(RECT, SIZE, Some(crop), at), expected, "{at}");
        }
        // Half as large, a part that is two pixels wide has both edges near.
        let narrow = Crop { first: [8, 6], size: [2, 12] };
        for (x, stays) in [(144.0, 9), (146.0, 8)] {
            let found = drag_at(RECT, [64, 36], Some(narrow), pos2(x, 110.0));
            assert_eq!(found, Drag::Edges(narrow, [Some(stays), None]), "{x}");
        }
    }

    #[derive(Default)]
    struct Picture {
        cropping: Cropping,
        crop: Option<Crop>,
    }

    fn picture(crop: Option<Crop>) -> Harness<'static, Picture> {
        let draw = |ui: &mut Ui, Picture { cropping, crop }: &mut Picture| {
            let response = ui.allocate_rect(RECT, Sense::click_and_drag());
            cropping.handle(ui, &response, RECT, SIZE, crop);
            paint(ui, ui.painter(), RECT, SIZE, *crop);
        };
        dressed([500.0, 300.0]).build_ui_state(draw, Picture { crop, ..Picture::default() })
    }

    fn drag(harness: &mut Harness<'_, Picture>, from: Pos2, to: Pos2, modifiers: Modifiers) {
        let press = |pos, pressed| {
            let button = PointerButton::Primary;
            Event::PointerButton { pos, button, pressed, modifiers }
        };
        harness.event(Event::PointerMoved(from));
        harness.event_modifiers(press(from, true), modifiers);
        harness.event_modifiers(Event::PointerMoved(to), modifiers);
        harness.run_steps(1);
    }

    #[test]
    fn a_part_is_what_is_left_of_it_in_a_smaller_picture() {
        let mut harness = picture(Some(Crop { first: [30, 3], size: [10, 6] }));
        harness.run_steps(1);
        assert_eq!(harness.state().crop, Some(Crop { first: [30, 3], size: [2, 6] }));
        harness.state_mut().crop = Some(Crop { first: [32, 3], size: [10, 6] });
        harness.run_steps(1);
        assert_eq!(harness.state().crop, None);
    }
}
