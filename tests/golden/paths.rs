//! Paths of every stage in words, as the reference traces them, and the layers that are made of paths.

use crate::common::{at_once, check};
use std::fmt::Write as _;
use std::sync::atomic::AtomicBool;
use weekender::explain::{steps, timeline};
use weekender::layers::{Layer, LayerImage};
use weekender::recipe::Recipe;
use weekender::render::RenderJob;
use weekender::render_cpu::{Isa, PathRecorder, record_path};
use weekender::scene::builtin::BuiltinScene;
use weekender::stages::Stage;

fn recipes() -> Vec<Recipe> {
    let scenes = BuiltinScene::ALL.iter().map(|scene| Recipe::find(scene.name).unwrap());
    let mut recipes: Vec<Recipe> = Stage::ALL.iter().map(Stage::recipe).chain(scenes).collect();
    for recipe in &mut recipes {
        (recipe.settings.width, recipe.settings.height) = (16, 9);
    }
    recipes.dedup_by(|a, b| a.name == b.name);
    recipes
}

fn told(job: &RenderJob, pixel: [u32; 2], index: u64) -> String {
    let record = record_path(job, pixel, index, None);
    let mut text = String::new();
    for step in steps(job, pixel, index, &record) {
        let [o, d, t] = [step.origin, step.direction, step.throughput]
            .map(|v| format!("{:.4} {:.4} {:.4}", v.x + 0.0, v.y + 0.0, v.z + 0.0));
        let hit = step.hit.map_or_else(
            || "nothing".to_owned(),
            |hit| {
                format!(
                    "{} at {:.4}, normal {:.4}, outside {}",
                    hit.sphere, hit.point, hit.normal, hit.is_outside
                )
            },
        );
        writeln!(text, "  {o} | {d} | {t} | {hit}\n    {}", step.sentence(job)).unwrap();
    }
    writeln!(text, "  radiance {:.5?}", record.radiance).unwrap();
    text
}

#[test]
fn paths_are_told_as_kept() {
    let texts = at_once(&recipes(), |recipe| {
        let job = recipe.job().unwrap();
        let mut text = String::new();
        let (pixel, index) = ([5, 5], 3);
        writeln!(text, "{}, pixel {pixel:?}, sample {index}", recipe.name).unwrap();
        text.push_str(&told(&job, pixel, index));
        text
    });
    check("paths", &texts.concat());
}

#[test]
fn layers_and_timelines_are_as_kept() {
    let texts = at_once(&recipes(), |recipe| {
        let job = recipe.job().unwrap();
        let mut text = format!("{}\n", recipe.name);
        for layer in [Layer::Normals, Layer::Albedo, Layer::RaysPerPath] {
            let job = layer.job(&job).unwrap();
            let paths = PathRecorder::new(&job, Isa::Portable, None);
            let mut image = LayerImage::new(layer, &job);
            for _ in 0..3 {
                image.add_sample(&paths, &AtomicBool::new(false));
            }
            let values = [[8, 4], [4, 5], [15, 0], [0, 8]].map(|pixel| image.mean(pixel));
            writeln!(text, "  {layer:?} {values:.4?}").unwrap();
        }
        let records: Vec<_> = (0..6).map(|lane| vec![record_path(&job, [8, 4], lane, None)]).collect();
        for refill in [false, true] {
            let all = timeline(job.scene(), &records, refill);
            writeln!(text, "  {} steps, {:.4} at work", all.len(), all.share_at_work()).unwrap();
        }
        text
    });
    check("layers", &texts.concat());
}
