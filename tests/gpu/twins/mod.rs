//! Compares each small function of the shaders with its twin: integers exactly, floats in units in the last place.

mod boxes;
mod names;
mod numbers;
mod probe;
mod surfaces;

use crate::common::gpu::program::Programs;
use crate::common::oracle::{pixel_key, sin_cos_turns, sobol_numbers, unit_float};
use glam::DVec3;
use probe::{PROBE_STRIDE, Probe};
use weekender::film::FIXED_POINT_MAX;
use weekender::job::render::{RenderJob, RenderSettings};
use weekender::kernel::sampling::pcg4d;
use weekender::kernel::{AnchoredSphere, CameraTable};
use weekender::render_cpu::camera::{lens_ray, pinhole_ray, screen};
use weekender::render_cpu::lanes::{Scalar, Single, V3, Wide, Word};
use weekender::render_cpu::material::{Material, incidence_of, reflectance, refracted, scatter};
use weekender::render_cpu::sphere::{
    NONE, Rays, Spheres, anchored_root, anchored_surface_point, book_root, near_root, nearest_root,
    speck_surface_point, surface_point,
};
use weekender::scene::{Camera, Scene};
use weekender::stages::{DielectricLaws, Rules};

/// One lane of the CPU's arithmetic, fused.
type L = Scalar<true>;
const L: L = Scalar::<true>;
type F = Single<true>;

const COUNT: usize = 4096;

type Words = [u32; PROBE_STRIDE];

fn job(laws: DielectricLaws) -> RenderJob {
    let settings = RenderSettings { width: 640, height: 360, max_depth: 4, ..RenderSettings::default() };
    let camera = Camera {
        look_from: DVec3::new(3.0, 2.0, 5.0),
        look_at: DVec3::new(0.0, 0.5, -1.0),
        defocus_angle_degrees: 3.0,
        vfov_degrees: 40.0,
        ..Camera::default()
    };
    RenderJob::new(Scene::default(), camera, settings, Rules { dielectric: laws, ..Rules::default() })
        .unwrap()
}

/// Runs a probe on `COUNT` inputs.
fn run(
    gpu: &Programs,
    laws: DielectricLaws,
    probe: Probe,
    input: impl Fn(u32) -> Words,
) -> Vec<(Words, Words)> {
    let inputs: Vec<Words> = (0..COUNT as u32).map(input).collect();
    let output = probe::run(gpu, &job(laws), probe, &inputs.concat());
    inputs.into_iter().zip(output.chunks_exact(PROBE_STRIDE).map(|w| w.try_into().unwrap())).collect()
}

/// Pseudo-random numbers in `[0, 1)` that depend on `i` and `stream`.
fn uniform(i: u32, stream: u32) -> [f32; 4] {
    pcg4d([i, stream, 7, 11]).map(unit_float)
}

fn unit_vector(i: u32, stream: u32) -> [f32; 3] {
    let [a, b, ..] = uniform(i, stream);
    crate::common::oracle::unit_sphere(a, b)
}

/// The bits of floats, followed by zeros.
fn words(floats: &[f32]) -> Words {
    let mut words = [0; PROBE_STRIDE];
    for (to, from) in words.iter_mut().zip(floats) {
        *to = from.to_bits();
    }
    words
}

fn float(words: &Words, i: usize) -> f32 {
    f32::from_bits(words[i])
}

fn number(words: &Words, i: usize) -> F {
    Single(float(words, i))
}

fn vector(words: &Words, i: usize) -> V3<F> {
    V3 { x: number(words, i), y: number(words, i + 1), z: number(words, i + 2) }
}

fn list(v: V3<F>) -> [f32; 3] {
    [v.x.0, v.y.0, v.z.0]
}

/// The largest difference, in units in the last place of numbers as large as `scale`.
#[derive(Default)]
struct Ulps(f64);

impl Ulps {
    fn compare(&mut self, got: &[f32], expected: &[f32], scale: f32) {
        let unit = f64::from(scale.next_up()) - f64::from(scale);
        for (a, b) in got.iter().zip(expected) {
            let difference = (f64::from(*a) - f64::from(*b)).abs() / unit;
            assert!(!difference.is_nan(), "{got:?} {expected:?}");
            self.0 = self.0.max(difference);
        }
    }

    fn within(&self, what: &str, limit: f64) {
        println!("{what}: {:.1} units of the last place", self.0);
        assert!(self.0 <= limit, "{what}: {} > {limit}", self.0);
    }
}

const BOOK_T_MIN: f32 = weekender::stages::BOOK_T_MIN as f32;

