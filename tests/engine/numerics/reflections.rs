//! Reflections inside a sphere: case 19. (Book 1, section 11.)

use crate::numerics::common::*;
use crate::numerics::intersection::{FUSED, NUMBER, UNFUSED, surface_at};
use glam::DVec3;
use weekender::render_cpu::lanes::{Float, Lanes, Mask, V3};
use weekender::render_cpu::material::{incidence_of, scatter};
use weekender::render_cpu::sphere::{NONE, Rays, Spheres, nearest_root};
use weekender::stages::DielectricLaws;

/// Follows total reflection around the inside of a glass ball. Returns the largest distance of a hit from the sphere,
/// relative to its radius, and the largest change of the sine of the angle of incidence.
fn drift<L: Lanes>(l: L, center: DVec3, radius: f64, sine: f64) -> [f64; 2] {
    let mut random = Random::new(6);
    let number = l.splat_u(NUMBER);
    let sphere = packed::<L>(center, radius);
    let normal = random.direction();
    let along = perpendicular(normal, &mut random);
    let mut rays = Rays::<L> {
        origin: v3(l, center + normal * radius),
        direction: normalised(l, v3(l, along * sine - normal * (1.0 - sine * sine).sqrt())),
        left: l.splat_u(NONE),
        inside: number,
    };
    let material = glass_lanes(l, 1.5);
    let zero = l.constant(0.0);
    let rounded_center = vector::<L>(v3(l, center));
    let mut largest = [0.0_f64; 2];
    for _ in 0..1000 {
        let t = distance::<L>(nearest_root(l, &rays, &Spheres::splat(l, sphere, number)).key(l)).unwrap();
        let point = surface_at(l, &rays, t, center, radius);
        let away = vector::<L>(point.position) - rounded_center;
        largest[0] = largest[0].max((away.length() / radius - 1.0).abs());
        let now = vector::<L>(rays.direction).normalize().cross(away.normalize()).length();
        largest[1] = largest[1].max((now - sine).abs());
        let cosine = zero.max(l.constant(1.0).min(rays.direction.dot(point.outward)));
        let inward = V3 { x: -point.outward.x, y: -point.outward.y, z: -point.outward.z };
        let bounced = scatter::<L, true>(
            l,
            &material,
            DielectricLaws::Schlick,
            rays.direction,
            inward,
            &incidence_of(l, cosine),
            l.mask(0),
            v3(l, DVec3::ZERO),
            l.constant(0.999_999),
        );
        assert_eq!(bounced.refracts.bits() & 1, 0, "total reflection");
        rays.origin = point.position;
        rays.direction = normalised(l, bounced.direction);
    }
    largest
}

#[test]
fn case_19_a_thousand_internal_reflections() {
    for sine in [0.7, 0.8, 0.9, 0.99] {
        for (center, radius) in
            [(DVec3::ZERO, 1.0), (DVec3::new(-1.0, 0.0, -1.0), 0.5), (DVec3::new(0.3, 0.2, 0.4), 0.2)]
        {
            for (name, [off, turned]) in [
                ("fused", drift(FUSED, center, radius, sine)),
                ("unfused", drift(UNFUSED, center, radius, sine)),
            ] {
                println!("case 19 {name}, sine {sine}, radius {radius}: off {off:.2e}, sine {turned:.2e}");
                assert!(off <= 1e-6, "{name}, sine {sine}, radius {radius}: {off:e} off the sphere");
                assert!(turned <= 1e-4, "{name}, sine {sine}, radius {radius}: drifts by {turned:e}");
            }
        }
    }
}
