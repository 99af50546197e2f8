//! What the checks of random scenes compare, and when they fail.

use super::*;
use crate::backends::BackendChoice;
use crate::render::RenderJob;
use crate::render_cpu::CpuOptions;
use crate::scene::{Material, Sky};
use crate::stress::families::build::{glass, one_ball, sized, tame};
use crate::stress::painted::{fill, grey, painted};
use crate::stress::suite::by_the_book;
use std::sync::atomic::AtomicU64;

fn checker() -> Checker {
    let options = CpuOptions { threads: Some(1), ..CpuOptions::default() };
    let cpu = Backend::new("cpu", BackendChoice::Cpu(options));
    Checker::new(vec![cpu], Backend::new("f64", BackendChoice::Reference { threads: Some(1) }))
}

#[test]
fn a_tame_scene_holds_and_the_books_arithmetic_on_a_small_one_does_not() {
    let go_on = AtomicBool::new(false);
    let mut checker = checker();
    let small = sized(tame(), [12, 8], 8);
    assert_eq!(checker.first_failure(&small, &go_on), None);
    assert_eq!(checker.fails(Check::Rounding, &small, &go_on), None);
    let traced = checker.last.as_ref().map(|(_, outcomes)| outcomes.len());
    assert_eq!(traced, Some(2), "the pictures of both backends are kept for the next check");
    // Its threshold is a length, so a larger scene looks different.
    let book = by_the_book(&moved(&small, 0.003, DVec3::ZERO));
    let reason = checker.fails(Check::Scaling, &book, &go_on);
    assert!(reason.is_some_and(|reason| reason.starts_with("cpu: ")), "scaling");
}

#[test]
fn a_scene_is_not_moved_so_far_that_its_eye_changes_sides() {
    assert!(there_and_back(&tame()).is_some());
    let mut near = one_ball();
    let ball = near.scene.spheres[0];
    near.camera.look_from = ball.center + DVec3::Y * ball.radius * (1.0 + 1e-9);
    assert!(there_and_back(&near).is_some());
    near.camera.look_at = near.camera.look_from + DVec3::X * 1e7 * ball.radius;
    assert!(there_and_back(&near).is_none());
}

#[test]
fn copies_are_removed_where_they_change_nothing() {
    assert_eq!(without_copies(&one_ball()), None);
    let mut recipe = one_ball();
    let scene = Arc::make_mut(&mut recipe.scene);
    scene.spheres.push(scene.spheres[0]);
    assert_eq!(without_copies(&recipe), Some(one_ball()));
}

#[test]
fn light_from_nowhere_is_seen() {
    let recipe = one_ball();
    let mut film = Film::new(1, 1, 1);
    film.halves_mut()[0][0] = crate::film::fixed_point([1.0, 1.0, 1.1]).unwrap();
    film.record(0..1, 0).unwrap();
    let reason = has_no_more_light(&recipe, &film).unwrap_err();
    assert!(reason.starts_with("pixel 0 is 1.1"), "{reason}");
}

#[test]
fn only_what_is_wrong_at_every_look_is_wrong() {
    let taken = |looks: &[Result<(), &str>]| {
        let mut taken = 0;
        let result = right_or_last(looks.iter().map(|look| {
            taken += 1;
            look.map_err(str::to_owned)
        }));
        (result, taken)
    };
    assert_eq!(taken(&[Ok(()), Err("b")]), (Ok(()), 1));
    assert_eq!(taken(&[Err("a"), Ok(()), Err("c")]), (Ok(()), 2));
    assert_eq!(taken(&[Err("a"), Err("b")]), (Err("b".to_owned()), 2));
}

#[test]
fn a_second_look_has_more_samples_but_takes_no_minutes() {
    let found = [1e-3, 5.0 / 64.0, 0.5, 1.0, 1.25, 100.0].map(more_samples);
    assert_eq!(found, [64, 64, 10, 5, 4, 4]);
    let mut recipe = one_ball();
    recipe.settings.seed = u32::MAX;
    let pair = Pair { check: Check::Scaling, one: recipe.clone(), other: Some(recipe.clone()) };
    let second = pair.second_look(7, 1);
    assert_eq!(second.check, Check::Scaling);
    for more in [Some(&second.one), second.other.as_ref()] {
        let more = more.unwrap();
        assert_eq!((more.samples_per_pixel, more.settings.seed), (7 * recipe.samples_per_pixel, 0));
        assert_eq!((&more.scene, more.camera), (&recipe.scene, recipe.camera));
    }
    assert!(Pair { other: None, ..pair }.second_look(2, 1).other.is_none());
    assert_ne!(SEEDS[0], SEEDS[1]);
}

