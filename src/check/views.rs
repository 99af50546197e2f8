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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::compared::compare;
    use crate::check::hypothesis::{Expected, Hypothesis};
    use crate::stages::{Stage, Transfer};

    #[test]
    fn the_difference_is_the_root_mean_square_of_the_channels() {
        let stage = Stage::find("sky").unwrap();
        let mut recipe = stage.recipe();
        recipe.rules.transfer = Transfer::LinearAboveGamma2;
        let bytes = vec![[64, 64, 64], [64, 79, 64], [128, 128, 128], [0, 255, 128]];
        let mine = Mine { width: 2, height: 2, bytes: bytes.clone(), format: "P3", damages: Vec::new() };
        let expected = Expected { pixels: vec![[0.25; 3]; 4] };
        let right = compare(&mine, Hypothesis::right(&recipe), expected);
        let [shown, ours, difference] = pictures(&mine, &Finding { stage, right, mistake: None });
        assert_eq!(shown, bytes);
        // The upper row is linear, the lower row the square root.
        assert_eq!(ours, [[64; 3], [64; 3], [128; 3], [128; 3]]);
        let colour = |squares: f64| HeatScale::ERROR.colour((squares / 3.0).sqrt() / 255.0);
        let squares = [0.0, 15.0_f64.powi(2), 0.0, 128.0_f64.powi(2) + 127.0_f64.powi(2)];
        assert_eq!(difference, squares.map(colour));
    }
}
