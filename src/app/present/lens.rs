//! The pixel under the pointer, large: it and its neighbours as squares, and its numbers.

use super::unit::unit;
use crate::app::theme;
use crate::app::widgets::compact;
use eframe::egui::{
    Align2, Color32, Context, CornerRadius, FontFamily, FontId, Pos2, Rect, Stroke, StrokeKind, Ui, Vec2,
    pos2, vec2,
};

/// Pixels on a side.
const SIDE: u32 = 9;

/// The side of a pixel in hundredths of the window's height, at least and at most.
const PIXEL: [f32; 2] = [2.1, 2.7];

/// Size of the numbers in hundredths of the window's height.
const TEXT: f32 = 2.4;

/// What is under the pointer.
pub struct Seen {
    /// The pixel, column and row from the upper left.
    pub at: [u32; 2],
    /// The pixel and its neighbours, row by row; `None` beyond the picture.
    pub colours: Vec<Option<[u8; 3]>>,
    /// Linear radiance, if it is known.
    pub mean: Option<[f64; 3]>,
}

impl Seen {
    /// The pixel `at` with its neighbours; `colour` gives the colour of a pixel of the picture.
    pub fn around(
        at: [u32; 2],
        mean: Option<[f64; 3]>,
        colour: impl Fn([u32; 2]) -> Option<[u8; 3]>,
    ) -> Self {
        let reach = SIDE / 2;
        let colours = (0..SIDE)
            .flat_map(|row| (0..SIDE).map(move |column| [column, row]))
            .map(|[column, row]| {
                let x = (at[0] + column).checked_sub(reach)?;
                let y = (at[1] + row).checked_sub(reach)?;
                colour([x, y])
            })
            .collect();
        Seen { at, colours, mean }
    }

    /// The pixel's own colour.
    fn colour(&self) -> Option<[u8; 3]> {
        self.colours.get(self.colours.len() / 2).copied().flatten()
    }

    /// The lines of text.
    fn lines(&self) -> Vec<String> {
        let [x, y] = self.at;
        let mut lines = vec![format!("x {x}   y {y}")];
        let bytes = self.colour();
        for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
            let byte = bytes.map_or_else(String::new, |bytes| format!("{:>3}", bytes[channel]));
            let mean =
                self.mean.map_or_else(String::new, |mean| format!("   {}", compact(rounded(mean[channel]))));
            lines.push(format!("{name} {byte}{mean}"));
        }
        lines
    }
}

/// To three decimals.
fn rounded(value: f64) -> f64 {
    (1e3 * value).round() / 1e3
}

/// Where the lens is, and what it shows.
pub struct Lens<'a> {
    /// The area of the viewport.
    pub room: Rect,
    /// The picture in it.
    pub picture: Rect,
    pub pointer: Pos2,
    pub seen: &'a Seen,
}

impl Lens<'_> {
    /// Draws it beside the picture, or where it does not cover the pointer.
    pub fn paint(&self, ui: &Ui) {
        let Lens { room, picture, pointer, seen } = self;
        let (unit, lines) = (unit(ui.ctx()), seen.lines());
        let (line, pad) = (1.35 * TEXT * unit, unit);
        let slack = room.right() - picture.right() - 4.0 * pad;
        let [least, most] = PIXEL.map(|side| side * unit);
        // Smaller beside the picture rather than on it.
        let side = if slack < SIDE as f32 * least { most } else { (slack / SIDE as f32).min(most) };
        let squares = side * SIDE as f32;
        let size = vec2(squares + 2.0 * pad, squares + line * lines.len() as f32 + 2.5 * pad);
        let plate = beside(ui.ctx(), *room, *picture, *pointer, size);
        let painter = ui.painter().with_clip_rect(*room);
        painter.rect_filled(plate, CornerRadius::same(6), ui.visuals().panel_fill.gamma_multiply(0.94));
        let corner = plate.min + vec2(pad, pad);
        for (place, colour) in seen.colours.iter().enumerate() {
            let Some([red, green, blue]) = *colour else { continue };
            let [column, row] = [place as u32 % SIDE, place as u32 / SIDE].map(|along| along as f32);
            let square = Rect::from_min_size(corner + vec2(column, row) * side, vec2(side, side));
            painter.rect_filled(square, 0.0, Color32::from_rgb(red, green, blue));
        }
        let middle =
            Rect::from_min_size(corner + vec2(1.0, 1.0) * side * (SIDE / 2) as f32, vec2(side, side));
        painter.rect_stroke(middle, 0.0, Stroke::new(0.5 * unit, Color32::BLACK), StrokeKind::Outside);
        painter.rect_stroke(middle, 0.0, Stroke::new(0.25 * unit, Color32::WHITE), StrokeKind::Outside);
        let font = FontId::new(TEXT * unit, FontFamily::Monospace);
        let (strong, accent) = (ui.visuals().strong_text_color(), theme::accent(ui));
        for (row, text) in lines.iter().enumerate() {
            let colour = if row == 0 { accent } else { strong };
            let at = corner + vec2(0.0, squares + 0.5 * pad + line * row as f32);
            painter.text(at, Align2::LEFT_TOP, text, font.clone(), colour);
        }
    }
}

/// A rectangle of this size at the right of the picture; if there is no room, at that edge of the picture which is
/// farther from the pointer, where neither titles nor scales are.
fn beside(context: &Context, room: Rect, picture: Rect, pointer: Pos2, size: Vec2) -> Rect {
    let gap = unit(context);
    let slack = room.right() - picture.right();
    if slack >= size.x + 1.9 * gap {
        let middle = pos2(0.5 * (picture.right() + room.right()), room.center().y);
        return Rect::from_center_size(middle, size);
    }
    let seen = picture.intersect(room);
    let (side, anchor) = if pointer.x < seen.center().x {
        (seen.right_center() - vec2(gap, 0.0), Align2::RIGHT_CENTER)
    } else {
        (seen.left_center() + vec2(gap, 0.0), Align2::LEFT_CENTER)
    };
    anchor.anchor_size(side, size)
}
