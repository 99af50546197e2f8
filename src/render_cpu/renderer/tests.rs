//! Tests of the renderer on the CPU.

use super::*;
use crate::job::render::tests::sized;
#[cfg(target_os = "linux")]
use crate::render_cpu::priority::NICENESS;
use crate::scene::{Material, Sphere};
use glam::DVec3;
use std::sync::atomic::AtomicUsize;

fn small(scene: &str) -> RenderJob {
    sized(scene, [20, 12])
}

fn film(renderer: &mut CpuRenderer, job: &RenderJob) -> Film {
    let mut film = job.new_film();
    renderer.accumulate(job, 0..4, &mut film, &AtomicBool::new(false)).expect("traced");
    film
}

#[test]
fn camera_move_keeps_hierarchy_and_film() {
    let first = small("field:200");
    let mut moved = *first.camera();
    moved.look_from += DVec3::new(0.5, 0.25, -1.0);
    moved.defocus_angle_degrees = 1.0;
    let scene = first.scene();
    let is_small_and_opaque =
        |s: &&Sphere| s.radius < 10.0 && !matches!(scene.material_of(s), Material::Dielectric { .. });
    let mut inside = *first.camera();
    inside.look_from = scene.spheres.iter().find(is_small_and_opaque).expect("one").center;
    let mut renderer = CpuRenderer::new(CpuOptions::default()).expect("available");
    film(&mut renderer, &first);
    assert_ne!(renderer.diagnostics().kernel.hierarchy_time, Duration::ZERO);
    // Inside an opaque ball nothing else is visible, so there is nothing to build.
    for (camera, is_kept) in [(moved, true), (inside, true), (moved, false), (*first.camera(), true)] {
        let job = first.seen_by(camera, *first.settings()).expect("valid");
        let again = film(&mut renderer, &job);
        assert_eq!(renderer.diagnostics().kernel.hierarchy_time == Duration::ZERO, is_kept, "{camera:?}");
        let mut fresh = CpuRenderer::new(CpuOptions::default()).expect("available");
        assert!(again == film(&mut fresh, &job), "{camera:?}");
    }
}

#[test]
fn sample_time_is_estimated_for_a_prepared_job() {
    let (job, never) = (small("three-spheres"), AtomicBool::new(false));
    let mut renderer = CpuRenderer::new(CpuOptions::default()).expect("available");
    assert_eq!(renderer.estimate_sample_time(16, &never), None, "nothing is prepared");
    renderer.prepare(&job, &never).expect("prepared");
    assert!(renderer.estimate_sample_time(16, &never).is_some_and(|time| time > Duration::ZERO));
    assert_eq!(renderer.estimate_sample_time(16, &AtomicBool::new(true)), None, "it was cancelled");
}

#[test]
fn stopped_pass_is_whole_or_withdrawn() {
    let (job, never) = (sized("three-spheres", [256, 144]), AtomicBool::new(false));
    let mut renderer =
        CpuRenderer::new(CpuOptions { threads: Some(2), ..CpuOptions::default() }).expect("available");
    let mut held = job.new_film();
    renderer.accumulate(&job, 0..4, &mut held, &never).expect("traced");
    let mut whole = held.clone();
    let begin = Instant::now();
    renderer.accumulate(&job, 4..68, &mut whole, &never).expect("traced");
    let pass = begin.elapsed();
    for eighths in [0, 1, 2, 3, 4, 6] {
        let (mut film, stop) = (held.clone(), AtomicBool::new(eighths == 0));
        let outcome = std::thread::scope(|scope| {
            scope.spawn(|| {
                std::thread::sleep(eighths * pass / 8);
                stop.store(true, Ordering::Relaxed);
            });
            let control = Control { stop: &stop, ..Control::new(&never) };
            renderer.advance(&job, 4..68, &mut film, &control).expect("no failure")
        });
        let is_withdrawn = outcome == Outcome::Withdrawn;
        assert!(film == if is_withdrawn { held.clone() } else { whole.clone() }, "{eighths} eighths");
        assert!(eighths > 0 || is_withdrawn, "it should be given up");
    }
}

/// The tracer panics in the middle of a tile.
#[test]
fn panic_in_a_tile_leaves_the_film_unchanged() {
    let (job, never) = (sized("three-spheres", [100, 70]), AtomicBool::new(false));
    let mut renderer = CpuRenderer::new(CpuOptions::default()).expect("available");
    let mut film = job.new_film();
    renderer.accumulate(&job, 0..6, &mut film, &never).expect("traced");
    let before = film.clone();
    let Some(Prepared::Single(_, kernel)) = &mut renderer.prepared else { panic!("no packets") };
    let whole = std::mem::replace(kernel, Box::new(|_, _| TileStats::default()));
    let tiles = AtomicUsize::new(0);
    *kernel = Box::new(move |scene, work| {
        if tiles.fetch_add(1, Ordering::Relaxed) == 3 {
            work.rows.last_mut().into_iter().for_each(|row| *row = &mut []);
        }
        whole(scene, work)
    });
    let error = renderer.accumulate(&job, 6..40, &mut film, &never).expect_err("a row is missing");
    assert!(matches!(error, RenderError::Backend { backend: "cpu", .. }), "{error}");
    assert!(error.to_string().contains("panicked"), "{error}");
    assert!(film == before);
    // The next attempt works.
    renderer.accumulate(&job, 6..40, &mut film, &never).expect("traced");
    let mut expected = job.new_film();
    renderer.accumulate(&job, 0..40, &mut expected, &never).expect("traced");
    assert!(film == expected);
}

#[cfg(target_os = "linux")]
#[test]
fn low_priority_threads_are_nicer() {
    let niceness = |low_priority| {
        let options = CpuOptions { threads: Some(1), low_priority, ..CpuOptions::default() };
        CpuRenderer::new(options).unwrap().threads.install(|| {
            let stat = std::fs::read_to_string("/proc/thread-self/stat").unwrap();
            // The 19th field; the second is a name in brackets, which may hold blanks.
            let (_, from_third) = stat.rsplit_once(") ").unwrap();
            from_third.split(' ').nth(16).unwrap().parse::<i32>().unwrap()
        })
    };
    assert_eq!(niceness(true), (niceness(false) + NICENESS).min(19));
}
