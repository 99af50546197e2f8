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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crop_holds_both_corners() {
        for (a, b) in [([2, 9], [5, 3]), ([5, 3], [2, 9]), ([5, 9], [2, 3])] {
            let crop = Crop::between(a, b);
            assert_eq!((crop.first, crop.size, crop.last()), ([2, 3], [4, 7], [5, 9]));
        }
        assert_eq!(Crop::between([7, 7], [7, 7]).words(), "1x1 at 7,7");
    }

    #[test]
    fn a_crop_stays_in_the_picture() {
        let crop = Crop { first: [2, 3], size: [4, 7] };
        assert_eq!(crop.moved([3, -1], [32, 18]).first, [5, 2]);
        assert_eq!(crop.moved([-3, 99], [32, 18]).first, [0, 11]);
        assert_eq!(crop.moved([1, 1], [3, 5]).first, [0, 0], "a picture that is too small");
        assert_eq!(crop.within([32, 18]), Some(crop));
        assert_eq!(crop.within([4, 18]), Some(Crop { size: [2, 7], ..crop }));
        assert_eq!(crop.within([2, 18]), None);
    }
}
