//! Texts and figures that functions make of made-up numbers.

use crate::common::check;
use std::fmt::Write as _;
use weekender::animation::{CameraPath, FrameNames, Turn};
use weekender::check::Mistake;
use weekender::describe::{counted, seconds};
use weekender::film::SampleRanges;
use weekender::memory;
use weekender::plan::divide;
use weekender::recipe::Recipe;
use weekender::scene::builtin::BuiltinScene;
use weekender::shell;
use weekender::statistics::blocks::{BlockTest, Differences, Noise};
use weekender::statistics::fit::{Point, PowerLaw, predict, time_to};
use weekender::statistics::flip::Appearance;
use weekender::statistics::median;
use weekender::statistics::normal::{from_student, largest_of, two_sided_quantile, two_sided_tail};

/// Numbers of 0 to 1 that are the same in every run.
fn noise(index: u64) -> f64 {
    let x = (index + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    ((x ^ (x >> 32)) >> 11) as f64 / (1_u64 << 53) as f64
}

#[test]
fn statistics_are_as_kept() {
    let mut text = String::new();
    for z in [0.0, 0.5, 1.0, 1.96, 3.0, 5.0] {
        writeln!(
            text,
            "tail {z}: {:.8e}, student {:.6} {:.6}",
            two_sided_tail(z),
            from_student(z, 3.0),
            from_student(-z, 20.0)
        )
        .unwrap();
    }
    for chance in [0.3, 0.05, 0.01, 1e-6] {
        writeln!(
            text,
            "quantile {chance}: {:.6}, of 10 {:.6}, of 3000 {:.6}",
            two_sided_quantile(chance),
            largest_of(10, chance),
            largest_of(3000, chance)
        )
        .unwrap();
    }
    let points: Vec<Point> = (0..8)
        .map(|i| Point {
            time: f64::from(1 << i),
            error: 0.4 * f64::from(1 << i).powf(-0.5) * (0.9 + 0.2 * noise(i)),
        })
        .collect();
    for count in [0, 1, 2, 3, 8] {
        let points = &points[..count];
        writeln!(text, "{count} points: {:.6?}", PowerLaw::through(points)).unwrap();
        for target in [0.5, 0.2, 0.05, 0.001] {
            let now = points.last().copied().unwrap_or(Point { time: 1.0, error: 0.4 });
            writeln!(
                text,
                "  {target}: {:.6?} {:.6?}",
                time_to(points, target),
                predict(points, now, target)
            )
            .unwrap();
        }
    }
    let values: Vec<f64> = (0..9).map(noise).collect();
    writeln!(
        text,
        "medians {:.6?} {:.6?} {:?}",
        median(values.clone()),
        median(values[..8].to_vec()),
        median([])
    )
    .unwrap();
    for (width, height) in [(16_u32, 16_u64), (21, 13), (5, 3)] {
        let count = u64::from(width) * height;
        let values: Vec<[f64; 3]> =
            (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2].map(|k| noise(k) - 0.49)).collect();
        let variances: Vec<[f64; 3]> =
            (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2].map(|k| 0.05 + 0.1 * noise(k + 999))).collect();
        let steps: Vec<[f64; 3]> = values.iter().map(|_| [0.02, 0.01, 0.0]).collect();
        for noise in [Noise::Variances(&variances), Noise::Spread] {
            for (steps, tolerance, rare) in
                [(None, 0.0, 0.0), (Some(&steps[..]), 0.0, 0.0), (None, 0.1, 0.0), (None, 0.0, 0.5)]
            {
                let test =
                    BlockTest::of(&Differences { width, values: &values, noise, steps, tolerance, rare });
                let worst: Vec<_> = test
                    .worst(2)
                    .iter()
                    .map(|block| (block.x.clone(), block.y.clone(), format!("{:.5}", block.largest())))
                    .collect();
                writeln!(
                    text,
                    "{width}x{height} sums {:.5?} counts {:?} largest {:.5} of {:.5}, excess {:.5}, ratio {:.5}, within {}, near {}, worst {worst:?}",
                    test.sums, test.counts, test.largest, test.largest_limit, test.largest_excess(), test.ratio(), test.is_within(), test.is_too_near()
                )
                .unwrap();
            }
        }
        let shown = |from: u64| -> Vec<[f64; 3]> {
            (0..count).map(|i| [0, 1, 2].map(|c| noise(from + 3 * i + c))).collect()
        };
        let [a, b] = [0, 5000].map(|from| Appearance::of(width as usize, &shown(from)));
        writeln!(text, "{width}x{height} FLIP {:.6} {:.6}", a.difference(&b), a.difference(&a)).unwrap();
    }
    check("statistics", &text);
}

