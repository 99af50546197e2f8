//! Tests of the second picture.

use super::*;
use crate::app::model::view::With;
use crate::backends::BackendChoice;
use crate::measure::stress::shown_cases;
use crate::progressive::{Phase, Stop, View};
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
