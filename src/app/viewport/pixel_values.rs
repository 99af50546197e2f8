//! The numbers of pixels, drawn in them when they are large.

use crate::app::toolkit::Query;
use crate::app::toolkit::widgets::compact;
use crate::app::tracing::subject::{PictureId, Subject};
use crate::progressive::luminance;
use eframe::egui::{self, Align2, Color32, Rect, TextStyle, Ui, vec2};

/// The smallest side of a pixel, in points, in which its numbers have room.
const ROOM: f32 = 44.0;

/// A part of the film's picture.
struct Part {
    first: [u32; 2],
    width: u32,
    /// Linear RGB, row by row.
    means: Vec<[f64; 3]>,
}

/// The numbers of the visible pixels.
#[derive(Default)]
pub struct PixelValues {
    /// By film, samples and pixels.
    query: Query<(PictureId, u64, [[u32; 2]; 2]), Part>,
}

impl PixelValues {
    /// Takes the film's answer, and asks again if other pixels are visible or have changed. The picture is drawn at `rect`;
    /// `area` is the viewport.
    pub fn follow(&mut self, subject: &Subject<'_>, rect: Rect, area: Option<Rect>, context: &egui::Context) {
        self.query.follow();
        let visible = area.and_then(|area| visible(rect, area, subject.document.size()));
        let Some([first, end]) = visible.filter(|_| subject.has_samples()) else {
            *self = PixelValues::default();
            return;
        };
        let key = (subject.id(), subject.samples(), [first, end]);
        subject.ask(context, &mut self.query, key, move |film| {
            let means = (first[1]..end[1].min(film.height()))
                .flat_map(|y| (first[0]..end[0].min(film.width())).map(move |x| [x, y]))
                .map(|[x, y]| film.mean(y as usize * film.width() as usize + x as usize))
                .collect();
            Some(Part { first, width: end[0] - first[0], means })
        });
    }

    /// Draws the numbers over the picture at `rect`, which has `size` pixels of these colours.
    pub fn paint(
        &self,
        ui: &Ui,
        clip: Rect,
        rect: Rect,
        size: [u32; 2],
        colour: impl Fn([u32; 2]) -> Option<[u8; 3]>,
    ) {
        let Some(part) = self.query.answer.as_ref().filter(|_| visible(rect, clip, size).is_some()) else {
            return;
        };
        let side = rect.width() / size[0] as f32;
        let painter = ui.painter().with_clip_rect(clip);
        let font = TextStyle::Small.resolve(ui.style());
        for (place, mean) in part.means.iter().enumerate() {
            let place = [place as u32 % part.width, place as u32 / part.width];
            let at = [0, 1].map(|axis| part.first[axis] + place[axis]);
            let middle = rect.min + vec2(at[0] as f32 + 0.5, at[1] as f32 + 0.5) * side;
            let Some(ground) = colour(at) else { continue };
            let colour = readable_on(ground);
            for (row, value) in mean.iter().enumerate() {
                let down = (row as f32 - 1.0) * (font.size + 1.0);
                painter.text(
                    middle + vec2(0.0, down),
                    Align2::CENTER_CENTER,
                    compact(*value),
                    font.clone(),
                    colour,
                );
            }
        }
    }
}

/// Black or white, whichever contrasts more with an sRGB colour (WCAG 2).
fn readable_on(ground: [u8; 3]) -> Color32 {
    let [red, green, blue, _] =
        egui::Rgba::from(Color32::from_rgb(ground[0], ground[1], ground[2])).to_array();
    let luminance = luminance([red, green, blue].map(f64::from));
    // The contrast is (brighter + 0.05) / (darker + 0.05).
    if (luminance + 0.05).powi(2) > 1.05 * 0.05 { Color32::BLACK } else { Color32::WHITE }
}

/// The first visible pixel of a picture of `size` pixels at `rect`, and the one after the last. `None` if pixels have no
/// room for numbers, or none is visible.
fn visible(rect: Rect, area: Rect, size: [u32; 2]) -> Option<[[u32; 2]; 2]> {
    let side = rect.width() / size[0] as f32;
    let seen = rect.intersect(area);
    if side < ROOM || !seen.is_positive() {
        return None;
    }
    let (from, to) = ((seen.min - rect.min) / side, (seen.max - rect.min) / side);
    let first = [from.x.floor() as u32, from.y.floor() as u32];
    Some([first, [(to.x.ceil() as u32).min(size[0]), (to.y.ceil() as u32).min(size[1])]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn numbers_are_readable_on_the_colour_that_is_shown() {
        for (ground, expected) in [
            ([140, 0, 0], Color32::WHITE),
            ([0, 100, 0], Color32::WHITE),
            ([0, 0, 255], Color32::WHITE),
            ([204, 0, 0], Color32::WHITE),
            ([255, 0, 0], Color32::BLACK),
            ([0, 160, 0], Color32::BLACK),
            ([128, 128, 128], Color32::BLACK),
        ] {
            assert_eq!(readable_on(ground), expected, "{ground:?}");
        }
    }

    #[test]
    fn only_large_pixels_in_sight_have_numbers() {
        let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(800.0, 500.0));
        let area = Rect::from_min_size(pos2(150.0, 250.0), vec2(200.0, 200.0));
        assert_eq!(visible(rect, area, [8, 5]), Some([[1, 2], [4, 5]]));
        assert_eq!(visible(rect, area, [80, 50]), None);
        assert_eq!(visible(rect, area.translate(vec2(800.0, 0.0)), [8, 5]), None);
    }
}