#[test]
fn each_check_compares_two_pictures_that_should_be_the_same() {
    // The eye is 3 from what it looks at; the nearest power of two is 4.
    let recipe = one_ball();
    let of = |check: Check| Pair::of(check, &recipe).unwrap();
    for check in [Check::Rounding, Check::Energy] {
        let pair = of(check);
        assert_eq!((pair.check, &pair.one, &pair.other), (check, &recipe, &None));
    }
    let Pair { one, other, .. } = of(Check::Hierarchy);
    let far = other.unwrap();
    assert_eq!((&one, far.scene.spheres.len(), far.camera), (&recipe, 41, recipe.camera));
    for sphere in &far.scene.spheres[1..] {
        let distance = sphere.center.distance(recipe.camera.look_from);
        assert!((distance - 3000.0).abs() < 1e-6 && (sphere.radius - 0.03).abs() < 1e-12, "{sphere:?}");
    }
    let Pair { one, other, .. } = of(Check::Scaling);
    assert_eq!((one, other), (recipe.clone(), Some(moved(&recipe, 4.0, DVec3::ZERO))));
    let Pair { one, other, .. } = of(Check::Translation);
    let there = moved(&recipe, 1.0, DVec3::new(16.0, -32.0, 8.0));
    assert_eq!((one, other), (recipe.clone(), Some(there)));
    assert!(Pair::of(Check::Copies, &recipe).is_none());
    let mut refused = recipe.clone();
    refused.camera.look_at = refused.camera.look_from;
    assert!(Check::ALL.into_iter().all(|check| Pair::of(check, &refused).is_none()));
}

#[test]
fn an_eye_is_as_near_to_a_surface_as_the_digits_of_the_way_allow() {
    let mut near = one_ball();
    // The way has up to 8 units, so 256 units in the last place of 1 may be lost.
    for (places, is_clear) in [(-300.0, true), (-200.0, false), (200.0, false), (300.0, true)] {
        near.camera.look_from = DVec3::Y * (1.0 + places * f64::EPSILON);
        near.camera.look_at = near.camera.look_from + DVec3::X;
        assert_eq!(there_and_back(&near).is_some(), is_clear, "{places}");
    }
}

#[test]
fn copies_of_glass_stay() {
    let mut recipe = one_ball();
    let scene = Arc::make_mut(&mut recipe.scene);
    let clear = scene.add_material("clear", glass(1.5));
    scene.add_sphere(DVec3::X, 0.5, clear);
    scene.spheres.extend_from_within(..);
    let kept = without_copies(&recipe).unwrap().scene;
    assert_eq!(kept.spheres.len(), 3);
    let is_glass = |sphere: &&Sphere| matches!(kept.material_of(sphere), Material::Dielectric { .. });
    assert_eq!(kept.spheres.iter().filter(is_glass).count(), 2);
}

#[test]
fn a_backend_without_pictures_fails_unless_it_was_interrupted() {
    let no_kernel = CpuOptions { lanes: Some(3), ..CpuOptions::default() };
    let broken = Backend::new("broken", BackendChoice::Cpu(no_kernel));
    let reference = Backend::new("f64", BackendChoice::Reference { threads: Some(1) });
    let mut checker = Checker::new(vec![broken], reference);
    let mut fails = |check, interrupt: bool| checker.fails(check, &one_ball(), &AtomicBool::new(interrupt));
    assert!(fails(Check::Energy, false).is_some_and(|reason| reason.starts_with("broken: ")));
    assert_eq!(fails(Check::Energy, true), None);
    assert_eq!(fails(Check::Copies, false), None);
}

#[test]
fn the_sky_is_the_most_that_a_pixel_may_have() {
    let mut recipe = one_ball();
    let sky = Sky { bottom: DVec3::new(0.25, 1.0, 0.5), top: DVec3::new(0.5, 0.25, 1.0) };
    Arc::make_mut(&mut recipe.scene).sky = sky;
    let of = |pixel: usize, light: [f64; 3]| {
        let mut film = Film::new(2, 1, 1);
        film.halves_mut()[0][pixel] = crate::film::fixed_point(light).unwrap();
        film.record(0..1, 0).unwrap();
        has_no_more_light(&recipe, &film).err()
    };
    assert_eq!(of(0, [0.5 * (1.0 + 0.9e-5), 1.0, 1.0 + 0.9e-5]), None);
    let reason = of(1, [0.5 * (1.0 + 1.1e-5), 0.0, 0.0]).unwrap();
    assert!(reason.starts_with("pixel 1 is 0.50000") && reason.ends_with("at most 0.5"), "{reason}");
    let reason = of(0, [0.0, 0.0, 1.0 + 1.1e-5]).unwrap();
    assert!(reason.starts_with("pixel 0 is 1.00001") && reason.ends_with("at most 1"), "{reason}");
}

/// Why a check of a painted scene with one ball fails.
fn failure(check: Check, cpu: Backend, reference: Backend) -> Option<String> {
    let recipe = sized(one_ball(), [2, 2], 4);
    Checker::new(vec![cpu], reference).fails(check, &recipe, &AtomicBool::new(false))
}

