//! Mistakes and their pictures, mistakes that blocks cannot show, and the report.

use super::fit::Fit;
use super::hypothesis::{Hypothesis, Mistake, Rendered, Studio, What};
use super::mistakes::{MISTAKES, bubble};
use super::written::{Order, Seen, Written};
use super::*;
use crate::job::output::Encoding;
use crate::job::recipe::Recipe;
use crate::numbers::statistics::blocks::{BlockTest, Differences, Noise};
use crate::scene::Material;
use crate::stages::{Shading, Stage, SurfaceRule};
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
    let none = vec![[0.0; 3]; pixels.len()];
    Rendered { halves: [pixels.clone(), pixels], variance: none.clone(), error: none }
}

fn seen(mine: &Mine, written: &Written) -> Seen {
    Seen::of(mine, written, |_, _| 1.0)
}

fn picture_of(bytes: Vec<[u8; 3]>, [width, height]: [u32; 2]) -> Mine {
    Mine::of_bytes(bytes, [width, height])
}

fn right(id: &str, size: [u32; 2]) -> Hypothesis {
    Hypothesis::right(Stage::find(id).unwrap(), recipe(id), size)
}

static GO: AtomicBool = AtomicBool::new(false);

/// A picture that our own tracer makes of a hypothesis, with other random numbers than those of a check.
fn shown(studio: &mut Studio, of: &Hypothesis, samples: u64) -> Mine {
    let mut of = of.clone();
    of.recipe.settings.seed += 1;
    let linear = studio.picture(&of, samples).unwrap();
    picture_of(of.written.bytes_of(&linear, of.size()), of.size())
}

fn judged(mine: &Mine, stage: &str) -> Finding {
    judge(mine, Stage::find(stage).ok(), &GO, |_| {}).unwrap()
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
        let mut studio = Studio::new(&GO).unwrap();
        let right = right(stage.id, [96, 54]);
        let mut plain = right.clone();
        plain.plain();
        let [right, plain] = [right, plain].map(|hypothesis| studio.picture(&hypothesis, 256).unwrap());
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
        let right = right(id, [16, 9]);
        let others =
            ["no-gamma", "gamma-early", "gamma-twice", "gamma-2.2", "gamma-srgb", "scale-255", "rounds"]
                .map(mistake);
        let others = others.into_iter().flat_map(|mistake| mistake.pictures(&right));
        for Hypothesis { written, rows, .. } in others.chain([right.clone()]) {
            for byte in 0..254 {
                let [linear, half_step] = written.linear(byte, 3, 9);
                assert_eq!(written.byte_of(linear, 3, 9), byte, "{id}, {rows:?}");
                assert!(half_step > 0.0);
            }
        }
    }
    let right = Written::right(&recipe("metal"));
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
            let most = if matches!(order, Order::Long | Order::Short | Order::Padded) { 24 } else { 45 };
            assert!(known.count() >= most, "{order:?}");
        }
    }
    let laid_out = Written { order: Order::Flipped, ..linear }.laid_out(&pictures, size);
    assert_eq!(laid_out[0], pictures[10]);
}

/// The noise of a picture tells its number of samples, and right pictures leave nothing.
#[test]
fn right_pictures_fit_with_their_number_of_samples() {
    let mut studio = Studio::new(&GO).unwrap();
    for (id, samples) in
        [("lambertian-gamma", 20), ("metal-fuzzy", 100), ("hollow-glass", 60), ("diffuse", 8)]
    {
        let right = right(id, [160, 90]);
        let mine = shown(&mut studio, &right, samples);
        let rendered = studio.render(&right, 1, 256, None).unwrap();
        let fit = Fit::new(&seen(&mine, &right.written), &right.written, &rendered);
        assert!(fit.is_enough(), "{id}: {} {:?}", fit.score, fit.slopes);
        let ratio = fit.samples.unwrap() / samples as f64;
        assert!((0.8..1.25).contains(&ratio), "{id}: {ratio}");
    }
}

/// What blocks do not show: a shift by a part of a pixel, a blur, a level of bytes.
#[test]
fn small_differences_do_not_fit() {
    let mut studio = Studio::new(&GO).unwrap();
    let right = right("metal-fuzzy", [160, 90]);
    let rendered = studio.render(&right, 1, 256, None).unwrap();
    for id in ["half-pixel-up", "width-less-one", "wide-filter", "scale-255", "no-antialiasing", "gamma-2.2"]
    {
        let wrong = mistake(id).pictures(&right).remove(0);
        let mine = shown(&mut studio, &wrong, 200);
        let fit = Fit::new(&seen(&mine, &right.written), &right.written, &rendered);
        assert!(!fit.is_enough(), "{id}: {} {:?}", fit.score, fit.slopes);
    }
}

