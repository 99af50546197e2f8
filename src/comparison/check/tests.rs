//! Mistakes and their pictures, mistakes that blocks cannot show, and the report.

use super::hypothesis::{Compared, Hypothesis, Mistake, Rendered, Rest, Studio, compare};
use super::mistakes::{MISTAKES, bubble};
use super::tracer::Steps;
use super::written::{Order, Seen, Written};
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

/// A picture without noise.
fn rendered(pixels: Vec<[f64; 3]>) -> Rendered {
    Rendered { halves: [pixels.clone(), pixels], samples: 1 }
}

fn seen(mine: &Mine, written: &Written) -> Seen {
    Seen::of(mine, written, |_, _| 1.0)
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
    let right = Hypothesis::right(&recipe);
    let expected = rendered(places().map(|(x, y)| linear(x, y)).collect());
    let found = compare(&seen(&mine, &right.written), right, expected);
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
    for stage in Stage::ALL.iter().filter(is_traced) {
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
            ["no-gamma", "gamma-early", "gamma-twice", "gamma-2.2", "gamma-srgb", "scale-255", "rounds"]
                .map(mistake);
        let others = others.into_iter().flat_map(|mistake| mistake.pictures(&recipe));
        for Hypothesis { written, mistake, .. } in others.chain([Hypothesis::right(&recipe)]) {
            for byte in 0..254 {
                let [linear, half_step] = written.linear(byte, 3, 9);
                assert_eq!(written.byte_of(linear, 3, 9), byte, "{id}, {mistake:?}");
                assert!(half_step > 0.0);
            }
        }
    }
    let right = Hypothesis::right(&recipe("metal")).written;
    let other = Written { curve: Encoding::Gamma(2.2), ..right };
    assert_eq!(
        [right.byte_of(0.25, 0, 1), other.byte_of(0.25, 0, 1)],
        [128, (256.0 * 0.25_f64.powf(1.0 / 2.2)) as u8]
    );
}

#[test]
fn files_are_read_in_the_order_written() {
    // Five columns and three rows; all values differ.
    let size = [5, 3];
    let pictures: Vec<[f64; 3]> =
        (0..15).map(|at| [0.0, 1.0, 2.0].map(|c| (3.0 * f64::from(at) + c + 0.5) / 256.0)).collect();
    let orders = [
        Order::Rows,
        Order::Flipped,
        Order::Mirrored,
        Order::Rotated,
        Order::Moved(1, -1),
        Order::Columns,
        Order::Exchanged,
        Order::Transposed,
        Order::Planar,
        Order::Long,
        Order::Short,
        Order::Padded,
    ];
    let linear = Written::right(&recipe("sky"));
    for order in orders {
        for channels in [[0, 1, 2], [2, 0, 1]] {
            let written = Written { order, channels, ..linear };
            let file = if order.exchanges_sides() { [3, 5] } else { size };
            let bytes = written.bytes_of(&written.laid_out(&pictures, size), file);
            let mine = picture_of(bytes, file);
            let seen = seen(&mine, &written);
            assert_eq!(seen.size, size, "{order:?}");
            let known = seen
                .values
                .as_flattened()
                .iter()
                .zip(pictures.as_flattened())
                .filter(|(seen, _)| seen.is_finite());
            assert!(known.clone().all(|(seen, right)| (seen - right).abs() < 1e-9), "{order:?}");
            let most = if matches!(order, Order::Long | Order::Short | Order::Padded | Order::Moved(..)) {
                24
            } else {
                45
            };
            assert!(known.count() >= most, "{order:?}");
        }
    }
    let laid_out = Written { order: Order::Flipped, ..linear }.laid_out(&pictures, size);
    assert_eq!(laid_out[0], pictures[10]);
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
    // Values beyond the range of bytes are not errors.
    close(misfit(&|_, _| [255, 0, 255], &|_, _| [2.0, 0.0, 1.0]), 0.0);
    // Each row has its own transfer.
    let halves = |_: u32, y: u32| if y < 8 { [64; 3] } else { [128; 3] };
    let (_, found) = compared([16, 16], Transfer::LinearAboveGamma2, halves, |_, _| [0.25; 3]);
    assert!(found.misfit < 1e-5 && found.is_noise, "{}", found.misfit);
    // Noise is not an error; anything beyond it is.
    let noise = |x: u32, y: u32, c: u32| (crate::kernel::sampling::pcg4d([x, y, c, 5])[0] >> 27) as u8;
    for (more, is_noise) in [(0, true), (12, false)] {
        let bytes = |x: u32, y: u32| [0, 1, 2].map(|c| 100 + more + noise(x, y, c));
        let (_, found) = compared([48, 32], Transfer::Linear, bytes, |_, _| [116.0 / 256.0; 3]);
        assert_eq!(found.is_noise, is_noise, "{more}: {}", found.misfit);
    }
}