#[test]
fn words_are_as_kept() {
    let mut text = String::new();
    for time in [0.0, 0.04, 59.4, 59.6, 60.0, 61.0, 3599.0, 3600.0, 7384.0, 863_999.0, 864_000.0, 2e6] {
        writeln!(text, "{time} s: {}", seconds(time)).unwrap();
    }
    for count in [0, 1, 2] {
        writeln!(text, "{}", counted(count, "sample")).unwrap();
    }
    for bytes in [0, 1, 1023, 1024, 1536, 1 << 20, 5 << 20, 1 << 30, 3 << 40] {
        writeln!(text, "{bytes} bytes: {}", memory::words(bytes)).unwrap();
    }
    for word in ["plain", "with space", "it's", "", "a=b", "$x", "*"] {
        writeln!(text, "{}", shell::quoted(word)).unwrap();
    }
    for (samples, parts) in [(0..8, 3), (0..100, 7), (5..9, 2), (0..4, 5), (64..1024, 5), (0..1000, 1)] {
        writeln!(text, "{samples:?} in {parts}: {:?}", divide(samples.clone(), parts)).unwrap();
    }
    let mut ranges = SampleRanges::default();
    for range in [4..8, 10..11, 8..10, 20..30, 0..2] {
        ranges.insert(range).unwrap();
        writeln!(
            text,
            "{ranges}: {} = {} + {}",
            ranges.count(),
            ranges.count_in_half(0, 2),
            ranges.count_in_half(1, 2)
        )
        .unwrap();
    }
    for range in [5..6, 1..3, 29..31, 3..3] {
        writeln!(text, "{range:?}: {:?}", ranges.insert(range.clone())).unwrap();
    }
    for scene in BuiltinScene::ALL {
        let recipe = Recipe::find(scene.name).unwrap();
        writeln!(text, "{} {}: {}", scene.name, recipe.samples_per_pixel, scene.about).unwrap();
        for mistake in Mistake::ALL.into_iter().filter(|mistake| mistake.applies_to(&recipe)) {
            write!(text, " {}", mistake.about().id).unwrap();
        }
        text.push('\n');
    }
    for mistake in Mistake::ALL {
        let about = mistake.about();
        writeln!(
            text,
            "{}: {}; {} {} {}",
            about.id,
            about.title,
            about.remedy,
            mistake.is_of_output(),
            mistake.is_of_pixels()
        )
        .unwrap();
    }
    for pattern in ["a-##.png", "a.png", "b/x-####.png"] {
        let names = FrameNames::of_pattern(pattern.as_ref());
        writeln!(text, "{pattern}: {:?}", names.map(|names| [0, 7, 12345].map(|frame| names.path(frame))))
            .unwrap();
    }
    check("words", &text);
}

#[test]
fn camera_paths_are_as_kept() {
    let mut text = String::new();
    let mut recipe = Recipe::find("close-up").unwrap();
    let scene = format!(
        "{}\n[[keyframes]]\nframe = 2\n[[keyframes]]\nframe = 6\nlook_from = [1, 2, 3]\nvfov_degrees = 50\n[[keyframes]]\nframe = 9\nlook_from = [4, 2, 3]\nlook_at = [0, 1, 0]\nvup = [0.1, 1, 0]\ndefocus_angle_degrees = 3\nfocus_distance = 4\n",
        weekender::recipe::file::to_toml(&recipe)
    );
    match weekender::recipe::file::parse(&scene, "k.toml") {
        Ok(parsed) => recipe = parsed,
        Err(error) => writeln!(text, "{error}").unwrap(),
    }
    let mut paths = vec![CameraPath::Keyframes { still: recipe.camera, keyframes: recipe.keyframes.clone() }];
    for turn in [Turn::FramesPerTurn(90), Turn::DegreesPerFrame(-7.5)] {
        paths.push(CameraPath::Turntable { start: recipe.camera, turn });
    }
    for path in paths {
        for frame in [0, 2, 3, 5, 6, 8, 9, 20] {
            let camera = path.camera(frame);
            writeln!(
                text,
                "{frame}: {:.9} {:.9} {:.9} {:.9} {:.9} {:.9?}",
                camera.look_from,
                camera.look_at,
                camera.vup,
                camera.vfov_degrees,
                camera.defocus_angle_degrees,
                camera.focus_distance
            )
            .unwrap();
        }
    }
    check("camera_paths", &text);
}
