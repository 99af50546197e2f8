//! LDR-FLIP: how different two pictures look to someone who flips between them, from 0 (equal) to 1.
//!
//! Source: Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild, "FLIP: A Difference Evaluator for
//! Alternating Images", HPG 2020. Constants have the paper's names.

/// Pixels per degree of the visual field: a screen 3840 pixels and .7 m wide, seen from .7 m.
pub const PIXELS_PER_DEGREE: f64 = 67.0;

/// The eye's contrast filters: weights `a` and widths `b` of two Gaussians for brightness, red-green and blue-yellow.
const CONTRAST: [[(f64, f64); 2]; 3] =
    [[(1.0, 0.0047), (0.0, 1e-5)], [(1.0, 0.0053), (0.0, 1e-5)], [(34.1, 0.04), (13.5, 0.025)]];

/// Exponent of the colour difference.
const Q_C: f64 = 0.7;

/// Fraction of the largest colour difference that is mapped to [`P_T`].
const P_C: f64 = 0.4;

const P_T: f64 = 0.95;

type Plane = Vec<f64>;

/// A picture as the eye perceives it.
#[derive(Clone, Debug)]
pub struct Appearance {
    /// Filtered colours: CIELAB with the chroma scaled by the lightness (Hunt effect).
    colours: Vec<[f64; 3]>,
    /// Strength of edges and of points.
    features: Vec<[f64; 2]>,
}

impl Appearance {
    /// Filters a picture of `width` columns in display values: sRGB, `0..=1`, row by row.
    pub fn of(width: usize, shown: &[[f64; 3]]) -> Self {
        let opponent: Vec<[f64; 3]> = shown
            .iter()
            .map(|pixel| opponent_from_xyz(xyz_from_linear(pixel.map(linear_from_srgb))))
            .collect();
        let plane = |channel: usize| -> Plane { opponent.iter().map(|pixel| pixel[channel]).collect() };
        let filtered = [0, 1, 2].map(|channel| contrast_filtered(&plane(channel), width, CONTRAST[channel]));
        let colours = (0..shown.len())
            .map(|i| {
                let linear =
                    linear_from_xyz(xyz_from_opponent([filtered[0][i], filtered[1][i], filtered[2][i]]));
                hunt(lab_from_xyz(xyz_from_linear(linear.map(|x| x.clamp(0.0, 1.0)))))
            })
            .collect();
        let lightness: Plane = opponent.iter().map(|pixel| (pixel[0] + 16.0) / 116.0).collect();
        Appearance { colours, features: features(&lightness, width) }
    }

    /// The mean difference from another picture. Panics if the sizes differ.
    pub fn difference(&self, other: &Appearance) -> f64 {
        assert_eq!(self.colours.len(), other.colours.len(), "the pictures must have the same size");
        let greatest = greatest_colour_difference();
        let sum: f64 = (0..self.colours.len())
            .map(|i| {
                let colour = mapped(hyab(self.colours[i], other.colours[i]).powf(Q_C), greatest);
                let [edges, points] =
                    [0, 1].map(|f: usize| (self.features[i][f] - other.features[i][f]).abs());
                let feature = (edges.max(points) / std::f64::consts::SQRT_2).sqrt().min(1.0);
                colour.powf(1.0 - feature)
            })
            .sum();
        sum / self.colours.len().max(1) as f64
    }
}

/// The largest difference between displayable colours: between green and blue.
fn greatest_colour_difference() -> f64 {
    let of = |linear| hunt(lab_from_xyz(xyz_from_linear(linear)));
    hyab(of([0.0, 1.0, 0.0]), of([0.0, 0.0, 1.0])).powf(Q_C)
}

fn mapped(difference: f64, greatest: f64) -> f64 {
    let knee = P_C * greatest;
    if difference < knee {
        P_T / knee * difference
    } else {
        P_T + (difference - knee) / (greatest - knee) * (1.0 - P_T)
    }
}

fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

fn hunt([l, a, b]: [f64; 3]) -> [f64; 3] {
    [l, 0.01 * l * a, 0.01 * l * b]
}

