//! Tests of the second picture.

use super::*;
use crate::app::command::Command;
use crate::app::model::slots::{Slot, SlotNumber};
use crate::app::model::view::With;
use crate::app::tests::{until, window};
use crate::app::window::Window;
use crate::backends::BackendChoice;
use crate::film::{Film, PixelSum};
use crate::measure::stress::shown_cases;
use crate::progressive::{Phase, Stop, View};
use crate::render::RenderSettings;
use crate::render_cpu::CpuOptions;
use crate::stages::{Stage, SurfaceRule};
use std::time::{Duration, Instant};

#[test]
fn a_film_is_taken_only_for_the_picture_that_is_compared() {
    let (mut second, context) = (Second::default(), Context::default());
    let stage = &Stage::ALL[0];
    let [mine, other] = [(); 2].map(|()| Arc::new(Origin::of_stage(stage)));
    let film = || ReferenceMeans { width: 1, height: 1, means: vec![[0.5; 3]], identity: None };
    let answer = |second: &mut Second, origin: &Arc<Origin>| {
        second.films.answer(&context).give((Arc::clone(origin), film()));
        second.receive();
        second.film().is_some()
    };
    assert!(!answer(&mut second, &mine), "the comparison is over");
    second.of = Some((Other::Stage(stage), Arc::clone(&mine)));
    assert!(!answer(&mut second, &other), "another picture is compared by now");
    assert!(answer(&mut second, &mine));
}

#[test]
fn the_second_picture_waits_and_goes_on_with_the_first() {
    let (mut second, context, mut view) = (Second::default(), Context::default(), ViewState::default());
    let mut document = Document::new(Origin::of_stage(Stage::find("glass-schlick").unwrap()));
    document.give_size([16, 9]);
    document.stop = Stop::at_samples(4_000_000_000);
    view.toggle(Mode::Wipe, With::Stage);
    let want = Want {
        document: &document,
        backend: &BackendChoice::Cpu(CpuOptions::default()),
        stop: document.stop,
        view: View::Picture,
        is_moving: false,
        is_paused: false,
    };
    let until = |second: &mut Second, what: &str, is_so: &dyn Fn(&Tracer) -> bool| {
        let begin = Instant::now();
        while !second.tracer.as_ref().is_some_and(is_so) {
            assert!(begin.elapsed() < Duration::from_secs(60), "never: {what}");
            std::thread::sleep(Duration::from_millis(1));
            assert!(second.follow(&context, &view, &want));
        }
    };
    until(&mut second, "samples", &|tracer: &Tracer| tracer.newest_status().samples_per_pixel > 0);
    second.pause();
    until(&mut second, "a pause", &|tracer: &Tracer| tracer.newest_status().phase == Phase::Paused);
    let samples = second.tracer.as_ref().unwrap().newest_status().samples_per_pixel;
    second.resume();
    until(&mut second, "more samples", &|tracer: &Tracer| tracer.newest_status().samples_per_pixel > samples);
}

#[test]
fn a_paused_comparison_goes_on_if_the_picture_is_started_anew() {
    let context = Context::default();
    let mut window = window("weekender --stage glass-schlick --size 16x9 --samples 4000000000 --device cpu");
    let is_in = |wanted: Phase| {
        move |window: &Window| {
            window.second.tracer.as_ref().is_some_and(|tracer| tracer.newest_status().phase == wanted)
        }
    };
    window.perform(&context, Command::Wipe);
    until(&mut window, &context, "a second picture", is_in(Phase::Tracing));
    window.perform(&context, Command::Pause);
    until(&mut window, &context, "a pause", is_in(Phase::Paused));
    window.perform(&context, Command::Restart);
    until(&mut window, &context, "the second picture again", is_in(Phase::Tracing));
}

