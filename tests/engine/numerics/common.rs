//! Rays, exact answers, renders and random numbers for the cases.

use glam::DVec3;
use std::ops::Range;
use std::sync::atomic::AtomicBool;
use weekender::film::Film;
use weekender::job::render::{RenderJob, RenderSettings, Renderer, Stats};
use weekender::kernel::Real;
use weekender::render_cpu::lanes::{Float, Lanes, V3, Wide, splat3};
use weekender::render_cpu::material::Material as LaneMaterial;
use weekender::render_cpu::sphere::{NONE, Rays};
use weekender::render_cpu::{CpuOptions, CpuRenderer, Isa};
use weekender::scene::{Camera, Material, Scene};
use weekender::stages::Rules;

/// Random numbers, the same in every run (SplitMix64).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Random(seed)
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    /// Uniform in `[0, 1)`.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform in the logarithm.
    pub fn log_within(&mut self, low: f64, high: f64) -> f64 {
        self.within(low.ln(), high.ln()).exp()
    }

    pub fn direction(&mut self) -> DVec3 {
        let (z, turn) = (self.within(-1.0, 1.0), self.within(0.0, std::f64::consts::TAU));
        let rho = (1.0 - z * z).sqrt();
        DVec3::new(rho * turn.cos(), rho * turn.sin(), z)
    }

    pub fn in_box(&mut self, half_side: f64) -> DVec3 {
        let mut coordinate = || self.within(-half_side, half_side);
        DVec3::new(coordinate(), coordinate(), coordinate())
    }
}

/// The first lane.
pub fn first<L: Lanes>(f: L::F) -> f64 {
    let mut buffer = Wide::default();
    L::store(f, &mut buffer);
    buffer.0[0].to_f64()
}

pub fn vector<L: Lanes>(v: V3<L::F>) -> DVec3 {
    DVec3::new(first::<L>(v.x), first::<L>(v.y), first::<L>(v.z))
}

/// `v` rounded to the lanes' precision.
pub fn v3<L: Lanes>(l: L, v: DVec3) -> V3<L::F> {
    splat3(l, v.to_array().map(L::Real::from_f64))
}

/// `v` normalised by the same division as in the path loop.
pub fn normalised<L: Lanes>(l: L, d: V3<L::F>) -> V3<L::F> {
    d.scale(l.constant(1.0) / d.dot(d).sqrt())
}

/// A ray that does not start on a sphere. `direction` may have any length.
pub fn ray<L: Lanes>(l: L, origin: DVec3, direction: DVec3) -> Rays<L> {
    Rays {
        origin: v3(l, origin),
        direction: normalised(l, v3(l, direction)),
        left: l.splat_u(NONE),
        inside: l.splat_u(NONE),
    }
}

/// Centre and squared radius.
pub fn packed<L: Lanes>(center: DVec3, radius: f64) -> [L::Real; 4] {
    [center.x, center.y, center.z, radius * radius].map(L::Real::from_f64)
}

/// The distance of a key; `None` for a miss.
pub fn distance<L: Lanes>(key: L::Key) -> Option<f64> {
    let t = -first::<L>(L::from_key(key));
    (t.is_finite() && t.is_sign_positive()).then_some(t)
}

/// Both roots in `f64`, for a direction of any length.
pub fn exact_roots(origin: DVec3, direction: DVec3, center: DVec3, radius: f64) -> Option<[f64; 2]> {
    let f = center - origin;
    let a = direction.length_squared();
    let h = direction.dot(f);
    let across = f - direction * (h / a);
    let d = radius * radius - across.length_squared();
    (d >= 0.0).then(|| [h - (a * d).sqrt(), h + (a * d).sqrt()].map(|q| q / a))
}

/// Glass of this refraction index.
pub fn glass_lanes<L: Lanes>(l: L, index: f64) -> LaneMaterial<L> {
    LaneMaterial {
        weight: l.constant(-0.0),
        refraction_index: l.constant(index),
        inverse_index: l.constant(1.0 / index),
        f0: l.constant(((1.0 - index) / (1.0 + index)).powi(2)),
    }
}

/// A unit vector at right angles to `v`.
pub fn perpendicular(v: DVec3, random: &mut Random) -> DVec3 {
    v.cross(random.direction()).normalize()
}

pub fn lambertian(albedo: f64) -> Material {
    Material::Lambertian { albedo: DVec3::splat(albedo) }
}

pub fn mirror(albedo: f64) -> Material {
    Material::Metal { albedo: DVec3::splat(albedo), fuzz: 0.0 }
}

pub fn glass(refraction_index: f64) -> Material {
    Material::Dielectric { refraction_index }
}

/// Each sphere has its own material.
pub fn scene(spheres: &[(DVec3, f64, Material)]) -> Scene {
    let mut scene = Scene::default();
    for (index, (center, radius, material)) in spheres.iter().enumerate() {
        let material = scene.add_material(format!("m{index}"), *material);
        scene.add_sphere(*center, *radius, material);
    }
    scene
}

