//! Changes of a picture that make it much closer to another: mistakes of a file rather than of the light.

use crate::comparison::Picture;
use crate::job::output::Encoding;
use crate::stages::Transfer;

/// A hint follows if a change leaves less than this share of the difference.
const MUCH: f64 = 0.5;

/// Maximum number of pixels compared. In a larger picture, they are spread evenly.
const MOST: usize = 1 << 20;

/// Names the change that brings the second picture much closer to the first.
pub(super) fn hint(a: &Picture, b: &Picture) -> Option<String> {
    let [width, height] = [b.width, b.height].map(|side| side as usize);
    let at = |x: usize, y: usize| b.pixels[y.min(height - 1) * width + x.min(width - 1)];
    let right = |x: usize| width - 1 - x;
    let below = |y: usize| height - 1 - y;
    let factor = factor(a, b);
    let square_root = |x: f64| Encoding::Book(Transfer::Gamma2).displayed(x.max(0.0), 0, 1);
    let of_srgb = |x: f64| {
        // Integers have been read as square roots.
        let shown = if b.limit.is_finite() { square_root(x) } else { x };
        Encoding::Srgb.linear(shown.clamp(0.0, 1.0), 0, 1)
    };
    let bright = format!("the second is made {factor:.4} times as bright");
    // The pixel in a column and row of the second picture after each change. The first of equally good ones is named.
    type Change<'a> = &'a dyn Fn(usize, usize) -> [f64; 3];
    let changes: [(&str, Change); 12] = [
        ("one of them is turned upside down", &|x, y| at(x, below(y))),
        ("one of them is mirrored", &|x, y| at(right(x), y)),
        ("one of them is turned by 180 degrees", &|x, y| at(right(x), below(y))),
        ("red and blue of one of them are swapped", &|x, y| {
            let [red, green, blue] = at(x, y);
            [blue, green, red]
        }),
        ("the second is shifted to the left by a pixel", &|x, y| at(x + 1, y)),
        ("the second is shifted to the right by a pixel", &|x, y| at(x.saturating_sub(1), y)),
        ("the second is shifted up by a pixel", &|x, y| at(x, y + 1)),
        ("the second is shifted down by a pixel", &|x, y| at(x, y.saturating_sub(1))),
        (&bright, &|x, y| at(x, y).map(|value| factor * value)),
        ("the second's values are squared: they may be meant for display", &|x, y| {
            at(x, y).map(|value| value * value)
        }),
        (
            "the second's values are replaced by their square roots: the first's may be meant for display",
            &|x, y| at(x, y).map(square_root),
        ),
        ("the second's values are decoded as sRGB (--encoding srgb for integers)", &|x, y| {
            at(x, y).map(of_srgb)
        }),
    ];
    let before = difference(a, &at);
    let after = changes.into_iter().map(|(name, change)| (difference(a, change), name));
    let (after, name) = after.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
    (after < MUCH * before).then(|| format!("they are much closer if {name}"))
}

/// Root mean square difference of the channels that are finite in both, where `b` returns the pixel in a column and row.
fn difference(a: &Picture, b: &dyn Fn(usize, usize) -> [f64; 3]) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    let pixels = places(a).map(|(index, x, y)| (a.pixels[index], b(x, y)));
    let apart = pixels.flat_map(|(a, b)| [0, 1, 2].map(|channel| a[channel] - b[channel]));
    for apart in apart.filter(|apart| apart.is_finite()) {
        sum += apart * apart;
        count += 1;
    }
    if count == 0 { f64::INFINITY } else { (sum / f64::from(count)).sqrt() }
}

/// The factor that brings `b` closest to `a`.
fn factor(a: &Picture, b: &Picture) -> f64 {
    let (mut both, mut own) = (0.0, 0.0);
    let pixels = places(a).map(|(index, ..)| (a.pixels[index], b.pixels[index]));
    let pairs = pixels.flat_map(|(a, b)| [0, 1, 2].map(|channel| (a[channel], b[channel])));
    for (a, b) in pairs.filter(|(a, b)| (a * b).is_finite()) {
        both += a * b;
        own += b * b;
    }
    if own > 0.0 { both / own } else { 1.0 }
}

/// Indices of the compared pixels, with their columns and rows.
fn places(picture: &Picture) -> impl Iterator<Item = (usize, usize, usize)> {
    let (width, count) = (picture.width as usize, picture.pixels.len());
    (0..count).step_by(count.div_ceil(MOST).max(1)).map(move |index| (index, index % width, index / width))
}