#[test]
fn the_others_camera_moves_along_but_keeps_its_own() {
    let base = Camera::BOOK;
    let theirs = Camera { vfov_degrees: 30.0, ..base };
    let mine = Camera { look_from: glam::DVec3::Z, vfov_degrees: 80.0, ..base };
    let camera = camera_of(&mine, &base, &theirs);
    assert_eq!((camera.look_from, camera.vfov_degrees), (glam::DVec3::Z, 30.0));
    assert_eq!(camera_of(&mine, &base, &base), mine);
}

#[test]
fn the_other_stage_is_seen_by_my_camera_unless_that_is_the_difference() {
    let (mut second, view) = (Second::default(), ViewState::default());
    let mut of_cameras = Vec::new();
    for stage in Stage::ALL {
        let mut mine = Document::new(Origin::of_stage(stage));
        mine.camera.look_from += glam::DVec3::new(0.25, 0.5, 0.125);
        let other = view.other_of(stage).unwrap();
        let theirs = second.document_of(Other::Stage(other), &mine);
        if view.is_of_cameras(stage) {
            of_cameras.push(stage.id);
            assert_ne!(theirs.camera, mine.camera, "{}", stage.id);
        } else {
            assert_eq!(theirs.camera, mine.camera, "{}", stage.id);
        }
    }
    assert!(of_cameras.contains(&"view-distant") && !of_cameras.contains(&"glass-schlick"), "{of_cameras:?}");
}

#[test]
fn the_book_traces_the_same_picture_by_its_own_rules() {
    let mut second = Second::default();
    for case in shown_cases() {
        let mine = Document::new(Origin::of_case(case));
        let other = Other::ByTheBook(Arc::clone(&mine.origin), Arc::clone(&mine.checked));
        let theirs = second.document_of(other, &mine);
        assert_eq!(theirs.rules().surface, SurfaceRule::Book, "{}", case.id);
        assert_eq!((theirs.camera, theirs.settings, theirs.stop), (mine.camera, mine.settings, mine.stop));
    }
}

/// What a window asks for that shows this document.
fn wish<'a>(document: &'a Document, backend: &'a BackendChoice) -> Want<'a> {
    Want { document, backend, stop: document.stop, view: View::Picture, is_moving: false, is_paused: false }
}

#[test]
fn the_film_of_a_difference_is_that_of_the_picture_on_the_screen() {
    let (mut second, context, mut view) = (Second::default(), Context::default(), ViewState::default());
    let mut document = Document::new(Origin::of_stage(Stage::find("glass-schlick").unwrap()));
    document.give_size([16, 9]);
    document.stop = Stop::at_samples(4);
    let backend = BackendChoice::Cpu(CpuOptions::default());
    view.toggle(Mode::Difference, With::Stage);
    assert!(!second.is_over() && !second.has_picture(&document, &view));
    let begin = Instant::now();
    while second.film().is_none() {
        assert!(begin.elapsed() < Duration::from_secs(60), "no film");
        assert!(second.follow(&context, &view, &wish(&document, &backend)));
        std::thread::sleep(Duration::from_millis(1));
        second.receive();
        assert!(second.film().is_none() || second.shown().is_some(), "a film without a picture");
    }
    assert!(second.has_picture(&document, &view));
    let film = second.film().unwrap();
    assert_eq!((film.width, film.height), (16, 9));
    assert!(film.means.iter().flatten().any(|mean| *mean > 0.0), "it has samples");
    // A wipe needs only the picture.
    view.toggle(Mode::Wipe, With::Stage);
    assert!(second.follow(&context, &view, &wish(&document, &backend)));
    assert!(second.film().is_none() && second.shown().is_some());
    view.end_comparison();
    assert!(!second.follow(&context, &view, &wish(&document, &backend)));
    assert!(second.shown().is_none() && !second.has_picture(&document, &view));
}

