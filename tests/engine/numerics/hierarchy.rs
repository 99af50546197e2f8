//! The hierarchy finds the same hits as testing every sphere: the same sphere and the same distance, bit for bit.

use crate::numerics::common::*;
use crate::numerics::film::trace_tables;
use glam::DVec3;
use std::sync::Arc;
use weekender::job::render::{RenderJob, RenderSettings};
use weekender::kernel::{BOX_MARGIN, Node, Real};
use weekender::prepared::PreparedScene;
use weekender::prepared::hierarchy::{Effort, Hierarchy};
use weekender::render_cpu::bvh::{EMPTY_STACK, misses_box, slabs_of, traverse};
use weekender::render_cpu::lanes::{Key, Lanes, Mask, Reference, Scalar, Unsigned, V3, Wide, WideU};
use weekender::render_cpu::sphere::{NONE, Nearest, Rays, Spheres, near_root, nearest_root};
use weekender::scene::Sphere;
use weekender::scene::builtin::{BOOK_CAMERA, book};
use weekender::stages::{Rules, SurfaceRule};

/// Spheres with sizes over many powers of ten, some touching, some at the same place.
fn spheres(random: &mut Random, count: usize, spread: f64, radii: [f64; 2]) -> Vec<Sphere> {
    let mut spheres: Vec<Sphere> = Vec::with_capacity(count);
    for index in 0..count {
        if index % 8 == 7 {
            // A copy: a tie.
            spheres.push(spheres[index - 1 - (random.bits() % 7) as usize]);
            continue;
        }
        let radius = random.log_within(radii[0], radii[1]);
        let center = match index % 8 {
            0 if index > 0 => spheres[index - 1].center,
            1 if index > 1 => {
                let other = spheres[index - 2];
                other.center + random.direction() * (other.radius + radius)
            }
            2 => DVec3::new(random.within(-spread, spread), 0.0, 0.0),
            _ => random.in_box(spread),
        };
        spheres.push(Sphere { center, radius, material: 0 });
    }
    spheres
}

/// A ray before it is rounded, and the spheres that it leaves and is inside of.
struct OneRay {
    origin: DVec3,
    direction: DVec3,
    left: u32,
    inside: u32,
}

fn one_ray(random: &mut Random, spheres: &[Sphere], spread: f64) -> OneRay {
    let index = (random.bits() % spheres.len() as u64) as usize;
    let target = spheres[index];
    let aim = target.center + random.direction() * target.radius * random.within(0.0, 1.001);
    let free = |origin, direction: DVec3| OneRay {
        origin,
        direction: direction.normalize(),
        left: NONE,
        inside: NONE,
    };
    match random.bits() % 5 {
        // Outwards or inwards from the surface of a sphere.
        kind @ (0 | 1) => {
            let from = free(target.center + random.direction() * target.radius, random.direction());
            let index = index as u32;
            if kind == 0 { OneRay { left: index, ..from } } else { OneRay { inside: index, ..from } }
        }
        // Along an axis, where a component of the direction is 0.
        2 => {
            let axis = DVec3::AXES[(random.bits() % 3) as usize];
            let direction = if random.bits() & 1 == 0 { axis } else { -axis };
            free(aim - direction * spread * random.log_within(0.1, 100.0), direction)
        }
        // From afar past the point where a sphere touches its box, nearly along another axis.
        3 => {
            let axis = (random.bits() % 3) as usize;
            let [touching, along] = [DVec3::AXES[axis], DVec3::AXES[(axis + 1) % 3]];
            let aim = target.center + touching * target.radius * (1.0 + random.within(-1e-6, 1e-6));
            let direction = along + random.direction() * random.log_within(1e-9, 1e-3);
            free(aim - direction * target.radius * random.log_within(1.0, 1e4), direction)
        }
        // From afar.
        _ => {
            let origin = random.direction() * spread * random.log_within(0.1, 1000.0);
            free(origin, aim - origin)
        }
    }
}

