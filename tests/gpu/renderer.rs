//! The whole GPU renderer: known radiance, odd sizes, films continued by another backend, failures.

use crate::common::films::{parted, rendered};
use crate::common::gpu::{cpu, go_on, gpu, job_of, three_spheres};
use glam::DVec3;
use weekender::job::render::{Control, RenderError, RenderSettings, Renderer, SamplerKind, Stats};
use weekender::prepared::PreparedScene;
use weekender::render_gpu::{GpuError, GpuOptions, GpuRenderer, adapters};
use weekender::scene::builtin::{BOOK_CAMERA, BuiltinScene, field};
use weekender::scene::{Camera, Scene, Sky};
use weekender::stages::Stage;

#[test]
fn software_adapter_needs_permission() {
    let Some(software) = adapters().into_iter().find(|a| a.is_software) else { return };
    let options = GpuOptions { adapter: Some(software.name.clone()), ..GpuOptions::default() };
    assert!(matches!(GpuRenderer::new(options), Err(GpuError::Software { .. })));
    let options = GpuOptions { adapter: Some("no such thing".into()), ..GpuOptions::default() };
    let error = GpuRenderer::new(options).err().unwrap().to_string();
    assert!(error.contains(&software.name), "{error}");
}

/// A picture of one column or row, among others; the gradient ends in the last one.
#[test]
fn odd_sizes_and_depths() {
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    let mut gradient = Stage::find("ppm-gradient").unwrap().recipe();
    for size in [[1, 1], [1, 2000], [2000, 1], [3, 5], [65, 9], [2, 700]] {
        for max_depth in [1, 8] {
            let job = three_spheres(size, max_depth);
            let apart = parted(&rendered(&mut gpu, &job, 3), &rendered(&mut cpu(), &job, 3), 1e-4);
            assert!(apart <= 2, "{size:?}, {max_depth} rays: {apart}");
        }
        [gradient.settings.width, gradient.settings.height] = size;
        let job = gradient.job().unwrap();
        assert!(parted(&rendered(&mut gpu, &job, 1), &rendered(&mut cpu(), &job, 1), 1e-6) == 0, "{size:?}");
    }
}

#[test]
fn dispatches_and_slabs_are_invisible() {
    let Some(mut whole) = gpu(GpuOptions::default()) else { return };
    let job = three_spheres([50, 43], 12);
    let expected = rendered(&mut whole, &job, 37);
    let row = 50 * 2 * 24;
    for options in [
        GpuOptions { samples_per_dispatch: Some(1), ..GpuOptions::default() },
        GpuOptions { samples_per_dispatch: Some(37), ..GpuOptions::default() },
        GpuOptions { film_limit: Some(row * 11), ..GpuOptions::default() },
        GpuOptions { dispatch_target: std::time::Duration::from_micros(50), ..GpuOptions::default() },
    ] {
        let mut renderer = gpu(options.clone()).unwrap();
        assert!(rendered(&mut renderer, &job, 37) == expected, "{options:?}");
    }
    let mut renderer = gpu(GpuOptions { film_limit: Some(row), ..GpuOptions::default() }).unwrap();
    let error = renderer.prepare(&job, &go_on()).unwrap_err().to_string();
    assert!(error.contains("binds at most"), "{error}");
}

#[test]
fn specialised_is_general() {
    let Some(mut specialised) = gpu(GpuOptions::default()) else { return };
    let Some(mut general) = gpu(GpuOptions { specialise: false, ..GpuOptions::default() }) else { return };
    let mut left_out = [0; 2];
    for scene in &BuiltinScene::ALL[..2] {
        let (spheres, camera) = (scene.build)();
        let job = job_of(&spheres, camera, [96, 54], 20, SamplerKind::Sobol);
        let (a, b) = (rendered(&mut specialised, &job, 1), rendered(&mut general, &job, 1));
        assert!(parted(&a, &b, 1e-3) <= 3, "{}", scene.name);
        left_out[0] += specialised.diagnostics().kernel.left_out.len();
        left_out[1] += general.diagnostics().kernel.left_out.len();
    }
    assert!(left_out[0] > left_out[1], "{left_out:?}");
}

