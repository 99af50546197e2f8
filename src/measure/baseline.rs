//! The control: a plain C89 program that renders the same picture, compiled on demand.

use crate::film::{FIXED_POINT_SCALE, Film, PixelSum};
use crate::job::output::{Encoding, read_picture};
use crate::job::render::{BackendInfo, Control, Outcome, RenderError, RenderJob, Renderer, Stats};
use crate::scene::{Camera, Parameter, Scene};
use anyhow::{Context, Result, anyhow, bail};
use glam::DVec3;
use std::fmt::{Display, Write as _};
use std::fs;
use std::io::{BufRead, BufReader};
use std::ops::Range;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use tempfile::TempDir;

pub const SOURCE: &str = include_str!("../../reference/rt_weekend.c");

pub const FLAGS: [&str; 5] = ["-std=c89", "-pedantic", "-Wall", "-Wextra", "-O2"];

/// The compiled program. As a renderer it draws its own random numbers, and its films have one half.
pub struct Baseline {
    directory: TempDir,
    compiler: String,
    /// The job whose scene file is on disk.
    job: Option<RenderJob>,
}

impl Baseline {
    /// Compiles the program with the compiler that the environment variable CC names, or `cc`.
    pub fn compile() -> Result<Self> {
        let compiler = std::env::var("CC").ok().filter(|name| !name.trim().is_empty());
        let compiler = compiler.unwrap_or_else(|| "cc".to_owned());
        let directory = tempfile::Builder::new().prefix("weekender-baseline-").tempdir()?;
        let baseline = Baseline { directory, compiler, job: None };
        let source = baseline.file("rt_weekend.c");
        fs::write(&source, SOURCE).context("cannot write the C program")?;
        let mut command = baseline.compiler.split_whitespace();
        let output = Command::new(command.next().unwrap_or("cc"))
            .args(command)
            .args(FLAGS)
            .arg("-o")
            .args([baseline.program(), source])
            .arg("-lm")
            .stdin(Stdio::null())
            .output()
            .map_err(|reason| {
                let compiler = &baseline.compiler;
                anyhow!("there is no C compiler {compiler:?} ({reason}); install one or name it in CC")
            })?;
        if !output.status.success() {
            let message =
                String::from_utf8_lossy(&output.stderr).lines().take(3).collect::<Vec<_>>().join("; ");
            bail!("{} cannot compile the C program: {message}", baseline.compiler);
        }
        Ok(baseline)
    }

    pub fn program(&self) -> PathBuf {
        self.file(&format!("rt_weekend{}", std::env::consts::EXE_SUFFIX))
    }

    fn file(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    /// Renders samples of the prepared job to `picture.pfm`. Ctrl+C ends the program, too; any other cancellation waits
    /// for it.
    fn run(&self, job: &RenderJob, samples: &Range<u64>, cancel: &AtomicBool) -> Result<Stats, RenderError> {
        let settings = job.settings();
        // Give each range of samples its own random numbers. The program takes 31-bit seeds.
        let seed = settings.seed.wrapping_add((samples.start as u32).wrapping_mul(0x9e37_79b9)) & 0x7fff_ffff;
        let numbers = [settings.width, settings.height].map(u64::from).into_iter();
        let numbers = numbers.chain([samples.end - samples.start, settings.max_depth.into(), seed.into()]);
        let mut command = Command::new(self.program());
        command.args(numbers.map(|number| number.to_string()));
        command.arg("--scene").arg(self.file("scene.txt")).arg("--out").arg(self.file("picture.pfm"));
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().map_err(failed)?;
        let lines = child.stdout.take().map(|output| BufReader::new(output).lines().map_while(Result::ok));
        let stats = lines.and_then(|mut lines| {
            lines.find(|line| line == "tracing")?;
            let begin = Instant::now();
            let line = lines.next()?;
            figures(&line, begin.elapsed())
        });
        let output = child.wait_with_output().map_err(failed)?;
        match stats {
            _ if cancel.load(Ordering::Relaxed) => Err(RenderError::Cancelled),
            Some(stats) if output.status.success() => Ok(stats),
            _ => {
                Err(failed(format!("{}, {}", output.status, String::from_utf8_lossy(&output.stderr).trim())))
            }
        }
    }
}

impl Renderer for Baseline {
    fn info(&self) -> BackendInfo {
        BackendInfo { name: "C89", device: format!("{} -O2", self.compiler), lanes: 1, threads: 1 }
    }

    fn prepare(&mut self, job: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
        if self.job.as_ref() == Some(job) {
            return Ok(());
        }
        if !job.rules().are_finished() {
            return Err(failed("it has only the rules of the finished renderer"));
        }
        fs::write(self.file("scene.txt"), scene_text(job.scene(), job.camera())).map_err(failed)?;
        self.job = Some(job.clone());
        Ok(())
    }

    fn advance(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        &Control { cancel, .. }: &Control,
    ) -> Result<Outcome, RenderError> {
        self.prepare(job, cancel)?;
        if cancel.load(Ordering::Relaxed) {
            return Err(RenderError::Cancelled);
        }
        let stats = self.run(job, &range, cancel)?;
        // The encoding applies only to integers; a PFM holds floats.
        let picture = read_picture(&self.file("picture.pfm"), None).map_err(failed)?.linear(Encoding::Srgb);
        let scale = (range.end - range.start) as f64 * FIXED_POINT_SCALE;
        film.record(range, 0)?;
        for (sum, mean) in film.halves_mut()[0].iter_mut().zip(picture.pixels) {
            sum.add(PixelSum(mean.map(|x| (x * scale).round() as u64)));
        }
        Ok(Outcome::Added(stats))
    }
}

fn failed(reason: impl Display) -> RenderError {
    RenderError::Backend { backend: "the C program", reason: reason.to_string() }
}

/// Parses `trace_seconds S paths P rays R`, which arrived `wall` after tracing began.
fn figures(line: &str, wall: Duration) -> Option<Stats> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let ["trace_seconds", _, "paths", paths, "rays", rays] = words[..] else { return None };
    Some(Stats { paths: paths.parse().ok()?, rays: rays.parse().ok()?, trace: wall, ..Stats::default() })
}

/// Writes a scene in the baseline's format.
fn scene_text(scene: &Scene, camera: &Camera) -> String {
    let three = |v: DVec3| format!("{:?} {:?} {:?}", v.x, v.y, v.z);
    let Camera { look_from, look_at, vfov_degrees: vfov, defocus_angle_degrees: defocus, .. } = *camera;
    // vup may be almost parallel to the view, so write the exact up direction.
    let [from, at, up] = [look_from, look_at, camera.basis().v].map(three);
    let (focus, [bottom, top]) =
        (camera.effective_focus_distance(), [scene.sky.bottom, scene.sky.top].map(three));
    let mut text = format!("camera {from} {at} {up} {vfov:?} {defocus:?} {focus:?}\nsky {bottom} {top}\n");
    for sphere in &scene.spheres {
        let place = format!("{} {:?}", three(sphere.center), sphere.radius);
        let material = scene.material_of(sphere);
        let numbers = material.parameters().into_iter().map(|(_, parameter)| match parameter {
            Parameter::Number(number) => format!(" {number:?}"),
            Parameter::Colour(colour) => format!(" {}", three(colour)),
        });
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{} {place}{}", material.kind(), numbers.collect::<String>());
    }
    text
}
