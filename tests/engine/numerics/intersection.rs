//! Rays against spheres: cases 1 to 9. (Book 1, section 5.)

use crate::numerics::common::*;
use glam::DVec3;
use weekender::job::render::RenderJob;
use weekender::kernel::Real;
use weekender::prepared::PreparedScene;
use weekender::render_cpu::lanes::{Lanes, Mask, Reference, Scalar};
use weekender::render_cpu::material::{incidence_of, scatter};
use weekender::render_cpu::sphere::{
    NONE, Rays, Spheres, SurfacePoint, anchored_root, anchored_surface_point, near_root, nearest_root,
    surface_point,
};
use weekender::scene::Camera;
use weekender::stages::DielectricLaws;

pub const FUSED: Scalar<true> = Scalar;
pub const UNFUSED: Scalar<false> = Scalar;

/// A sphere's number in these tests.
pub const NUMBER: u32 = 7;

/// Errors of the roots for rays aimed at a sphere.
#[derive(Debug, Default)]
struct Aimed {
    hits: u32,
    false_misses: u32,
    false_hits: u32,
    rays: u32,
    largest_error: f64,
}

/// Aims `count` rays at the disk of radius `reach` radii around a sphere at `distance_away` from the origin, and
/// compares with the exact roots of the rays as the lanes hold them.
fn aim<L: Lanes>(l: L, distance_away: f64, radius: f64, reach: f64, count: u32) -> Aimed {
    let mut random = Random::new(1);
    let number = l.splat_u(NUMBER);
    let mut result = Aimed { rays: count, ..Aimed::default() };
    for _ in 0..count {
        let towards = random.direction();
        let center = (towards * distance_away).as_vec3().as_dvec3();
        let radius = f64::from(radius as f32);
        let across = perpendicular(center, &mut random) * (reach * radius * random.unit().sqrt());
        let rays = ray(l, DVec3::ZERO, center + across);
        let sphere = || Spheres::splat(l, packed::<L>(center, radius), number);
        let found = distance::<L>(near_root(l, &rays, &sphere()).key(l));
        let both = distance::<L>(nearest_root(l, &rays, &sphere()).key(l));
        assert_eq!(found, both, "one root or two");
        let exact = exact_roots(DVec3::ZERO, vector::<L>(rays.direction), center, radius);
        match (found, exact) {
            (Some(t), Some([near, _])) => {
                result.hits += 1;
                result.largest_error = result.largest_error.max((t - near).abs());
            }
            (None, Some(_)) => result.false_misses += 1,
            (Some(_), None) => result.false_hits += 1,
            (None, None) => {}
        }
        if let Some(t) = found {
            let point = surface_at(l, &rays, t, center, radius);
            assert!([point.position, point.outward].into_iter().all(|v| vector::<L>(v).is_finite()));
        }
    }
    result
}

pub fn surface_at<L: Lanes>(l: L, rays: &Rays<L>, t: f64, center: DVec3, radius: f64) -> SurfacePoint<L> {
    surface_point(l, rays, l.constant(t), v3(l, center), l.constant(1.0 / radius), l.constant(radius))
}

/// A sphere that is far away, one at a million radii, and a tiny one.
#[test]
fn cases_01_to_03_aimed_rays() {
    let aimed = |distance, radius, reach, count| {
        [
            ("fused", aim(FUSED, distance, radius, reach, count)),
            ("unfused", aim(UNFUSED, distance, radius, reach, count)),
        ]
    };
    for (name, far) in aimed(1e3, 0.5, 1.0, 200_000) {
        let missed = f64::from(far.false_misses) / f64::from(far.hits + far.false_misses);
        println!("case 1 {name}: false misses {missed:.2e}, distance {:.2e}", far.largest_error);
        assert!(missed <= 1e-4 && far.largest_error <= 5e-3, "{name}: {far:?}");
    }
    for (name, farther) in aimed(1e6, 0.5, 2.0, 100_000) {
        let wrong = f64::from(farther.false_misses + farther.false_hits) / f64::from(farther.rays);
        println!("case 2 {name}: misclassified {wrong:.2e}");
        assert!(wrong <= 0.03, "{name}: {farther:?}");
    }
    for (name, tiny) in aimed(3.0, 1e-3, 1.0, 200_000) {
        println!("case 3 {name}: distance {:.2e}", tiny.largest_error);
        assert!(tiny.largest_error <= 2e-5, "{name}: {tiny:?}");
    }
}

