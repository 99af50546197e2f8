//! Noise, shifts of blocks, and unknown values.

use super::*;
use crate::kernel::sampling::pcg4d;
use proptest::prelude::*;

/// Normal numbers by Box and Muller, two for each counter.
fn normal(counter: u32, seed: u32) -> [f64; 2] {
    let [a, b, _, _] = pcg4d([counter, seed, 7, 11]).map(|x| (f64::from(x) + 0.5) / 4_294_967_296.0);
    let (radius, turn) = ((-2.0 * a.ln()).sqrt(), std::f64::consts::TAU * b);
    [radius * turn.cos(), radius * turn.sin()]
}

/// Differences with deviation 1 per pixel, and the variances that two halves would estimate.
fn noise(width: u32, height: u32, seed: u32) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
    (0..width * height)
        .map(|pixel| {
            let of = |channel: u32| normal(3 * pixel + channel, seed);
            let pairs = [of(0), of(1), of(2)];
            (pairs.map(|pair| pair[0]), pairs.map(|pair| pair[1].powi(2)))
        })
        .unzip()
}

fn differences<'a>(width: u32, values: &'a [[f64; 3]], noise: Noise<'a>) -> Differences<'a> {
    Differences { width, values, noise, steps: None, tolerance: 0.0, rare: 0.0 }
}

fn test(width: u32, values: &[[f64; 3]], noise: Noise) -> BlockTest {
    BlockTest::of(&differences(width, values, noise))
}

#[test]
fn noise_passes_at_expected_rate() {
    let (mut failed_by_halves, mut failed_by_spread) = (0, 0);
    for seed in 0..200 {
        let (values, variances) = noise(96, 64, seed);
        let halves = test(96, &values, Noise::Variances(&variances));
        assert!(!halves.is_too_near());
        failed_by_halves += usize::from(!halves.is_within());
        failed_by_spread += usize::from(!test(96, &values, Noise::Spread).is_within());
    }
    // 2 of 200 are expected; the probability of 9 or more is 2e-4.
    assert!(failed_by_halves < 9 && failed_by_spread < 9, "{failed_by_halves}, {failed_by_spread}");
}

#[test]
fn strong_local_and_faint_global_shifts_are_found() {
    let (values, variances) = noise(96, 64, 1);
    let noises = [Noise::Variances(&variances), Noise::Spread];
    let mut one = values.clone();
    for (x, y) in (16..24).flat_map(|x| (8..16).map(move |y| (x, y))) {
        one[y * 96 + x][1] += 1.0;
    }
    let all: Vec<[f64; 3]> = values.iter().map(|v| [v[0] + 0.12, v[1], v[2]]).collect();
    for noise in noises {
        let found = test(96, &one, noise);
        assert!(!found.is_within());
        assert_eq!((found.worst(1)[0].x.clone(), found.worst(1)[0].y.clone()), (16..24, 8..16));
        let found = test(96, &all, noise);
        assert!(found.excess[0] > SUM_DEVIATIONS && found.excess[1] < SUM_DEVIATIONS, "{:?}", found.excess);
    }
}

#[test]
fn steps_and_tolerance_excuse_differences() {
    let shifted = vec![[0.004; 3]; 64 * 64];
    let none = vec![[0.0; 3]; 64 * 64];
    let with = |steps, tolerance| {
        let noise = Noise::Variances(&none);
        BlockTest::of(&Differences { steps, tolerance, ..differences(64, &shifted, noise) })
    };
    assert!(!with(None, 0.0).is_within());
    assert!(with(None, 0.005).is_within());
    let steps = vec![[0.004; 3]; 64 * 64];
    let by_steps = with(Some(&steps), 0.0);
    assert!(by_steps.largest < 1.01 && !by_steps.is_too_near(), "{}", by_steps.largest);
}

#[test]
fn known_variance_has_infinite_freedom() {
    // One pixel has all the noise, with one degree of freedom, and half the variance is known: 4 degrees by Welch
    // and Satterthwaite. Student's two-sided quantile at 5 % is then 2.7764; that of a normal number is 1.960.
    let share = 8.0 * 8.0;
    let mut variances = vec![[0.0; 3]; 64];
    variances[20] = [share * share; 3];
    let of = |tolerance: f64, deviations: f64| {
        let total = (1.0 + tolerance * tolerance).sqrt();
        let values = vec![[deviations * total; 3]; 64];
        BlockTest::of(&Differences { tolerance, ..differences(8, &values, Noise::Variances(&variances)) })
    };
    for (tolerance, quantile) in [(1.0, 2.7764), (2.0_f64.sqrt(), 2.2622)] {
        let z = of(tolerance, quantile).blocks[0].z;
        assert!(z.iter().all(|z| (z - 1.960).abs() < 0.03), "{tolerance}: {z:?}");
    }
}

