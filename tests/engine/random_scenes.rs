//! Random scenes that combine all difficulties: scales from 1e-6 to 1e6, copies, shells, contacts, glass of any index,
//! and eyes inside or on spheres. Single precision must give the same picture as double, and changes that must not
//! matter must not change it.
//!
//! It takes a moment by default, and as long as `WEEKENDER_SEARCH_SECONDS` says otherwise. A failing scene is shrunk and
//! printed as a scene file.

use glam::DVec3;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use weekender::backends::BackendChoice;
use weekender::job::recipe::{Recipe, file};
use weekender::job::render::RenderSettings;
use weekender::measure::stress::{Difference, Level, moved, trace, with_far_spheres};
use weekender::measure::{Candidate, Traced};
use weekender::render_cpu::{CpuOptions, Isa};
use weekender::scene::{Camera, Material, Scene, Sky};
use weekender::stages::Rules;

/// Allowed difference of a mean apart from noise, linear radiance.
const TOLERANCE: f64 = 1e-5;

/// A difference is examined again with this many times the samples. Where rounding differs, chaotic paths diverge at
/// random, a few in a thousand in glass; a wrong picture stays wrong whatever the seed.
const SECOND_LOOK: u64 = 64;

/// A number whose logarithm is uniform.
fn log(low: f64, high: f64) -> impl Strategy<Value = f64> + Clone {
    (low.ln()..high.ln()).prop_map(f64::exp)
}

fn direction() -> impl Strategy<Value = DVec3> + Clone {
    (-1.0..1.0_f64, 0.0..std::f64::consts::TAU).prop_map(|(height, turn)| {
        let across = (1.0 - height * height).sqrt();
        DVec3::new(across * turn.cos(), height, across * turn.sin())
    })
}

fn material() -> impl Strategy<Value = Material> + Clone {
    let grey = prop::sample::select(vec![1.0, 0.5, 0.9, 0.2]).prop_map(DVec3::splat);
    let fuzz = prop_oneof![Just(0.0), 0.0..1.0_f64];
    let index =
        prop_oneof![Just(1.5), Just(1.0 / 1.5), log(1e-6, 1.0).prop_map(|more| 1.0 + more), log(1e-2, 1e2)];
    prop_oneof![
        3 => grey.clone().prop_map(|albedo| Material::Lambertian { albedo }),
        1 => (grey, fuzz).prop_map(|(albedo, fuzz)| Material::Metal { albedo, fuzz }),
        2 => index.prop_map(|refraction_index| Material::Dielectric { refraction_index }),
    ]
}

/// A sphere in a stiff relation to an earlier one, or an independent one.
#[derive(Clone, Copy, Debug)]
enum Relation {
    Copy,
    AlmostACopy(f64),
    Shell(f64),
    TouchingOutside(f64),
    TouchingInside(f64),
    Free { distance: f64, radius: f64 },
}

fn relation() -> impl Strategy<Value = Relation> + Clone {
    prop_oneof![
        2 => (log(1e-2, 10.0), log(1e-3, 10.0))
            .prop_map(|(distance, radius)| Relation::Free { distance, radius }),
        1 => Just(Relation::Copy),
        1 => log(1e-9, 1e-2).prop_map(Relation::AlmostACopy),
        2 => log(1e-5, 0.5).prop_map(Relation::Shell),
        1 => log(1e-3, 1e3).prop_map(Relation::TouchingOutside),
        1 => (0.1..0.9_f64).prop_map(Relation::TouchingInside),
    ]
}

/// Centre, radius and material.
type Ball = (DVec3, f64, Material);

/// Balls with equal materials share one.
fn scene(balls: Vec<Ball>, sky: Sky) -> Scene {
    let mut scene = Scene { sky, ..Scene::default() };
    for (center, radius, material) in balls {
        let known = scene.materials.iter().position(|named| named.material == material);
        let new = scene.materials.len().to_string();
        let index = known.unwrap_or_else(|| scene.add_material(new, material));
        scene.add_sphere(center, radius, index);
    }
    scene
}

type Described = (Relation, DVec3, Material, prop::sample::Index);

fn ball((relation, direction, material, other): Described, others: &[Ball]) -> Ball {
    let first = (DVec3::ZERO, 1.0, material);
    let (center, radius, own) = if others.is_empty() { first } else { others[other.index(others.len())] };
    match relation {
        Relation::Copy => (center, radius, own),
        Relation::AlmostACopy(shift) => (center + radius * shift * direction, radius, own),
        Relation::Shell(thickness) => (center, radius * (1.0 - thickness), material),
        Relation::TouchingOutside(factor) => {
            (center + (1.0 + factor) * radius * direction, factor * radius, material)
        }
        Relation::TouchingInside(factor) => {
            (center + (1.0 - factor) * radius * direction, factor * radius, material)
        }
        Relation::Free { distance, radius } => (distance * direction, radius, material),
    }
}

/// How far the eye is from the centre of a sphere, in radii: inside, on the surface or close to it, or outside.
fn distance_of_eye() -> impl Strategy<Value = f64> {
    prop_oneof![0.0..0.99, log(1e-6, 1e-1).prop_map(|height| 1.0 + height), log(1.1, 30.0), log(1.1, 30.0)]
}

