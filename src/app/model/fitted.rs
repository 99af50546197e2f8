//! A picture scaled to the place of another one, for a wipe.

/// Where a picture lies that is scaled to the place of another one, as large as possible and in the middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    mine: [u32; 2],
    theirs: [u32; 2],
    /// The share of the width and of the height that the scaled picture covers.
    covered: [f64; 2],
}

impl Fitted {
    /// A picture of `theirs` pixels in the place of one of `mine`; both are across and down.
    pub fn new(theirs: [u32; 2], mine: [u32; 2]) -> Self {
        let ratios = [0, 1].map(|axis| f64::from(mine[axis]) / f64::from(theirs[axis]));
        let scale = ratios[0].min(ratios[1]);
        let covered = [0, 1].map(|axis| {
            let free = f64::from(mine[axis]) - scale * f64::from(theirs[axis]);
            // Sizes of one aspect ratio are rounded to whole pixels.
            if free < 1.0 { 1.0 } else { scale / ratios[axis] }
        });
        Fitted { mine, theirs, covered }
    }

    /// The place: left, top, right and bottom as shares of the other picture's width and height.
    pub fn part(&self) -> [f64; 4] {
        let [x, y] = self.covered.map(|share| 0.5 - 0.5 * share);
        [x, y, 1.0 - x, 1.0 - y]
    }

    /// Whether the pictures have the same size.
    pub fn is_exact(&self) -> bool {
        self.mine == self.theirs
    }

    /// The pixel of the scaled picture at the middle of a pixel of the other one; `None` beside the scaled picture.
    pub fn pixel(&self, at: [u32; 2]) -> Option<[u32; 2]> {
        let share = [0, 1].map(|axis| {
            let share = (f64::from(at[axis]) + 0.5) / f64::from(self.mine[axis]);
            (share - 0.5) / self.covered[axis] + 0.5
        });
        let is_inside = share.iter().all(|share| (0.0..1.0).contains(share));
        is_inside.then(|| [0, 1].map(|axis| (share[axis] * f64::from(self.theirs[axis])) as u32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_of_another_shape_has_bars() {
        let square = Fitted::new([64, 64], [128, 72]);
        assert_eq!(square.part(), [0.21875, 0.0, 0.78125, 1.0]);
        // 28 pixels at the left and at the right are bars.
        assert_eq!(
            [27, 28, 99, 100].map(|x| square.pixel([x, 0]).map(|[x, _]| x)),
            [None, Some(0), Some(63), None]
        );
        assert_eq!([0, 36, 71].map(|y| square.pixel([64, y]).map(|[_, y]| y)), [Some(0), Some(32), Some(63)]);
        let wide = Fitted::new([160, 90], [90, 90]);
        assert_eq!(wide.part(), [0.0, 0.21875, 1.0, 0.78125]);
        assert_eq!((wide.pixel([0, 0]), wide.pixel([45, 45])), (None, Some([80, 45])));
    }
}