fn packet<L: Lanes>(l: L, rays: &[OneRay]) -> Rays<L> {
    let vector = |of: fn(&OneRay) -> DVec3| {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let mut wide = Wide::default();
            wide.0.iter_mut().zip(rays).for_each(|(to, ray)| *to = L::Real::from_f64(of(ray)[axis]));
            l.load(&wide)
        });
        V3 { x, y, z }
    };
    let integers = |of: fn(&OneRay) -> u32| {
        let mut wide = WideU::default();
        wide.0.iter_mut().zip(rays).for_each(|(to, ray)| *to = of(ray));
        l.load_u(&wide)
    };
    Rays {
        origin: vector(|ray| ray.origin),
        direction: vector(|ray| ray.direction),
        left: integers(|ray| ray.left),
        inside: integers(|ray| ray.inside),
    }
}

/// A hierarchy in which only the nearer root counts for every other sphere.
struct Tree<L: Lanes> {
    hierarchy: Hierarchy<L::Real>,
    /// In leaf order.
    ordered: Vec<Sphere>,
    rows: Vec<[L::Real; 4]>,
    /// The spheres' numbers in list order.
    numbers: Vec<u32>,
}

impl<L: Lanes> Tree<L> {
    fn over(listed: &[Sphere]) -> Self {
        let hierarchy = Hierarchy::<L::Real>::build(listed, DVec3::ZERO, Effort::Quick);
        let ordered: Vec<Sphere> = hierarchy.ranks.iter().map(|rank| listed[*rank as usize]).collect();
        assert_eq!(ordered.len(), listed.len(), "each sphere is in one leaf");
        let row = |(sphere, rank): (&Sphere, &u32)| {
            let [x, y, z, radius2] = packed::<L>(sphere.center, sphere.radius);
            [x, y, z, if rank % 2 == 0 { radius2 } else { negated(radius2) }]
        };
        let rows = ordered.iter().zip(&hierarchy.ranks).map(row).collect();
        let mut numbers: Vec<u32> = (0..ordered.len() as u32).collect();
        numbers.sort_by_key(|number| hierarchy.ranks[*number as usize]);
        Tree { hierarchy, ordered, rows, numbers }
    }
}

fn negated<R: Real>(x: R) -> R {
    R::from_f64(-x.to_f64())
}

#[inline(always)]
fn nearest_in_list<L: Lanes>(l: L, rays: &Rays<L>, rows: &[[L::Real; 4]], numbers: &[u32]) -> Nearest<L> {
    let mut nearest = Nearest::nothing(l);
    for index in numbers {
        let ([x, y, z, radius2], number) = (rows[*index as usize], l.splat_u(*index));
        let candidate = if radius2 < L::Real::default() {
            near_root(l, rays, &Spheres::splat(l, [x, y, z, negated(radius2)], number))
        } else {
            nearest_root(l, rays, &Spheres::splat(l, [x, y, z, radius2], number))
        };
        nearest.take(l, candidate, number);
    }
    nearest
}

/// Number, spread and radii of a scene's spheres.
#[derive(Clone, Copy, Debug)]
struct Scale {
    count: usize,
    spread: f64,
    radii: [f64; 2],
}

/// Checks packets of rays in all directions, and returns the number of hits.
#[inline(always)]
fn same_hits<L: Lanes>(l: L, seed: u64, scale: Scale, ray_count: usize) -> u32 {
    let mut random = Random::new(seed);
    let listed = spheres(&mut random, scale.count, scale.spread, scale.radii);
    let Tree { hierarchy, ordered, rows, numbers } = Tree::<L>::over(&listed);
    let (mut stack, mut hits) = (EMPTY_STACK, 0);
    let all = l.mask((1 << L::WIDTH) - 1);
    for _ in 0..ray_count / L::WIDTH {
        let single: Vec<_> = (0..L::WIDTH).map(|_| one_ray(&mut random, &ordered, scale.spread)).collect();
        let rays = packet(l, &single);
        let mut found = Nearest::nothing(l);
        traverse(l, &hierarchy, &rows, &rays, all, &mut stack, &mut found);
        let expected = nearest_in_list(l, &rays, &rows, &numbers);
        let same = found.key.eq(expected.key) & found.sphere.eq(expected.sphere);
        assert_eq!(same.bits() & all.bits(), all.bits(), "seed {seed}, {scale:?}");
        hits += ((!found.sphere.eq(l.splat_u(NONE))).bits() & all.bits()).count_ones();
    }
    hits
}

