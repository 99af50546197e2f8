//! Times the GPU backend; benches/gpu.sh calls it.
//!
//! `gpu_bench trace SCENE WIDTH HEIGHT SAMPLES DEPTH RUNS [general] [bvh2] [samples=N] [target_ms=N] [adapter=NAME]`
//! prints one row of a table: the median of RUNS after a warm-up, tracing alone.
//! `gpu_bench pair SCENE WIDTH HEIGHT SAMPLES DEPTH RUNS [OPTION...]` runs both hierarchies in turn and prints the
//! median of each and of the ratios.
//! `gpu_bench hierarchy SCENE...` prints the size of both hierarchies and how long they take to build.
//! `gpu_bench adapter [adapter=NAME]` prints the adapter.
//! `gpu_bench size SCENE...` prints how large each scene's kernel is, general and specialised.

use naga::back::pipeline_constants::process_overrides;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{Arena, Block, Expression, Function, Handle, Literal, Statement};
use std::collections::HashMap;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use weekender::render::{RenderJob, RenderSettings, Renderer, SamplerKind};
use weekender::render_gpu::shader_source::{EntryPoint, source};
use weekender::render_gpu::{Constant, GpuOptions, GpuRenderer, HierarchyKind, Overrides};
use weekender::scene::Camera;
use weekender::scene::builtin::{BuiltinScene, field};
use weekender::stages::{Rules, Shading};
use weekender::tables::Tables;
use weekender::tables::cwbvh::{CwBvhNode, Cwbvh};
use weekender::tables::hierarchy::{Hierarchy, Node};

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.split_first() {
        Some((mode, rest)) if mode == "trace" => trace(rest),
        Some((mode, rest)) if mode == "pair" => pair(rest),
        Some((mode, rest)) if mode == "hierarchy" => rest.iter().try_for_each(|scene| hierarchy(scene)),
        Some((mode, rest)) if mode == "adapter" => {
            println!("{}", GpuRenderer::new(options_of(rest)?)?.adapter());
            Ok(())
        }
        Some((mode, rest)) if mode == "size" => rest.iter().try_for_each(|scene| size(scene)),
        _ => anyhow::bail!("the first argument must be trace, pair, hierarchy, adapter or size"),
    }
}

/// A built-in scene or `field:N`.
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

fn options_of(arguments: &[String]) -> anyhow::Result<GpuOptions> {
    let mut options = GpuOptions { allow_software: true, ..GpuOptions::default() };
    for option in arguments {
        match option.split_once('=') {
            None if option == "general" => options.specialise = false,
            None if option == "bvh2" => options.hierarchy = HierarchyKind::Bvh2,
            Some(("samples", count)) => options.samples_per_dispatch = Some(count.parse()?),
            Some(("target_ms", ms)) => options.dispatch_target = Duration::from_millis(ms.parse()?),
            Some(("adapter", name)) => options.adapter = Some(name.to_owned()),
            _ => anyhow::bail!("unknown option {option}"),
        }
    }
    Ok(options)
}