/// Filters with the sum of two Gaussians, normalised to 1.
fn contrast_filtered(plane: &Plane, width: usize, gaussians: [(f64, f64); 2]) -> Plane {
    use std::f64::consts::PI;
    let widest = CONTRAST.iter().flatten().fold(0.0_f64, |most, (_, b)| most.max(*b));
    let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as i32;
    let kernels = gaussians.map(|(a, b)| {
        let kernel: Vec<f64> = (-radius..=radius)
            .map(|x| (-(PI * f64::from(x) / PIXELS_PER_DEGREE).powi(2) / b).exp())
            .collect();
        let sum: f64 = kernel.iter().sum();
        (a * (PI / b).sqrt() * sum * sum, kernel.iter().map(|x| x / sum).collect::<Vec<f64>>())
    });
    let total: f64 = kernels.iter().map(|(weight, _)| weight).sum();
    let mut filtered = vec![0.0; plane.len()];
    for (weight, kernel) in kernels.iter().filter(|(weight, _)| *weight > 0.0) {
        for (sum, x) in filtered.iter_mut().zip(convolved(plane, width, kernel, kernel)) {
            *sum += weight / total * x;
        }
    }
    filtered
}

/// Strength of edges and points: the magnitudes of first and second derivatives of a Gaussian.
fn features(lightness: &Plane, width: usize) -> Vec<[f64; 2]> {
    let sigma = 0.5 * 0.082 * PIXELS_PER_DEGREE;
    let radius = (3.0 * sigma).ceil() as i32;
    let kernel = |of: fn(f64) -> f64| -> Vec<f64> {
        let raw: Vec<f64> =
            (-radius..=radius).map(|x| f64::from(x) / sigma).map(|x| of(x) * (-0.5 * x * x).exp()).collect();
        // Positive weights sum to 1, negative ones to -1.
        let sum = |sign: f64| raw.iter().map(|x| (sign * x).max(0.0)).sum::<f64>();
        let (above, below) = (sum(1.0), sum(-1.0));
        raw.iter()
            .map(|x| {
                if *x > 0.0 {
                    x / above
                } else if *x < 0.0 {
                    x / below
                } else {
                    0.0
                }
            })
            .collect()
    };
    let (smooth, edge, point) = (kernel(|_| 1.0), kernel(|x| -x), kernel(|x| x * x - 1.0));
    let length = |derivative: &[f64]| -> Plane {
        let across = convolved(lightness, width, derivative, &smooth);
        let down = convolved(lightness, width, &smooth, derivative);
        across.iter().zip(down).map(|(x, y)| x.hypot(y)).collect()
    };
    length(&edge).into_iter().zip(length(&point)).map(|(edge, point)| [edge, point]).collect()
}

/// Filters rows with one kernel and columns with another. Pixels beyond the border repeat the outermost ones.
fn convolved(plane: &Plane, width: usize, across: &[f64], down: &[f64]) -> Plane {
    let height = plane.len() / width.max(1);
    let pass =
        |source: &Plane, kernel: &[f64], length: usize, index: &dyn Fn(usize, usize) -> usize| -> Plane {
            let radius = kernel.len() / 2;
            let mut result = vec![0.0; source.len()];
            for line in 0..source.len() / length.max(1) {
                for at in 0..length {
                    result[index(line, at)] = kernel
                        .iter()
                        .enumerate()
                        .map(|(tap, weight)| {
                            let from = (at + tap).saturating_sub(radius).min(length - 1);
                            weight * source[index(line, from)]
                        })
                        .sum();
                }
            }
            result
        };
    let rows = pass(plane, across, width, &|line, at| line * width + at);
    pass(&rows, down, height, &|line, at| at * width + line)
}

fn linear_from_srgb(v: f64) -> f64 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// sRGB's primaries under D65.
const XYZ_FROM_LINEAR: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

fn xyz_from_linear(rgb: [f64; 3]) -> [f64; 3] {
    XYZ_FROM_LINEAR.map(|row| row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2])
}

fn linear_from_xyz(xyz: [f64; 3]) -> [f64; 3] {
    let [a, b, c] = XYZ_FROM_LINEAR.map(glam::DVec3::from);
    let inverse = glam::DMat3::from_cols(a, b, c).transpose().inverse();
    (inverse * glam::DVec3::from(xyz)).to_array()
}

/// XYZ relative to white.
fn relative(xyz: [f64; 3]) -> [f64; 3] {
    let white = xyz_from_linear([1.0; 3]);
    [0, 1, 2].map(|i| xyz[i] / white[i])
}

