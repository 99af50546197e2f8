//! The top-down builder, and the scenes it is for.

use super::*;
use crate::prepared::regions::on_a_curve;
use crate::scene::Sphere;
use glam::DVec3;

fn ball(x: f64, radius: f64) -> Sphere {
    Sphere { center: DVec3::X * x, radius, material: 0 }
}

/// Shells around the origin, largest first.
fn shells(count: u32) -> impl Iterator<Item = Sphere> {
    (0..count).map(|index| ball(0.0, 1.0 - 1e-5 * f64::from(index)))
}

/// Scattered balls, away from the origin.
fn strewn(count: u32) -> impl Iterator<Item = Sphere> {
    (0..count).map(|index| {
        let [x, y, z, _] = crate::kernel::sampling::pcg4d([index, 0, 0, 0]).map(|k| f64::from(k >> 8));
        Sphere { center: 10.0 + DVec3::new(x, y, z) / 1e4, radius: 0.1, material: 0 }
    })
}

/// Balls beside each other, none nested.
fn row(count: u32) -> impl Iterator<Item = Sphere> {
    (1..=count).map(|place| ball(3.0 * f64::from(place), 0.1))
}

/// Those that clustering would chain, and those that it pairs fast.
#[test]
fn nested_and_stretched_scenes_are_crowded() {
    let over_decades = |decades: f64, share: f64| -> Vec<Sphere> {
        let along = (0..4096).map(|index| 10_f64.powf(decades * (f64::from(index) / 4096.0 - 0.5)));
        let at = |x: f64| Sphere { center: DVec3::new(x, 0.0, -x), radius: share * x, material: 0 };
        along.map(at).collect()
    };
    // In an order unrelated to their size.
    let mut mixed = over_decades(24.0, 0.3);
    mixed.sort_by_key(|ball| ball.center.x.to_bits().wrapping_mul(0x9E37_79B9_7F4A_7C15));
    let hollow: Vec<Sphere> = (0..100_u32)
        .flat_map(|place| (0..32).map(move |index| (place, index)))
        .map(|(place, index)| ball(3.0 * f64::from(place), 1.0 - 0.01 * f64::from(index)))
        .collect();
    let lattice = |i: u32| Sphere {
        center: DVec3::new(f64::from(i % 16), f64::from(i / 16 % 16), f64::from(i / 256)),
        radius: 0.25,
        material: 0,
    };
    for (what, spheres, expected) in [
        ("shells", shells(3000).collect(), true),
        ("shells beside a row", shells(1500).chain(row(1000)).collect(), true),
        ("few shells", shells(2000).collect(), false),
        ("three decades", over_decades(3.0, 0.3), true),
        ("many decades of small balls", over_decades(24.0, 1e-4), true),
        ("mixed", mixed, true),
        ("a row", row(4096).collect(), true),
        ("hollow balls", hollow, false),
        ("scattered", strewn(20_000).collect(), false),
        ("a lattice", (0..4096).map(lattice).collect::<Vec<_>>(), false),
    ] {
        let bounded = Bounded::all(&spheres, &DVec3::ZERO);
        let own: Vec<&Bounded> = on_a_curve(&bounded);
        let boxes: Vec<Aabb> = own.iter().map(|sphere| sphere.aabb()).collect();
        assert_eq!(is_crowded(&own, &boxes), expected, "{what}");
    }
}

/// The numbers on either side of the best split, in order.
fn sides(spheres: &[Sphere]) -> Option<[Vec<u32>; 2]> {
    let mut part: Vec<u32> = (0..spheres.len() as u32).collect();
    let left = part_where_it_pays(&Bounded::all(spheres, &DVec3::ZERO), &mut part)?;
    let (a, b) = part.split_at(left);
    Some([a, b].map(|side| {
        let mut side = side.to_vec();
        side.sort_unstable();
        side
    }))
}

#[test]
fn split_minimises_area_times_spheres() {
    // One ball in each of the sixteen bins.
    let even: Vec<Sphere> = (0..16).map(|place| ball(f64::from(place), 0.25)).collect();
    let all: Vec<u32> = (0..16).collect();
    assert_eq!(sides(&even), Some([all[..8].to_vec(), all[8..].to_vec()]));
    let backwards: Vec<Sphere> = even.iter().rev().copied().collect();
    assert_eq!(sides(&backwards), Some([all[8..].to_vec(), all[..8].to_vec()]));
    for axis in [DVec3::Y, DVec3::Z] {
        let turned = even.iter().map(|ball| Sphere { center: ball.center.x * axis, ..*ball });
        assert_eq!(sides(&turned.collect::<Vec<_>>()), sides(&even), "{axis}");
    }
    // Many balls at one end draw the split towards them.
    let heavy: Vec<Sphere> = even.iter().copied().chain([even[1]; 30]).collect();
    let [left, _] = sides(&heavy).unwrap();
    assert_eq!(left, [0, 1].into_iter().chain(16..46).collect::<Vec<u32>>());
    // Balls around the same place are split by size, the small ones first.
    let nested: Vec<Sphere> = (0..6).map(|index| ball(0.0, [8.0, 1.0][index % 2])).collect();
    assert_eq!(sides(&nested), Some([vec![1, 3, 5], vec![0, 2, 4]]));
    assert_eq!(sides(&[ball(1.0, 2.0); 5]), None, "copies cannot be parted");
}

#[test]
fn tree_holds_every_sphere_once() {
    let spheres: Vec<Sphere> = row(100).chain(shells(30)).collect();
    let bounded = Bounded::all(&spheres, &DVec3::ZERO);
    let trees = [(1, false), (1, true), (4, false), (4, true), (130, false)];
    for ((leaf_size, halved), cancelled) in trees.into_iter().flat_map(|t| [(t, false), (t, true)]) {
        let tree = build(&bounded, leaf_size, halved, &AtomicBool::new(cancelled));
        let mut order = tree.primitive_indices.clone();
        order.sort_unstable();
        assert!(order.into_iter().eq(0..130));
        let mut places = Vec::new();
        for node in &tree.nodes {
            let places_of = node.first_index..node.first_index + node.prim_count;
            if node.is_leaf() {
                assert!(node.prim_count as usize <= leaf_size);
                places.extend(places_of.clone());
            }
            for place in places_of {
                let inner = bounded[tree.primitive_indices[place as usize] as usize].aabb();
                assert_eq!(node.aabb().union(&inner), *node.aabb(), "a box holds its spheres");
            }
        }
        places.sort_unstable();
        assert!(places.into_iter().eq(0..130), "leaves of {leaf_size}");
        assert!(leaf_size < 130 || tree.nodes.len() == 1, "no more nodes than are needed");
        assert!(leaf_size > 1 || tree.nodes.len() == 2 * 130 - 1, "each node has two children");
    }
}
