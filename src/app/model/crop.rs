//! A part of the picture to copy or to save.

/// Pixels of the picture: a rectangle that is not empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// The first column and row.
    pub first: [u32; 2],
    /// Pixels across and down.
    pub size: [u32; 2],
}

impl Crop {
    /// The smallest rectangle that holds both pixels.
    pub fn between(a: [u32; 2], b: [u32; 2]) -> Self {
        Crop {
            first: [0, 1].map(|axis| a[axis].min(b[axis])),
            size: [0, 1].map(|axis| a[axis].abs_diff(b[axis]) + 1),
        }
    }

    /// The last column and row.
    pub fn last(&self) -> [u32; 2] {
        [0, 1].map(|axis| self.first[axis] + self.size[axis] - 1)
    }

    /// The rectangle moved by this many pixels, as far as a picture of `size` pixels has room.
    pub fn moved(&self, by: [i64; 2], size: [u32; 2]) -> Self {
        let first = [0, 1].map(|axis| {
            let room = i64::from(size[axis].saturating_sub(self.size[axis]));
            (i64::from(self.first[axis]) + by[axis]).clamp(0, room) as u32
        });
        Crop { first, ..*self }
    }

    /// What is left of it in a picture of `size` pixels.
    pub fn within(&self, size: [u32; 2]) -> Option<Self> {
        let is_inside = (0..2).all(|axis| self.first[axis] < size[axis]);
        let left = [0, 1].map(|axis| self.size[axis].min(size[axis].saturating_sub(self.first[axis])));
        is_inside.then_some(Crop { size: left, ..*self })
    }

    /// Its size and its place, such as `300x200 at 120,40`.
    pub fn words(&self) -> String {
        let ([x, y], [width, height]) = (self.first, self.size);
        format!("{width}x{height} at {x},{y}")
    }
}
