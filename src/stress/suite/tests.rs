//! Cases on backends that work and on one that does not.

use super::*;
use crate::backends::BackendChoice;
use crate::render::{RenderError, RenderJob};
use crate::render_cpu::CpuOptions;
use crate::stress::families::build::{moved, one_ball, sized, tame};
use crate::stress::families::{cases, families};
use crate::stress::painted::{fill, grey, painted};

#[test]
fn a_backend_that_does_not_start_has_no_picture_and_is_not_right() {
    let no_kernel = CpuOptions { isa: Some(Isa::Portable), lanes: Some(3), ..CpuOptions::default() };
    let reference = Backend::new("f64", BackendChoice::Reference { threads: Some(1) });
    let mut suite = Suite::new(vec![Backend::new("cpu", BackendChoice::Cpu(no_kernel))], reference);
    let case = cases().iter().find(|case| case.id == "shells/1").unwrap();
    let report = suite.run(case, &AtomicBool::new(false));
    let [cpu, reference, ..] = report.measured.as_slice() else { panic!("{report:#?}") };
    assert!(cpu.verdict.reason().contains("has no 3 lanes") && cpu.mean.is_none(), "{cpu:?}");
    assert!(reference.verdict.is_right() && !report.is_right(), "{report:#?}");
}

#[test]
fn a_case_is_measured_on_every_backend_in_every_form() {
    let options = CpuOptions { threads: Some(1), ..CpuOptions::default() };
    let reference = Backend::new("f64", BackendChoice::Reference { threads: Some(1) });
    let mut suite = Suite::new(vec![Backend::new("cpu", BackendChoice::Cpu(options))], reference);
    assert_eq!(suite.names(), ["cpu", "f64"]);
    let find = |id: &str| cases().iter().find(|case| case.id == id).unwrap();
    let report = suite.run(find("shells/1"), &AtomicBool::new(false));
    let who: Vec<_> = report.measured.iter().map(|m| (m.backend.as_str(), m.form)).collect();
    assert_eq!(who, [("cpu", "plain"), ("f64", "plain"), ("cpu", "+40"), ("f64", "+40")]);
    assert!(report.is_right(), "{report:#?}");
    assert_eq!(report.measured[0].mean, Some(0.5));
    assert_eq!(report.first_hits, Some(FirstHits { rays: 64, agree: 64 }));
    assert!(report.measured[0].rounding.is_some() && report.measured[1].rounding.is_none());
    assert_eq!(report.book.iter().map(|book| book.precision).collect::<Vec<_>>(), ["f32", "f64"]);

    let mut wrong = find("shells/1").clone();
    wrong.expected = Expected::Mean { value: 0.6, why: "it is not" };
    let report = suite.run(&wrong, &AtomicBool::new(false));
    assert!(report.measured.iter().all(|measured| !measured.verdict.is_right()), "{report:#?}");

    // Balls of half a millimetre are smaller than the book's threshold.
    let small = suite.run(find("scaled/1e-3"), &AtomicBool::new(false));
    assert!(small.is_right(), "{small:#?}");
    assert!(small.book.iter().all(|book| !book.verdict.is_right()), "{:#?}", small.book);
}

#[test]
fn an_eye_on_a_surface_is_moved_out_by_a_few_units_in_the_last_place() {
    let ball = one_ball().scene;
    let at = |places: f64| DVec3::Y * (1.0 + places * f64::EPSILON);
    // With an eye and a radius of 1, a digit is worth two units in the last place of 1.
    for places in [-7.0, 0.0, 7.0] {
        let moved = (outside(&ball, at(places)).y - 1.0) / f64::EPSILON;
        assert!((15.0..=17.0).contains(&moved), "{places}: {moved}");
    }
    for places in [-9.0, 9.0] {
        assert_eq!(outside(&ball, at(places)), at(places), "{places}");
    }
    let afar = moved(&one_ball(), 1.0, DVec3::new(0.0, 1024.0, 0.0)).scene;
    let places = (outside(&afar, DVec3::new(0.0, 1025.0, 0.0)).y - 1025.0) / f64::EPSILON;
    assert!((16_000.0..17_000.0).contains(&places), "{places}");
}

