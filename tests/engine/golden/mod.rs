//! Digests of the exact sums of small films of every stage and built-in scene, under every setting that changes samples.
//!
//! Processors that round multiply and add once have other sums than those that round twice, so each film is kept for
//! both, and for the reference in `f64`. `tests/engine/numerics/parity.rs` checks that the levels of a class agree.
//! `UPDATE_SNAPSHOTS=1` writes the digests anew, for a change of the film version or the sample version.

use crate::common::skip::report_untested;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::thread;
use weekender::backends::{BackendChoice, create};
use weekender::film::Film;
use weekender::job::recipe::Recipe;
use weekender::job::render::SamplerKind;
use weekender::render_cpu::{CpuOptions, Isa};
use weekender::scene::builtin::BuiltinScene;
use weekender::stages::{DielectricLaws, Diffuse, Shading, Stage, SurfaceRule};

const SAMPLES: u64 = 5;

type Change = (&'static str, fn(&mut Recipe));

/// Applied to three scenes; each stage and scene is also rendered as it is.
const CHANGES: &[Change] = &[
    ("independent", |recipe| recipe.settings.sampler = SamplerKind::Independent),
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
    let numbers = sums.chain(ranges).chain([film.rejected()]);
    let fnv1a = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    format!("{:016x}", numbers.flat_map(u64::to_le_bytes).fold(0xcbf2_9ce4_8422_2325, fnv1a))
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

/// Compares `actual` with the kept digests `name`.
fn check(name: &str, actual: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/engine/golden").join(name);
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        std::fs::write(&path, actual).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap();
    assert_eq!(kept.lines().count(), actual.lines().count(), "{name} has other films");
    let differences: Vec<_> =
        kept.lines().zip(actual.lines()).filter(|(kept, actual)| kept != actual).collect();
    assert!(differences.is_empty(), "{} films differ from {name}: {differences:#?}", differences.len());
}

/// The rows of all pictures, made by several threads. They are not rayon's: one of those would begin another picture on
/// its stack while it waits for a renderer's threads, and another one inside that.
fn rows(pictures: &[(String, Recipe)], row: impl Fn(&(String, Recipe)) -> String + Sync) -> String {
    let share = pictures.len().div_ceil(thread::available_parallelism().map_or(1, usize::from));
    thread::scope(|scope| {
        let parts =
            pictures.chunks(share).map(|part| scope.spawn(|| part.iter().map(&row).collect::<String>()));
        parts.collect::<Vec<_>>().into_iter().map(|part| part.join().unwrap()).collect()
    })
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
    let separate = |(name, recipe): &(String, Recipe)| {
        let reference = BackendChoice::Reference { threads: Some(1) };
        format!("{name:36} {} {}\n", film(recipe, &cpu(Isa::Portable)), film(recipe, &reference))
    };
    let separate = rows(&pictures, separate);
    check("films.txt", &format!("{:36} {:16} reference\n{separate}", "", "portable"));
    if let Some(isa) = fused {
        let row = |(name, recipe): &(String, Recipe)| format!("{name:36} {}\n", film(recipe, &cpu(isa)));
        check("films_fused.txt", &rows(&pictures, row));
    } else {
        report_untested("the fused half of the films: this processor has no fused multiply-add");
    }
}