#[test]
fn rare_path_in_both_halves_is_ignored() {
    let none = vec![[0.0; 3]; 64];
    let mut values = none.clone();
    values[9] = [-1.0 / 32.0; 3];
    let of = differences(8, &values, Noise::Variances(&none));
    let test = |rare| BlockTest::of(&Differences { tolerance: 2e-6, rare, ..of });
    assert!(!test(0.0).is_within());
    assert!(test(2.0 / 64.0).is_within());
}

#[test]
fn one_channel_decides() {
    let (values, variances) = noise(96, 64, 3);
    for channel in 0..3 {
        let scaled = |of: &[[f64; 3]], by: f64| -> Vec<[f64; 3]> {
            let scaled = |mut pixel: [f64; 3]| {
                pixel[channel] *= by;
                pixel
            };
            of.iter().copied().map(scaled).collect()
        };
        let near = test(96, &values, Noise::Variances(&scaled(&variances, 4.0)));
        assert!(near.is_too_near() && near.is_within(), "{channel}: {near:?}");
        let far = test(96, &scaled(&values, 2.0), Noise::Variances(&variances));
        assert!(!far.is_within() && !far.is_too_near(), "{channel}: {far:?}");
        let most = (0..3).max_by(|a, b| far.excess[*a].total_cmp(&far.excess[*b]));
        assert_eq!((most, far.largest_excess()), (Some(channel), far.excess[channel]));
        assert!((far.ratio() - (far.sums[channel] / 96.0).sqrt()).abs() < 1e-12, "{channel}");
    }
}

#[test]
fn noiseless_difference_is_infinite() {
    let none = vec![[0.0; 3]; 64];
    let found = test(8, &[[-0.5, 0.0, 0.5]; 64], Noise::Variances(&none));
    assert_eq!(found.blocks[0].z, [f64::NEG_INFINITY, 0.0, f64::INFINITY]);
    assert_eq!((found.blocks[0].means, found.blocks[0].largest()), ([-0.5, 0.0, 0.5], f64::INFINITY));
    assert!(!found.is_within() && (0..3).all(|channel| found.blocks[0].is_known(channel)), "{found:?}");
    // A block of a single pixel has no spread, so only its known error counts.
    let of = differences(1, &[[2.0, -1.0, 0.0]], Noise::Spread);
    let single = BlockTest::of(&Differences { tolerance: 0.5, ..of });
    assert_eq!((single.blocks[0].z, single.counts), ([4.0, -2.0, 0.0], [1; 3]));
}

#[test]
fn unknown_channel_is_not_counted() {
    // Two of four blocks have an unknown value in the second channel.
    let (mut values, variances) = noise(32, 8, 4);
    values[3][1] = f64::NAN;
    values[20][1] = f64::INFINITY;
    let found = test(32, &values, Noise::Variances(&variances));
    assert_eq!(found.counts, [4, 2, 4]);
    let known: Vec<bool> = found.blocks.iter().map(|block| block.is_known(1)).collect();
    assert_eq!(known, [false, true, false, true]);
    assert_eq!((found.blocks[0].z[1], found.blocks[0].means[1]), (0.0, 0.0));
    assert_eq!(found.largest_limit, crate::numbers::statistics::normal::largest_of(10, CHANCE));
    assert!((found.excess[1] - (found.sums[1] - 2.0) / 2.0).abs() < 1e-12, "{found:?}");
}

proptest! {
    #[test]
    fn blocks_cover_every_pixel_once(width in 1_u32..70, height in 1_u32..70) {
        let values = vec![[1.0; 3]; (width * height) as usize];
        let found = test(width, &values, Noise::Spread);
        let area = |b: &Block| (b.x.end - b.x.start) * (b.y.end - b.y.start);
        prop_assert_eq!(found.blocks.iter().map(area).sum::<u32>(), width * height);
        prop_assert!(found.blocks.iter().all(|b| area(b) > 0 && b.x.end <= width && b.y.end <= height));
    }
}