#[test]
fn rays_are_checked_one_by_one_unless_there_are_too_many_spheres_or_a_lens() {
    let found = first_hits(&tame());
    assert!(found.is_some_and(|hits| hits.rays == 64 && hits.is_right()), "{found:?}");
    let mut recipe = tame();
    recipe.camera.defocus_angle_degrees = 1.0;
    assert_eq!(first_hits(&recipe), None);
    let many = |count: usize| {
        let mut recipe = one_ball();
        let scene = std::sync::Arc::make_mut(&mut recipe.scene);
        scene.spheres = vec![scene.spheres[0]; count];
        first_hits(&recipe)
    };
    assert_eq!(many(CHECKED_SPHERES), Some(FirstHits { rays: 64, agree: 64 }));
    assert_eq!(many(CHECKED_SPHERES + 1), None);
}

#[test]
fn another_scene_is_rendered_once_by_each_backend_and_a_twin_for_the_plain_form() {
    let options = CpuOptions { threads: Some(1), ..CpuOptions::default() };
    let reference = Backend::new("f64", BackendChoice::Reference { threads: Some(1) });
    let mut suite = Suite::new(vec![Backend::new("cpu", BackendChoice::Cpu(options))], reference);
    let go_on = AtomicBool::new(false);
    let (small, family) = (sized(tame(), [12, 8], 4), families().next().unwrap());
    let case = Case::new(family, "tame", "nothing", small.clone());
    let same = Expected::Same { other: Box::new(small), why: "it is" };
    let reports = [suite.run(&case, &go_on), suite.run(&case.clone().expect(same, 2e-6), &go_on)];
    for report in &reports {
        assert!(report.is_right(), "{report:#?}");
        assert!(report.measured.iter().all(|m| m.seconds.is_some() && m.tame_seconds.is_none()));
        for book in &report.book {
            let (mean, offset) = (book.mean.unwrap(), book.offset.unwrap());
            assert!((0.2..0.9).contains(&mean) && offset.abs() < 0.05, "{book:?}");
        }
    }
    let own = &reports[1].measured[0];
    assert_eq!((own.offset, own.rounding.is_some()), (Some(0.0), true), "a picture is like itself");
    assert_eq!(suite.shared.len(), 2);
    let report = suite.run(&case.beside(sized(one_ball(), [4, 4], 1)), &go_on);
    let timed: Vec<bool> = report.measured.iter().map(|m| m.tame_seconds.is_some()).collect();
    assert_eq!(timed, [true, true, false, false]);
}

#[test]
fn a_hit_agrees_within_a_part_of_its_distance_and_a_margin() {
    assert!(agrees(None, None, 1.0));
    assert!(!agrees(Some(1.0), None, 1.0) && !agrees(None, Some(1.0), 1.0));
    // A hundred-thousandth of 1000, and a hundredth.
    for (off, is_same) in [(0.0, true), (0.0199, true), (-0.0199, true), (0.0201, false), (-0.0201, false)] {
        assert_eq!(agrees(Some(1000.0 + off), Some(1000.0), 0.01), is_same, "{off}");
    }
    assert!(!agrees(Some(f64::NAN), Some(1.0), 1.0));
}

/// A small case that is no scene of its own: its pictures are painted.
fn made_up(expected: Expected) -> Case {
    let family = families().next().unwrap();
    Case::new(family, "made-up", "nothing", sized(one_ball(), [4, 3], 4)).expect(expected, 1e-6)
}

/// Mean, offset and whether it is right, of each measurement.
fn figures(report: &CaseReport) -> Vec<(&str, &str, [f64; 2], bool)> {
    let rounded = |x: Option<f64>| (1000.0 * x.unwrap_or(f64::NAN)).round() / 1000.0;
    let of = |m: &Measured| [rounded(m.mean), rounded(m.offset)];
    report.measured.iter().map(|m| (m.backend.as_str(), m.form, of(m), m.verdict.is_right())).collect()
}

