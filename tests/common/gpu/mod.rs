//! Helpers that the GPU tests share.
#![allow(dead_code, reason = "each test uses some of it")]

pub use crate::common::skip::skip;
use std::cell::RefCell;
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, MutexGuard, PoisonError};
use weekender::job::recipe::Recipe;
use weekender::job::render::{RenderJob, RenderSettings, SamplerKind};
use weekender::render_cpu::{CpuOptions, CpuRenderer};
use weekender::render_gpu::{GpuError, GpuOptions, GpuRenderer};
use weekender::scene::builtin::BuiltinScene;
use weekender::scene::{Camera, Scene};
use weekender::stages::{Rules, Stage};

thread_local! {
    /// Held by a test's thread until it ends.
    static TURN: RefCell<Option<MutexGuard<'static, ()>>> = const { RefCell::new(None) };
}

/// Waits until no other test of this binary uses the adapter: NVIDIA's driver crashed or hung when many tests opened
/// and closed devices at once.
fn take_turn() {
    static DEVICE: Mutex<()> = Mutex::new(());
    TURN.with_borrow_mut(|turn| {
        turn.get_or_insert_with(|| DEVICE.lock().unwrap_or_else(PoisonError::into_inner));
    });
}

/// A renderer on any adapter, even a software one, or on the one that `WEEKENDER_TEST_ADAPTER` names. Without an
/// adapter, prints a message and lets the test pass, unless `WEEKENDER_REQUIRE_GPU=1`.
pub fn gpu(options: GpuOptions) -> Option<GpuRenderer> {
    take_turn();
    let adapter = std::env::var("WEEKENDER_TEST_ADAPTER").ok();
    match GpuRenderer::new(GpuOptions { adapter, allow_software: true, ..options }) {
        Ok(renderer) => Some(renderer),
        Err(GpuError::None) => {
            skip_without_adapter();
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// Whether there is an adapter, even a software one. If not, prints a message, and fails under
/// `WEEKENDER_REQUIRE_GPU=1`.
pub fn has_adapter() -> bool {
    let has_one = !weekender::render_gpu::adapters().is_empty();
    if !has_one {
        skip_without_adapter();
    }
    has_one
}

fn skip_without_adapter() {
    skip("GPU", "no graphics adapter");
}

/// A flag that cancels nothing.
pub fn go_on() -> AtomicBool {
    AtomicBool::new(false)
}

/// The CPU renderer to compare with.
pub fn cpu() -> CpuRenderer {
    CpuRenderer::new(CpuOptions::default()).unwrap()
}

pub fn job_of(
    scene: &Scene,
    camera: Camera,
    [width, height]: [u32; 2],
    max_depth: u32,
    sampler: SamplerKind,
) -> RenderJob {
    let settings = RenderSettings { width, height, max_depth, sampler, seed: 3 };
    RenderJob::new(scene.clone(), camera, settings, Rules::default()).unwrap()
}

/// The book's three spheres.
pub fn three_spheres(size: [u32; 2], max_depth: u32) -> RenderJob {
    let (scene, camera) = (BuiltinScene::ALL[0].build)();
    job_of(&scene, camera, size, max_depth, SamplerKind::Sobol)
}

/// All stages and all built-in scenes.
pub fn jobs(width: u32, height: u32) -> Vec<(String, RenderJob)> {
    let job = |mut recipe: Recipe| {
        (recipe.settings.width, recipe.settings.height) = (width, height);
        recipe.job().unwrap()
    };
    let stages = Stage::ALL.iter().map(|stage| (format!("stage {}", stage.id), job(stage.recipe())));
    let scenes = BuiltinScene::ALL.iter();
    let scenes = scenes.map(|s| (format!("scene {}", s.name), job(Recipe::builtin(s.name).unwrap())));
    stages.chain(scenes).collect()
}