fn recipe() -> impl Strategy<Value = Recipe> {
    let balls =
        prop::collection::vec((relation(), direction(), material(), any::<prop::sample::Index>()), 1..15);
    let ground = prop::option::weighted(0.3, log(1e2, 1e7));
    let sky = prop::sample::select(vec![
        Sky::default(),
        Sky { bottom: DVec3::ONE, top: DVec3::ONE },
        Sky { bottom: DVec3::ZERO, top: DVec3::new(0.5, 1.0, 2.0) },
    ]);
    let from = (distance_of_eye(), direction(), any::<prop::sample::Index>());
    let at = (direction(), any::<prop::sample::Index>());
    let lens = prop_oneof![4 => Just(0.0), 1 => log(1e-3, 30.0)];
    let place = (
        prop_oneof![Just(1.0), log(1e-6, 1e6)],
        prop_oneof![Just(DVec3::ZERO), (log(1.0, 1e5), direction()).prop_map(|(far, way)| far * way)],
    );
    let rest = (log(1.0, 120.0), lens, log(2.0, 200.0), any::<u32>(), place);
    (balls, ground, sky, from, at, rest).prop_map(|(described, ground, sky, from, at, rest)| {
        let mut balls: Vec<Ball> = Vec::new();
        described.into_iter().for_each(|next| balls.push(ball(next, &balls)));
        if let Some(radius) = ground {
            let ground = Material::Lambertian { albedo: DVec3::splat(0.5) };
            let lowest = balls.iter().map(|(center, r, _)| center.y - r).fold(f64::INFINITY, f64::min);
            balls.push((DVec3::new(0.0, lowest - radius, 0.0), radius, ground));
        }
        let (center, radius, _) = balls[from.2.index(balls.len())];
        let look_from = center + radius * from.0 * from.1;
        let (center, radius, _) = balls[at.1.index(balls.len())];
        let look_at = center + 0.3 * radius * at.0;
        let look_at = if look_from == look_at { look_from + DVec3::X } else { look_at };
        let (vfov, lens, depth, seed, (factor, offset)) = rest;
        let view = look_at - look_from;
        let vup = if view.x == 0.0 && view.z == 0.0 { DVec3::X } else { DVec3::Y };
        let (vfov_degrees, defocus_angle_degrees) = (vfov, lens);
        let camera = Camera { look_from, look_at, vup, vfov_degrees, defocus_angle_degrees, ..Camera::BOOK };
        let settings =
            RenderSettings { width: 16, height: 12, max_depth: depth as u32, seed, ..Default::default() };
        let recipe = Recipe {
            name: "random".to_owned(),
            scene: Arc::new(scene(balls, sky)),
            camera,
            settings,
            keyframes: Vec::new(),
            rules: Rules::FINISHED,
            samples_per_pixel: 16,
        };
        moved(&recipe, factor, factor * offset)
    })
}

/// Pairs of scenes that must give the same picture: one for each change that applies.
fn changes(recipe: &Recipe) -> Vec<(&'static str, [Recipe; 2])> {
    let extent = recipe.camera.look_from.distance(recipe.camera.look_at);
    let with = |other: Recipe| Some([recipe.clone(), other]);
    let changes = [
        ("40 distant spheres, and so a hierarchy", with(with_far_spheres(recipe, extent))),
        ("four times as large", with(moved(recipe, 4.0, DVec3::ZERO))),
        ("copies removed", without_copies(recipe).and_then(with)),
        ("moved", there_and_back(recipe, extent)),
    ];
    let is_valid = |pair: &[Recipe; 2]| pair.iter().all(|one| one.job().is_ok());
    changes.into_iter().filter_map(|(change, pair)| Some((change, pair.filter(is_valid)?))).collect()
}

fn without_copies(recipe: &Recipe) -> Option<Recipe> {
    let mut scene = Scene::clone(&recipe.scene);
    let mut kept = Vec::new();
    for sphere in &recipe.scene.spheres {
        if scene.material_of(sphere).is_transparent() || !kept.contains(sphere) {
            kept.push(*sphere);
        }
    }
    let is_less = kept.len() < scene.spheres.len();
    scene.spheres = kept;
    is_less.then(|| Recipe { scene: Arc::new(scene), ..recipe.clone() })
}

/// The scene moved away, and the same moved back, so that both have lost the same digits. `None` if only those digits
/// tell on which side of a surface the eye is.
fn there_and_back(recipe: &Recipe, extent: f64) -> Option<[Recipe; 2]> {
    // A power of two, so that coordinates keep their digits.
    let way = extent.log2().round().exp2() * DVec3::new(4.0, -8.0, 2.0);
    let there = moved(recipe, 1.0, way);
    let rounding = 32.0 * f64::EPSILON * way.abs().max_element();
    let eye = recipe.camera.look_from;
    let is_clear = recipe.scene.spheres.iter().all(|s| (s.center.distance(eye) - s.radius).abs() > rounding);
    is_clear.then(|| [moved(&there, 1.0, -way), there])
}

