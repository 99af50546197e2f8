//! Stiff scenes in a list and in a hierarchy, and how they are prepared. (tests/program/stress.rs renders many more.)

use crate::numerics::common::*;
use crate::numerics::film::trace_tables;
use glam::DVec3;
use weekender::prepared::PreparedScene;
use weekender::prepared::hierarchy::{DEPTH_LIMIT, Effort, Hierarchy};
use weekender::prepared::wide_bvh::WideBvh;
use weekender::scene::{Camera, Material, Scene, Sky};

pub type Ball = (DVec3, f64, Material);

pub fn under_white_sky(balls: &[Ball]) -> Scene {
    Scene { sky: Sky { bottom: DVec3::ONE, top: DVec3::ONE }, ..scene(balls) }
}

/// A camera 3 units from the unit ball at the origin, with a view so narrow that nothing else is visible.
const AT_BALL: Camera =
    Camera { look_from: DVec3::new(0.0, 0.0, 3.0), look_at: DVec3::ZERO, vfov_degrees: 20.0, ..Camera::BOOK };

/// Of copies, the first is seen, whether they are in a list or a hierarchy.
#[test]
fn copies_look_like_the_first_ball() {
    let coloured = |albedo| (DVec3::ZERO, 1.0, Material::Lambertian { albedo });
    for (first, others) in [(DVec3::X, 0), (DVec3::Y, 1), (DVec3::X, 109), (DVec3::Y, 2999)] {
        let mut balls = vec![coloured(first)];
        balls.resize(1 + others, coloured(DVec3::splat(0.5)));
        // Forty more far behind the eye, enough for a hierarchy.
        let far = |i: u32| (DVec3::new(f64::from(i) - 20.0, 0.0, 500.0), 0.1, lambertian(0.5));
        balls.extend((0..40).map(far));
        let job = job(&under_white_sky(&balls), AT_BALL, size(4, 4));
        let prepared = PreparedScene::<f32>::new(&job);
        assert!(prepared.hierarchy.is_some(), "there is a hierarchy");
        for prepared in [prepared, PreparedScene::as_list(&job)] {
            let mut film = job.new_film();
            trace_tables(&prepared, &mut film, 0..16);
            assert!((0..16).all(|pixel| film.mean(pixel) == first.to_array()), "{others} copies");
        }
    }
}

/// Shells about one centre, and many balls in one place, do not make a tree too deep to traverse.
#[test]
fn shells_and_crowds_have_low_trees() {
    let ball = |center, radius| weekender::scene::Sphere { center, radius, material: 0 };
    let mut random = Random::new(5);
    let shells: Vec<_> = (1..=6000).map(|i| ball(DVec3::ZERO, 1e-3 * f64::from(i))).collect();
    let halves: Vec<_> = (0..60).map(|i| ball(DVec3::X, 0.5_f64.powi(i))).collect();
    let crowd: Vec<_> = (0..6000).map(|_| ball(random.in_box(1e-3), random.within(0.5, 1.5))).collect();
    let copies = vec![ball(DVec3::Y, 1.0); 6000];
    let row: Vec<_> = (0..6000).map(|i| ball(DVec3::X * f64::from(i), 0.5)).collect();
    for spheres in [&shells, &halves, &crowd, &copies, &row] {
        let hierarchy = Hierarchy::<f32>::build(spheres, DVec3::ZERO, Effort::Quick);
        let mut order = hierarchy.ranks.clone();
        order.sort_unstable();
        assert!(order.iter().enumerate().all(|(place, rank)| place == *rank as usize), "each once");
        let mut levels = vec![1; hierarchy.nodes.len()];
        for (index, node) in hierarchy.nodes.iter().enumerate().filter(|(_, node)| node.sphere_count() == 0) {
            levels[node.first as usize] = levels[index] + 1;
            levels[node.first as usize + 1] = levels[index] + 1;
        }
        let depth = levels.into_iter().max();
        assert!(depth <= Some(DEPTH_LIMIT), "{depth:?}");
        let never = std::sync::atomic::AtomicBool::new(false);
        let (wide, _) = WideBvh::build_unless(&never, spheres, DVec3::ZERO).unwrap();
        assert!(wide.depth <= 24);
    }
}

/// Spheres much larger than what is on them are anchored there, in the scene's order, whichever gains most.
#[test]
fn large_spheres_are_anchored_at_details() {
    let grounds = [
        (DVec3::Y * -(1e4 + 10.0), 1e4, DVec3::new(0.01, 1.0, 0.0).normalize()),
        (DVec3::Y * (1e6 + 10.0), 1e6, DVec3::new(0.0, -1.0, 1e-4).normalize()),
    ];
    for order in [[0, 1], [1, 0]] {
        let large = order.map(|ground: usize| grounds[ground]);
        let with_detail = |(center, radius, towards): (DVec3, f64, DVec3)| {
            let detail = (center + towards * (radius + 0.05), 0.05, lambertian(0.5));
            [(center, radius, lambertian(0.5)), detail]
        };
        let balls: Vec<Ball> = large.into_iter().flat_map(with_detail).collect();
        let prepared = PreparedScene::<f32>::new(&job(&scene(&balls), AT_BALL, size(2, 2)));
        assert_eq!(prepared.scene_index, [1, 3, 0, 2], "anchored spheres come last");
        for (anchored, (_, _, towards)) in prepared.anchored.iter().zip(large) {
            let outward = -DVec3::from(anchored.inward.map(f64::from));
            assert!(outward.distance(towards) < 1e-6, "{outward} {towards}");
        }
    }
}
