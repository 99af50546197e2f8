//! Cases on backends that work and on one that does not.

use super::*;
use crate::backends::BackendChoice;
use crate::render_cpu::CpuOptions;
use crate::stress::families::build::{moved, one_ball, sized, tame};
use crate::stress::families::{cases, families};

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