#[test]
fn samples_stay_on_device_until_read_back() {
    let new = || gpu(GpuOptions { film_limit: Some(50 * 2 * 24 * 16), ..GpuOptions::default() });
    let (Some(mut other), Some(mut gpu)) = (new(), new()) else { return };
    let job = three_spheres([50, 43], 12);
    let expected = rendered(&mut other, &job, 32);
    let mut film = job.new_film();
    gpu.prepare(&job, &go_on()).unwrap();
    // The first pass reads the film back on its own, because the cost of a readback is still unknown.
    let mut rays = gpu.advance(&job, 0..4, &mut film, &Control::deferring(&go_on())).unwrap().stats().rays;
    assert_eq!((film.sample_count(), rays), (0, 0));
    let second = gpu.advance(&job, 4..8, &mut film, &Control::deferring(&go_on())).unwrap().stats();
    assert_eq!((film.samples().to_string().as_str(), second.paths), ("0..4", 50 * 43 * 4));
    rays += second.rays;
    // Samples on the device cannot be requested again.
    assert!(matches!(
        gpu.advance(&job, 6..10, &mut film, &Control::deferring(&go_on())),
        Err(RenderError::Film(_))
    ));
    gpu.request_readback().unwrap();
    rays += gpu.advance(&job, 8..20, &mut film, &Control::deferring(&go_on())).unwrap().stats().rays;
    assert_eq!(film.samples().to_string(), "0..8");
    rays += gpu.advance(&job, 20..32, &mut film, &Control::deferring(&go_on())).unwrap().stats().rays;
    rays += gpu.finish(&mut film).unwrap().rays;
    assert!(film == expected);
    let again = gpu.accumulate(&job, 32..33, &mut film, &go_on()).unwrap();
    assert_eq!(again.paths, 50 * 43);
    assert!(rays > 50 * 43 * 32 && rays < 50 * 43 * 32 * 12, "{rays}");
    assert_eq!(gpu.finish(&mut film).unwrap(), Stats::default());
}

#[test]
fn new_film_gets_no_old_samples() {
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    let job = three_spheres([64, 36], 8);
    let expected = rendered(&mut gpu, &job, 4);
    let mut dropped = job.new_film();
    gpu.prepare(&job, &go_on()).unwrap();
    gpu.advance(&job, 0..4, &mut dropped, &Control::deferring(&go_on())).unwrap();
    gpu.advance(&job, 4..8, &mut dropped, &Control::deferring(&go_on())).unwrap();
    gpu.prepare(&job, &go_on()).unwrap();
    assert!(rendered(&mut gpu, &job, 4) == expected);
    // Nor does a different job of the same size.
    gpu.advance(&job, 0..4, &mut job.new_film(), &Control::deferring(&go_on())).unwrap();
    let other = three_spheres([64, 36], 3);
    let film = rendered(&mut gpu, &other, 4);
    assert!(film != expected);
    let mut fresh = crate::common::gpu::gpu(GpuOptions::default()).unwrap();
    assert!(film == rendered(&mut fresh, &other, 4));
}

#[test]
fn large_radiance_adds_up() {
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    // The brightest sky: the sum of a block fits 32 bits because blocks are short.
    let sky = Sky { bottom: DVec3::splat(100.0), top: DVec3::splat(100.0) };
    let scene = Scene { sky, ..Scene::default() };
    let job = job_of(&scene, Camera::default(), [16, 9], 4, SamplerKind::Independent);
    for mean in rendered(&mut gpu, &job, 1000).means() {
        assert!(mean.iter().all(|x| (x - 100.0).abs() < 1e-4), "{mean:?}");
    }
}

#[test]
fn moving_camera_keeps_scene_on_device() {
    let Some(mut moved) = gpu(GpuOptions::default()) else { return };
    let job = job_of(&field(300).0, BOOK_CAMERA, [64, 36], 8, SamplerKind::Sobol);
    rendered(&mut moved, &job, 2);
    assert!(!moved.diagnostics().kernel.hierarchy_time.is_zero());
    let settings = RenderSettings { width: 48, height: 27, ..*job.settings() };
    let low = DVec3::new(13.0, 0.05, 3.0);
    for look_from in [BOOK_CAMERA.look_from * 1.1, low] {
        let next = job.seen_by(Camera { look_from, ..BOOK_CAMERA }, settings).unwrap();
        let film = rendered(&mut moved, &next, 2);
        assert!(moved.diagnostics().kernel.hierarchy_time.is_zero(), "{:?}", moved.diagnostics().kernel);
        let Some(mut fresh) = gpu(GpuOptions::default()) else { return };
        assert!(film.halves() == rendered(&mut fresh, &next, 2).halves());
        // Near the ground, the ground is measured from the point below the eye.
        let anchors = |job| -> Vec<_> {
            PreparedScene::<f32>::new(job).anchored.iter().map(|sphere| sphere.anchor).collect()
        };
        assert_eq!(anchors(&job) != anchors(&next), look_from == low);
    }

    // A different scene gets a new hierarchy.
    let other = job_of(&field(200).0, BOOK_CAMERA, [48, 27], 8, SamplerKind::Sobol);
    let film = rendered(&mut moved, &other, 2);
    let Some(mut fresh) = gpu(GpuOptions::default()) else { return };
    assert!(film.halves() == rendered(&mut fresh, &other, 2).halves());
}
