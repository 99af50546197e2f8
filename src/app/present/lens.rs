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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::tests::part;

    #[test]
    fn numbers_have_three_decimals() {
        assert_eq!([0.6666, 0.0005, 0.1234, 12.3456].map(rounded), [0.667, 0.001, 0.123, 12.346]);
    }

    #[test]
    fn the_lens_shows_the_pixel_and_its_neighbours() {
        let picture = |[x, y]: [u32; 2]| (x < 32 && y < 18).then_some([x as u8, y as u8, 7]);
        let seen = Seen::around([10, 5], Some([0.25, 1.0 / 3.0, 0.0]), picture);
        assert_eq!(seen.colours.len(), 81);
        assert_eq!(seen.colour(), Some([10, 5, 7]));
        assert_eq!((seen.colours[0], seen.colours[80]), (Some([6, 1, 7]), Some([14, 9, 7])));
        assert_eq!(seen.lines(), ["x 10   y 5", "R  10   0.25", "G   5   0.333", "B   7   0"]);
        let corner = Seen::around([0, 17], None, picture);
        assert_eq!((corner.colour(), corner.colours[0], corner.colours[80]), (Some([0, 17, 7]), None, None));
        assert_eq!(corner.colours.iter().flatten().count(), 25);
    }

    #[test]
    fn the_lens_does_not_cover_what_it_shows() {
        let context = Context::default();
        let room = Rect::from_min_size(pos2(0.0, 50.0), vec2(1000.0, 600.0));
        let size = vec2(200.0, 260.0);
        // A picture as wide as the room, and one that is enlarged beyond it.
        for picture in [room, room.expand(300.0)] {
            for x in [10.0, 450.0, 550.0, 990.0] {
                let pointer = pos2(x, 350.0);
                let plate = beside(&context, room, picture, pointer, size);
                assert!(room.contains_rect(plate) && !plate.contains(pointer), "{plate} at {pointer}");
                assert!((plate.center().x - x).abs() > 300.0, "on the other side: {plate} at {pointer}");
            }
        }
        let narrow = Rect { max: pos2(600.0, 650.0), ..room };
        let plate = beside(&context, room, narrow, pos2(100.0, 350.0), size);
        assert!(plate.left() > narrow.right() && plate.right() < room.right(), "{plate}");
    }
}