/// A ray that hits the sphere, but not near its edge, where the distance is as uncertain as a root of 0.
fn ray_words(i: u32) -> Words {
    let [radius, distance, inside, code] = uniform(i, 20);
    let radius = 0.1 + 2.0 * radius;
    let center = unit_vector(i, 21).map(|x| 3.0 * x);
    let towards = unit_vector(i, 22);
    let reach = if inside < 0.3 { 0.9 * distance * radius } else { radius * (1.2 + 5.0 * distance) };
    let origin = [0, 1, 2].map(|k| center[k] + reach * towards[k]);
    let aim = unit_vector(i, 23);
    let target = [0, 1, 2].map(|k| center[k] + 0.8 * radius * aim[k]);
    let d = DVec3::from_array([0, 1, 2].map(|k| f64::from(target[k] - origin[k]))).normalize();
    let mut words = words(&[origin[0], origin[1], origin[2], d.x as f32, d.y as f32, d.z as f32]);
    (words[6], words[7]) = match (code * 4.0) as u32 {
        0 => (1, NONE),
        1 => (NONE, 1),
        _ => (NONE, NONE),
    };
    for (to, x) in words[8..12].iter_mut().zip([center[0], center[1], center[2], radius * radius]) {
        *to = x.to_bits();
    }
    words[12] = BOOK_T_MIN.to_bits();
    words
}

fn rays(words: &Words) -> Rays<L> {
    Rays {
        origin: vector(words, 0),
        direction: vector(words, 3),
        left: Word(words[6]),
        inside: Word(words[7]),
    }
}

/// Compares distances; if one side misses, the other must, too.
fn compare_keys(ulps: &mut Ulps, got: u32, expected: i32, what: &Words) {
    // The CPU's keys are those of negated distances.
    let expected = (-f32::from_bits(expected as u32)).to_bits();
    let hits = |key: u32| key < f32::INFINITY.to_bits();
    assert_eq!(hits(got), hits(expected), "{what:?}: {got:x} {expected:x}");
    if hits(got) {
        let (got, expected) = (f32::from_bits(got), f32::from_bits(expected));
        ulps.compare(&[got], &[expected], expected.max(4.0));
    }
}

#[test]
fn intersections() {
    let Some(gpu) = Programs::open() else { return };
    let mut ulps = Ulps::default();
    for (input, output) in run(&gpu, DielectricLaws::Schlick, Probe::Roots, ray_words) {
        let rays = rays(&input);
        let spheres = || Spheres::splat(L, [8, 9, 10, 11].map(|i| float(&input, i)), Word(1));
        let near = near_root(L, &rays, &spheres()).key(L);
        let nearest = nearest_root(L, &rays, &spheres()).key(L);
        let book = book_root(L, &rays, &spheres(), Single(BOOK_T_MIN)).key(L);
        for (found, expected) in output.into_iter().zip([near, nearest, book, nearest, near]) {
            compare_keys(&mut ulps, found, expected, &input);
        }
    }
    ulps.within("roots", 64.0);

    let (mut ulps, mut specks) = (Ulps::default(), Ulps::default());
    let surface = |i: u32| {
        let mut words = ray_words(i);
        let radius = float(&words, 11).sqrt();
        words[11] = (1.0 / radius).to_bits();
        words[12] = (2.0 * uniform(i, 24)[0]).to_bits();
        words[13] = radius.to_bits();
        // A point on the sphere, as for a hit.
        let origin = [0, 1, 2].map(|k| float(&words, 8 + k) + radius * unit_vector(i, 25)[k]);
        let d = vector(&words, 3);
        let t = float(&words, 12);
        for (k, d) in list(d).into_iter().enumerate() {
            words[k] = (origin[k] - t * d).to_bits();
        }
        words
    };
    for (input, output) in run(&gpu, DielectricLaws::Schlick, Probe::Surface, surface) {
        let [curvature, t, radius] = [11, 12, 13].map(|i| number(&input, i));
        let point = surface_point(L, &rays(&input), t, vector(&input, 8), curvature, radius);
        ulps.compare(&list(vector(&output, 0)), &list(point.position), 4.0);
        ulps.compare(&list(vector(&output, 3)), &list(point.outward), 4.0);
        let speck = speck_surface_point(L, &rays(&input), t, vector(&input, 8), curvature, radius);
        specks.compare(&list(vector(&output, 6)), &list(speck.position), 4.0);
        specks.compare(&list(vector(&output, 9)), &list(speck.outward), 4.0);
    }
    // Half the chord is the root of a difference.
    specks.within("speck_surface_point", 4096.0);
    ulps.within("surface_point", 8.0);
}

#[test]
fn anchored_spheres() {
    let Some(gpu) = Programs::open() else { return };
    let (mut roots, mut points) = (Ulps::default(), Ulps::default());
    for (input, output) in run(&gpu, DielectricLaws::Schlick, Probe::Anchored, |i| {
        let [x, height, z, code] = uniform(i, 30);
        let [a, b, ..] = uniform(i, 31);
        // Downwards, not grazing, onto a large ground.
        let d = DVec3::new(f64::from(a) - 0.5, -0.3 - f64::from(b), f64::from(b) - 0.5).normalize();
        let origin = [4.0 * x, 0.1 + height, 4.0 * z];
        let curvature = 10.0_f32.powi(-((i % 6) as i32) - 2);
        let t = 2.0 * height;
        let mut words = words(&[
            origin[0], origin[1], origin[2], d.x as f32, d.y as f32, d.z as f32, 0.0, 0.0, 0.5, 0.01, 0.25,
            curvature, 0.0, -1.0, 0.0, t,
        ]);
        (words[6], words[7]) = if code < 0.2 { (1, NONE) } else { (NONE, NONE) };
        words
    }) {
        let sphere = AnchoredSphere {
            anchor: list(vector(&input, 8)),
            inward: list(vector(&input, 12)),
            curvature: float(&input, 11),
            flags: input[3] % 3,
        };
        let rays = rays(&input);
        compare_keys(&mut roots, output[0], anchored_root(L, &rays, &sphere, Word(1)).key(L), &input);
        let (anchor, inward) = (vector(&input, 8), vector(&input, 12));
        let point =
            anchored_surface_point(L, &rays, number(&input, 15), anchor, inward, Single(sphere.curvature));
        points.compare(&list(vector(&output, 1)), &list(point.position), 4.0);
        points.compare(&list(vector(&output, 4)), &list(point.outward), 1.0);
    }
    roots.within("anchored_root", 64.0);
    points.within("anchored_surface_point", 8.0);
}

