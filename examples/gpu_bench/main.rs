//! Times the GPU backend; benches/gpu.sh calls it.
//!
//! `gpu_bench trace SCENE WIDTH HEIGHT SAMPLES DEPTH RUNS [general] [samples=N] [target_ms=N] [adapter=NAME]`
//! prints one row of a table: the median of RUNS after a warm-up, tracing alone.
//! `gpu_bench hierarchy SCENE...` prints the size of the hierarchy and how long it takes to build.
//! `gpu_bench adapter [adapter=NAME]` prints the adapter.
//! `gpu_bench size SCENE...` prints how large each scene's kernel is, general and specialised.
//! `gpu_bench work SCENE...` prints the operations of one iteration of the path loop, for scenes without a hierarchy.
//! `gpu_bench passes SCENE WIDTH HEIGHT SAMPLES DEPTH PASSES [OPTION...]` prints the cost of passes whose films are
//! read at once, and of passes whose films stay on the device. `gpu_bench first SCENE WIDTH HEIGHT DEPTH [OPTION...]`
//! prints the time from a change to its first picture.

mod kernel_count;

use kernel_count::Counted;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use weekender::backends::BackendChoice;
use weekender::job::recipe::Recipe;
use weekender::job::render::{Control, RenderJob, RenderSettings, Renderer};
use weekender::kernel::parts;
use weekender::numbers::statistics;
use weekender::prepared::PreparedScene;
use weekender::prepared::hierarchy::Hierarchy;
use weekender::progressive::{Plan, Progressive, RenderRequest};
use weekender::render_gpu::{GpuOptions, GpuRenderer};
use weekender::stages::Shading;

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.split_first() {
        Some((mode, rest)) if mode == "trace" => trace(rest),
        Some((mode, rest)) if mode == "hierarchy" => rest.iter().try_for_each(|scene| hierarchy(scene)),
        Some((mode, rest)) if mode == "adapter" => {
            println!("{}", GpuRenderer::new(options_of(rest)?)?.adapter());
            Ok(())
        }
        Some((mode, rest)) if mode == "size" => rest.iter().try_for_each(|scene| size(scene)),
        Some((mode, rest)) if mode == "work" => rest.iter().try_for_each(|scene| work(scene)),
        Some((mode, rest)) if mode == "passes" => passes(rest),
        Some((mode, rest)) if mode == "first" => first(rest),
        _ => {
            anyhow::bail!("the first argument must be trace, passes, first, hierarchy, adapter, size or work")
        }
    }
}

/// A built-in scene or `field:N`.
fn job(scene: &str, [width, height, max_depth]: [u32; 3]) -> anyhow::Result<RenderJob> {
    let mut recipe = Recipe::find(scene)?;
    recipe.settings = RenderSettings { width, height, max_depth, ..RenderSettings::default() };
    Ok(recipe.job()?)
}

