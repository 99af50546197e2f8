//! Mistakes and their pictures, mistakes that blocks cannot show, and the report.

use super::bytes::{is_times_255, is_truncated};
use super::hypothesis::{Compared, Hypothesis, Mistake, Studio, compare};
use super::judge::at_edges;
use super::mistakes::{MISTAKES, bubble};
use super::tracer::Steps;
use super::*;
use crate::job::output::Encoding;
use crate::job::recipe::Recipe;
use crate::numbers::statistics::blocks::{BlockTest, Differences, Noise};
use crate::scene::Material;
use crate::stages::{Shading, Stage, SurfaceRule, Transfer};
use glam::DVec3;
use std::sync::Arc;

fn recipe(id: &str) -> Recipe {
    Stage::find(id).unwrap().recipe()
}

fn mistake(id: &str) -> &'static Mistake {
    MISTAKES.iter().find(|mistake| mistake.id == id).unwrap()
}

fn picture_of(bytes: Vec<[u8; 3]>, [width, height]: [u32; 2]) -> Mine {
    Mine::of_bytes(bytes, [width, height])
}

/// Compares bytes with linear values; both are functions of column and row.
fn compared(
    size @ [width, height]: [u32; 2],
    transfer: Transfer,
    bytes: impl Fn(u32, u32) -> [u8; 3],
    linear: impl Fn(u32, u32) -> [f64; 3],
) -> (Mine, Compared) {
    let mut recipe = recipe("sky");
    recipe.rules.transfer = transfer;
    let places = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let mine = picture_of(places().map(|(x, y)| bytes(x, y)).collect(), size);
    let expected = places().map(|(x, y)| linear(x, y)).collect();
    let found = compare(&mine, Hypothesis::right(&recipe), expected);
    (mine, found)
}

#[test]
fn mistakes_have_unique_ids_and_apply_somewhere() {
    let mut ids: Vec<&str> = MISTAKES.iter().map(|mistake| mistake.id).collect();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), MISTAKES.len());
    for mistake in MISTAKES {
        let shows = |stage: &Stage| {
            let recipe = stage.recipe();
            (mistake.applies)(&recipe)
        };
        assert!(Stage::ALL.iter().any(shows), "{}", mistake.id);
    }
    for (id, can_show) in [("sky", false), ("normals-world", false), ("lambertian-gamma", true)] {
        for name in ["zero-t-min", "bounce-limit"] {
            assert_eq!((mistake(name).applies)(&recipe(id)), can_show, "{name} in {id}");
        }
    }
}

#[test]
fn bubble_is_air_inside_glass() {
    let (glass, air) = (1.5, 1.0 / 1.5);
    let found = |spheres: &[(f64, f64, f64)]| {
        let mut recipe = recipe("metal");
        let scene = Arc::make_mut(&mut recipe.scene);
        scene.spheres.clear();
        for (index, (x, radius, refraction_index)) in spheres.iter().copied().enumerate() {
            let material = scene.add_material(format!("{index}"), Material::Dielectric { refraction_index });
            scene.add_sphere(DVec3::X * x, radius, material);
        }
        bubble(scene)
    };
    assert_eq!(found(&[(0.0, 0.5, glass), (0.0, 0.4, air)]), Some(1));
    assert_eq!(found(&[(1.0, 0.4, air), (0.0, 0.4, air), (0.0, 0.5, glass)]), Some(1));
    assert_eq!(found(&[(0.0, 0.4, air)]), None, "alone");
    assert_eq!(found(&[(0.0, 0.4, glass), (0.0, 0.4, air)]), None, "as large");
    assert_eq!(found(&[(0.1, 0.5, glass), (0.0, 0.4, air)]), None, "beside the middle");
    assert_eq!(found(&[(0.0, 0.5, glass), (0.0, 0.4, 1.0)]), None, "of nothing");
}

#[test]
fn plain_tracer_matches_fast_tracer() {
    // Acne depends on the precision, and the gradient traces no rays.
    let is_traced = |stage: &&Stage| {
        let rules = stage.setup.rules;
        rules.shading != Shading::ImageGradient && rules.surface != SurfaceRule::Acne
    };
    for stage in stages().filter(is_traced) {
        let mut studio = Studio::new(stage.recipe(), [96, 54]).unwrap();
        let right = Hypothesis::right(studio.recipe());
        let plain = Hypothesis { steps: Some(Steps::OF_THE_BOOK), ..right.clone() };
        let [right, plain] = [right, plain].map(|hypothesis| studio.render(&hypothesis, 256).unwrap());
        // A one-sample grid hits edges exactly, where precisions may differ.
        let values: Vec<[f64; 3]> =
            right.iter().zip(&plain).map(|(a, b)| [0, 1, 2].map(|i| b[i] - a[i])).collect();
        let (noise, steps, tolerance) = (Noise::Spread, None, 2e-3);
        let test =
            BlockTest::of(&Differences { width: 96, values: &values, noise, steps, tolerance, rare: 0.0 });
        assert!(test.largest_excess() < 6.0 && test.largest < 7.0, "{}: {:?}", stage.id, test.excess);
    }
}