/// Settings of a picture of this size, with 50 rays per path.
pub fn size(width: u32, height: u32) -> RenderSettings {
    RenderSettings { width, height, max_depth: 50, ..RenderSettings::default() }
}

pub const NO_ANTIALIASING: Rules = Rules { antialiasing: false, ..Rules::FINISHED };

pub fn job(scene: &Scene, camera: Camera, settings: RenderSettings) -> RenderJob {
    RenderJob::new(scene.clone(), camera, settings, Rules::FINISHED).unwrap()
}

/// Like [`job`], with all samples through the centres of their pixels.
pub fn sharp_job(scene: &Scene, camera: Camera, settings: RenderSettings) -> RenderJob {
    RenderJob::new(scene.clone(), camera, settings, NO_ANTIALIASING).unwrap()
}

const THREADS: Option<usize> = Some(2);

/// The fastest renderer for this processor.
pub fn widest() -> CpuRenderer {
    CpuRenderer::new(CpuOptions { threads: THREADS, ..CpuOptions::default() }).unwrap()
}

pub fn packets(isa: Isa, lanes: usize) -> CpuRenderer {
    let options =
        CpuOptions { isa: Some(isa), lanes: Some(lanes), threads: THREADS, ..CpuOptions::default() };
    CpuRenderer::new(options).unwrap()
}

/// Scalar `f32` without fused multiply and add, which every processor can run.
pub fn portable() -> CpuRenderer {
    packets(Isa::Portable, 1)
}

/// The `f64` reference.
pub fn reference() -> CpuRenderer {
    CpuRenderer::reference(THREADS).unwrap()
}

/// A film of samples `range`, none of them rejected.
pub fn render_with_stats(renderer: &mut CpuRenderer, job: &RenderJob, range: Range<u64>) -> (Film, Stats) {
    let mut film = job.new_film();
    let stats = renderer.accumulate(job, range, &mut film, &AtomicBool::new(false)).unwrap();
    assert_eq!(stats.rejected, 0, "samples were rejected");
    (film, stats)
}

pub fn render(renderer: &mut CpuRenderer, job: &RenderJob, range: Range<u64>) -> Film {
    render_with_stats(renderer, job, range).0
}

/// Mean of all pixels and channels.
pub fn mean(film: &Film) -> f64 {
    let pixels = (film.width() * film.height()) as usize;
    (0..pixels).flat_map(|pixel| film.mean(pixel)).sum::<f64>() / (3 * pixels) as f64
}

/// The ray through a pixel's centre, in `f64`: origin and unit direction.
pub fn centre_ray(camera: &Camera, width: u32, height: u32, x: u32, y: u32) -> (DVec3, DVec3) {
    view_ray(camera, width, height, f64::from(x) + 0.5, f64::from(y) + 0.5)
}

/// A pinhole camera's ray through a point of the picture, in pixels from the upper left corner.
pub fn view_ray(camera: &Camera, width: u32, height: u32, x: f64, y: f64) -> (DVec3, DVec3) {
    let basis = camera.basis();
    let pixel = 2.0 * (camera.vfov_degrees.to_radians() / 2.0).tan() / f64::from(height);
    let (sx, sy) = (pixel * (x - 0.5 * f64::from(width)), -pixel * (y - 0.5 * f64::from(height)));
    (camera.look_from, (basis.u * sx + basis.v * sy - basis.w).normalize())
}

/// How two renderers differ on the same samples.
#[derive(Debug, Default)]
pub struct Paired {
    pub bias: f64,
    /// Share of samples with a channel off by more than 1e-3.
    pub outliers: f64,
    /// Root mean square of the other samples.
    pub inlier_rms: f64,
}

/// Renders single samples with both and compares them pixel by pixel.
pub fn paired(job: &RenderJob, samples: u64, a: &mut CpuRenderer, b: &mut CpuRenderer) -> Paired {
    let pixels = (job.settings().width * job.settings().height) as usize;
    let paths = (samples * pixels as u64) as f64;
    let mut found = Paired::default();
    for index in 0..samples {
        let (a, b) = (render(a, job, index..index + 1), render(b, job, index..index + 1));
        for pixel in 0..pixels {
            let (a, b) = (a.mean(pixel), b.mean(pixel));
            let difference = [0, 1, 2].map(|channel| a[channel] - b[channel]);
            found.bias += difference.iter().sum::<f64>() / (3.0 * paths);
            if difference.iter().any(|x| x.abs() > 1e-3) {
                found.outliers += 1.0 / paths;
            } else {
                found.inlier_rms += difference.iter().map(|x| x * x).sum::<f64>() / (3.0 * paths);
            }
        }
    }
    Paired { inlier_rms: found.inlier_rms.sqrt(), ..found }
}