#[test]
fn a_slope_tells_how_far_a_direction_leads() {
    let size = [160, 96];
    let noise = |x: u32, y: u32, c: u32| {
        f64::from(crate::kernel::sampling::pcg4d([x, y, c, 9])[0] >> 27) / 256.0 - 0.06
    };
    let of = |value: &dyn Fn(u32, u32, u32) -> f64| -> Vec<[f64; 3]> {
        let places = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        places.map(|(x, y)| [0, 1, 2].map(|c| value(x, y, c))).collect()
    };
    let edge = |x: u32| if x % 16 < 8 { 0.2 } else { 0.6 };
    let right = Hypothesis::right(&recipe("sky"));
    for share in [0.0, 0.3, 1.0] {
        // Beside the edges, the picture goes part of the way to another.
        let way = |x: u32| if x % 16 == 9 { -0.3 } else { 0.0 };
        let shown = of(&|x, y, c| edge(x) + share * way(x) + noise(x, y, c));
        let mine = picture_of(right.written.bytes_of(&shown, size), size);
        let from = rendered(of(&|x, _, _| edge(x)));
        let to = rendered(of(&|x, _, _| edge(x) + way(x)));
        let seen = seen(&mine, &right.written);
        let slope = Rest::new(&seen, &from).slopes(&to, false)[0];
        assert!((slope.at - share).abs() < 0.1, "{share}: {slope:?}");
        assert_eq!(slope.deviations > 4.0, share > 0.0, "{share}: {slope:?}");
    }
}

/// Every program places the small spheres of 14.1 elsewhere.
#[test]
fn final_picture_is_checked_where_it_is_not_random() {
    let stage = Stage::find("book").unwrap();
    let size = [160, 90];
    let mut studio = Studio::new(stage.recipe(), size).unwrap();
    let mut own = Hypothesis::right(studio.recipe());
    own.recipe.scene = Arc::new(crate::scene::builtin::book_of(7));
    let mut judged = |own: &Hypothesis| {
        let shown = studio.render(own, 64).unwrap();
        let mine = picture_of(own.written.bytes_of(&shown, size), size);
        let finding = judge(&mine, Some(stage), |_| {}).unwrap();
        (finding.answer(&mine), finding.named().map(|named| named.id))
    };
    let (answer, named) = judged(&own);
    assert!(answer.kind == AnswerKind::Right && named.is_none(), "{answer:?}");
    assert!(answer.evidence[0].contains("sky") && answer.evidence[0].contains("gold"), "{answer:?}");
    let flipped = Hypothesis { written: Written { order: Order::Flipped, ..own.written }, ..own.clone() };
    assert_eq!(judged(&flipped).1, Some("flipped-rows"));
    let scene = Arc::make_mut(&mut own.recipe.scene);
    let gold = scene.materials.iter_mut().find(|material| material.name == "gold").unwrap();
    gold.material = Material::Metal { albedo: DVec3::new(0.5, 0.6, 0.7), fuzz: 0.0 };
    let (answer, _) = judged(&own);
    assert!(
        answer.kind != AnswerKind::Right && answer.evidence.join(" ").contains("show: gold"),
        "{answer:?}"
    );
}

