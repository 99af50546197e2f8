//! The exact sum: cases 23 to 25, through the tracer. (For the film alone, see tests/film.)

use crate::numerics::common::*;
use glam::DVec3;
use weekender::film::Film;
use weekender::job::render::RenderJob;
use weekender::kernel::parts;
use weekender::prepared::PreparedScene;
use weekender::render_cpu::broadcast::BroadcastScene;
use weekender::render_cpu::lanes::Scalar;
use weekender::render_cpu::path::trace;
use weekender::render_cpu::work::{RefillBlock, RefillOrder, TileStats, Work};
use weekender::scene::builtin::empty;
use weekender::scene::{Camera, Sky};

/// Traces a prepared scene without validating it, in one tile of at most 256 pixels a side.
pub fn trace_tables(
    prepared: &PreparedScene<f32>,
    film: &mut Film,
    samples: std::ops::Range<u64>,
) -> TileStats {
    let settings = prepared.settings;
    let blocks = RefillBlock::of_range(samples.clone(), &settings, prepared.block_limit);
    let order = RefillOrder::new(settings.width, settings.height);
    let rows =
        film.halves_mut().iter_mut().flat_map(|half| half.chunks_mut(settings.width as usize)).collect();
    let mut work = Work::new(&blocks, &order, [0, 0], rows);
    let stats =
        trace::<_, { parts::ALL }>(Scalar::<false>, &BroadcastScene::new(prepared.clone()), &mut work);
    film.record(samples, stats.rejected).unwrap();
    stats
}

#[test]
fn case_23_ten_million_samples() {
    let mut scene = empty();
    scene.sky = Sky { bottom: DVec3::splat(0.7), top: DVec3::splat(0.7) };
    let film = render(&mut widest(), &job(&scene, Camera::BOOK, size(1, 1)), 0..10_000_000);
    for x in film.mean(0) {
        println!("case 23: relative error {:.2e}", x / 0.7 - 1.0);
        assert!((x / 0.7 - 1.0).abs() <= 1e-7, "{x}");
    }
}

/// A block's sums fit 32 bits, whichever end of the sky is bright.
#[test]
fn sums_of_a_bright_sky_do_not_overflow() {
    let mut scene = empty();
    for (bottom, top) in [(100.0, 0.0), (0.0, 100.0)] {
        scene.sky = Sky { bottom: DVec3::splat(bottom), top: DVec3::splat(top) };
        let look_at = DVec3::Y * (top - bottom);
        let camera = Camera { look_at, vup: DVec3::Z, vfov_degrees: 1.0, ..Camera::BOOK };
        let film = render(&mut widest(), &job(&scene, camera, size(2, 2)), 0..1024);
        assert!(film.mean(0).iter().all(|x| (99.9..=100.0).contains(x)), "{bottom}: {:?}", film.mean(0));
    }
}

/// A lone ball, or its sky, has a NaN colour: exactly the paths that see it are counted and left out.
#[test]
fn case_25_not_a_number() {
    const SAMPLES: u64 = 4;
    let ball = scene(&[(DVec3::new(0.0, 0.0, -1.0), 0.5, lambertian(0.5))]);
    let job = sharp_job(&ball, Camera::BOOK, size(64, 36));
    let clean = PreparedScene::<f32>::new(&job);
    let mut expected = job.new_film();
    assert_eq!(trace_tables(&clean, &mut expected, 0..SAMPLES).rejected, 0);
    assert_eq!(expected, render(&mut portable(), &job, 0..SAMPLES), "the prepared are rendered as they are");
    let is_ball = |x: u32, y: u32| {
        let (o, d) = centre_ray(&Camera::BOOK, 64, 36, x, y);
        exact_roots(o, d, DVec3::new(0.0, 0.0, -1.0), 0.5).is_some()
    };

    for bad in [f32::NAN, f32::INFINITY, f32::MAX] {
        let mut prepared = clean.clone();
        // One channel of three is enough.
        prepared.records[0].0[5] = bad;
        let mut film = job.new_film();
        let stats = trace_tables(&prepared, &mut film, 0..SAMPLES);
        let mut hits = 0;
        for y in 0..36 {
            for x in 0..64 {
                let pixel = (y * 64 + x) as usize;
                if is_ball(x, y) {
                    hits += 1;
                    assert_eq!(film.pixel_sum(pixel).0, [0; 3], "{bad} at {x}, {y}");
                } else {
                    assert_eq!(film.pixel_sum(pixel), expected.pixel_sum(pixel), "{bad} at {x}, {y}");
                }
            }
        }
        assert!(hits > 100);
        assert_eq!(stats.rejected, hits * SAMPLES, "{bad}");
        assert_eq!(film.rejected(), stats.rejected);
        assert!(film.means().iter().flatten().all(|x| x.is_finite()));
    }

    // NaN geometry is never hit; a NaN sky spoils every sample.
    let mut prepared = clean.clone();
    prepared.opaque[0] = [f32::NAN; 4];
    let mut film = job.new_film();
    assert_eq!(trace_tables(&prepared, &mut film, 0..SAMPLES).rejected, 0);
    let bare = RenderJob::new(empty(), *job.camera(), *job.settings(), *job.rules()).unwrap();
    assert_eq!(film, render(&mut portable(), &bare, 0..SAMPLES));
    let mut prepared = clean;
    prepared.sky_middle[1] = f32::INFINITY;
    let mut film = job.new_film();
    assert_eq!(trace_tables(&prepared, &mut film, 0..SAMPLES).rejected, 64 * 36 * SAMPLES);
    for pixel in 0..64 * 36 {
        assert_eq!(film.pixel_sum(pixel).0, [0; 3]);
    }
}