#[test]
fn scattering() {
    let Some(gpu) = Programs::open() else { return };
    for laws in [DielectricLaws::RefractOnly, DielectricLaws::TotalReflection, DielectricLaws::Schlick] {
        let mut ulps = Ulps::default();
        let mut parted = 0;
        for (input, output) in run(&gpu, laws, Probe::Scatter, |i| {
            let [index, weight, coin, front] = uniform(i, 40);
            let (weight, index) = match i % 3 {
                0 => (1.0, 0.0),
                1 => (-weight, 0.0),
                _ => (-0.0, 0.5 + 1.5 * index),
            };
            let normal = DVec3::from_array(unit_vector(i, 41).map(f64::from));
            let incoming = DVec3::from_array(unit_vector(i, 42).map(f64::from));
            let incoming = if incoming.dot(normal) > 0.0 { -incoming } else { incoming };
            let [d, n] = [incoming, normal].map(|v| v.to_array().map(|x| x as f32));
            let unit = unit_vector(i, 43);
            let share = ((1.0 - index) / (1.0 + index)).powi(2);
            let inverse = if index > 0.0 { 1.0 / index } else { 0.0 };
            let cosine = (-incoming.dot(normal)) as f32;
            let mut words = words(&[
                weight, index, inverse, share, d[0], d[1], d[2], n[0], n[1], n[2], unit[0], unit[1], unit[2],
                cosine, 0.0, coin,
            ]);
            words[14] = u32::from(front < 0.5);
            words
        }) {
            let [weight, refraction_index, inverse_index, f0] = [0, 1, 2, 3].map(|i| number(&input, i));
            let material: Material<L> = Material { weight, refraction_index, inverse_index, f0 };
            let (cosine, coin) = (number(&input, 13), number(&input, 15));
            let (d, n, unit) = (vector(&input, 4), vector(&input, 7), vector(&input, 10));
            let front = input[14] != 0;
            let sent =
                scatter::<L, true>(L, &material, laws, d, n, &incidence_of(L, cosine), front, unit, coin);
            let flags = u32::from(sent.refracts) | u32::from(sent.is_metal) << 1;
            if output[3] != flags {
                // The random number is within rounding of the reflectance.
                parted += 1;
                continue;
            }
            ulps.compare(&list(vector(&output, 0)), &list(sent.direction), 2.0);
            ulps.compare(&[float(&output, 4)], &[reflectance(L, cosine, f0).0], 1.0);
            let sine2 = incidence_of(L, cosine).sine2;
            // One lane only computes the ratio for glass.
            if refraction_index.0 > 0.0 {
                ulps.compare(&list(vector(&output, 5)), &list(refracted(L, d, n, sent.ratio, sine2)), 2.0);
            }
        }
        assert!(parted <= 2, "{parted} parted");
        // Near the critical angle, the inner cosine is the root of almost 0.
        ulps.within(&format!("scatter, {laws:?}"), 512.0);
    }
}

#[test]
fn camera_rays() {
    let Some(gpu) = Programs::open() else { return };
    let job = job(DielectricLaws::Schlick);
    let settings = job.settings();
    let camera =
        CameraTable::<f32>::new(job.camera(), job.viewport(), [settings.width, settings.height], DVec3::ZERO)
            .map(Wide::splat);
    let mut ulps = Ulps::default();
    for (input, output) in run(&gpu, DielectricLaws::Schlick, Probe::Camera, |i| {
        let [x, y, a, b] = uniform(i, 50);
        let [c, d, ..] = uniform(i, 51);
        words(&[(x * 640.0).floor(), (y * 360.0).floor(), a, b, c - 0.5, d - 0.5])
    }) {
        let [x, y, a, b, c, d] = [0, 1, 2, 3, 4, 5].map(|i| number(&input, i));
        let corner = screen(L, &camera, x, y);
        let pinhole = pinhole_ray(L, &camera, corner, [a, b]);
        let lens = lens_ray(L, &camera, corner, [a, b], [c, d]);
        for (at, v) in [(0, pinhole.origin), (3, pinhole.direction), (6, lens.origin), (9, lens.direction)] {
            ulps.compare(&list(vector(&output, at)), &list(v), 4.0);
        }
    }
    ulps.within("camera rays", 4.0);
}