#[test]
fn bytes_and_linear_values_correspond() {
    for id in ["sky", "metal", "gamut"] {
        let recipe = recipe(id);
        let others =
            ["no-gamma", "gamma-early", "gamma-twice", "gamma-2.2", "gamma-srgb", "scale-255"].map(mistake);
        let others = others.into_iter().flat_map(|mistake| mistake.pictures(&recipe));
        for Hypothesis { written, mistake, .. } in others.chain([Hypothesis::right(&recipe)]) {
            for byte in 0..254 {
                let [linear, half_step] = written.linear(byte, 3, 9);
                assert_eq!(written.byte_of(linear, 3, 9), byte, "{id}, {mistake:?}");
                assert!(half_step > 0.0);
                // Scaling by 255 and truncating makes the upper half of all bytes one less.
                let less = written.byte_of(written.times_255(linear, 3, 9), 3, 9);
                assert_eq!(less, byte - u8::from(byte >= 128), "{id}, {mistake:?}");
            }
        }
    }
    let right = Hypothesis::right(&recipe("metal")).written;
    let other = hypothesis::Written { curve: Encoding::Gamma(2.2), ..right };
    assert_eq!(
        [right.byte_of(0.25, 0, 1), other.byte_of(0.25, 0, 1)],
        [128, (256.0 * 0.25_f64.powf(1.0 / 2.2)) as u8]
    );
}

#[test]
fn layout_follows_mistake() {
    // Three columns and two rows; each pixel holds its index.
    let linear: Vec<[f64; 3]> = (0..6).map(|place| [0.0, 0.1, 0.2].map(|c| f64::from(place) + c)).collect();
    let laid_out = |id| mistake(id).pictures(&recipe("metal"))[0].written.laid_out(&linear, 3);
    let places = |of: Vec<[f64; 3]>| of.iter().map(|pixel| pixel[0] as u32).collect::<Vec<_>>();
    assert_eq!(places(laid_out("no-gamma")), [0, 1, 2, 3, 4, 5]);
    assert_eq!(places(laid_out("flipped-rows")), [3, 4, 5, 0, 1, 2]);
    assert_eq!(places(laid_out("mirrored-columns")), [2, 1, 0, 5, 4, 3]);
    assert_eq!(laid_out("swapped-channels")[4], [4.2, 4.1, 4.0]);
}

#[test]
fn misfit_is_displayed_error_beyond_noise() {
    let misfit = |bytes: &dyn Fn(u32, u32) -> [u8; 3], linear: &dyn Fn(u32, u32) -> [f64; 3]| {
        compared([16, 8], Transfer::Linear, bytes, linear).1.misfit
    };
    let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    let middle = |byte: f64| (byte + 0.5) / 256.0;
    close(misfit(&|_, _| [153; 3], &|_, _| [0.5; 3]), (middle(153.0) - 0.5).powi(2) / 2.0);
    // Dark values count errors as at 0.02.
    close(misfit(&|_, _| [2; 3], &|_, _| [0.01; 3]), (middle(2.0) - 0.01).powi(2) / 0.08);
    // The mean of 64 pixels has 1/64 of their variance.
    let chequers = |x: u32, y: u32| [[140, 160][((x + y) % 2) as usize]; 3];
    let (mean, apart) = (middle(150.0) - 0.5, 10.0_f64 / 256.0);
    close(misfit(&chequers, &|_, _| [0.5; 3]), (mean * mean - apart * apart / 63.0) / 2.0);
    // Values beyond the range of bytes are no error.
    close(misfit(&|_, _| [255, 0, 255], &|_, _| [2.0, 0.0, 1.0]), 0.0);
    // Each row has its own transfer.
    let halves = |_: u32, y: u32| if y < 8 { [64; 3] } else { [128; 3] };
    let (_, found) = compared([16, 16], Transfer::LinearAboveGamma2, halves, |_, _| [0.25; 3]);
    assert!(found.misfit < 1e-5 && found.is_noise, "{}", found.misfit);
    // Noise is no error; more than noise is.
    let noise = |x: u32, y: u32, c: u32| (crate::kernel::sampling::pcg4d([x, y, c, 5])[0] >> 27) as u8;
    for (more, is_noise) in [(0, true), (12, false)] {
        let bytes = |x: u32, y: u32| [0, 1, 2].map(|c| 100 + more + noise(x, y, c));
        let (_, found) = compared([48, 32], Transfer::Linear, bytes, |_, _| [116.0 / 256.0; 3]);
        assert_eq!(found.is_noise, is_noise, "{more}: {}", found.misfit);
    }
}