/// A ground with its top at height 0, a ball on it and an eye at height 1.
fn ground_job(radius: f64) -> RenderJob {
    let scene = scene(&[
        (DVec3::new(0.0, -radius, 0.0), radius, lambertian(0.5)),
        (DVec3::new(0.0, 0.5, -2.0), 0.5, lambertian(0.5)),
    ]);
    let camera =
        Camera { look_from: DVec3::new(0.0, 1.0, 0.0), look_at: DVec3::new(0.0, 0.5, -2.0), ..Camera::BOOK };
    job(&scene, camera, size(16, 9))
}

/// The nearer root for a sphere whose top is the origin. `f.f - r^2` is computed without squaring the radius, so `f64`
/// resolves it even for a radius of 1e7.
fn exact_ground_root(origin: DVec3, direction: DVec3, radius: f64) -> Option<f64> {
    let a = direction.length_squared();
    let b = direction.dot(origin) + radius * direction.y;
    let c = origin.length_squared() + 2.0 * radius * origin.y;
    let d = b * b - a * c;
    (d >= 0.0 && b < 0.0).then(|| c / (-b + d.sqrt()))
}

/// Largest errors of the distance, and of the hit point's height above the ground.
fn ground_errors<L: Lanes>(l: L, radius: f64) -> [f64; 2] {
    let prepared: PreparedScene<L::Real> = PreparedScene::new(&ground_job(radius));
    assert_eq!(prepared.anchored.len(), 1, "the ground is anchored");
    let sphere = &prepared.anchored[0];
    let mut random = Random::new(2);
    let mut largest = [0.0_f64; 2];
    for _ in 0..100_000 {
        let origin = DVec3::new(random.within(-3.0, 3.0), 1.0, random.within(-3.0, 3.0));
        let down = random.within(-1.0, -0.1);
        let turn = random.within(0.0, std::f64::consts::TAU);
        let level = (1.0 - down * down).sqrt();
        let rays = ray(l, origin, DVec3::new(level * turn.cos(), down, level * turn.sin()));
        let (o, d) = (vector::<L>(rays.origin), vector::<L>(rays.direction));
        let exact = exact_ground_root(o, d, radius).unwrap();
        let t = distance::<L>(anchored_root(l, &rays, sphere, l.splat_u(NUMBER)).key(l)).unwrap();
        largest[0] = largest[0].max((t - exact).abs());
        let point = anchored_surface_point(
            l,
            &rays,
            l.constant(t),
            v3(l, DVec3::from_array(sphere.anchor.map(Real::to_f64))),
            v3(l, DVec3::from_array(sphere.inward.map(Real::to_f64))),
            l.splat(sphere.curvature),
        );
        let p = vector::<L>(point.position);
        let height = (p.length_squared() + 2.0 * radius * p.y) / (2.0 * radius);
        largest[1] = largest[1].max(height.abs());
        assert!((vector::<L>(point.outward).length() - 1.0).abs() < 1e-6);
    }
    largest
}

#[test]
fn cases_04_to_06_grounds() {
    for (number, radius) in [(4, 1e3), (5, 1e5), (6, 1e7)] {
        for (name, [distance, height]) in
            [("fused", ground_errors(FUSED, radius)), ("unfused", ground_errors(UNFUSED, radius))]
        {
            println!("case {number} {name}: distance {distance:.2e}, height of the hit {height:.2e}");
            assert!(distance <= 2e-5, "{name}: {distance:e}");
        }
        let [distance, _] = ground_errors(Reference, radius);
        assert!(distance <= 1e-8, "the reference itself: {distance:e}");
    }
}

#[test]
fn case_07_direction_of_any_length() {
    let mut random = Random::new(3);
    let mut largest = 0.0_f64;
    for _ in 0..20_000 {
        let center = random.in_box(3.0).as_vec3().as_dvec3();
        let origin = (center + random.direction() * random.within(1.0, 10.0)).as_vec3().as_dvec3();
        let across = perpendicular(center - origin, &mut random) * (0.45 * random.unit().sqrt());
        let towards = center + across - origin;
        let hit = |length: f64| {
            let rays = ray(UNFUSED, origin, towards.normalize() * length);
            let sphere = packed::<Scalar<false>>(center, 0.5);
            let sphere = Spheres::splat(UNFUSED, sphere, Lanes::splat_u(UNFUSED, NUMBER));
            distance::<Scalar<false>>(near_root(UNFUSED, &rays, &sphere).key(UNFUSED))
        };
        let [short, one, long] = [1e-3, 1.0, 1e6].map(|length| hit(length).expect("the same hit"));
        for other in [short, long] {
            largest = largest.max((other / one - 1.0).abs());
        }
    }
    println!("case 7: relative distance {largest:.2e}");
    assert!(largest <= 1e-5, "{largest:e}");
}