#[test]
fn a_number_that_was_typed_wrong_is_found() {
    let mut studio = Studio::new(&GO).unwrap();
    for (what, value) in [(What::Center(2, 0), -0.9), (What::Albedo(0, 2), 0.3), (What::FieldOfView, 85.0)] {
        let mut wrong = right("metal-fuzzy", [160, 90]);
        match what {
            What::Center(sphere, axis) => {
                Arc::make_mut(&mut wrong.recipe.scene).spheres[sphere].center[axis] = value
            }
            What::FieldOfView => wrong.recipe.camera.vfov_degrees = value,
            _ => {
                let albedo = DVec3::new(0.8, 0.8, value);
                Arc::make_mut(&mut wrong.recipe.scene).materials[0].material =
                    Material::Lambertian { albedo };
            }
        }
        let mine = shown(&mut studio, &wrong, 100);
        let finding = judged(&mine, "metal-fuzzy");
        let numbers = &finding.found.as_ref().unwrap().hypothesis.numbers;
        assert!(finding.is_sure && numbers.len() == 1 && finding.alike.is_empty(), "{what:?}: {numbers:?}");
        assert!(
            numbers[0].what == what && (numbers[0].value - value).abs() < 0.02 * value.abs(),
            "{numbers:?}"
        );
        let answer = finding.answer(&mine);
        assert!(answer.remedy.is_some_and(|remedy| remedy.starts_with("Look at `")), "{}", answer.title);
    }
}

/// A screenshot at twice the size, in a frame, is the same picture.
#[test]
fn frames_and_scaling_are_undone() {
    let mut studio = Studio::new(&GO).unwrap();
    let own = shown(&mut studio, &right("metal", [48, 27]), 16);
    let at = |x: u32, y: u32| match (x.checked_sub(3), y.checked_sub(20)) {
        (Some(x), Some(y)) if x < 96 && y < 54 => own.bytes[(y / 2 * 48 + x / 2) as usize],
        _ => [30, 30, 30],
    };
    let mut file = "P3\n102 80\n255\n".to_owned();
    (0..80 * 102)
        .for_each(|i| file += &format!("{:?}\n", at(i % 102, i / 102)).replace(['[', ']', ','], " "));
    let mine = Mine::decode(file.as_bytes()).unwrap();
    assert_eq!(([mine.width, mine.height], &mine.bytes), ([48, 27], &own.bytes));
    assert_eq!(mine.notes.len(), 2, "{:?}", mine.notes);
}

#[test]
fn a_check_can_be_stopped() {
    let mut studio = Studio::new(&GO).unwrap();
    let mine = shown(&mut studio, &right("metal", [32, 18]), 4);
    let error = judge(&mine, None, &AtomicBool::new(true), |_| {}).unwrap_err();
    assert!(error.to_string().contains("stopped"), "{error}");
}

/// Every program places the small spheres of 14.1 elsewhere.
#[test]
fn final_picture_is_checked_where_it_is_not_random() {
    let stage = Stage::find("book").unwrap();
    let size = [160, 90];
    let mut studio = Studio::new(&GO).unwrap();
    let mut own = right("book", size);
    own.recipe.scene = Arc::new(crate::scene::builtin::book_of(7));
    let mut judged = |own: &Hypothesis| {
        let mine = shown(&mut studio, own, 64);
        let finding = judged(&mine, stage.id);
        (finding.answer(&mine), finding.named().map(|named| named.id))
    };
    let (answer, named) = judged(&own);
    assert!(answer.kind == AnswerKind::Right && named.is_none(), "{answer:?}");
    let evidence = answer.evidence.join(" ");
    assert!(evidence.contains("sky") && evidence.contains("gold"), "{answer:?}");
    let mut flipped = own.clone();
    flipped.written.order = Order::Flipped;
    assert_eq!(judged(&flipped).1, Some("flipped-rows"));
    let scene = Arc::make_mut(&mut own.recipe.scene);
    let gold = scene.materials.iter_mut().find(|material| material.name == "gold").unwrap();
    gold.material = Material::Metal { albedo: DVec3::new(0.5, 0.6, 0.7), fuzz: 0.0 };
    let (answer, _) = judged(&own);
    assert!(answer.kind != AnswerKind::Right && answer.evidence.join(" ").contains("gold"), "{answer:?}");
}

