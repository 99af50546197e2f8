use glam::DVec3;
use std::sync::atomic::AtomicBool;
use weekender::render::*;
use weekender::render_cpu::*;
use weekender::scene::*;
use weekender::stages::*;
fn main() {
    let mut scene = Scene::default();
    let ground = scene.add_material("ground", Material::Lambertian { albedo: DVec3::new(0.8, 0.8, 0.0) });
    let center = scene.add_material("center", Material::Lambertian { albedo: DVec3::new(0.1, 0.2, 0.5) });
    let left = scene.add_material("left", Material::Dielectric { refraction_index: 1.5 });
    let bubble = scene.add_material("bubble", Material::Dielectric { refraction_index: 1.0 / 1.5 });
    let right = scene.add_material("right", Material::Metal { albedo: DVec3::new(0.8, 0.6, 0.2), fuzz: 1.0 });
    scene.add_sphere(DVec3::new(0.0, -100.5, -1.0), 100.0, ground);
    scene.add_sphere(DVec3::new(0.0, 0.0, -1.2), 0.5, center);
    scene.add_sphere(DVec3::new(-1.0, 0.0, -1.0), 0.5, left);
    scene.add_sphere(DVec3::new(-1.0, 0.0, -1.0), 0.4, bubble);
    scene.add_sphere(DVec3::new(1.0, 0.0, -1.0), 0.5, right);
    let spp: u64 = std::env::args().nth(1).map_or(64, |s| s.parse().unwrap());
    let sampler = if std::env::args().nth(2).as_deref() == Some("i") {
        SamplerKind::Independent
    } else {
        SamplerKind::Sobol
    };
    let settings =
        RenderSettings { width: 800, height: 450, max_depth: 24, sampler, seed: 0, estimate_error: true };
    let job = RenderJob::new(scene, Camera::default(), settings, Rules::default()).unwrap();
    let only: Option<usize> = std::env::args().nth(3).map(|s| s.parse().unwrap());
    for (isa, lanes) in [
        (Isa::Avx2, 8),
        (Isa::Sse42, 4),
        (Isa::Avx2, 16),
        (Isa::Avx2, 4),
        (Isa::Avx2, 1),
        (Isa::Sse42, 1),
        (Isa::Baseline, 1),
    ] {
        let mut r =
            CpuRenderer::new(CpuOptions { isa: Some(isa), lanes: Some(lanes), threads: Some(1) }).unwrap();
        let mut film = job.new_film();
        let s = r.accumulate(&job, 0..spp, &mut film, &AtomicBool::new(false)).unwrap();
        let hash = film
            .halves()
            .iter()
            .flatten()
            .fold(0u64, |h, p| p.0.iter().fold(h, |h, k| (h ^ k).wrapping_mul(0x100000001b3)));
        println!(
            "{isa} {lanes}: {:.2} Mpaths/s, {:.3} rays/path, lanes {:.3}, rmse {:.5}, rejected {}, hash {hash:x}",
            s.paths as f64 / s.trace.as_secs_f64() / 1e6,
            s.rays as f64 / s.paths as f64,
            s.busy_lanes as f64 / s.offered_lanes as f64,
            film.error().unwrap().rmse,
            s.rejected
        );
        image::RgbImage::from_raw(800, 450, film.to_rgb8(Transfer::Gamma2))
            .unwrap()
            .save("/tmp/try.png")
            .unwrap();
    }
}
