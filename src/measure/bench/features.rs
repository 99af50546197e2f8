//! Measures the gain of specialised kernels: renders each picture alternately with its own kernel and with the general
//! one. The films must be equal bit for bit.

use super::super::{Candidate, Stop};
use super::figures::{DeviceFigures, GainRow, Run};
use super::{Bench, counted};
use crate::backends::BackendChoice;
use crate::cli::BenchScene;
use crate::render_cpu::{CpuOptions, Isa};
use crate::render_gpu::GpuOptions;
use anyhow::{Result, bail};

/// Candidates with a picture's own kernel and with the general one.
type Pair = [Candidate; 2];

impl Bench<'_> {
    /// Measures every picture on every device. An interrupt keeps the rows measured before it. Fails if the two films
    /// differ.
    pub(super) fn features(&mut self, scenes: &[BenchScene]) -> Result<()> {
        let pairs = self.pairs();
        self.expect_runs(pairs.len() * scenes.len() * (1 + self.options.runs));
        for mut pair in pairs {
            let device = self.device(scenes, &mut pair);
            self.figures.features.push(device);
            if self.is_cancelled() {
                break;
            }
        }
        check(&self.figures.features)
    }

    fn device(&mut self, scenes: &[BenchScene], pair: &mut Pair) -> DeviceFigures {
        let skipped = pair.iter_mut().find_map(|candidate| candidate.start().err());
        if let Some(info) = pair[0].info().filter(|info| info.name == "gpu") {
            pair[0].name = info.device;
        }
        let (device, skipped) = (pair[0].name.clone(), skipped.map(|error| error.to_string()));
        let mut rows = Vec::new();
        for scene in scenes.iter().take_while(|_| skipped.is_none()) {
            self.progress.at(&format!("{}: {device}", scene.name));
            match self.gain(scene, pair) {
                Ok(row) => rows.push(row),
                Err(Stop::Cancelled) => break,
                Err(Stop::Failed(reason)) => {
                    rows.push(GainRow {
                        name: scene.name.clone(),
                        skipped: Some(reason),
                        ..GainRow::default()
                    });
                }
            }
        }
        DeviceFigures { device, rows, skipped }
    }

    fn pairs(&self) -> Vec<Pair> {
        let pair = |name: &str, choice: &dyn Fn(bool) -> BackendChoice| {
            [false, true].map(|general| Candidate::backend(name, choice(general)))
        };
        let cpu = |isa: &Isa| {
            let name = format!("{isa}, {}, 1 thread", counted(isa.native_lanes(), "lane"));
            let options = CpuOptions { isa: Some(*isa), threads: Some(1), ..CpuOptions::default() };
            pair(&name, &|general| BackendChoice::Cpu(CpuOptions { general, ..options }))
        };
        let mut pairs: Vec<Pair> = self.levels.iter().map(cpu).collect();
        if let Some(BackendChoice::Gpu(options)) =
            BackendChoice::gpu_if_present(self.options.adapter.as_deref())
        {
            pairs.push(pair("GPU", &|general| {
                BackendChoice::Gpu(GpuOptions { specialise: !general, ..options.clone() })
            }));
        }
        pairs
    }

    fn gain(&mut self, scene: &BenchScene, [own, general]: &mut Pair) -> Result<GainRow, Stop> {
        let (job, cancel, settings) = (&scene.job, self.cancel, scene.job.settings());
        let contents = |candidate: &mut Candidate| -> Result<_, Stop> {
            let renderer = candidate.start()?;
            renderer.prepare(job, cancel)?;
            Ok(renderer.kernel())
        };
        let (kernel, never) = (contents(own)?, contents(general)?.left_out);
        let samples = self.affordable_samples(own, job, scene.samples)?;
        let mut row = GainRow {
            name: scene.name.clone(),
            width: settings.width,
            height: settings.height,
            samples_per_pixel: samples,
            kernel: kernel.present,
            left_out: kernel.left_out.into_iter().filter(|word| !never.contains(word)).collect(),
            ..GainRow::default()
        };
        general.trace(job, samples, cancel)?;
        self.progress.finished(1.0);
        for turn in 0..self.options.runs {
            // Alternate which kernel goes first.
            let early = (turn % 2 == 1).then(|| general.trace(job, samples, cancel)).transpose()?;
            let of_own = own.trace(job, samples, cancel)?;
            let of_general = early.map_or_else(|| general.trace(job, samples, cancel), Ok)?;
            row.own_runs.push(Run::of(&of_own));
            row.general_runs.push(Run::of(&of_general));
            row.same_bits = Some(row.same_bits != Some(false) && of_own.film == of_general.film);
            self.progress.finished(1.0);
        }
        row.sum_up();
        Ok(row)
    }
}

fn check(devices: &[DeviceFigures]) -> Result<()> {
    let rows = devices.iter().flat_map(|device| device.rows.iter().map(move |row| (device, row)));
    let differing: Vec<String> = rows
        .filter(|(_, row)| row.same_bits == Some(false))
        .map(|(device, row)| format!("{} ({})", row.name, device.device))
        .collect();
    if differing.is_empty() {
        return Ok(());
    }
    bail!(
        "the scene's own kernel and the general one give different films of {}; please report this with the command",
        differing.join(", ")
    )
}
