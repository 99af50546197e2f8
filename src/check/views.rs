//! Mine, ours and the difference, as pictures.

use super::judge::Finding;
use super::picture::Mine;
use crate::heat::HeatScale;

/// The reader's picture, ours and a heat map of their difference, 8-bit RGB, row by row from the top.
pub fn pictures(mine: &Mine, finding: &Finding) -> [Vec<[u8; 3]>; 3] {
    let (width, height) = (mine.width as usize, mine.height as usize);
    let right = &finding.right;
    let expected = right.expected.pixels.iter().enumerate();
    let ours: Vec<[u8; 3]> = expected
        .map(|(index, pixel)| pixel.map(|x| right.hypothesis.byte_of(x, index / width, height)))
        .collect();
    let difference = mine.bytes.iter().zip(&ours).map(|(mine, ours)| {
        let square = |channel: usize| ((f64::from(mine[channel]) - f64::from(ours[channel])) / 255.0).powi(2);
        HeatScale::ERROR.colour(((square(0) + square(1) + square(2)) / 3.0).sqrt())
    });
    let difference = difference.collect();
    [mine.bytes.clone(), ours, difference]
}