#[test]
fn pixel_mistakes_show_only_at_edges() {
    let found = |id: &str, size: [u32; 2], planted: &'static Mistake| {
        let mut studio = Studio::new(recipe(id), size).unwrap();
        let right = Hypothesis::right(studio.recipe());
        let planted = planted.pictures(studio.recipe()).remove(0);
        [planted, right.clone()].map(|made| {
            let shown = studio.render(&made, 64).unwrap();
            let mine = picture_of(made.written.bytes_of(&shown, size), size);
            let expected = studio.render(&right, 64).unwrap();
            let compared = compare(&mine, right.clone(), expected);
            at_edges(&mine, &mut studio, &compared, 64).unwrap()?.hypothesis.mistake.map(|mistake| mistake.id)
        })
    };
    for planted in MISTAKES.iter().filter(|mistake| mistake.is_at_edges()) {
        assert_eq!(found("antialiased", [64, 36], planted), [Some(planted.id), None]);
    }
    // The sky changes too slowly to tell half a pixel's shift from different light.
    assert_eq!(found("sky", [32, 18], mistake("half-pixel-up")), [None, None]);
}

#[test]
fn truncated_picture_is_mostly_ends() {
    // Of 300 values: how many are 0 or 255, how many should be, and how many are white though they should be dark.
    let is_found = |ends: u32, expected_ends: u32, too_bright: u32| {
        let byte = |index: u32| match index {
            index if index < too_bright => [254, 255][index as usize % 2],
            index if index < ends => [0, 1][index as usize % 2],
            _ => [2, 253][index as usize % 2],
        };
        let bytes = |x: u32, y: u32| [0, 1, 2].map(|c| byte(3 * (10 * y + x) + c));
        let linear = |x: u32, y: u32| [if 3 * (10 * y + x) < expected_ends { 1.0 } else { 0.25 }; 3];
        let (mine, right) = compared([10, 10], Transfer::Linear, bytes, linear);
        is_truncated(&mine, &right)
    };
    assert!(is_found(300, 0, 0) && is_found(297, 0, 0) && !is_found(296, 0, 0));
    assert!(is_found(300, 147, 0) && !is_found(300, 150, 0));
    assert!(is_found(300, 0, 3) && !is_found(300, 0, 4));
}

#[test]
fn scaling_by_255_needs_clear_loss() {
    let right = Hypothesis::right(&recipe("lambertian-gamma"));
    let found = |pixels: u32, loss: f64, noise: f64, [from, to]: [f64; 2]| {
        let value = |index: u32| from + (to - from) * f64::from(index * 7919 % 12_289) / 12_289.0;
        let picture = |of: &dyn Fn(u32) -> f64| -> Vec<[f64; 3]> {
            (0..pixels).map(|pixel| [0, 1, 2].map(|channel| of(3 * pixel + channel))).collect()
        };
        // The displayed value is the square root of the linear one.
        let darker = picture(&|index| {
            let noise = if index.is_multiple_of(2) { noise } else { -noise };
            value(index) * (1.0 - loss / 256.0_f64).powi(2) + noise
        });
        let mine = picture_of(right.written.bytes_of(&darker, [pixels, 1]), [pixels, 1]);
        let compared = compare(&mine, right.clone(), picture(&value));
        is_times_255(&mine, &Compared { is_noise: true, ..compared })
    };
    let losses = [-1.0, 0.0, 0.5, 0.7, 1.0, 1.3, 1.5, 2.0];
    assert_eq!(
        losses.map(|loss| found(4096, loss, 0.0, [0.25, 0.65])),
        [false, false, false, true, true, true, false, false]
    );
    // With this noise, a mean over all values cannot rule out a loss.
    assert_eq!([0.02, 0.2].map(|noise| found(4096, 1.0, noise, [0.25, 0.65])), [true, false]);
    assert!(!found(333, 1.0, 0.0, [0.1, 0.9]) && found(334, 1.0, 0.0, [0.1, 0.9]));
    // Values that are too dark or clipped carry no information.
    assert!(!found(2000, 1.0, 0.0, [0.0, 0.049]) && !found(2000, 1.0, 0.0, [0.981, 1.2]));
}

