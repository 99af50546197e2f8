//! Times the GPU backend; benches/gpu.sh calls it.
//!
//! `gpu_bench trace SCENE WIDTH HEIGHT SAMPLES DEPTH RUNS [general] [samples=N] [target_ms=N] [adapter=NAME]`
//! prints one row of a table: the median of RUNS after a warm-up, tracing alone.
//! `gpu_bench size SCENE...` prints how large each scene's kernel is, general and specialised.

use naga::back::{pipeline_constants::process_overrides, spv};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use weekender::render::{RenderJob, RenderSettings, Renderer, SamplerKind};
use weekender::render_gpu::shader_source::{EntryPoint, source};
use weekender::render_gpu::{Constant, GpuOptions, GpuRenderer, Overrides};
use weekender::scene::Camera;
use weekender::scene::builtin::{BuiltinScene, field};
use weekender::stages::{Rules, Shading};
use weekender::tables::Tables;

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.split_first() {
        Some((mode, rest)) if mode == "trace" => trace(rest),
        Some((mode, rest)) if mode == "size" => rest.iter().try_for_each(|scene| size(scene)),
        _ => anyhow::bail!("the first argument must be trace or size"),
    }
}

/// A built-in scene, `field:N`, or a stage-like simplification: `sky`, `matte` and `pinhole-glass` have less and
/// less in them.
fn job(scene: &str, [width, height, max_depth]: [u32; 3]) -> anyhow::Result<RenderJob> {
    let (spheres, camera): (_, Camera) = match scene.strip_prefix("field:") {
        Some(count) => field(count.parse()?),
        None => match BuiltinScene::ALL.iter().find(|builtin| builtin.name == scene) {
            Some(builtin) => (builtin.build)(),
            None => anyhow::bail!("there is no scene {scene}"),
        },
    };
    let settings = RenderSettings {
        width,
        height,
        max_depth,
        sampler: SamplerKind::Sobol,
        seed: 0,
        estimate_error: false,
    };
    Ok(RenderJob::new(spheres, camera, settings, Rules::default())?)
}

fn trace(arguments: &[String]) -> anyhow::Result<()> {
    let [scene, width, height, samples, depth, runs, rest @ ..] = arguments else {
        anyhow::bail!("trace needs SCENE WIDTH HEIGHT SAMPLES DEPTH RUNS");
    };
    let job = job(scene, [width.parse()?, height.parse()?, depth.parse()?])?;
    let mut options = GpuOptions { allow_software: true, ..GpuOptions::default() };
    for option in rest {
        match option.split_once('=') {
            None if option == "general" => options.specialise = false,
            Some(("samples", count)) => options.samples_per_dispatch = Some(count.parse()?),
            Some(("target_ms", ms)) => options.dispatch_target = Duration::from_millis(ms.parse()?),
            Some(("adapter", name)) => options.adapter = Some(name.to_owned()),
            _ => anyhow::bail!("unknown option {option}"),
        }
    }
    let mut renderer = GpuRenderer::new(options)?;
    let range = 0..samples.parse()?;
    let go_on = AtomicBool::new(false);
    let mut times = Vec::new();
    let mut stats = Default::default();
    let mut report = renderer.report().clone();
    // The first two calls compile and find the size of the dispatches.
    for run in 0..2 + runs.parse::<usize>()? {
        let mut film = job.new_film();
        report = renderer.report().clone();
        stats = renderer.accumulate(&job, range.clone(), &mut film, &go_on)?;
        if run >= 2 {
            times.push(stats.trace);
        }
    }
    times.sort_unstable();
    let median = times[times.len() / 2].as_secs_f64();
    let now = renderer.report();
    println!(
        "| {} | {:.2} | {:.1} | {:.1} | {:.2} | {} | {:.2} ({}) |",
        arguments.join(" "),
        median * 1e3,
        stats.paths as f64 / median / 1e6,
        stats.rays as f64 / median / 1e6,
        times[0].as_secs_f64() * 1e3,
        now.dispatches - report.dispatches,
        (now.dispatch_time - report.dispatch_time).as_secs_f64() * 1e3,
        now.timer,
    );
    Ok(())
}

