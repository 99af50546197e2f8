//! The size of the picture: that of the viewport, the book's, or its own.

use super::{Document, Origin, Source};
use crate::job::render::{RenderSettings, SIZE_LIMIT};
use crate::stages::Shading;
use serde::{Deserialize, Serialize};

/// How the size of a picture is chosen if it has none of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Sizing {
    /// As large as fits into the viewport, one pixel of the picture per pixel of the screen.
    #[default]
    Viewport,
    /// As large as in the book. Scenes that are not in the book have the size that they define.
    Book,
}

impl Origin {
    /// Whether its pictures have a size of their own: files do, and stages without rays, whose pixels are the lesson.
    pub fn keeps_size(&self) -> bool {
        let is_file = matches!(self.source, Source::File(_) | Source::Embedded);
        is_file || self.recipe.rules.shading == Shading::ImageGradient
    }

    /// The width and height that the scene defines, pixels.
    pub fn size(&self) -> [u32; 2] {
        let RenderSettings { width, height, .. } = self.recipe.settings;
        [width, height]
    }

    /// Width and height in the book, pixels; for other scenes, the size that they define.
    pub fn book_size(&self) -> [u32; 2] {
        match self.stage() {
            Some(stage) if !self.keeps_size() => scaled(self.size(), stage.book_width()),
            _ => self.size(),
        }
    }

    /// The largest size of the scene's aspect ratio in a room of `room` pixels. `None` if there is no room.
    pub fn size_in(&self, room: [u32; 2]) -> Option<[u32; 2]> {
        let room = room.map(|side| side.min(SIZE_LIMIT));
        let ([wide, high], [width, height]) = (self.size().map(u64::from), room.map(u64::from));
        let width = width.min(height * wide / high);
        let size = scaled(self.size(), u32::try_from(width).unwrap_or(SIZE_LIMIT));
        (width > 0).then_some([size[0], size[1].min(room[1])])
    }
}

/// A size of the same aspect ratio with another width.
fn scaled([wide, high]: [u32; 2], width: u32) -> [u32; 2] {
    let height = f64::from(width) * f64::from(high) / f64::from(wide);
    [width, (height.round() as u32).max(1)]
}

/// Where a picture of the size `theirs` lies over one of the size `mine`: its corner and its size, as shares of that.
/// One of another shape lies in the middle.
pub fn laid_over(mine: [u32; 2], theirs: [u32; 2]) -> [[f64; 2]; 2] {
    let stretch = [0, 1].map(|axis| f64::from(mine[axis]) / f64::from(theirs[axis]));
    let least = stretch[0].min(stretch[1]);
    // Sizes of one shape can differ by rounding.
    let is_same_shape = stretch[0].max(stretch[1]) < 1.02 * least;
    let size = if is_same_shape { [1.0; 2] } else { stretch.map(|along| least / along) };
    [size.map(|along| 0.5 * (1.0 - along)), size]
}

/// The middle of a pixel as a place in the picture, `0..=1` from the upper left.
pub fn middle_of(at: [u32; 2], size: [u32; 2]) -> [f64; 2] {
    [0, 1].map(|axis| (f64::from(at[axis]) + 0.5) / f64::from(size[axis]))
}

/// The pixel of such a picture that lies over the middle of the one at `at`.
pub fn at_other(at: [u32; 2], mine: [u32; 2], theirs: [u32; 2]) -> Option<[u32; 2]> {
    let ([corner, size], middle) = (laid_over(mine, theirs), middle_of(at, mine));
    let [x, y] = [0, 1].map(|axis| {
        let place = (middle[axis] - corner[axis]) / size[axis];
        // Rounding must not lead to the pixel before.
        let pixel = (place * f64::from(theirs[axis]) + 1e-6).floor();
        (pixel >= 0.0 && pixel < f64::from(theirs[axis])).then_some(pixel as u32)
    });
    Some([x?, y?])
}

