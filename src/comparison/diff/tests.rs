//! Two paths: where they differ, how they leave a sphere, the sentences, and the search.

use super::*;
use crate::backends::BackendChoice;
use crate::job::recipe::Recipe;
use crate::kernel::path_record::{PathRecord, RecordedHit, RecordedRay};
use crate::render_cpu::{CpuOptions, Isa};
use crate::scene::{Material, Sphere};
use crate::stages::Shading;

fn job() -> RenderJob {
    Recipe::find("three-spheres").unwrap().job().unwrap()
}

fn ray(origin: [f64; 3], direction: [f64; 3], sphere: Option<usize>) -> RecordedRay {
    let hit = sphere.map(|sphere| RecordedHit { sphere, distance: 2.0, position: Some([0.0; 3]) });
    RecordedRay { origin, direction, throughput: [1.0; 3], hit }
}

/// A path that hits a matte sphere, then the sky.
fn path() -> PathRecord {
    let rays = vec![ray([0.0; 3], [0.0, 0.0, -1.0], Some(1)), ray([0.0; 3], [0.0, 1.0, 0.0], None)];
    PathRecord { rays, radiance: [0.25, 0.5, 1.0] }
}

fn pair<'a>(job: &'a RenderJob, paths: [&'a PathRecord; 2], tolerance: f64) -> Pair<'a> {
    Pair { job, names: ["cpu", "gpu"], paths, tolerance }
}

#[test]
fn first_difference_is_found_and_described() {
    type Change = fn(&mut PathRecord);
    let cases: [(usize, &str, Change, &str); 7] = [
        (0, "direction", |p| p.rays[0].direction[0] = 1e-3, "ray 1: direction differs by 1.0e-3"),
        (1, "origin", |p| p.rays[1].origin[2] = 1e-3, "ray 2: origin differs by 1.0e0"),
        (1, "throughput", |p| p.rays[1].throughput[1] = 0.99, "ray 2: throughput differs by 1.0e-2"),
        (0, "object", |p| p.rays[0].hit = None, "the sky"),
        (0, "distance", |p| p.rays[0].hit.as_mut().unwrap().distance = 2.002, "distance differs by 1.0e-3"),
        (0, "departure", |p| p.rays.truncate(1), "ray 1: the paths diverge in departure: cpu "),
        (1, "radiance", |p| p.radiance[0] = 0.26, "differ by 1.0e-2, but only 1e-4 is allowed"),
    ];
    let job = job();
    for (ray, quantity, change, expected) in cases {
        let mut changed = path();
        change(&mut changed);
        for paths in [[&path(), &changed], [&changed, &path()]] {
            let pair = pair(&job, paths, 1e-4);
            let first = pair.compare().first.unwrap();
            assert_eq!((first.ray, first.quantity), (ray, quantity));
            assert!(pair.sentence(&first).contains(expected), "{}", pair.sentence(&first));
        }
    }
    let original = path();
    let same = pair(&job, [&original, &original], 0.0);
    assert_eq!(same.compare(), PathComparison { first: None, parting: None, largest: 0.0, radiance: 0.0 });
    assert_eq!(same.verdict(&same.compare()), "the paths agree to the bit");
    let mut changed = path();
    changed.rays[1].direction[0] = 3e-5;
    let near = pair(&job, [&original, &changed], 1e-4);
    let expected = "the paths agree: the largest difference is 3.0e-5, and up to 1e-4 is allowed";
    assert_eq!(near.verdict(&near.compare()), expected);
    let unit = 1.0 / crate::film::FIXED_POINT_SCALE;
    assert_eq!(radiance_amount([0.0, unit, unit], [unit, 0.0, unit]), 0.0);
}

#[test]
fn nothing_counts_after_paths_part() {
    let job = job();
    let mut changed = path();
    changed.rays[0].direction[0] = 1e-3;
    changed.rays[1] = ray([0.0, 2e-3, 0.0], [0.0, 1.0, 0.0], Some(2));
    changed.rays.push(ray([0.0; 3], [0.0, 1.0, 0.0], None));
    let original = path();
    let pair = pair(&job, [&original, &changed], 1e-4);
    let found = pair.compare();
    let place = |difference: Difference| (difference.ray, difference.quantity);
    assert_eq!(found.first.map(place), Some((0, "direction")));
    assert_eq!(found.parting.map(place), Some((1, "object")));
    // The second ray's origin is the path's largest coordinate, so the difference is all of it.
    assert_eq!((found.largest, found.radiance), (1.0, 0.0));
    let verdict = pair.verdict(&found);
    assert!(
        verdict.starts_with("ray 1: direction")
            && verdict.contains(". Then ray 2: the paths diverge in object: cpu the sky")
    );
}

#[test]
fn positions_allow_for_largest_coordinate() {
    let job = job();
    let path = |z: f64| {
        let rays =
            vec![ray([0.0, 8.0, 0.0], [0.0, 0.0, -1.0], None), ray([0.0, 0.0, z], [0.0, 1.0, 0.0], None)];
        PathRecord { rays, radiance: [0.5; 3] }
    };
    for (z, amount) in [(2.0, 0.25), (16.0, 1.0)] {
        let amounts = |a, b| [0, 1].map(|index| pair(&job, [a, b], 0.0).rows(index)[0].amount);
        assert_eq!(amounts(&path(0.0), &path(z)), [0.0, amount]);
    }
}

#[test]
fn departure_follows_material_and_next_ray() {
    let of = |job: &RenderJob, test: fn(&Material) -> bool| {
        let scene = job.scene();
        scene.spheres.iter().position(|sphere| test(scene.material_of(sphere))).unwrap()
    };
    // A downward ray hits the top of the sphere, where the next one starts.
    let found = |job: &RenderJob, sphere: usize, next: Option<[f64; 3]>, index: usize| {
        let Sphere { center, radius, .. } = job.scene().spheres[sphere];
        let top = (center + radius * glam::DVec3::Y).to_array();
        let mut down = ray(top, [0.0, -1.0, 0.0], Some(sphere));
        down.hit.as_mut().unwrap().position = Some(top);
        let mut rays = vec![down; index + 1];
        rays.extend(next.map(|direction| ray(top, direction, None)));
        let path = PathRecord { rays, radiance: [0.0; 3] };
        pair(job, [&path, &path], 0.0).rows(index)[5].values[0].clone()
    };
    let job = job();
    let matte = of(&job, |material| matches!(material, Material::Lambertian { .. }));
    let metal = of(&job, |material| matches!(material, Material::Metal { .. }));
    let glass = of(&job, |material| matches!(material, Material::Dielectric { .. }));
    let (up, down) = (Some([0.6, 0.8, 0.0]), Some([0.6, -0.8, 0.0]));
    let last = job.settings().max_depth as usize - 1;
    for (sphere, next, index, word) in [
        (matte, up, 0, "scattered"),
        (metal, up, 0, "reflected"),
        (glass, up, 0, "reflected"),
        (glass, down, 0, "refracted"),
        (metal, None, 0, "absorbed"),
        (metal, None, last, "cut off"),
        (metal, None, last - 1, "absorbed"),
    ] {
        assert_eq!(found(&job, sphere, next, index).as_deref(), Some(word), "{sphere} {next:?}");
    }
    // A stage without bounces shows the first hit.
    let mut recipe = Recipe::find("three-spheres").unwrap();
    recipe.rules.shading = Shading::Normals;
    assert_eq!(found(&recipe.job().unwrap(), metal, None, 0).as_deref(), Some("shown"));
}

#[test]
fn unpaired_rays_are_shown() {
    let job = job();
    let path = |rays: &[RecordedRay]| PathRecord { rays: rays.to_vec(), radiance: [0.5; 3] };
    let [first, second] = [1.0, 2.0].map(|z| ray([0.0, 0.0, z], [0.0, 0.0, -1.0], None));
    let (short, long) = (path(&[first]), path(&[first, second]));
    for paths in [[&short, &long], [&long, &short]] {
        let pair = pair(&job, paths, 1e-3);
        let text = text::text(&pair, &pair.compare());
        let (both, one) = text.split_once("ray 2 ").unwrap();
        assert!(both.contains("ray 1 from the camera") && !both.contains('▶'), "{text}");
        let row = |label: &str| one.lines().find(|line| line.contains(label)).unwrap();
        assert!(row("▶ origin").contains("2.000000") && row("object").contains("the sky"), "{text}");
        assert!(one.contains("ray 2: the paths diverge in origin") && !text.contains("ray 3"), "{text}");
    }
}

#[test]
fn search_finds_worst_sample() {
    let mut recipe = Recipe::find("three-spheres").unwrap();
    (recipe.settings.width, recipe.settings.height) = (12, 7);
    let job = recipe.job().unwrap();
    let portable = || {
        let isa = Some(Isa::Portable);
        Side::open(&BackendChoice::Cpu(CpuOptions { isa, threads: Some(1), ..CpuOptions::default() }))
            .unwrap()
    };
    let mut sides = [portable(), Side::open(&BackendChoice::Reference { threads: Some(1) }).unwrap()];
    let (mut most, mut expected, mut differing) = (0.0, None, 0);
    for sample in 0..3 {
        for pixel in (0..7).flat_map(|y| (0..12).map(move |x| [x, y])) {
            let [a, b] = sides.each_mut().map(|side| side.record(&job, pixel, sample).unwrap().radiance);
            let by = (0..3).map(|channel| (a[channel] - b[channel]).abs()).fold(0.0, f64::max);
            differing += u64::from(radiance_amount(a, b) > 0.0);
            if by > most {
                (most, expected) = (by, Some((pixel, sample)));
            }
        }
    }
    let (pixel, sample) = expected.unwrap();
    assert!(0 < differing && differing < 3 * 7 * 12, "{differing}");
    let found = find(&job, &mut sides, 3, 0.0).unwrap();
    assert_eq!(found, Found { pixel, sample, searched: 3, differing });
    let found = find(&job, &mut [portable(), portable()], 2, 0.0).unwrap();
    assert_eq!(found, Found { pixel: [0, 0], sample: 0, searched: 2, differing: 0 });
}