fn trace(arguments: &[String]) -> anyhow::Result<()> {
    let [scene, width, height, samples, depth, runs, rest @ ..] = arguments else {
        anyhow::bail!("trace needs SCENE WIDTH HEIGHT SAMPLES DEPTH RUNS");
    };
    let job = job(scene, [width.parse()?, height.parse()?, depth.parse()?])?;
    let options = options_of(rest)?;
    let mut renderer = GpuRenderer::new(options)?;
    let range = 0..samples.parse()?;
    let go_on = AtomicBool::new(false);
    let mut times = Vec::new();
    let mut stats = Default::default();
    let mut report = renderer.report();
    // The first two calls compile and find the size of the dispatches.
    for run in 0..2 + runs.parse::<usize>()? {
        let mut film = job.new_film();
        report = renderer.report();
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

fn median(values: &mut [f64]) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}

fn pair(arguments: &[String]) -> anyhow::Result<()> {
    let [scene, width, height, samples, depth, runs, rest @ ..] = arguments else {
        anyhow::bail!("pair needs SCENE WIDTH HEIGHT SAMPLES DEPTH RUNS");
    };
    let job = job(scene, [width.parse()?, height.parse()?, depth.parse()?])?;
    let range = 0..samples.parse()?;
    let go_on = AtomicBool::new(false);
    let mut renderers = Vec::new();
    for hierarchy in [HierarchyKind::Bvh2, HierarchyKind::Cwbvh] {
        renderers.push(GpuRenderer::new(GpuOptions { hierarchy, ..options_of(rest)? })?);
    }
    let mut times = [Vec::new(), Vec::new()];
    for run in 0..2 + runs.parse::<usize>()? {
        for (renderer, times) in renderers.iter_mut().zip(&mut times) {
            let stats = renderer.accumulate(&job, range.clone(), &mut job.new_film(), &go_on)?;
            if run >= 2 {
                times.push(stats.trace.as_secs_f64() * 1e9 / stats.paths as f64);
            }
        }
    }
    let mut ratios: Vec<f64> = times[1].iter().zip(&times[0]).map(|(cwbvh, bvh2)| cwbvh / bvh2).collect();
    let [bvh2, cwbvh] = &mut times;
    println!(
        "| {} | {:.1} | {:.1} | {:.2} |",
        arguments.join(" "),
        median(bvh2),
        median(cwbvh),
        median(&mut ratios)
    );
    Ok(())
}

fn hierarchy(scene: &str) -> anyhow::Result<()> {
    let job = job(scene, [64, 36, 8])?;
    let spheres = Tables::<f32>::new(&job).spheres_of_hierarchy(&job);
    let [mut bvh2_times, mut cwbvh_times] = [Vec::new(), Vec::new()];
    let count = spheres.len() as f64;
    let ms = |start: Instant| start.elapsed().as_secs_f64() * 1e3;
    let mut sizes = [0, 0];
    for _ in 0..5 {
        let start = Instant::now();
        let (bvh2, _) = Hierarchy::<f32>::build(&spheres);
        bvh2_times.push(ms(start));
        let start = Instant::now();
        let cwbvh = Cwbvh::build(&spheres);
        cwbvh_times.push(ms(start));
        sizes = [bvh2.nodes.len() * size_of::<Node<f32>>(), cwbvh.nodes.len() * size_of::<CwBvhNode>()];
    }
    println!(
        "| {scene} | {:.1} | {:.1} | {:.2} | {:.2} |",
        sizes[0] as f64 / count,
        sizes[1] as f64 / count + size_of::<u32>() as f64,
        median(&mut bvh2_times),
        median(&mut cwbvh_times),
    );
    Ok(())
}

/// Number of operations of a kernel in naga's representation, all calls inlined, after overrides are put in and the branches that
/// they decide are cut.
fn kernel_size(overrides: &Overrides) -> anyhow::Result<usize> {
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
    let known = Known { constants: module.constants.clone(), globals: module.global_expressions.clone() };
    let entries = module.entry_points.iter_mut().map(|entry| &mut entry.function);
    for function in module.functions.iter_mut().map(|(_, function)| function).chain(entries) {
        // What one pass finds lets the next find more.
        for _ in 0..3 {
            let mut body = std::mem::take(&mut function.body);
            let mut stores = HashMap::new();
            known.stores(&body, function, &mut stores);
            known.cut(&mut body, function, &stores);
            function.body = body;
        }
    }
    Ok(module.entry_points.iter().map(|entry| operations(&entry.function.body, &module)).sum())
}

/// Operations of a block, with every function that it calls put in at every call.
fn operations(block: &Block, module: &naga::Module) -> usize {
    let of = |statement: &Statement| match statement {
        Statement::Emit(range) => range.clone().count(),
        Statement::Call { function, .. } => operations(&module.functions[*function].body, module),
        Statement::If { accept, reject, .. } => 1 + operations(accept, module) + operations(reject, module),
        Statement::Loop { body, continuing, .. } => {
            1 + operations(body, module) + operations(continuing, module)
        }
        Statement::Block(inner) => operations(inner, module),
        _ => 1,
    };
    block.iter().map(of).sum()
}

/// Values that are known once overrides are put in.
struct Known {
    constants: Arena<naga::Constant>,
    globals: Arena<Expression>,
}

/// The values that are stored to a variable.
type Stores = HashMap<Handle<naga::LocalVariable>, Vec<Handle<Expression>>>;

impl Known {
    fn literal(&self, function: &Function, expression: Handle<Expression>) -> Option<Literal> {
        match function.expressions[expression] {
            Expression::Literal(literal) => Some(literal),
            Expression::Constant(constant) => match self.globals[self.constants[constant].init] {
                Expression::Literal(literal) => Some(literal),
                _ => None,
            },
            _ => None,
        }
    }

    fn truth(&self, function: &Function, stores: &Stores, condition: Handle<Expression>) -> Option<bool> {
        match function.expressions[condition] {
            Expression::Unary { op: naga::UnaryOperator::LogicalNot, expr } => {
                self.truth(function, stores, expr).map(|truth| !truth)
            }
            Expression::Binary { op, left, right } => {
                let equal = self.literal(function, left)? == self.literal(function, right)?;
                match op {
                    naga::BinaryOperator::Equal => Some(equal),
                    naga::BinaryOperator::NotEqual => Some(!equal),
                    _ => None,
                }
            }
            Expression::Load { pointer } => match function.expressions[pointer] {
                Expression::LocalVariable(variable) => match stores.get(&variable)?.as_slice() {
                    [only] => self.truth(function, stores, *only),
                    _ => None,
                },
                _ => None,
            },
            _ => match self.literal(function, condition)? {
                Literal::Bool(truth) => Some(truth),
                _ => None,
            },
        }
    }

    fn stores(&self, block: &Block, function: &Function, stores: &mut Stores) {
        for statement in block.iter() {
            match statement {
                Statement::Store { pointer, value } => {
                    if let Expression::LocalVariable(variable) = function.expressions[*pointer] {
                        stores.entry(variable).or_default().push(*value);
                    }
                }
                Statement::If { accept, reject, .. } => {
                    self.stores(accept, function, stores);
                    self.stores(reject, function, stores);
                }
                Statement::Loop { body, continuing, .. } => {
                    self.stores(body, function, stores);
                    self.stores(continuing, function, stores);
                }
                Statement::Block(inner) => self.stores(inner, function, stores),
                _ => {}
            }
        }
    }

    /// Replaces branches whose condition is known by the side that is taken, as every driver's compiler does.
    fn cut(&self, block: &mut Block, function: &Function, stores: &Stores) {
        let mut kept = Block::new();
        for (statement, span) in std::mem::take(block).span_into_iter() {
            match statement {
                Statement::If { condition, mut accept, mut reject } => {
                    self.cut(&mut accept, function, stores);
                    self.cut(&mut reject, function, stores);
                    match self.truth(function, stores, condition) {
                        Some(true) => kept.extend_block(accept),
                        Some(false) => kept.extend_block(reject),
                        None => kept.push(Statement::If { condition, accept, reject }, span),
                    }
                }
                Statement::Loop { mut body, mut continuing, break_if } => {
                    self.cut(&mut body, function, stores);
                    self.cut(&mut continuing, function, stores);
                    kept.push(Statement::Loop { body, continuing, break_if }, span);
                }
                Statement::Block(mut inner) => {
                    self.cut(&mut inner, function, stores);
                    kept.push(Statement::Block(inner), span);
                }
                other => kept.push(other, span),
            }
        }
        *block = kept;
    }
}

fn size(scene: &str) -> anyhow::Result<()> {
    let job = job(scene, [64, 36, 8])?;
    let tables = Tables::<f32>::new(&job);
    let [general, specialised] = [Overrides::general(&job, &tables), Overrides::specialised(&job, &tables)]
        .map(|o| (kernel_size(&o), o));
    let (specialised, overrides) = specialised;
    println!(
        "| {scene} | {} | {} | {} |",
        general.0?,
        specialised?,
        if overrides.shading == Shading::Path { overrides.summary() } else { String::new() }
    );
    Ok(())
}