impl Document {
    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.settings.width, self.settings.height]
    }

    /// Sets width and height, pixels; the picture still follows the viewport or the book if it does so now.
    pub fn set_size(&mut self, [width, height]: [u32; 2]) {
        (self.settings.width, self.settings.height) = (width, height);
    }

    /// Gives the picture this width and height, pixels, whatever size the viewport or the book has.
    pub fn give_size(&mut self, size: [u32; 2]) {
        self.set_size(size);
        self.has_own_size = true;
    }

    /// The size that the picture should have: its own, or else that of `sizing`. `room` is the room for it in the
    /// viewport, pixels of the screen. `None` if there is no room.
    pub fn fitting_size(&self, sizing: Sizing, room: [u32; 2]) -> Option<[u32; 2]> {
        match sizing {
            _ if self.has_own_size => Some(self.size()),
            Sizing::Viewport => self.origin.size_in(room),
            Sizing::Book => Some(self.origin.book_size()),
        }
    }

    /// The settings that the user chose: without a size that follows the viewport or the book.
    pub(super) fn chosen_settings(&self) -> RenderSettings {
        let [width, height] = if self.has_own_size { self.size() } else { [0; 2] };
        RenderSettings { width, height, ..self.settings }
    }

    /// Whether the documents differ at most in their size.
    pub fn is_same_at_another_size(&self, other: &Document) -> bool {
        let mut resized = self.clone();
        resized.set_size(other.size());
        resized.has_same_film(other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::Stage;

    fn stage(id: &str) -> Document {
        Document::new(Origin::of_stage(Stage::find(id).unwrap()))
    }

    #[test]
    fn the_picture_is_as_large_as_its_aspect_ratio_allows() {
        let document = stage("metal");
        for (room, size) in [
            ([1037, 900], [1037, 583]),
            ([3000, 583], [1036, 583]),
            ([1600, 900], [1600, 900]),
            ([1, 1], [1, 1]),
            ([100_000, 100_000], [16_384, 9216]),
        ] {
            let found = document.fitting_size(Sizing::Viewport, room).unwrap();
            assert_eq!(found, size, "{room:?}");
            assert!(found[0] <= room[0] && found[1] <= room[1]);
        }
        assert_eq!(document.fitting_size(Sizing::Viewport, [0, 500]), None);
        assert_eq!(document.fitting_size(Sizing::Viewport, [500, 0]), None);
    }

    #[test]
    fn pictures_of_other_shapes_are_read_where_drawn() {
        for (at, mine, theirs, expected) in [
            ([7, 3], [32, 18], [32, 18], Some([7, 3])),
            ([7, 3], [32, 18], [64, 36], Some([15, 7])),
            ([7, 3], [760, 428], [400, 225], Some([3, 1])),
            // Half as wide: in the middle.
            ([16, 9], [32, 18], [16, 18], Some([8, 9])),
            ([8, 9], [32, 18], [16, 18], Some([0, 9])),
            ([7, 9], [32, 18], [16, 18], None),
            ([24, 9], [32, 18], [16, 18], None),
        ] {
            assert_eq!(at_other(at, mine, theirs), expected, "{at:?} {mine:?} {theirs:?}");
        }
    }

    #[test]
    fn a_size_is_rounded_and_never_empty() {
        let size_in = |[width, height]: [u32; 2], room| {
            let mut recipe = Stage::find("metal").unwrap().recipe();
            (recipe.settings.width, recipe.settings.height) = (width, height);
            Origin::new(recipe, Source::Builtin).size_in(room)
        };
        for (size, room, expected) in [
            ([3, 2], [10, 7], Some([10, 7])),
            ([3, 2], [100, 5], Some([7, 5])),
            ([16, 9], [3, 1], Some([1, 1])),
            // A fifth of a row.
            ([1000, 10], [20, 20], Some([20, 1])),
            ([10, 1000], [20, 300], Some([3, 300])),
            ([10, 1000], [20, 99], None),
            // No picture is larger than the limit, and its sides keep their ratio.
            ([100, 200], [40_000, 60_000], Some([SIZE_LIMIT / 2, SIZE_LIMIT])),
            ([200, 100], [40_000, 60_000], Some([SIZE_LIMIT, SIZE_LIMIT / 2])),
        ] {
            assert_eq!(size_in(size, room), expected, "{size:?} in {room:?}");
        }
    }
}
