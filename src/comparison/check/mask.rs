//! Masks: some of the pixels of a picture.

/// The mask with all pixels next to it.
pub fn grown(mask: &[bool], [width, height]: [usize; 2]) -> Vec<bool> {
    let near = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
    let is_near = |pixel: usize| {
        near(pixel / width, height).any(|y| near(pixel % width, width).any(|x| mask[y * width + x]))
    };
    (0..mask.len()).map(is_near).collect()
}

/// A mask of squares of `factor` x `factor` pixels as one of pixels. Incomplete squares at the right and the bottom are
/// like those beside them.
pub fn enlarged<T: Copy>(mask: &[T], [width, height]: [usize; 2], factor: usize) -> Vec<T> {
    let (columns, rows) = (width / factor, height / factor);
    let at = |pixel: usize| {
        let (x, y) = (pixel % width / factor, pixel / width / factor);
        mask[y.min(rows - 1) * columns + x.min(columns - 1)]
    };
    (0..width * height).map(at).collect()
}