struct Checker {
    single: Vec<Candidate>,
    double: Candidate,
}

impl Checker {
    fn new() -> Self {
        let available = Isa::available();
        let best = |is_fused: bool| available.iter().copied().rfind(|isa| isa.is_fused() == is_fused);
        let cpu = |isa: Isa| {
            let options = CpuOptions { isa: Some(isa), threads: Some(1), ..CpuOptions::default() };
            Candidate::new(isa.name(), BackendChoice::Cpu(options))
        };
        Checker {
            single: best(true).into_iter().chain(best(false)).map(cpu).collect(),
            double: Candidate::new("f64", BackendChoice::Reference { threads: Some(1) }),
        }
    }

    /// Finds faults in a scene's pictures. Scenes that are refused or warned about are not faults.
    fn check(&mut self, recipe: &Recipe) -> Result<(), String> {
        if recipe.job().is_err() {
            return Ok(());
        }
        for index in 0..self.single.len() {
            let name = self.single[index].name.clone();
            let itself = [recipe.clone(), recipe.clone()];
            let precise = self.compare(index, true, &itself);
            precise.map_err(|reason| format!("{name}, f32 and f64: {reason}"))?;
            for (change, pair) in changes(recipe) {
                let changed = self.compare(index, false, &pair);
                changed.map_err(|reason| format!("{name}, {change}: {reason}"))?;
            }
            let film = traced(&mut self.single[index], recipe)?.film;
            let most = recipe.scene.sky.bottom.max(recipe.scene.sky.top).to_array();
            for pixel in 0..film.width() as usize * film.height() as usize {
                let mean = film.mean(pixel);
                if (0..3).any(|channel| mean[channel] > most[channel] * (1.0 + 1e-5)) {
                    return Err(format!("{name}: pixel {pixel} is {mean:?}; the sky is at most {most:?}"));
                }
            }
        }
        Ok(())
    }

    /// Two pictures must be the same, if not with few samples then with many and one of two seeds. The second is traced in
    /// double precision if `is_precise`.
    fn compare(&mut self, index: usize, is_precise: bool, pair: &[Recipe; 2]) -> Result<(), String> {
        let mut trace = |factor: u64, more_seed: u32| -> Result<[Traced; 2], String> {
            let [one, other] = pair.clone().map(|mut recipe| {
                recipe.samples_per_pixel *= factor;
                recipe.settings.seed = recipe.settings.seed.wrapping_add(more_seed);
                recipe
            });
            let single = &mut self.single[index];
            let one = traced(single, &one)?;
            if is_precise {
                let exact = traced(&mut self.double, &other)?;
                return Ok([one, Traced { warnings: Vec::new(), ..exact }]);
            }
            Ok([one, traced(single, &other)?])
        };
        if same(&trace(1, 0)?, 0.5, 1e-4).is_ok() {
            return Ok(());
        }
        // Two independent pictures differ by 1.4 times their noise, which is only known to within a tenth.
        let first = same(&trace(SECOND_LOOK, 0)?, 1.6, 3e-4);
        first.or_else(|_| same(&trace(SECOND_LOOK, 1)?, 1.6, 3e-4))
    }
}

fn traced(tracer: &mut Candidate, recipe: &Recipe) -> Result<Traced, String> {
    trace(tracer, recipe, &AtomicBool::new(false))
}

/// Whether the means differ by no more than chance, and the pixels by less than `share` of their noise or `floor`.
fn same([one, other]: &[Traced; 2], share: f64, floor: f64) -> Result<(), String> {
    if !one.warnings.is_empty() || !other.warnings.is_empty() {
        return Ok(());
    }
    let (paired, noise) = (Difference::of(&other.film, &one.film), Level::of(&one.film).noise);
    let rejected = one.film.rejected() + other.film.rejected();
    let is_near = paired.bias.abs() <= TOLERANCE + 4.0 * paired.bias_deviation;
    if rejected == 0 && is_near && paired.rms <= (share * noise).max(floor) {
        return Ok(());
    }
    Err(format!("{paired:?}, noise {noise:.1e}, rejected {rejected}"))
}

#[test]
fn random_scenes_survive_single_precision_and_neutral_changes() {
    let seconds =
        std::env::var("WEEKENDER_SEARCH_SECONDS").ok().and_then(|text| text.parse().ok()).unwrap_or(2.0);
    let (begin, limit) = (Instant::now(), Duration::from_secs_f64(seconds));
    let checker = std::cell::RefCell::new(Checker::new());
    let is_long = seconds > 10.0;
    while begin.elapsed() < limit {
        let config =
            Config { cases: if is_long { 100 } else { 5 }, max_shrink_iters: 2000, ..Config::default() };
        // A short search always tries the same scenes.
        let mut runner = if is_long {
            TestRunner::new(config)
        } else {
            TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha))
        };
        let outcome = runner.run(&recipe(), |recipe| {
            let checked = checker.borrow_mut().check(&recipe);
            checked.map_err(|reason| TestCaseError::fail(format!("{reason}\n{}", file::to_toml(&recipe))))
        });
        if let Err(error) = outcome {
            panic!("{error}");
        }
        if !is_long {
            break;
        }
    }
}
