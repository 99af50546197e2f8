//! All packets of one class render the same bits: levels with fused multiply and add are one class, those without the
//! other.
//!
//! At a level's own lane count the path loop is specialised to the job; with one lane it is so less often. Equality over
//! the widths is therefore also case 39, on the CPU and to the bit.

use crate::numerics::common::*;
use std::collections::BTreeMap;
use weekender::film::Film;
use weekender::job::recipe::Recipe;
use weekender::job::render::{RenderJob, RenderSettings, SamplerKind};
use weekender::render_cpu::{CpuOptions, CpuRenderer, Isa};
use weekender::scene::builtin::BuiltinScene;
use weekender::stages::Stage;

/// One renderer for each level and lane count of this machine.
fn all_packets() -> Vec<(Isa, usize, CpuRenderer)> {
    Isa::available()
        .into_iter()
        .flat_map(|isa| isa.lane_counts().iter().map(move |lanes| (isa, *lanes, packets(isa, *lanes))))
        .collect()
}

fn small(recipe: &Recipe, sampler: SamplerKind) -> RenderJob {
    let settings = RenderSettings { width: 48, height: 27, sampler, ..recipe.settings };
    RenderJob::new(recipe.scene.clone(), recipe.camera, settings, recipe.rules).unwrap()
}

/// Wide packets trace this many samples in blocks in which lanes wait for each other. A half's blocks have four samples
/// and one, so lanes wait even where each path is a single ray.
const SAMPLES: u64 = 10;

fn assert_parity(recipes: impl Iterator<Item = Recipe>) {
    let mut renderers = all_packets();
    for (index, recipe) in recipes.enumerate() {
        let job = small(&recipe, SamplerKind::ALL[index % 2]);
        let mut classes: BTreeMap<bool, (String, Film, u64)> = BTreeMap::new();
        for (isa, lanes, renderer) in &mut renderers {
            let (film, stats) = render_with_stats(renderer, &job, 0..SAMPLES);
            let name = format!("{isa} with {lanes} lanes");
            let (first, expected, expected_rays) =
                classes.entry(isa.is_fused()).or_insert_with(|| (name.clone(), film.clone(), stats.rays));
            assert!(film == *expected, "{}: {name} differs from {first}", recipe.name);
            assert_eq!(stats.rays, *expected_rays, "{}: {name} and {first} count rays", recipe.name);
        }
    }
}

#[test]
fn case_39_all_packets_render_the_same_stages() {
    assert_parity(Stage::ALL.iter().map(Stage::recipe));
}

#[test]
fn case_39_all_packets_render_the_same_scenes() {
    assert_parity(BuiltinScene::ALL.iter().map(|scene| Recipe::find(scene.name).unwrap()));
}

/// Tiles, threads, passes and their order do not change the picture.
#[test]
fn case_24_another_order() {
    let threaded = |threads| CpuRenderer::new(CpuOptions { threads: Some(threads), ..CpuOptions::default() });
    for name in ["three-spheres", "close-up"] {
        let recipe = Recipe::find(name).unwrap();
        for sampler in SamplerKind::ALL {
            let settings = RenderSettings { width: 131, height: 70, sampler, ..recipe.settings };
            let job = RenderJob::new(recipe.scene.clone(), recipe.camera, settings, recipe.rules).unwrap();
            let expected = render(&mut threaded(1).unwrap(), &job, 0..13);
            for threads in [2, 5] {
                let film = render(&mut threaded(threads).unwrap(), &job, 0..13);
                assert!(film == expected, "{name} on {threads} threads");
            }
            let mut film = job.new_film();
            for range in [8..13, 0..1, 2..7, 7..8, 1..2] {
                film.merge(&render(&mut widest(), &job, range)).unwrap();
            }
            assert!(film == expected, "{name} in passes");
        }
    }
}
