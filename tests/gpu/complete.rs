//! All requested samples are added, despite long paths, many samples, loops that a driver cuts short, and a device that
//! leaves samples out.

use crate::common::films::{mean, rendered};
use crate::common::gpu::{cpu, go_on, gpu, job_of, three_spheres};
use glam::DVec3;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use weekender::job::render::{Control, RenderError, RenderJob, Renderer, SamplerKind, Stats};
use weekender::render_gpu::{GpuOptions, GpuRenderer, ITERATION_LIMIT};
use weekender::scene::builtin::{BOOK_CAMERA, BuiltinScene, book};
use weekender::scene::{Camera, Material, Scene, Sky};
use weekender::stages::{Rules, SurfaceRule};

/// Each thread needs far more loop iterations than llvmpipe allows.
#[test]
fn few_pixels_with_many_samples() {
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    let job = three_spheres([4, 4], 50);
    let samples = 2 * u64::from(ITERATION_LIMIT);
    let [on_gpu, on_cpu] =
        [&mut gpu as &mut dyn Renderer, &mut cpu()].map(|r| mean(&rendered(r, &job, samples)));
    assert!((on_gpu - on_cpu).abs() < 1e-4, "{on_gpu} {on_cpu}");
}

/// The eye in a closed white ball: every path runs to its last ray, and none brings light.
fn closed(max_depth: u32) -> RenderJob {
    let mut scene = Scene { sky: Sky { bottom: DVec3::ONE, top: DVec3::ONE }, ..Scene::default() };
    let white = scene.add_material("white", Material::Lambertian { albedo: DVec3::ONE });
    scene.add_sphere(DVec3::new(0.0, 0.0, -0.25), 1.0, white);
    job_of(&scene, Camera::default(), [5, 3], max_depth, SamplerKind::Independent)
}

#[test]
fn longest_paths_are_complete() {
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    let job = closed(10_000);
    let mut film = job.new_film();
    let stats = gpu.accumulate(&job, 0..8, &mut film, &go_on()).unwrap();
    assert_eq!((stats.paths, stats.rays), (15 * 8, 15 * 8 * 10_000));
    assert_eq!((film.rejected(), mean(&film)), (0, 0.0));
}

/// Suspending paths does not change the film, even with glass that stores the angle of incidence from ray to ray.
#[test]
fn suspending_paths_keeps_film() {
    let three = (BuiltinScene::ALL[0].build)();
    let mut steep = three.clone();
    for named in &mut steep.0.materials {
        if let Material::Dielectric { refraction_index } = &mut named.material {
            *refraction_index = 6.0;
        }
    }
    let Some(mut at_once) = gpu(GpuOptions::default()) else { return };
    let mut in_turns = gpu(GpuOptions { iteration_limit: Some(1), ..GpuOptions::default() }).unwrap();
    for (scene, camera) in [three, (book(), BOOK_CAMERA), steep] {
        for sampler in SamplerKind::ALL {
            let job = job_of(&scene, camera, [20, 11], 30, sampler);
            let expected = rendered(&mut at_once, &job, 5);
            assert!(rendered(&mut in_turns, &job, 5) == expected, "{sampler:?}");
        }
    }
    assert!(in_turns.report().dispatches > 10 * at_once.report().dispatches);
}

/// A renderer that suspends most paths.
fn suspending() -> Option<GpuRenderer> {
    gpu(GpuOptions { iteration_limit: Some(8), samples_per_dispatch: Some(1), ..GpuOptions::default() })
}

/// A renderer that was used before renders like a new one.
fn assert_starts_afresh(mut used: GpuRenderer) {
    let (scene, camera) = (BuiltinScene::ALL[0].build)();
    let job = job_of(&scene, camera, [5, 3], 30, SamplerKind::Independent);
    assert!(rendered(&mut used, &job, 8) == rendered(&mut suspending().unwrap(), &job, 8));
    let messages = used.take_messages();
    assert!(!messages.iter().any(|message| message.contains("traced again")), "{messages:?}");
}

/// A picture does not resume the suspended paths of an abandoned one.
#[test]
fn abandoned_paths_are_not_resumed() {
    let Some(mut used) = suspending() else { return };
    let long = closed(200);
    // Cancel while dispatches are under way, however long the device takes to start.
    let mut time = Duration::from_millis(10);
    while used.report().dispatches < 3 {
        let cancel = go_on();
        std::thread::scope(|scope| {
            scope.spawn(|| {
                std::thread::sleep(time);
                cancel.store(true, Ordering::Relaxed);
            });
            let outcome = used.accumulate(&long, 0..1000, &mut long.new_film(), &cancel);
            assert!(matches!(outcome, Err(RenderError::Cancelled)), "{outcome:?}");
        });
        time *= 2;
    }
    assert_starts_afresh(used);
}

/// A picture does not resume the paths of an earlier one whose rays no loop of the driver can trace.
#[test]
fn stuck_paths_are_not_resumed() {
    let Some(mut used) = suspending() else { return };
    if !used.adapter().is_software {
        return;
    }
    // Rays along the axis pass through the boxes of all balls and miss the balls.
    let mut scene = Scene::default();
    let matte = scene.add_material("matte", Material::Lambertian { albedo: DVec3::splat(0.5) });
    for i in 0..70_000 {
        scene.add_sphere(DVec3::new(0.8, 0.8, -2.0 - 1e-3 * f64::from(i)), 1.0, matte);
    }
    let camera = Camera { vfov_degrees: 0.1, ..Camera::default() };
    let long = job_of(&scene, camera, [5, 3], 30, SamplerKind::Independent);
    let error = used.accumulate(&long, 0..1, &mut long.new_film(), &go_on()).unwrap_err().to_string();
    assert!(error.contains("a loop of this driver"), "{error}");
    assert_starts_afresh(used);
}