/// The linear space YCxCz: brightness, red-green and blue-yellow.
fn opponent_from_xyz(xyz: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = relative(xyz);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn xyz_from_opponent([yy, cx, cz]: [f64; 3]) -> [f64; 3] {
    let white = xyz_from_linear([1.0; 3]);
    let y = (yy + 16.0) / 116.0;
    let relative = [y + cx / 500.0, y, y - cz / 200.0];
    [0, 1, 2].map(|i| relative[i] * white[i])
}

fn lab_from_xyz(xyz: [f64; 3]) -> [f64; 3] {
    const DELTA: f64 = 6.0 / 29.0;
    let f = |t: f64| {
        if t > DELTA.powi(3) { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    };
    let [x, y, z] = relative(xyz).map(f);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn constant(colour: [f64; 3]) -> Appearance {
        Appearance::of(24, &vec![colour; 24 * 20])
    }

    #[test]
    fn black_and_white_match_paper() {
        // Only the lightness differs, by 100: the paper's formula, evaluated by hand.
        let difference = constant([0.0; 3]).difference(&constant([1.0; 3]));
        let greatest = greatest_colour_difference();
        assert!((greatest - 41.2765).abs() < 0.01, "{greatest}");
        let expected = 0.95 + (100_f64.powf(0.7) - 0.4 * greatest) / (0.6 * greatest) * 0.05;
        assert!((difference - expected).abs() < 1e-6, "{difference} {expected}");
        let colours = constant([0.0, 1.0, 0.0]).difference(&constant([0.0, 0.0, 1.0]));
        assert!((colours - 1.0).abs() < 1e-6, "{colours}");
    }

    #[test]
    fn dot_spreads_by_paper_gaussians() {
        // `sum a sqrt(pi / b) exp(-pi^2 x^2 / b)` with the constants of the paper's table 1, at distances `x` of 0,
        // 2, 4 and 9 pixels at 67 pixels per degree, relative to the value at 0; and that value relative to the sum
        // of all weights.
        let expected = [
            ([1.0, 0.153_944_087_638_8, 0.000_561_632_273_9, 0.0], 0.148_902_643_575_7),
            ([1.0, 0.190_265_327_944_8, 0.001_310_504_800_1, 0.0], 0.132_045_740_867_8),
            ([1.0, 0.769_530_875_318_5, 0.358_232_424_778_8, 0.008_033_484_860_9], 0.020_012_846_957_7),
        ];
        let mut dot = vec![0.0; 41 * 41];
        dot[20 * 41 + 20] = 1.0;
        for (channel, (ratios, peak)) in expected.into_iter().enumerate() {
            let spread = contrast_filtered(&dot, 41, CONTRAST[channel]);
            let at = |x: usize, y: usize| spread[(20 + y) * 41 + 20 + x];
            assert!((at(0, 0) - peak).abs() < 1e-9, "channel {channel}: {}", at(0, 0));
            for (x, ratio) in [0, 2, 4, 9].into_iter().zip(ratios) {
                for value in [at(x, 0), at(0, x)] {
                    assert!(
                        (value / peak - ratio).abs() < 1e-9,
                        "channel {channel} at {x}: {}",
                        value / peak
                    );
                }
            }
        }
    }

    #[test]
    fn opponent_colours_round_trip() {
        let rgb = [0.2, 0.7, 0.4];
        let back = linear_from_xyz(xyz_from_opponent(opponent_from_xyz(xyz_from_linear(rgb))));
        assert!((0..3).all(|i| (back[i] - rgb[i]).abs() < 1e-12), "{back:?}");
        let white = lab_from_xyz(xyz_from_linear([1.0; 3]));
        assert!((white[0] - 100.0).abs() < 1e-9 && white[1].abs() < 1e-9, "{white:?}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(16))]
        #[test]
        fn a_distance(pixels in prop::collection::vec([0.0..1.0_f64, 0.0..1.0, 0.0..1.0], 2 * 12 * 9)) {
            let (a, b) = pixels.split_at(12 * 9);
            let (a, b) = (Appearance::of(12, a), Appearance::of(12, b));
            prop_assert_eq!(a.difference(&a), 0.0);
            let there = a.difference(&b);
            prop_assert!(there > 0.0 && there <= 1.0);
            prop_assert!((there - b.difference(&a)).abs() < 1e-12);
        }
    }
}
