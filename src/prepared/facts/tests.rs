//! Tests of covered spheres and thin layers.

use super::*;
use crate::scene::Material;

fn scene(spheres: impl IntoIterator<Item = (DVec3, f64)>) -> Scene {
    let mut scene = Scene::default();
    let material = scene.add_material("m", Material::Lambertian { albedo: DVec3::ONE });
    spheres.into_iter().for_each(|(center, radius)| scene.add_sphere(center, radius, material));
    scene
}

/// Two spheres that are close are found to be close, wherever they lie and however large they are.
#[test]
fn layers_are_found_across_borders() {
    let random = |i: u32, k: u32| f64::from(crate::sampling::pcg4d([i, k, 0, 0])[0]) / f64::from(u32::MAX);
    for i in 0..5000 {
        let at = |k: u32| 10.0 * random(i, k) - 5.0;
        let radius = (6.0 * random(i, 3) - 3.0).exp2();
        let center = DVec3::new(at(0), at(1), at(2)).round() * f64::from(i % 2) + DVec3::X * at(4);
        let by = DVec3::new(random(i, 5), random(i, 6), random(i, 7)) - 0.5;
        let near = (center + by * 0.005 * radius, radius * (1.0 - 0.004 * random(i, 8)));
        let far = (center + DVec3::X * 0.02 * radius, radius);
        let facts = Facts::of(&scene([(center, radius), near, far, (center, radius)]));
        assert_eq!(facts.covered, [3], "{center} {radius}");
        assert!(facts.layers.iter().any(|layer| layer.spheres == [0, 1]), "{center} {radius}");
        assert!(facts.layers.iter().all(|layer| layer.spheres != [0, 2]), "{center} {radius}");
    }
}

#[test]
fn a_sphere_that_is_tiny_for_its_place_is_no_layer_with_itself() {
    for center in [DVec3::new(4.0, 1.0, 0.0), DVec3::splat(-1e3), DVec3::X] {
        for radius in [1e-18, 1e-16, 1e-14] {
            let facts = Facts::of(&scene([(center, radius), (DVec3::NEG_Y, 1.0)]));
            assert_eq!(facts, Facts::default(), "{center} {radius}");
        }
    }
}

#[test]
fn the_first_of_many_copies_stays() {
    let copies = (0..10_000).map(|i| (DVec3::new(f64::from(i % 3), 0.0, -0.0), 1.0 + f64::from(i % 2)));
    let facts = Facts::of(&scene(copies));
    assert_eq!(facts.covered, (6..10_000).collect::<Vec<_>>());
    assert!(facts.layers.is_empty());
}

#[test]
fn in_a_full_cell_a_sphere_is_compared_with_the_four_nearest() {
    // The two at either end of a crowd have neighbours that are three or four places away.
    let nearest = |count: u32| 2 * count as usize - 3 + 6;
    for (count, layers) in
        [(2_u32, 1), (63, 63 * 62 / 2), (64, 64 * 63 / 2), (65, nearest(65)), (100, nearest(100))]
    {
        let around = DVec3::splat(0.5);
        let facts = Facts::of(&scene((0..count).map(|i| (around, 1.0 + 1e-5 * f64::from(i)))));
        assert_eq!(facts.layers.len(), layers, "{count}");
        let next = |layer: &ThinLayer| layer.spheres[1] == layer.spheres[0] + 1;
        assert_eq!(facts.layers.iter().filter(|layer| next(layer)).count(), count as usize - 1, "{count}");
        assert_eq!(facts.covered, [0_u32; 0], "{count}");
    }
}

/// Coated balls that overlap: all cores come before all coats in the order of their sizes.
#[test]
fn each_coat_in_a_crowd_is_found() {
    let random = |i: u32, k: u32| f64::from(crate::sampling::pcg4d([i, k, 2, 0])[0]) / f64::from(u32::MAX);
    for count in [20, 40, 500] {
        for (corner, spread) in [(0.0, 1.0), (0.25, 0.5), (-0.5, 1.0), (0.4, 0.1)] {
            for coat in [1e-7, 1e-3] {
                let place = |i: u32| {
                    DVec3::splat(corner) + spread * DVec3::new(random(i, 0), random(i, 1), random(i, 2))
                };
                let balls = (0..2 * count).map(|i| (place(i % count), 1.4 - coat * f64::from(i / count)));
                let facts = Facts::of(&scene(balls));
                for i in 0..count {
                    let is_coat = |layer: &ThinLayer| layer.spheres == [i, i + count];
                    assert!(facts.layers.iter().any(is_coat), "{i} of {count} at {corner}, {coat}");
                }
            }
        }
    }
}