/// A film keeps the samples it has; those still on the device are traced again and do not count twice.
#[test]
fn cancelled_samples_on_device_are_lost() {
    let Some(mut other) = gpu(GpuOptions::default()) else { return };
    let job = three_spheres([16, 9], 12);
    let expected = rendered(&mut other, &job, 8);
    let mut used = gpu(GpuOptions::default()).unwrap();
    for _ in 0..2 {
        let mut film = job.new_film();
        used.advance(&job, 0..4, &mut film, &Control::deferring(&go_on())).unwrap();
        used.advance(&job, 4..8, &mut film, &Control::deferring(&go_on())).unwrap();
        let outcome = used.advance(&job, 8..12, &mut film, &Control::deferring(&AtomicBool::new(true)));
        assert!(matches!(outcome, Err(RenderError::Cancelled)), "{outcome:?}");
        assert_eq!(used.finish(&mut film).unwrap(), Stats::default());
        let held = film.sample_count();
        assert!(held < 8, "the last samples cannot have come: {held}");
        used.accumulate(&job, held..8, &mut film, &go_on()).unwrap();
        assert!(film == expected);
    }
}

/// If a list needs more iterations per ray than a dispatch allows, the picture is traced ray by ray. A list that no
/// loop can handle is refused.
#[test]
fn long_lists_are_complete_or_refused() {
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    let list = |count: u32| {
        let (mut scene, camera) = (BuiltinScene::ALL[0].build)();
        let far = scene.add_material("far", Material::Lambertian { albedo: DVec3::splat(0.5) });
        for i in 0..count {
            scene.add_sphere(DVec3::new(f64::from(i % 100), 3.0, 40.0 + f64::from(i / 100)), 0.3, far);
        }
        let settings = *job_of(&scene, camera, [6, 4], 8, SamplerKind::Sobol).settings();
        let rules = Rules { surface: SurfaceRule::Acne, ..Rules::default() };
        RenderJob::new(scene, camera, settings, rules).unwrap()
    };
    let job = list(6000);
    let [on_gpu, on_cpu] = [&mut gpu as &mut dyn Renderer, &mut cpu()].map(|r| mean(&rendered(r, &job, 4)));
    assert!((on_gpu - on_cpu).abs() < 0.05, "{on_gpu} {on_cpu}");
    let job = list(ITERATION_LIMIT);
    let outcome = gpu.accumulate(&job, 0..1, &mut job.new_film(), &go_on());
    if gpu.adapter().is_software {
        let error = outcome.unwrap_err().to_string();
        assert!(error.contains("32768") && error.contains("CPU"), "{error}");
    }
}

/// A renderer whose dispatches are longer than llvmpipe allows, and a job for it; `None` on other adapters.
fn cut_short(samples_per_dispatch: u64) -> Option<(GpuRenderer, RenderJob)> {
    let (samples_per_dispatch, iteration_limit) = (Some(samples_per_dispatch), Some(u32::MAX));
    let gpu = gpu(GpuOptions { samples_per_dispatch, iteration_limit, ..GpuOptions::default() })?;
    let job = three_spheres([5, 3], 12);
    gpu.adapter().is_software.then_some((gpu, job))
}

#[test]
fn samples_that_a_driver_leaves_out_are_traced_again() {
    const SAMPLES: u64 = 1 << 17;
    let Some((mut short, job)) = cut_short(SAMPLES) else { return };
    let expected = rendered(&mut gpu(GpuOptions::default()).unwrap(), &job, SAMPLES);
    // Over several passes, whenever it is noticed.
    let mut film = job.new_film();
    for start in [0, SAMPLES / 2] {
        let (range, control) = (start..start + SAMPLES / 2, go_on());
        short.advance(&job, range, &mut film, &Control::deferring(&control)).unwrap();
        short.request_readback().unwrap();
    }
    short.finish(&mut film).unwrap();
    assert!(film == expected);
    let said = short.take_messages().join("; ");
    assert!(said.contains("traced again") && said.contains("the device added only"), "{said}");
}

#[test]
fn a_driver_that_always_leaves_samples_out_is_given_up() {
    let Some((mut short, job)) = cut_short(1 << 24) else { return };
    let mut film = job.new_film();
    let error = short.accumulate(&job, 0..1 << 24, &mut film, &go_on()).unwrap_err().to_string();
    assert!(error.contains("the device added only") && error.contains("CPU"), "{error}");
    assert!(film == job.new_film());
}

#[test]
fn duplicate_samples_are_refused() {
    let job = three_spheres([16, 9], 12);
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    let expected = rendered(&mut gpu, &job, 4);
    assert!(gpu.report().films > 0 && gpu.report().film_time > Duration::ZERO);
    gpu.advance(&job, 0..4, &mut job.new_film(), &Control::deferring(&go_on())).unwrap();
    let mut film = expected.clone();
    let outcome = gpu.finish(&mut film);
    assert!(matches!(outcome, Err(RenderError::Film(_))), "{outcome:?}");
    assert!(film == expected);
    assert!(rendered(&mut gpu, &job, 4) == expected);
}