#[test]
fn planted_mistake_is_found_and_reported() {
    let stage = Stage::find("metal-fuzzy").unwrap();
    let size = [48, 27];
    for planted in ["flipped-rows", "sky-reversed"].map(mistake) {
        let mut studio = Studio::new(stage.recipe(), size).unwrap();
        let hypothesis = planted.pictures(studio.recipe()).remove(0);
        let expected = studio.render(&hypothesis, 256).unwrap();
        let mine = picture_of(hypothesis.written.bytes_of(&expected, size), size);
        let finding = judge(&mine, Some(stage), |_| {}).unwrap();
        assert!(!finding.is_right() && finding.stage.id == stage.id);
        assert_eq!(finding.named().map(|found| found.id), Some(planted.id));
        assert!(finding.mistake.as_ref().is_some_and(|found| found.is_noise));
        let path = Path::new("a.ppm");
        let json = figures(path, &mine, &finding, &[]);
        assert_eq!(json["mistake"]["id"], planted.id);
        assert_eq!((&json["is_right"], &json["mistake"]["explains_all"]), (&false.into(), &true.into()));
        let answer = finding.answer(&mine);
        assert_eq!((answer.kind, answer.stage), (AnswerKind::Mistake, Some(stage)));
        let section = answer.section.unwrap();
        assert_eq!(section.number, planted.section);
        let report = text(path, &mine, &finding, &[]);
        assert!(report.contains(&section.url) && !report.contains(&stage.url()), "{report}");
        assert!(
            answer.evidence.iter().any(|line| line.ends_with("they differ in 0 %")),
            "{:?}",
            answer.evidence
        );
    }
}

#[test]
fn answer_covers_damage_shape_and_mistake() {
    let stage = Stage::find("metal").unwrap();
    let right = |is_noise| Compared {
        hypothesis: Hypothesis::right(&stage.recipe()),
        misfit: 0.0,
        is_noise,
        differing: if is_noise { 0.0 } else { 0.25 },
        worst: [3, 4],
        expected: Vec::new(),
    };
    let answer = |size, damages: &[Damage], finding: &Finding| {
        finding.answer(&Mine { damages: damages.to_vec(), ..picture_of(Vec::new(), size) })
    };
    let finding = Finding { stage, right: right(true), mistake: None, alike: None };
    let damage = Damage { title: "it is torn".to_owned(), remedy: "mend it" };
    let torn = answer([40, 20], &[damage.clone(), damage.clone()], &finding);
    assert_eq!((torn.kind, torn.title.as_str(), torn.damages.len()), (AnswerKind::Mistake, "It is torn", 1));
    assert_eq!(torn.remedy.as_deref(), Some("Mend it"));
    assert_eq!(torn.verdict(), Verdict::Different, "other programs cannot read a damaged file");
    let square = answer([40, 40], &[], &finding);
    assert_eq!((square.kind, square.verdict()), (AnswerKind::Right, Verdict::Same));
    assert!(square.evidence[0].contains("square"));
    let hypothesis = mistake("swapped-channels").pictures(&stage.recipe()).remove(0);
    let found = Compared { hypothesis, differing: 0.001, ..right(false) };
    let likely =
        answer([40, 20], &[], &Finding { stage, right: right(false), mistake: Some(found), alike: None });
    assert_eq!(likely.kind, AnswerKind::LikelyMistake);
    assert!(likely.title.ends_with("swapped, most likely"), "{}", likely.title);
    let [seen, ours, with] = likely.evidence.as_slice() else { panic!("{:?}", likely.evidence) };
    assert!(seen.contains("blue, green, red") && ours.contains("25 %") && ours.contains("column 3, row 4"));
    assert!(with.contains("less than 1 %"), "{with}");
    let unknown =
        answer([40, 20], &[damage], &Finding { stage, right: right(false), mistake: None, alike: None });
    assert_eq!(
        (unknown.kind, unknown.verdict(), unknown.damages.len()),
        (AnswerKind::Unknown, Verdict::Different, 1)
    );
    let cannot = Answer::cannot_check(&anyhow::anyhow!("it is blank"));
    assert_eq!((cannot.kind, cannot.explanation.as_str()), (AnswerKind::CannotCheck, "It is blank"));
}

#[test]
fn rough_difference_is_rms_of_channels() {
    let bytes = [[64, 64, 64], [64, 79, 64], [128, 128, 128], [0, 255, 128]];
    let of = |x: u32, y: u32| bytes[(2 * y + x) as usize];
    let (mine, right) = compared([2, 2], Transfer::LinearAboveGamma2, of, |_, _| [0.25; 3]);
    let stage = Stage::find("sky").unwrap();
    let [shown, ours, difference] = pictures(&mine, &Finding { stage, right, mistake: None, alike: None });
    // The upper row is linear, the lower the square root.
    assert_eq!((shown, ours), (bytes.to_vec(), vec![[64; 3], [64; 3], [128; 3], [128; 3]]));
    let colour = |squares: f64| HeatScale::ERROR.colour((squares / 3.0).sqrt() / 255.0);
    let squares = [0.0, 15.0_f64.powi(2), 0.0, 128.0_f64.powi(2) + 127.0_f64.powi(2)];
    assert_eq!(difference, squares.map(colour));
}
