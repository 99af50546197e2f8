//! `weekender bench`: how fast this machine renders, compared with a plain C program.

mod candidate;
#[cfg(test)]
mod fake;
mod features;
mod figures;
mod machine;
mod plot;
mod progress;
mod scale;
mod table;

use crate::baseline::{Baseline, BaselineError};
use crate::chart;
use crate::cli::{BenchOptions, BenchScene, JsonTarget};
use crate::failure::Failure;
use crate::files::check_writable;
use crate::interrupt::Interrupt;
use crate::terminal;
use candidate::{Cancelled, Candidate, candidates};
pub use figures::SCHEMA;
use figures::{BenchFigures, SPREAD_LIMIT, SceneFigures};
use machine::{LOAD_LIMIT, Machine};
use progress::Progress;
use std::process::ExitCode;
use std::rc::Rc;
use std::sync::atomic::AtomicBool;

/// Measures, prints tables and writes files.
///
/// # Errors
/// [`Failure::Input`] if nothing was measured; [`Failure::Run`] otherwise.
pub fn run(options: &BenchOptions) -> Result<ExitCode, Failure> {
    let json = match &options.json {
        Some(JsonTarget::File(path)) => Some(path),
        _ => None,
    };
    for path in [json, options.plot.as_ref()].into_iter().flatten() {
        check_writable(path).map_err(Failure::input)?;
    }
    let interrupt = Interrupt::install().map_err(Failure::Run)?;
    let cancel = interrupt.flag();
    let mut figures = BenchFigures {
        schema: SCHEMA,
        machine: Machine::look(),
        scenes: Vec::new(),
        scale: Vec::new(),
        features: Vec::new(),
        warnings: Vec::new(),
        interrupted: false,
    };
    let measured = match options.scale.as_slice() {
        _ if options.features => features::measure(options, &mut figures, cancel),
        [] => scenes(options, &mut figures, cancel),
        counts => fields(options, counts, &mut figures, cancel),
    };
    figures.interrupted = interrupt.is_set();
    figures.warnings = warnings(&figures);
    let written = write(options, &figures);
    measured.and(written).map_err(Failure::Run)?;
    Ok(if figures.interrupted { interrupt.exit_code() } else { ExitCode::SUCCESS })
}

fn scenes(options: &BenchOptions, figures: &mut BenchFigures, cancel: &AtomicBool) -> anyhow::Result<()> {
    let baseline = Baseline::compile().map(Rc::new);
    for scene in &options.scenes {
        let (scene_figures, outcome) = measure_scene(options, scene, &baseline, cancel);
        figures.scenes.push(scene_figures);
        if outcome.is_err() {
            break;
        }
    }
    Ok(())
}

/// Runs all candidates in turn, so that drift affects all of them alike.
fn measure_scene(
    options: &BenchOptions,
    scene: &BenchScene,
    baseline: &Result<Rc<Baseline>, BaselineError>,
    cancel: &AtomicBool,
) -> (SceneFigures, Result<(), Cancelled>) {
    let job = &scene.job;
    let mut candidates = candidates(options, &scene.name, job, baseline);
    let ready = candidates.iter().filter(|candidate| candidate.is_ready()).count();
    let mut progress = Progress::new(options.progress, (ready * (1 + options.runs)) as u64);
    let mut turns = || {
        for turn in 0..=options.runs {
            for candidate in candidates.iter_mut().filter(|candidate| candidate.is_ready()) {
                progress.begin(&format!("{}: {}", scene.name, candidate.row.name));
                match turn {
                    0 => candidate.warm_up(job, scene.samples, options.run_limit_seconds, cancel)?,
                    _ => candidate.measure(job, cancel)?,
                }
                progress.step();
            }
        }
        Ok(())
    };
    let outcome = turns();
    progress.clear();
    let settings = job.settings();
    let mut scene_figures = SceneFigures {
        scene: scene.name.clone(),
        width: settings.width,
        height: settings.height,
        max_depth: settings.max_depth,
        sampler: settings.sampler.name(),
        spheres: job.scene().spheres.len(),
        rows: candidates.into_iter().map(|Candidate { row, .. }| row).collect(),
    };
    scene_figures.sum_up();
    (scene_figures, outcome)
}

fn fields(
    options: &BenchOptions,
    counts: &[u64],
    figures: &mut BenchFigures,
    cancel: &AtomicBool,
) -> anyhow::Result<()> {
    let mut progress = Progress::new(options.progress, (counts.len() * options.runs) as u64);
    let mut outcome = Ok(());
    for count in counts {
        match scale::measure(options, *count, &mut progress, cancel) {
            Ok(Some(field)) => figures.scale.push(field),
            Ok(None) => break,
            Err(error) => {
                outcome = Err(error);
                break;
            }
        }
    }
    progress.clear();
    outcome
}

