//! Rays, exact answers, renders and random numbers for the cases.

pub use crate::common::films::{mean, paired, render, render_with_stats};
pub use crate::common::random::Random;
use glam::DVec3;
use weekender::job::render::{RenderJob, RenderSettings};
use weekender::kernel::Real;
use weekender::render_cpu::lanes::{Float, Lanes, V3, Wide, splat3};
use weekender::render_cpu::material::Material as LaneMaterial;
use weekender::render_cpu::sphere::{NONE, Rays};
use weekender::render_cpu::{CpuOptions, CpuRenderer, Isa};
use weekender::scene::{Camera, Material, Scene};
use weekender::stages::Rules;

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