/// A ray from outside hits a sphere and is scattered.
fn arrival<L: Lanes>(l: L, random: &mut Random, center: DVec3, radius: f64) -> Option<SurfacePoint<L>> {
    let origin = center + random.direction() * radius * random.log_within(1.5, 1e3);
    let across = perpendicular(center - origin, random) * (0.95 * radius * random.unit().sqrt());
    let rays = ray(l, origin, center + across - origin);
    let key = near_root(l, &rays, &Spheres::splat(l, packed::<L>(center, radius), l.splat_u(NUMBER))).key(l);
    distance::<L>(key).map(|t| surface_at(l, &rays, t, center, radius))
}

#[test]
fn case_08_no_ray_meets_the_surface_that_it_leaves() {
    let l = UNFUSED;
    let mut random = Random::new(4);
    let number = Lanes::splat_u(l, NUMBER);
    let mut left = 0;
    while left < 100_000 {
        let (center, radius) = (random.in_box(100.0), random.log_within(1e-3, 1e3));
        let Some(point) = arrival(l, &mut random, center, radius) else { continue };
        let normal = vector::<Scalar<false>>(point.outward);
        // Includes grazing angles, where the usual offset along the normal fails.
        let lift = random.log_within(1e-7, 1.0);
        let direction = perpendicular(normal, &mut random) + normal * lift;
        let mut rays = ray(l, DVec3::ZERO, direction);
        (rays.origin, rays.left) = (point.position, number);
        let sphere = || Spheres::splat(l, packed::<Scalar<false>>(center, radius), number);
        for key in [near_root(l, &rays, &sphere()).key(l), nearest_root(l, &rays, &sphere()).key(l)] {
            assert_eq!(distance::<Scalar<false>>(key), None);
        }
        left += 1;
    }
    // A ground, seen from its anchor.
    let prepared: PreparedScene<f32> = PreparedScene::new(&ground_job(1e5));
    for _ in 0..10_000 {
        let origin = DVec3::new(random.within(-3.0, 3.0), 0.0, random.within(-3.0, 3.0));
        let mut rays = ray(l, origin, random.direction() + DVec3::Y);
        rays.left = number;
        assert_eq!(
            distance::<Scalar<false>>(anchored_root(l, &rays, &prepared.anchored[0], number).key(l)),
            None
        );
    }
}

/// A ray enters glass of index 1.5 and crosses to the other side.
fn chord_error<L: Lanes>(l: L, random: &mut Random, center: DVec3, radius: f64) -> Option<f64> {
    let number = l.splat_u(NUMBER);
    let sphere = packed::<L>(center, radius);
    let origin = center + random.direction() * 3.0;
    let across = perpendicular(center - origin, random) * (0.98 * radius * random.unit().sqrt());
    let rays = ray(l, origin, center + across - origin);
    let t = distance::<L>(near_root(l, &rays, &Spheres::splat(l, sphere, number)).key(l))?;
    let point = surface_at(l, &rays, t, center, radius);
    let cosine = -rays.direction.dot(point.outward);
    let material = glass_lanes(l, 1.5);
    let zero = v3(l, DVec3::ZERO);
    let bounced = scatter::<L, true>(
        l,
        &material,
        DielectricLaws::RefractOnly,
        rays.direction,
        point.outward,
        &incidence_of(l, cosine),
        l.mask(1),
        zero,
        zero.x,
    );
    assert_eq!(bounced.refracts.bits() & 1, 1);
    let inner = Rays::<L> {
        origin: point.position,
        direction: normalised(l, bounced.direction),
        left: l.splat_u(NONE),
        inside: number,
    };
    let chord = distance::<L>(nearest_root(l, &inner, &Spheres::splat(l, sphere, number)).key(l)).unwrap();
    let [center, radius] = [center.as_vec3().as_dvec3(), DVec3::splat(f64::from(radius as f32))];
    let exact = exact_roots(vector::<L>(inner.origin), vector::<L>(inner.direction), center, radius.x);
    let [_, far] = exact.unwrap();
    Some((chord / far - 1.0).abs())
}

#[test]
fn case_09_chord_inside_a_tiny_sphere() {
    let mut random = Random::new(5);
    let (mut chords, mut largest) = (0, 0.0_f64);
    while chords < 100_000 {
        let center = random.in_box(1.0);
        for error in
            [chord_error(UNFUSED, &mut random, center, 1e-4), chord_error(FUSED, &mut random, center, 1e-4)]
                .into_iter()
                .flatten()
        {
            largest = largest.max(error);
            chords += 1;
        }
    }
    println!("case 9: relative chord {largest:.2e}");
    assert!(largest <= 1e-2, "{largest:e}");
}