/// Reasons to doubt the figures.
fn warnings(figures: &BenchFigures) -> Vec<String> {
    let mut warnings = Vec::new();
    if let Some(load) = figures.machine.load_at_start.filter(|load| *load > LOAD_LIMIT) {
        warnings.push(format!(
            "the machine was busy: load {load:.2} at the start, above {LOAD_LIMIT}; close other programs and measure again"
        ));
    }
    let rows = figures.scenes.iter().flat_map(|scene| {
        scene
            .rows
            .iter()
            .filter_map(|row| Some((format!("{}, {}", scene.scene, row.name), row.paths_per_second?)))
    });
    let fields = figures
        .scale
        .iter()
        .filter_map(|row| Some((format!("field:{}", row.spheres), row.paths_per_second?)));
    let gains = figures.features.iter().flat_map(|device| {
        device.rows.iter().filter_map(|row| Some((format!("{}, {}", row.name, device.device), row.gain?)))
    });
    let spreads: Vec<(String, f64)> =
        rows.chain(fields).chain(gains).map(|(name, spread)| (name, spread.share())).collect();
    let wide = spreads.iter().filter(|(_, share)| *share > SPREAD_LIMIT);
    if let Some((name, share)) = wide.clone().max_by(|a, b| a.1.total_cmp(&b.1)) {
        warnings.push(format!(
            "in {} of {} rows, the runs differ by more than {:.0} % of their median; the largest difference is {:.0} % in {name}",
            wide.count(),
            spreads.len(),
            100.0 * SPREAD_LIMIT,
            100.0 * share
        ));
    }
    warnings
}

fn write(options: &BenchOptions, figures: &BenchFigures) -> anyhow::Result<()> {
    let text = table::text(figures);
    // The files are written even if printing failed.
    let printed = terminal::print_beside(options.json.as_ref(), &text);
    if let Some(target) = &options.json {
        terminal::write_json(figures, target)?;
    }
    if let Some(path) = &options.plot {
        chart::save(path, &plot::figure(figures))?;
    }
    printed
}

#[cfg(test)]
mod tests {
    use super::figures::{DeviceFigures, GainRow, Kind, Row, ScaleFigures, Spread};
    use super::*;
    use crate::cli::{self, Request};

    fn figures() -> BenchFigures {
        BenchFigures {
            schema: SCHEMA,
            machine: Machine { load_at_start: Some(0.25), ..Machine::look() },
            scenes: Vec::new(),
            scale: Vec::new(),
            features: Vec::new(),
            warnings: Vec::new(),
            interrupted: false,
        }
    }

    #[test]
    fn a_field_that_cannot_be_measured_ends_the_measurement() {
        let line = "weekender bench --scale 1..10 --isa portable --threads 1 --runs 1 --progress off";
        let Request::Bench(options) = cli::parse(line.split(' ').map(Into::into)).unwrap() else {
            panic!("no benchmark")
        };
        let mut figures = figures();
        // No field has so few spheres.
        let error = fields(&options, &[0, 1], &mut figures, &AtomicBool::new(false)).unwrap_err();
        assert!(error.to_string().contains("field:0"), "{error}");
        assert!(figures.scale.is_empty());
    }

    #[test]
    fn a_busy_machine_and_runs_that_differ_are_reasons_to_doubt() {
        assert_eq!(warnings(&figures()), [""; 0]);
        let mut figures = figures();
        figures.machine.load_at_start = Some(0.75);
        let spread = |min: f64, max: f64| Some(Spread { median: 100.0, min, max });
        let row = |name: &str, gain| GainRow { name: name.to_owned(), gain, ..GainRow::default() };
        let rows = vec![
            row("steady", spread(95.0, 105.0)),
            row("first", spread(90.0, 110.0)),
            row("second", spread(80.0, 105.0)),
            row("skipped", None),
        ];
        figures.features = vec![DeviceFigures { device: "avx2".to_owned(), rows, skipped: None }];
        assert_eq!(
            warnings(&figures),
            [
                "the machine was busy: load 0.75 at the start, above 0.5; close other programs and measure again",
                "in 2 of 3 rows, the runs differ by more than 10 % of their median; the largest difference is 25 % \
                 in second, avx2",
            ]
        );
    }

    #[test]
    fn runs_of_scenes_and_fields_may_differ_by_a_tenth() {
        let spread = |max: f64| Some(Spread { median: 100.0, min: 100.0, max });
        let warned = |of_scene: f64, of_field: f64| {
            let row = Row {
                name: "avx2".to_owned(),
                kind: Kind::Packets,
                lanes: 8,
                threads: 1,
                samples_per_pixel: 4,
                runs: Vec::new(),
                paths_per_second: spread(of_scene),
                rays_per_second: spread(900.0),
                lanes_in_use: None,
                ratio_to_baseline: None,
                efficiency: None,
                skipped: None,
            };
            let scene = SceneFigures {
                scene: "book".to_owned(),
                width: 8,
                height: 4,
                max_depth: 50,
                sampler: "sobol",
                spheres: 485,
                rows: vec![row.clone(), Row { paths_per_second: None, ..row }],
            };
            let field = ScaleFigures {
                spheres: 1000,
                generate_seconds: 1.0,
                build_seconds: 1.0,
                hierarchy_seconds: 1.0,
                scene_bytes_per_sphere: 40.0,
                table_bytes_per_sphere: 96.0,
                peak_memory_bytes: None,
                samples_per_pixel: 4,
                paths_per_second: spread(of_field),
                rays_per_second: spread(900.0),
            };
            let mut figures = BenchFigures { scenes: vec![scene], scale: vec![field], ..figures() };
            figures.machine.load_at_start = Some(LOAD_LIMIT);
            warnings(&figures)
        };
        let doubt = |rows: usize, largest: &str| {
            [format!(
                "in {rows} of 2 rows, the runs differ by more than 10 % of their median; the largest difference is {largest}"
            )]
        };
        assert_eq!(warned(110.0, 110.0), [""; 0]);
        assert_eq!(warned(130.0, 110.0), doubt(1, "30 % in book, avx2"));
        assert_eq!(warned(110.0, 140.0), doubt(1, "40 % in field:1000"));
        assert_eq!(warned(150.0, 120.0), doubt(2, "50 % in book, avx2"));
    }
}