/// Number of SPIR-V instructions of a kernel, after overrides are put in and branches that they decide are cut.
fn instructions(overrides: &Overrides) -> anyhow::Result<usize> {
    let text = source(EntryPoint::PathTrace);
    let module = naga::front::wgsl::parse_str(&text)?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::default()).validate(&module)?;
    let constants = overrides
        .constants()
        .into_iter()
        .map(|(name, value)| {
            let value = match value {
                Constant::Flag(flag) => f64::from(u8::from(flag)),
                Constant::Number(number) => f64::from(number),
            };
            (name.to_owned(), value)
        })
        .collect();
    let entry = Some((naga::ShaderStage::Compute, EntryPoint::PathTrace.name()));
    let (module, _) = process_overrides(&module, &info, entry, &constants)?;
    let mut module = module.into_owned();
    for function in module
        .functions
        .iter_mut()
        .map(|(_, f)| f)
        .chain(module.entry_points.iter_mut().map(|e| &mut e.function))
    {
        let expressions = &function.expressions;
        let mut body = std::mem::take(&mut function.body);
        cut(&mut body, expressions);
        function.body = body;
    }
    naga::compact::compact(&mut module, naga::compact::KeepUnused::No);
    let info = Validator::new(ValidationFlags::all(), Capabilities::default()).validate(&module)?;
    let options = spv::PipelineOptions {
        shader_stage: naga::ShaderStage::Compute,
        entry_point: EntryPoint::PathTrace.name().to_owned(),
    };
    let words = spv::write_vec(&module, &info, &spv::Options::default(), Some(&options))?;
    // Past the header, each instruction's first word has its length in the upper half.
    let (mut at, mut count) = (5, 0);
    while at < words.len() {
        at += (words[at] >> 16).max(1) as usize;
        count += 1;
    }
    Ok(count)
}

/// Replaces branches whose condition is known by the side that is taken, as every driver's compiler does.
fn cut(block: &mut naga::Block, expressions: &naga::Arena<naga::Expression>) {
    let mut kept = naga::Block::new();
    for (statement, span) in std::mem::take(block).span_into_iter() {
        match statement {
            naga::Statement::If { condition, mut accept, mut reject } => {
                cut(&mut accept, expressions);
                cut(&mut reject, expressions);
                match expressions[condition] {
                    naga::Expression::Literal(naga::Literal::Bool(true)) => kept.extend_block(accept),
                    naga::Expression::Literal(naga::Literal::Bool(false)) => kept.extend_block(reject),
                    _ => kept.push(naga::Statement::If { condition, accept, reject }, span),
                }
            }
            naga::Statement::Loop { mut body, mut continuing, break_if } => {
                cut(&mut body, expressions);
                cut(&mut continuing, expressions);
                kept.push(naga::Statement::Loop { body, continuing, break_if }, span);
            }
            naga::Statement::Block(mut inner) => {
                cut(&mut inner, expressions);
                kept.push(naga::Statement::Block(inner), span);
            }
            other => kept.push(other, span),
        }
    }
    *block = kept;
}

fn size(scene: &str) -> anyhow::Result<()> {
    let job = job(scene, [64, 36, 8])?;
    let tables = Tables::<f32>::new(&job);
    let [general, specialised] = [Overrides::general(&job, &tables), Overrides::specialised(&job, &tables)]
        .map(|o| (instructions(&o), o));
    let (specialised, overrides) = specialised;
    println!(
        "| {scene} | {} | {} | {} |",
        general.0?,
        specialised?,
        if overrides.shading == Shading::Path { overrides.summary() } else { String::new() }
    );
    Ok(())
}