#[test]
fn copies_hide_no_layer_from_the_next_cell() {
    // The last sphere is beyond a border of the copies' cell.
    let radius = 1.0;
    let copies = (0..100).map(|_| (DVec3::new(0.005, 0.5, 0.5), radius));
    let inner = [(DVec3::new(0.005, 0.5, 0.5), 0.999), (DVec3::new(-0.001, 0.5, 0.5), radius)];
    let facts = Facts::of(&scene(copies.chain(inner)));
    let pairs: Vec<[u32; 2]> = facts.layers.iter().map(|layer| layer.spheres).collect();
    assert_eq!(pairs, [[0, 100], [0, 101], [100, 101]]);
}

#[test]
fn a_layer_is_as_thick_as_its_surfaces_are_apart() {
    let layer = |a: (f64, f64), b: (f64, f64)| {
        let facts = Facts::of(&scene([a, b].map(|(x, radius)| (DVec3::new(x, 0.5, 0.5), radius))));
        facts.layers.first().map(|layer| [layer.thickness, layer.opening].map(|x| (x * 1024.0).round()))
    };
    let unit = 1.0 / 1024.0;
    assert_eq!(layer((0.5, 1.0), (0.5, 1.0 - 4.0 * unit)), Some([4.0, 4.0]));
    assert_eq!(layer((0.5, 1.0), (0.5 + unit, 1.0 - 4.0 * unit)), Some([5.0, 3.0]));
    assert_eq!(layer((0.5, 1.0), (0.5 + 4.0 * unit, 1.0 + unit)), Some([5.0, 0.0]));
    // A layer is thinner than a hundredth of the smaller radius.
    assert_eq!(layer((0.5, 1.0), (0.5 + 10.2 * unit, 1.0)), Some([10.0, 0.0]));
    assert_eq!(layer((0.5, 1.0), (0.5 + 10.3 * unit, 1.0)), None);
    assert_eq!(layer((0.5, 1.0), (0.5, 1.0 - 10.2 * unit)), None);
    assert_eq!(layer((0.5, 1.0), (0.5, 1.0 - 10.1 * unit)), Some([10.0, 10.0]));
}

#[test]
fn layers_of_covered_spheres_are_those_of_the_first() {
    let (outer, inner) = ((DVec3::splat(0.5), 1.0), (DVec3::splat(0.5), 0.999));
    let facts = Facts::of(&scene([outer, inner, outer, inner]));
    assert_eq!(facts.covered, [2, 3]);
    assert!(facts.covers(2) && !facts.covers(1));
    let pairs: Vec<[u32; 2]> = facts.layers.iter().map(|layer| layer.spheres).collect();
    assert_eq!(pairs, [[0, 1]]);
}

#[test]
fn cells_beyond_a_border_are_near_it() {
    for (number, next) in [
        (5.0, Some(4.0)),
        (5.019, Some(4.0)),
        (5.021, None),
        (5.5, None),
        (5.979, None),
        (5.981, Some(6.0)),
        (-1.01, Some(-1.0)),
        (-1.99, Some(-3.0)),
    ] {
        let own = f64::floor(number);
        assert_eq!(cells_near(number), [Some(own), next], "{number}");
    }
    let count = |x: f64, y: f64, z: f64, radius: f64| {
        let sphere = Sphere { center: DVec3::new(x, y, z), radius, material: 0 };
        marks_beyond_borders(&sphere).len()
    };
    assert_eq!(count(0.5, 0.5, 0.5, 1.0), 0);
    assert_eq!(count(0.01, 0.5, 0.5, 1.0), 1);
    assert_eq!(count(0.01, 0.99, 0.5, 1.0), 3);
    assert_eq!(count(0.01, 0.99, 5.0, 1.0), 7);
    // The size is near a border, too: log2(radius) + 0.37 is 0.99.
    let radius = 0.62_f64.exp2();
    assert_eq!(count(0.5, 0.5, 0.5, radius), 1);
    assert_eq!(count(0.5, 0.5, 0.01, radius), 1 + 2);
}