/// Bytes that differ from ours are not enough to name a mistake.
#[test]
fn resemblance_is_not_certainty() {
    let size = [160, 90];
    let mut studio = Studio::new(&GO).unwrap();
    let right = right("lambertian-gamma", size);
    let linear = studio.picture(&right, 256).unwrap();
    // Light that only the lower right receives: smooth, and as faint as noise.
    let faint = |index: usize| {
        let (x, y) = ((index % 160) as f64 / 160.0, (index / 160) as f64 / 90.0);
        0.06 * (x * y).powi(2) * (9.0 * x).sin()
    };
    let lit: Vec<[f64; 3]> = linear.iter().enumerate().map(|(i, p)| p.map(|x| x + faint(i).abs())).collect();
    let mine = picture_of(right.written.bytes_of(&lit, size), size);
    let finding = judged(&mine, "lambertian-gamma");
    assert!(!finding.is_sure, "{:?}", finding.named());
}

#[test]
fn answer_covers_damage_shape_and_mistake() {
    let stage = Stage::find("metal").unwrap();
    let compared = |hypothesis: Hypothesis, score: f64| {
        let picture = rendered(vec![[0.5; 3]; 1600]);
        let written = hypothesis.written;
        let mine = picture_of(vec![[181; 3]; 1600], [40, 40]);
        let fit = Fit {
            score,
            differing: 0.25,
            places: vec![[3, 4]],
            ..Fit::new(&seen(&mine, &written), &written, &picture)
        };
        Compared { hypothesis, rendered: picture, fit }
    };
    let right = |score| compared(right("metal", [40, 40]), score);
    let finding = |right: Compared, found: Option<Compared>| Finding {
        stage,
        is_sure: found.as_ref().unwrap_or(&right).fit.score < 8.0,
        right,
        found,
        alike: Vec::new(),
        altered: None,
        ignored: None,
    };
    let answer = |size: [u32; 2], damages: &[Damage], finding: &Finding| {
        let bytes = vec![[0; 3]; (size[0] * size[1]) as usize];
        finding.answer(&Mine { damages: damages.to_vec(), ..picture_of(bytes, size) })
    };
    let damage = Damage { title: "it is torn".to_owned(), remedy: "mend it" };
    let torn = answer([40, 20], &[damage.clone(), damage.clone()], &finding(right(0.0), None));
    assert_eq!((torn.kind, torn.title.as_str(), torn.damages.len()), (AnswerKind::Mistake, "It is torn", 1));
    assert_eq!(torn.remedy.as_deref(), Some("Mend it"));
    assert_eq!(torn.verdict(), Verdict::Different, "other programs cannot read a damaged file");
    let square = answer([40, 40], &[], &finding(right(0.0), None));
    assert_eq!((square.kind, square.verdict()), (AnswerKind::Right, Verdict::Same));
    assert!(square.evidence.iter().any(|line| line.contains("square")));
    let hypothesis = mistake("swapped-channels").pictures(&right(0.0).hypothesis).remove(0);
    let likely = answer([40, 40], &[], &finding(right(100.0), Some(compared(hypothesis.clone(), 20.0))));
    assert_eq!((likely.kind, likely.verdict()), (AnswerKind::LikelyMistake, Verdict::Different));
    let evidence = likely.evidence.join("; ");
    for part in ["lue, green, red", "25 %", "column 3, row 4"] {
        assert!(evidence.contains(part), "{evidence}");
    }
    let mut both = finding(right(100.0), Some(compared(hypothesis, 0.0)));
    both.alike.extend(mistake("backwards").pictures(&right(0.0).hypothesis).pop());
    assert!(answer([40, 40], &[], &both).title.ends_with("or the camera looks backwards"));
    let unknown = answer([40, 40], &[damage], &finding(right(100.0), None));
    assert_eq!(
        (unknown.kind, unknown.verdict(), unknown.damages.len()),
        (AnswerKind::Unknown, Verdict::Different, 1)
    );
    let cannot = Answer::cannot_check(&anyhow::anyhow!("it is blank"));
    assert_eq!((cannot.kind, cannot.explanation.as_str()), (AnswerKind::CannotCheck, "It is blank"));
}
