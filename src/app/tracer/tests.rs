//! Tests of the window's side of a render.

use super::*;
use crate::app::model::origin::Origin;
use crate::render_cpu::CpuOptions;
use crate::stages::Stage;

#[test]
fn passes_are_short_while_something_moves_and_few_during_a_pause() {
    let document = Document::new(Origin::usual());
    let backend = BackendChoice::Cpu(CpuOptions::default());
    let plan = |stop, is_moving, is_held, preview| {
        let view = View::Picture;
        Want { document: &document, backend: &backend, stop, view, is_moving, is_paused: false }
            .plan(is_held, preview)
    };
    let stop = Stop::at_samples(100);
    let still = plan(stop, false, false, Preview::NONE);
    assert_eq!((still.pass_target, still.stop, still.preview), (Duration::from_millis(40), stop, None));
    let moving = plan(stop, true, false, Preview { divisor: 2, samples: 4 });
    assert_eq!((moving.pass_target, moving.preview), (Duration::from_millis(10), Some(4)));
    let held = |stop| plan(stop, false, true, Preview::NONE).stop.samples;
    assert_eq!([stop, Stop::at_samples(3), Stop::default()].map(held), [Some(8), Some(3), Some(8)]);
}

#[test]
fn a_pause_holds_only_renders_that_began_during_it() {
    let mut document = Document::new(Origin::usual());
    document.set_size([16, 9]);
    let (backend, stop) = (BackendChoice::Cpu(CpuOptions::default()), Stop::at_samples(100));
    let want = |is_paused: bool| {
        let view = View::Picture;
        Want { document: &document, backend: &backend, stop, view, is_moving: false, is_paused }
    };
    let end = |tracer: &Tracer| tracer.told.as_ref().and_then(|(_, plan)| plan.stop.samples);
    let mut tracer = Tracer::new().unwrap();
    for (began_paused, ends) in [(false, [100_u64; 4]), (true, [8, 8, 100, 100])] {
        tracer.start(&want(began_paused), Preview::NONE, None).unwrap();
        let mut found = vec![end(&tracer)];
        for is_paused in [true, false, true] {
            tracer.adjust(&want(is_paused));
            found.push(end(&tracer));
        }
        assert_eq!(found, ends.map(Some), "began during a pause: {began_paused}");
    }
}

/// A small picture of a stage.
fn small(stage: &str) -> Document {
    let mut document = Document::new(Origin::of_stage(Stage::find(stage).unwrap()));
    document.give_size([16, 9]);
    document
}

fn cpu() -> BackendChoice {
    BackendChoice::Cpu(CpuOptions::default())
}

/// What a window asks for that shows this document. Its render never ends.
fn wish<'a>(document: &'a Document, backend: &'a BackendChoice, is_moving: bool) -> Want<'a> {
    Want {
        document,
        backend,
        stop: Stop::at_samples(4_000_000_000),
        view: View::Picture,
        is_moving,
        is_paused: false,
    }
}

#[test]
fn a_preview_is_followed_by_the_picture_and_a_first_look_once_it_has_been_seen() {
    let (document, backend) = (small("metal"), cpu());
    let want = wish(&document, &backend, false);
    for (is_look, is_pictured, is_followed) in
        [(false, false, true), (false, true, true), (true, false, false), (true, true, true)]
    {
        let mut tracer = Tracer::new().unwrap();
        tracer.start(&want, Preview { divisor: 2, samples: 4 }, None).unwrap();
        assert!(tracer.is_of(&document) && !tracer.is_full(&document));
        let started = tracer.started.as_mut().unwrap();
        (started.is_look, started.is_pictured) = (is_look, is_pictured);
        tracer.want(&want).unwrap();
        assert_eq!(tracer.is_full(&document), is_followed, "{is_look} {is_pictured}");
        // The same again goes on.
        let run = tracer.status().run;
        tracer.want(&want).unwrap();
        assert_eq!(tracer.status().run, run);
        tracer.restart();
        assert!(!tracer.is_of(&document));
        tracer.want(&want).unwrap();
        assert_eq!((tracer.status().run, tracer.is_full(&document)), (run + 1, true), "it begins anew");
    }
}

#[test]
fn what_cannot_be_rendered_is_refused_and_the_render_goes_on() {
    let (document, backend) = (small("metal"), cpu());
    let mut tracer = Tracer::new().unwrap();
    tracer.want(&wish(&document, &backend, false)).unwrap();
    let run = tracer.status().run;
    let mut invalid = document.clone();
    invalid.settings.width = 0;
    let reason = tracer.want(&wish(&invalid, &backend, false)).unwrap_err();
    assert!(reason.contains("width"), "{reason}");
    assert_eq!((tracer.status().run, tracer.newest_status().run), (run, run));
    assert!(tracer.is_of(&document) && !tracer.is_of(&invalid));
}