/// Bytes that differ from ours are not enough to name a mistake.
#[test]
fn resemblance_is_not_certainty() {
    let stage = Stage::find("lambertian-gamma").unwrap();
    let size = [160, 90];
    let mut studio = Studio::new(stage.recipe(), size).unwrap();
    let right = Hypothesis::right(studio.recipe());
    let linear = studio.render(&right, 256).unwrap();
    // Light that only the lower right receives: smooth, and as faint as noise.
    let faint = |index: usize| {
        let (x, y) = ((index % 160) as f64 / 160.0, (index / 160) as f64 / 90.0);
        0.06 * (x * y).powi(2) * (9.0 * x).sin()
    };
    let lit: Vec<[f64; 3]> = linear.iter().enumerate().map(|(i, p)| p.map(|x| x + faint(i).abs())).collect();
    let mine = picture_of(right.written.bytes_of(&lit, size), size);
    let finding = judge(&mine, Some(stage), |_| {}).unwrap();
    assert!(!finding.is_sure, "{:?}", finding.named());
}

#[test]
fn answer_covers_damage_shape_and_mistake() {
    let stage = Stage::find("metal").unwrap();
    let compared = |is_noise| Compared {
        hypothesis: Hypothesis::right(&stage.recipe()),
        misfit: 0.0,
        is_noise,
        differing: if is_noise { 0.0 } else { 0.25 },
        places: vec![[3, 4]],
        rendered: rendered(vec![[0.0; 3]; 1600]),
        expected: vec![[0.0; 3]; 1600],
    };
    let finding = |right, mistake, is_sure| Finding {
        stage,
        right,
        mistake,
        is_sure,
        alike: Vec::new(),
        grain: None,
        ignored: None,
    };
    let answer = |size: [u32; 2], damages: &[Damage], finding: &Finding| {
        let bytes = vec![[0; 3]; (size[0] * size[1]) as usize];
        finding.answer(&Mine { damages: damages.to_vec(), ..picture_of(bytes, size) })
    };
    let right = finding(compared(true), None, true);
    let damage = Damage { title: "it is torn".to_owned(), remedy: "mend it" };
    let torn = answer([40, 20], &[damage.clone(), damage.clone()], &right);
    assert_eq!((torn.kind, torn.title.as_str(), torn.damages.len()), (AnswerKind::Mistake, "It is torn", 1));
    assert_eq!(torn.remedy.as_deref(), Some("Mend it"));
    assert_eq!(torn.verdict(), Verdict::Different, "other programs cannot read a damaged file");
    let square = answer([40, 40], &[], &right);
    assert_eq!((square.kind, square.verdict()), (AnswerKind::Right, Verdict::Same));
    assert!(square.evidence[0].contains("square"));
    let hypothesis = mistake("swapped-channels").pictures(&stage.recipe()).remove(0);
    let found = Compared { hypothesis, differing: 0.001, ..compared(false) };
    let likely = answer([40, 40], &[], &finding(compared(false), Some(found.clone()), false));
    assert_eq!((likely.kind, likely.verdict()), (AnswerKind::LikelyMistake, Verdict::Different));
    let evidence = likely.evidence.join("; ");
    for part in ["lue, green, red", "25 %", "column 3, row 4", "less than 1 %"] {
        assert!(evidence.contains(part), "{evidence}");
    }
    let mut both = finding(compared(false), Some(found), true);
    both.alike.push(mistake("glass-black"));
    assert!(answer([40, 40], &[], &both).title.ends_with("or glass is black"));
    let unknown = answer([40, 40], &[damage], &finding(compared(false), None, false));
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
    let [shown, ours, difference] = pictures(
        &mine,
        &Finding {
            stage,
            right,
            mistake: None,
            is_sure: true,
            alike: Vec::new(),
            grain: None,
            ignored: None,
        },
    );
    // The upper row is linear, the lower the square root.
    assert_eq!((shown, ours), (bytes.to_vec(), vec![[64; 3], [64; 3], [128; 3], [128; 3]]));
    let colour = |squares: f64| HeatScale::ERROR.colour((squares / 3.0).sqrt() / 255.0);
    let squares = [0.0, 15.0_f64.powi(2), 0.0, 128.0_f64.powi(2) + 127.0_f64.powi(2)];
    assert_eq!(difference, squares.map(colour));
}
