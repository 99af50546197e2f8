//! The exact sums of small films of every stage and built-in scene, under every setting that changes samples.
//!
//! Processors that round multiply and add once have other sums than those that round twice, so each film is kept for
//! both, and for the reference in `f64`. `tests/numerics/parity.rs` checks that the levels of a class agree.

use crate::common::{at_once, check, digest};
use std::sync::atomic::AtomicBool;
use weekender::backends::{BackendChoice, create};
use weekender::film::Film;
use weekender::recipe::Recipe;
use weekender::render::SamplerKind;
use weekender::render_cpu::{CpuOptions, Isa};
use weekender::scene::builtin::BuiltinScene;
use weekender::stages::{DielectricLaws, Diffuse, Shading, Stage, SurfaceRule};

const SAMPLES: u64 = 5;

type Change = (&'static str, fn(&mut Recipe));

/// Applied to three scenes; each stage and scene is also rendered as it is.
const CHANGES: &[Change] = &[
    ("independent", |recipe| recipe.settings.sampler = SamplerKind::Independent),
    ("independent, one half", |recipe| {
        recipe.settings.sampler = SamplerKind::Independent;
        recipe.settings.estimate_error = false;
    }),
    ("one half", |recipe| recipe.settings.estimate_error = false),
    ("seed 7", |recipe| recipe.settings.seed = 7),
    ("depth 1", |recipe| recipe.settings.max_depth = 1),
    ("depth 2", |recipe| recipe.settings.max_depth = 2),
    ("depth 3", |recipe| recipe.settings.max_depth = 3),
    ("lens", |recipe| {
        recipe.camera.defocus_angle_degrees = 3.0;
        recipe.camera.focus_distance = Some(2.0);
    }),
    ("lens, focus at look_at", |recipe| {
        recipe.camera.defocus_angle_degrees = 3.0;
        recipe.camera.focus_distance = None;
    }),
    ("tilted", |recipe| recipe.camera.vup = [1.0, 2.0, 0.5].into()),
    ("narrow", |recipe| recipe.camera.vfov_degrees = 11.0),
    ("upright", |recipe| std::mem::swap(&mut recipe.settings.width, &mut recipe.settings.height)),
    ("sharp pixels", |recipe| recipe.rules.antialiasing = false),
    ("strips", |recipe| recipe.rules.reflectance_strips = true),
    ("hemisphere", |recipe| recipe.rules.diffuse = Diffuse::Hemisphere),
    ("refract only", |recipe| recipe.rules.dielectric = DielectricLaws::RefractOnly),
    ("total reflection", |recipe| recipe.rules.dielectric = DielectricLaws::TotalReflection),
    ("acne", |recipe| recipe.rules.surface = SurfaceRule::Acne),
    ("book's surface", |recipe| recipe.rules.surface = SurfaceRule::Book),
    ("red", |recipe| recipe.rules.shading = Shading::FirstHitRed),
    ("normals", |recipe| recipe.rules.shading = Shading::Normals),
    ("eye in glass", |recipe| recipe.camera.look_from = [-1.0, 0.05, -0.95].into()),
    ("from afar", |recipe| {
        recipe.camera.look_from = [3e5, 1e5, 2e5].into();
        recipe.camera.vfov_degrees = 0.01;
    }),
];

fn digest_of_film(film: &Film) -> String {
    let sums = film.halves().iter().flatten().flat_map(|sum| sum.0);
    let ranges = film.samples().iter().flat_map(|range| [range.start, range.end]);
    digest(sums.chain(ranges).chain([film.rejected()]))
}

fn film(recipe: &Recipe, backend: &BackendChoice) -> String {
    let job = recipe.job().unwrap();
    let mut film = job.new_film();
    let mut renderer = create(backend).unwrap();
    renderer.accumulate(&job, 0..SAMPLES, &mut film, &AtomicBool::new(false)).unwrap();
    digest_of_film(&film)
}

fn cpu(isa: Isa) -> BackendChoice {
    BackendChoice::Cpu(CpuOptions { isa: Some(isa), threads: Some(1), ..CpuOptions::default() })
}

#[test]
fn films_have_the_kept_sums() {
    let mut pictures: Vec<(String, Recipe)> = Vec::new();
    let scenes = BuiltinScene::ALL.iter().map(|scene| Recipe::find(scene.name).unwrap());
    let scenes = scenes.chain([Recipe::find("field:60").unwrap()]);
    for mut recipe in Stage::ALL.iter().map(Stage::recipe).chain(scenes) {
        (recipe.settings.width, recipe.settings.height) = (16, 9);
        let name = recipe.name.clone();
        if ["three-spheres", "book", "close-up"].contains(&name.as_str()) {
            for (what, change) in CHANGES {
                let mut changed = recipe.clone();
                change(&mut changed);
                pictures.push((format!("{name}, {what}"), changed));
            }
        }
        pictures.push((name, recipe));
    }
    let fused = Isa::available().into_iter().find(|isa| isa.is_fused());
    let rows = at_once(&pictures, |(name, recipe)| {
        let separate = film(recipe, &cpu(Isa::Portable));
        let fused = fused.map(|isa| film(recipe, &cpu(isa)));
        let reference = film(recipe, &BackendChoice::Reference { threads: Some(1) });
        (name.clone(), separate, fused, reference)
    });
    let mut by_class = [String::new(), String::new()];
    for (name, separate, fused, reference) in rows {
        by_class[0].push_str(&format!("{name:36} {separate} {reference}\n"));
        by_class[1].push_str(&format!("{name:36} {}\n", fused.unwrap_or_default()));
    }
    check("films", &format!("{:36} {:16} reference\n{}", "", "portable", by_class[0]));
    if fused.is_some() {
        check("films_fused", &by_class[1]);
    } else {
        eprintln!("this processor has no fused multiply and add: half of the films are not checked");
    }
}