#[test]
fn each_backend_is_compared_with_its_own_picture_and_the_books_with_ours() {
    let is_book = |job: &RenderJob| job.rules().surface == SurfaceRule::Book;
    let cpu = grey("cpu", move |job| if is_book(job) { 0.875 } else { 0.75 });
    let exact = grey("f64", move |job| if is_book(job) { 0.625 } else { 0.5 });
    let mut suite = Suite::new(vec![cpu], exact);
    let other = Box::new(sized(tame(), [4, 3], 4));
    let report = suite.run(&made_up(Expected::Same { other, why: "it is" }), &AtomicBool::new(false));
    assert_eq!(
        figures(&report),
        [
            ("cpu", "plain", [0.75, 0.0], true),
            ("f64", "plain", [0.5, 0.0], true),
            ("cpu", "+40", [0.75, 0.0], true),
            ("f64", "+40", [0.5, 0.0], true),
        ]
    );
    let book: Vec<_> = report.book.iter().map(|book| (book.precision, book.mean, book.offset)).collect();
    assert_eq!(book, [("f32", Some(0.875), Some(0.375)), ("f64", Some(0.625), Some(0.125))]);
    assert!(report.book.iter().all(|book| !book.verdict.is_right()), "{:?}", report.book);
    let roundings: Vec<_> = report.measured.iter().map(|m| m.rounding.map(|paired| paired.bias)).collect();
    assert_eq!(roundings, [Some(0.25), None, Some(0.25), None]);
}

#[test]
fn every_form_is_compared_with_the_plain_picture_of_the_reference() {
    let is_far = |job: &RenderJob| job.scene().spheres.len() > 40;
    // Far spheres change what the reference makes of the scene, which is a fault of the reference.
    let exact = grey("f64", move |job| if is_far(job) { 0.25 } else { 0.5 });
    let mut suite = Suite::new(vec![grey("cpu", |_| 0.5), grey("gpu", |_| 0.25)], exact);
    let report = suite.run(&made_up(Expected::Reference { why: "it is" }), &AtomicBool::new(false));
    let expected = [
        ("cpu", "plain", [0.5, 0.0], true),
        ("gpu", "plain", [0.25, -0.25], false),
        ("f64", "plain", [0.5, 0.0], true),
        ("cpu", "+40", [0.5, 0.0], true),
        ("gpu", "+40", [0.25, -0.25], false),
        ("f64", "+40", [0.25, -0.25], false),
    ];
    assert_eq!(figures(&report), expected);
    assert!(!report.is_right());
    // Without a picture of the reference, nothing can be said.
    let failing = || RenderError::Backend { backend: "f64", reason: "gone".to_owned() };
    let mut suite = Suite::new(vec![grey("cpu", |_| 0.5)], painted("f64", move |_, _, _| Err(failing())));
    let case = made_up(Expected::Reference { why: "it is" });
    let report = suite.run(&case, &AtomicBool::new(false));
    let reasons: Vec<&str> = report.measured.iter().take(2).map(|m| m.verdict.reason()).collect();
    assert_eq!(reasons, ["the f64 reference has no picture", "f64 failed: gone"]);
}

#[test]
fn what_is_wrong_is_excused_by_a_warning_about_its_own_picture() {
    let verdicts = |cpu: Backend, value: f64| {
        let mut suite = Suite::new(vec![cpu], grey("f64", |_| 0.5));
        let expected = Expected::Every { value: [value; 3], why: "it is" };
        let report = suite.run(&made_up(expected), &AtomicBool::new(false));
        report.measured.into_iter().map(|measured| measured.verdict).collect::<Vec<_>>()
    };
    let warning = painted("cpu", |job, samples, film| {
        fill(film, samples, 0.75)?;
        let is_far = job.scene().spheres.len() > 40;
        Ok(if is_far { vec!["too far".to_owned()] } else { Vec::new() })
    });
    let found = verdicts(warning, 0.5);
    assert_eq!(found.iter().map(Verdict::name).collect::<Vec<_>>(), ["WRONG", "right", "warned", "right"]);
    let off = "off by +2.5e-1; at most 1.0e-6 is allowed";
    assert_eq!(
        [found[0].reason(), found[2].reason()],
        [off, format!("{off}; the backend warned: too far").as_str()]
    );
    let rejecting = painted("cpu", |_, samples, film| {
        film.record(samples, 3)?;
        Ok(Vec::new())
    });
    assert_eq!(verdicts(rejecting, 0.0)[0].reason(), "rejected samples (NaN, infinite or negative): 3");
}