#[test]
fn a_kept_picture_is_complete_and_goes_with_its_comparison() {
    let (mut second, context, mut view) = (Second::default(), Context::default(), ViewState::default());
    let mut document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
    document.give_size([4, 2]);
    let mut film = Film::new(4, 2, 1);
    film.halves_mut()[0].iter_mut().for_each(|sum| *sum = PixelSum([1 << 16; 3]));
    film.record(0..1, 0).unwrap();
    let kept = Arc::new(Kept::new(document.clone(), film, Arc::default(), None));
    let one = SlotNumber::ALL[0];
    view.slots.put(one, Slot { name: String::new(), kept: Arc::clone(&kept) });
    view.toggle(Mode::Difference, With::Slot(one));
    let backend = BackendChoice::Cpu(CpuOptions::default());
    let begin = Instant::now();
    while second.film().is_none() || second.shown().is_none() {
        assert!(begin.elapsed() < Duration::from_secs(60), "no film or no picture");
        assert!(second.follow(&context, &view, &wish(&document, &backend)));
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(Arc::ptr_eq(second.film().unwrap(), kept.means()));
    assert!(second.is_over() && second.has_picture(&document, &view) && second.shown_mut().is_some());
    view.toggle(Mode::Wipe, With::Slot(one));
    assert!(second.follow(&context, &view, &wish(&document, &backend)) && second.film().is_none());
    view.end_comparison();
    assert!(!second.follow(&context, &view, &wish(&document, &backend)));
    assert!(!second.is_over() && second.shown().is_none() && !second.has_picture(&document, &view));
}

#[test]
fn each_setting_of_the_camera_is_the_others_only_if_the_stages_differ_in_it() {
    let base = Camera { focus_distance: Some(1.0), ..Camera::BOOK };
    let [mine, theirs] = [1.0, 2.0].map(|by| Camera {
        look_from: base.look_from + glam::DVec3::splat(by),
        look_at: base.look_at - glam::DVec3::splat(by),
        vup: base.vup + glam::DVec3::X * by,
        vfov_degrees: base.vfov_degrees + by,
        defocus_angle_degrees: base.defocus_angle_degrees + by,
        focus_distance: base.focus_distance.map(|distance| distance + by),
    });
    // Gives `to` one setting of `from`.
    let changes: [fn(&mut Camera, &Camera); 6] = [
        |to, from| to.look_from = from.look_from,
        |to, from| to.look_at = from.look_at,
        |to, from| to.vup = from.vup,
        |to, from| to.vfov_degrees = from.vfov_degrees,
        |to, from| to.defocus_angle_degrees = from.defocus_angle_degrees,
        |to, from| to.focus_distance = from.focus_distance,
    ];
    for (index, change) in changes.into_iter().enumerate() {
        let (mut other, mut expected) = (base, mine);
        change(&mut other, &theirs);
        change(&mut expected, &theirs);
        assert_eq!(camera_of(&mine, &base, &other), expected, "setting {index}");
    }
}

#[test]
fn the_other_stage_has_my_settings_and_my_end_unless_that_is_the_difference() {
    let mut second = Second::default();
    let own = Stop::at_samples(33);
    // Of the pairs, one differs in the depth, and one in the samples that a picture without noise needs.
    for (mine, other, max_depth, stop) in [
        ("metal", "metal-fuzzy", 7, own),
        ("diffuse", "diffuse-limited", 5, own),
        ("aliased", "antialiased", 7, Stop::at_samples(64)),
    ] {
        let [mine, other] = [mine, other].map(|id| Stage::find(id).unwrap());
        let mut document = Document::new(Origin::of_stage(mine));
        document.give_size([16, 9]);
        (document.settings.seed, document.settings.max_depth, document.stop) = (5, 7, own);
        let theirs = second.document_of(Other::Stage(other), &document);
        assert_eq!(theirs.stage(), Some(other));
        let settings = RenderSettings { max_depth, ..document.settings };
        assert_eq!((theirs.settings, theirs.stop), (settings, stop), "{}", mine.id);
    }
}
