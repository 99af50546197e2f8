//! Stiff scenes on the GPU: the closed forms hold there, too. (tests/numerics/stiff.rs tests the CPU.)
#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

mod gpu_common;

use glam::DVec3;
use gpu_common::gpu;
use std::sync::atomic::AtomicBool;
use weekender::film::Film;
use weekender::job::render::{RenderJob, RenderSettings, Renderer};
use weekender::render_cpu::{CpuOptions, CpuRenderer};
use weekender::render_gpu::GpuOptions;
use weekender::scene::{Camera, Material, Scene, Sky};
use weekender::stages::Rules;

type Ball = (DVec3, f64, Material);

const MATTE: Material = Material::Lambertian { albedo: DVec3::splat(0.5) };
const WHITE: Material = Material::Lambertian { albedo: DVec3::ONE };
const GLASS: Material = Material::Dielectric { refraction_index: 1.5 };

const AT_BALL: Camera =
    Camera { look_from: DVec3::new(0.0, 0.0, 3.0), look_at: DVec3::ZERO, vfov_degrees: 20.0, ..Camera::BOOK };

fn job(balls: &[Ball], camera: Camera, max_depth: u32) -> RenderJob {
    let mut scene = Scene { sky: Sky { bottom: DVec3::ONE, top: DVec3::ONE }, ..Scene::default() };
    for (index, (center, radius, material)) in balls.iter().enumerate() {
        let material = scene.add_material(format!("m{index}"), *material);
        scene.add_sphere(*center, *radius, material);
    }
    let settings = RenderSettings {
        width: 16,
        height: 16,
        max_depth,
        estimate_error: false,
        ..RenderSettings::default()
    };
    RenderJob::new(scene, camera, settings, Rules::FINISHED).unwrap()
}

/// Forty balls behind the eye, enough for a hierarchy.
fn among_many(balls: &[Ball]) -> Vec<Ball> {
    let far = |i: u32| (DVec3::new(f64::from(i) - 20.0, 0.0, 500.0), 0.1, MATTE);
    balls.iter().copied().chain((0..40).map(far)).collect()
}

fn film(renderer: &mut dyn Renderer, job: &RenderJob) -> Film {
    let mut film = job.new_film();
    renderer.accumulate(job, 0..16, &mut film, &AtomicBool::new(false)).unwrap();
    film
}

fn mean(film: &Film) -> f64 {
    let pixels = (film.width() * film.height()) as usize;
    (0..pixels).flat_map(|pixel| film.mean(pixel)).sum::<f64>() / (3 * pixels) as f64
}

#[test]
fn closed_forms_hold() {
    let up = DVec3::new(0.3, 0.8, -0.5).normalize();
    let near = |eye: DVec3| Camera { look_from: eye, look_at: eye + up, ..AT_BALL };
    let shells = |count: u32| -> Vec<Ball> {
        (0..count).map(|i| (DVec3::ZERO, 1.0 - f64::from(i) / f64::from(2 * count), MATTE)).collect()
    };
    let inside = Camera { look_from: DVec3::new(0.2, 0.1, -0.3), look_at: DVec3::NEG_Y, ..AT_BALL };
    let side = DVec3::new(0.9, 0.0, 0.0);
    let trapped = Camera { look_from: side, look_at: side + DVec3::Y, vup: DVec3::Z, ..AT_BALL };
    let into = Camera { look_from: DVec3::ZERO, look_at: DVec3::NEG_Y, vup: DVec3::Z, ..AT_BALL };
    let ground = (DVec3::NEG_Y * 1001.0, 1000.0, WHITE);
    let at = DVec3::new(1e4, -3e4, 1e5);
    let cases: Vec<(&str, Vec<Ball>, Camera, u32, f64)> = vec![
        ("two copies", vec![(DVec3::ZERO, 1.0, MATTE); 2], AT_BALL, 50, 0.5),
        ("almost copies", vec![(DVec3::ZERO, 1.0, MATTE), (DVec3::X * 1e-6, 1.0, MATTE)], AT_BALL, 50, 0.5),
        ("shells", shells(300), AT_BALL, 50, 0.5),
        ("an eye on a ball", vec![(at, 0.5, MATTE)], near(at + up * 0.5), 50, 1.0),
        ("from a ball into it", vec![(DVec3::NEG_Y * 1000.0, 1000.0, MATTE)], into, 50, 0.5),
        ("an eye on glass", vec![(at, 0.5, GLASS)], near(at + up * 0.5), 50, 1.0),
        ("an eye near a ball", vec![(at, 0.5, MATTE)], near(at + up * (0.5 + 1e-7)), 50, 1.0),
        ("a closed ball on the ground", vec![(DVec3::ZERO, 1.0, WHITE), ground], inside, 300, 0.0),
        ("total reflection", vec![(DVec3::ZERO, 1.0, GLASS)], trapped, 1000, 0.0),
    ];
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    for (what, balls, camera, max_depth, expected) in &cases {
        for balls in [balls.clone(), among_many(balls)] {
            let found = mean(&film(&mut gpu, &job(&balls, *camera, *max_depth)));
            let count = balls.len();
            assert!((found - expected).abs() <= 1e-6, "{what}, {count} balls: {found}");
        }
    }
}

/// Thin shells far from the origin, a tiny ball and steep glass look the same as on the CPU.
#[test]
fn the_gpu_and_the_cpu_agree() {
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    let mut cpu = CpuRenderer::new(CpuOptions::default()).unwrap();
    let at = DVec3::new(2e4, 1e5, -7e4);
    let shell =
        vec![(at, 1.0, GLASS), (at, 1.0 - 1e-4, Material::Dielectric { refraction_index: 1.0 / 1.5 })];
    let before = Camera { look_from: at + DVec3::Z * 3.0, look_at: at, vfov_degrees: 30.0, ..AT_BALL };
    let speck = vec![(DVec3::ZERO, 3e-7, GLASS), (DVec3::NEG_Y * 1.3, 1.0, MATTE)];
    let steep = vec![(DVec3::ZERO, 1.0, Material::Dielectric { refraction_index: 1e4 })];
    let in_the_middle = Camera { look_from: DVec3::X * 1e-5, look_at: DVec3::Z, ..AT_BALL };
    for (what, balls, camera) in
        [("shell", shell, before), ("speck", speck, AT_BALL), ("steep glass", steep, in_the_middle)]
    {
        let job = job(&balls, camera, 50);
        let [a, b] = [mean(&film(&mut gpu, &job)), mean(&film(&mut cpu, &job))];
        println!("{what}: {a} {b}");
        assert!((a - b).abs() < 2e-4, "{what}: {a}, not {b}");
    }
}