/// A hundred scenes of various sizes, at scales from `1e-12` to `1e12`.
#[test]
fn hierarchy_and_list_agree() {
    let mut random = Random::new(11);
    let (mut hits, mut rays) = (0, 0);
    for seed in 100..200 {
        let count = random.log_within(1.0, 300.0) as usize;
        let spread = random.log_within(1e-9, 1e12);
        let largest = spread * random.log_within(1e-4, 1.0);
        let scale = Scale { count, spread, radii: [largest * random.log_within(1e-6, 1.0), largest] };
        hits += same_hits(Scalar::<true>, seed, scale, 200);
        hits += same_hits(Scalar::<false>, seed, scale, 100);
        hits += same_hits(Reference, seed, scale, 100);
        rays += 400;
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = fearless_simd::Level::new().as_avx2() {
            use fearless_simd::Simd;
            hits += simd.vectorize(
                #[inline(always)]
                || same_hits(weekender::render_cpu::lanes::Lanes8(simd), seed, scale, 300),
            );
            rays += 300;
        }
    }
    assert!(hits > rays / 4, "{hits} of {rays}");
}

/// The book's final picture with and without the hierarchy.
#[test]
fn hierarchy_and_list_render_same_film() {
    let job = job(&book(), BOOK_CAMERA, size(48, 27));
    let prepared = PreparedScene::<f32>::new(&job);
    assert!(prepared.hierarchy.is_some(), "the book has a hierarchy");
    let mut with = job.new_film();
    trace_tables(&prepared, &mut with, 0..4);
    let mut without = job.new_film();
    trace_tables(&PreparedScene::as_list(&job), &mut without, 0..4);
    assert_eq!(with, without);
    assert!(mean(&with) > 0.1);
}

/// Rays along an axis from afar, on either side, that pass a box within its margin or beyond it.
#[test]
fn boxes_are_widened_on_every_side() {
    const FAR: f64 = 1e6;
    let l = Scalar::<true>;
    let node = Node { low: [-1.0; 3], high: [1.0; 3], ..Node::default() };
    for (axis, sign) in (0..3).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
        let (side, across) = (sign * DVec3::AXES[axis], DVec3::AXES[(axis + 1) % 3]);
        for (margins, expected) in [(0.5, 0), (1.5, 1)] {
            let origin = FAR * side + (1.0 + margins * BOX_MARGIN * FAR) * across;
            let slabs = slabs_of(l, &ray(l, origin, -side), 1.0);
            let missed = misses_box(l, &slabs, &node, l.constant(f64::INFINITY)).bits();
            assert_eq!(missed & 1, expected, "from {origin}, {margins} margins beside the box");
        }
    }
}

/// A renderer reuses its prepared scene for the next job unless the rules change.
#[test]
fn renderer_reused_after_other_rules() {
    let settings = RenderSettings { max_depth: 8, ..size(24, 14) };
    let scene = Arc::new(book());
    let with = |surface| {
        let rules = Rules { surface, ..Rules::FINISHED };
        RenderJob::new(Arc::clone(&scene), BOOK_CAMERA, settings, rules).unwrap()
    };
    let jobs = [SurfaceRule::Exact, SurfaceRule::Book, SurfaceRule::Acne].map(with);
    let mut renderer = widest();
    for job in jobs.iter().chain(jobs.iter().rev()) {
        assert!(
            render(&mut renderer, job, 0..4) == render(&mut widest(), job, 0..4),
            "{:?}",
            job.rules().surface
        );
    }
}