fn options_of(arguments: &[String]) -> anyhow::Result<GpuOptions> {
    let mut options = GpuOptions { allow_software: true, ..GpuOptions::default() };
    for option in arguments {
        match option.split_once('=') {
            None if option == "general" => options.specialise = false,
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

fn median(values: &[f64]) -> f64 {
    statistics::median(values.iter().copied()).unwrap_or(f64::NAN)
}

fn hierarchy(scene: &str) -> anyhow::Result<()> {
    let job = job(scene, [64, 36, 8])?;
    let mut times = Vec::new();
    let mut size = 0.0;
    for _ in 0..5 {
        let prepared = PreparedScene::<f32>::wide(&job);
        times.push(prepared.hierarchy_source.time().as_secs_f64() * 1e3);
        if let Some(Hierarchy { wide: Some(wide), ranks, .. }) = &prepared.hierarchy {
            size = size_of_val(&*wide.nodes) as f64 / ranks.len() as f64 + size_of::<u32>() as f64;
        }
    }
    println!("| {scene} | {size:.1} | {:.2} |", median(&times));
    Ok(())
}

fn size(scene: &str) -> anyhow::Result<()> {
    let job = job(scene, [64, 36, 8])?;
    let prepared = PreparedScene::<f32>::new(&job);
    let needed = prepared.features;
    let [general, specialised] =
        [needed.generalised(), needed].map(|features| Counted::of(&features).map(|counted| counted.size()));
    println!(
        "| {scene} | {} | {} | {} |",
        general?,
        specialised?,
        if needed.shading == Shading::Path { parts::describe(needed.parts()) } else { String::new() }
    );
    Ok(())
}

/// The cost of one iteration of the loop (one ray per lane) when lanes diverge: both sides of every branch.
fn work(scene: &str) -> anyhow::Result<()> {
    let job = job(scene, [64, 36, 24])?;
    let prepared = PreparedScene::<f32>::new(&job);
    anyhow::ensure!(prepared.hierarchy.is_none(), "the length of a traversal is not known in advance");
    let trips = [prepared.opaque.len(), prepared.two_root.len(), prepared.anchored.len()];
    let work =
        Counted::of(&prepared.features)?.turn(&trips.into_iter().filter(|n| *n > 0).collect::<Vec<_>>());
    println!("| {scene} | {} | {} | {} | {} |", work.float, work.integer, work.special, work.total());
    Ok(())
}

fn passes(arguments: &[String]) -> anyhow::Result<()> {
    let [scene, width, height, samples, depth, count, rest @ ..] = arguments else {
        anyhow::bail!("passes needs SCENE WIDTH HEIGHT SAMPLES DEPTH PASSES");
    };
    let job = job(scene, [width.parse()?, height.parse()?, depth.parse()?])?;
    let (samples, count): (u64, u64) = (samples.parse()?, count.parse()?);
    let mut renderer = GpuRenderer::new(options_of(rest)?)?;
    let go_on = AtomicBool::new(false);
    let mut times = [Vec::new(), Vec::new()];
    let mut films = [0, 0];
    let mut film_time = Duration::ZERO;
    for run in 0..2 + 5 {
        for (stays, times) in times.iter_mut().enumerate() {
            let before = renderer.report();
            let mut film = job.new_film();
            renderer.prepare(&job, &go_on)?;
            let begin = Instant::now();
            for pass in 0..count {
                let range = pass * samples..(pass + 1) * samples;
                if stays == 1 {
                    renderer.advance(&job, range, &mut film, &Control::deferring(&go_on))?;
                } else {
                    renderer.accumulate(&job, range, &mut film, &go_on)?;
                }
            }
            renderer.finish(&mut film)?;
            anyhow::ensure!(film.sample_count() == count * samples, "samples are missing");
            let report = renderer.report();
            films[stays] = report.films - before.films;
            film_time = (report.film_time - before.film_time) / films[stays] as u32;
            if run >= 2 {
                times.push(begin.elapsed().as_secs_f64() * 1e3 / count as f64);
            }
        }
    }
    let [at_once, stays] = &times;
    let (at_once, stays) = (median(at_once), median(stays));
    println!(
        "| {} | {at_once:.2} | {stays:.2} | {} | {} | {:.2} |",
        arguments.join(" "),
        films[0],
        films[1],
        film_time.as_secs_f64() * 1e3
    );
    Ok(())
}

/// Measures as the window works: a scene is rendered for a while and then replaced by another.
fn first(arguments: &[String]) -> anyhow::Result<()> {
    let [scene, width, height, depth, rest @ ..] = arguments else {
        anyhow::bail!("first needs SCENE WIDTH HEIGHT DEPTH");
    };
    let numbers = [width.parse()?, height.parse()?, depth.parse()?];
    let changed = job(scene, numbers)?;
    let seed = RenderSettings { seed: 1, ..*changed.settings() };
    let again = RenderJob::new(changed.scene().clone(), *changed.camera(), seed, *changed.rules())?;
    let mut progressive = Progressive::spawn()?;
    for (what, job) in [
        ("opened", job("touching-spheres", numbers)?),
        ("another kernel", changed),
        ("the same kernel", again),
    ] {
        let begin = Instant::now();
        let backend = BackendChoice::Gpu(options_of(rest)?);
        progressive.start(RenderRequest::new(job, backend, Plan::endless()));
        let run = progressive.status().run;
        progressive.ask_for_picture();
        while progressive.newest_picture().is_none_or(|picture| picture.run != run) {
            std::thread::sleep(Duration::from_micros(200));
        }
        let took = begin.elapsed();
        let prepare = progressive.status().prepare;
        println!(
            "| {scene} {width} {height} {depth}, {what} | {:.1} | {:.1} |",
            took.as_secs_f64() * 1e3,
            prepare.as_secs_f64() * 1e3
        );
    }
    Ok(())
}