#[test]
fn a_check_compares_a_backend_with_the_reference_or_with_itself() {
    let off = "cpu: off by -2.5e-1; at most 1.0e-5 is allowed";
    let exact = || grey("f64", |_| 0.5);
    assert_eq!(failure(Check::Rounding, grey("cpu", |_| 0.5), exact()), None);
    assert_eq!(failure(Check::Rounding, grey("cpu", |_| 0.75), exact()).as_deref(), Some(off));
    // What the reference makes of a scene only counts beside the other precision.
    for check in [Check::Hierarchy, Check::Scaling, Check::Translation, Check::Energy] {
        assert_eq!(failure(check, grey("cpu", |_| 0.75), exact()), None, "{check:?}");
    }
    let is_near = |job: &RenderJob| job.camera().look_from.length() < 4.0;
    type IsOne = fn(&RenderJob) -> bool;
    let cases: [(Check, IsOne); 3] = [
        (Check::Hierarchy, |job| job.scene().spheres.len() == 1),
        (Check::Scaling, |job| job.scene().spheres[0].radius == 1.0),
        (Check::Translation, is_near),
    ];
    for (check, is_one) in cases {
        let cpu = grey("cpu", move |job| if is_one(job) { 0.75 } else { 0.5 });
        assert_eq!(failure(check, cpu, exact()).as_deref(), Some(off), "{check:?}");
    }
}

#[test]
fn what_a_backend_warns_about_is_no_failure() {
    // Warns of the first picture, of the other one, or of none.
    let cpu = |of_one: bool, of_other: bool| {
        painted("cpu", move |job, samples, film| {
            let is_one = job.scene().spheres[0].radius == 1.0;
            fill(film, samples, if is_one { 0.75 } else { 0.5 })?;
            let is_warned = if is_one { of_one } else { of_other };
            Ok(if is_warned { vec!["too thin".to_owned()] } else { Vec::new() })
        })
    };
    for (of_one, of_other) in [(false, false), (true, false), (false, true)] {
        let found = failure(Check::Scaling, cpu(of_one, of_other), grey("f64", |_| 0.5));
        assert_eq!(found.is_none(), of_one || of_other, "{of_one} {of_other}: {found:?}");
    }
    assert_eq!(failure(Check::Rounding, cpu(true, false), grey("f64", |_| 0.5)), None);
    // A warning of the reference is no excuse.
    let warning = painted("f64", |_, samples, film| {
        fill(film, samples, 0.5)?;
        Ok(vec!["too thin".to_owned()])
    });
    assert!(failure(Check::Rounding, cpu(false, false), warning).is_some());
}

#[test]
fn a_difference_is_looked_at_again_with_more_samples_unless_it_is_light_from_nowhere() {
    let pictures = Arc::new(AtomicU64::new(0));
    // Pictures have the wrong light up to the look with this number, counted from 0.
    let cpu = |right_from_look: u64, wrong: f64| {
        let pictures = Arc::clone(&pictures);
        pictures.store(0, Ordering::Relaxed);
        painted("cpu", move |_, samples, film| {
            let looks = pictures.fetch_add(1, Ordering::Relaxed);
            fill(film, samples, if looks < right_from_look { wrong } else { 0.5 })?;
            Ok(Vec::new())
        })
    };
    let found = |check, right_from_look, wrong| {
        let reason = failure(check, cpu(right_from_look, wrong), grey("f64", |_| 0.5));
        (reason.is_some(), pictures.load(Ordering::Relaxed))
    };
    assert_eq!(
        [0, 1, 2, 3].map(|look| found(Check::Rounding, look, 0.25)),
        [(false, 1), (false, 2), (false, 3), (true, 3)]
    );
    assert_eq!([0, 1, 2].map(|look| found(Check::Energy, look, 1.5)), [(false, 1), (true, 1), (true, 1)]);
}

#[test]
fn the_first_check_that_fails_is_named_and_rejected_samples_are_counted() {
    let recipe = sized(one_ball(), [2, 2], 4);
    let mut checker = Checker::new(vec![grey("cpu", |_| 1.5)], grey("f64", |_| 1.5));
    let found = checker.first_failure(&recipe, &AtomicBool::new(false));
    assert_eq!(found, Some((Check::Energy, "cpu: pixel 0 is 1.5; the sky is at most 1".to_owned())));
    let rejecting = |name, count: u64| {
        painted(name, move |_, samples, film| {
            film.record(samples, count)?;
            Ok(Vec::new())
        })
    };
    assert_eq!(
        failure(Check::Rounding, rejecting("cpu", 3), rejecting("f64", 4)).as_deref(),
        Some("cpu: rejected samples (NaN, infinite or negative): 7")
    );
}
