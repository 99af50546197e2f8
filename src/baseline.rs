//! The baseline: a plain C89 program that renders the same picture. It is compiled on demand.

use crate::render::{RenderJob, RenderSettings};
use crate::scene::{Camera, Parameter, Scene};
use glam::DVec3;
use std::fmt::Write as _;
use std::fs;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// The C source, `reference/rt_weekend.c`.
pub const SOURCE: &str = include_str!("../reference/rt_weekend.c");

/// Flags for the C compiler.
pub const FLAGS: [&str; 5] = ["-std=c89", "-pedantic", "-Wall", "-Wextra", "-O2"];

/// How often the program checks whether the caller wants to stop.
const POLL: Duration = Duration::from_millis(20);

/// Why the baseline is not available or has failed.
#[derive(Debug, thiserror::Error)]
pub enum BaselineError {
    /// There is no C compiler.
    #[error("there is no C compiler {compiler:?} ({reason}); install one or name it in CC")]
    NoCompiler {
        /// From CC, or `cc`.
        compiler: String,
        /// The system's error.
        reason: io::Error,
    },
    /// The compiler rejected the source.
    #[error("{compiler} cannot compile the baseline: {message}")]
    Compile {
        /// From CC, or `cc`.
        compiler: String,
        /// The first lines of its output.
        message: String,
    },
    /// The job needs something that the baseline does not support.
    #[error("{0}")]
    Unfit(&'static str),
    /// The run ended without figures.
    #[error("the baseline failed: {0}")]
    Run(String),
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// A temporary file cannot be written.
    #[error("cannot write the baseline's files: {0}")]
    Files(#[from] io::Error),
}

/// The compiled baseline.
pub struct Baseline {
    directory: TempDir,
    /// The C compiler.
    pub compiler: String,
}

/// The figures of one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaselineRun {
    /// Wall time of tracing, seconds.
    pub seconds: f64,
    /// Processor time of tracing, seconds, as the baseline measures it.
    pub processor_seconds: f64,
    /// Pixels times samples.
    pub paths: u64,
    /// Rays traced.
    pub rays: u64,
}

impl Baseline {
    /// Compiles the baseline with the C compiler that the environment variable CC names, or with `cc`.
    ///
    /// # Errors
    /// [`BaselineError::NoCompiler`], [`BaselineError::Compile`] or [`BaselineError::Files`].
    pub fn compile() -> Result<Self, BaselineError> {
        let compiler = std::env::var("CC").ok().filter(|name| !name.trim().is_empty());
        let compiler = compiler.unwrap_or_else(|| "cc".to_owned());
        let directory = tempfile::Builder::new().prefix("weekender-baseline-").tempdir()?;
        let source = directory.path().join("rt_weekend.c");
        fs::write(&source, SOURCE)?;
        let mut words = compiler.split_whitespace();
        let output = Command::new(words.next().unwrap_or("cc"))
            .args(words)
            .args(FLAGS)
            .arg("-o")
            .args([program_in(directory.path()), source])
            .arg("-lm")
            .stdin(Stdio::null())
            .output()
            .map_err(|reason| BaselineError::NoCompiler { compiler: compiler.clone(), reason })?;
        if !output.status.success() {
            let message =
                String::from_utf8_lossy(&output.stderr).lines().take(3).collect::<Vec<_>>().join("; ");
            return Err(BaselineError::Compile { compiler, message });
        }
        Ok(Baseline { directory, compiler })
    }

    /// Language, compiler and threads, for tables.
    pub fn about(&self) -> String {
        format!("C89, {} -O2, 1 thread", self.compiler)
    }

    /// Writes the scene file for the baseline.
    ///
    /// # Errors
    /// [`BaselineError::Unfit`] for the rules of a stage, [`BaselineError::Files`].
    pub fn write_scene(&self, job: &RenderJob, name: &str) -> Result<PathBuf, BaselineError> {
        if !job.rules().are_finished() {
            return Err(BaselineError::Unfit("the baseline has only the rules of the finished renderer"));
        }
        let path = self.directory.path().join(format!("{name}.txt"));
        fs::write(&path, scene_text(job.scene(), job.camera()))?;
        Ok(path)
    }

    /// A temporary file that is deleted with the baseline.
    pub fn scratch(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    /// Renders `samples` of every pixel of a scene file, or of the three spheres if there is none. Writes the picture
    /// to `out`: a .ppm as displayed or a linear .pfm. Stops early if `is_cancelled` returns true.
    ///
    /// # Errors
    /// [`BaselineError::Run`] or [`BaselineError::Cancelled`].
    pub fn run(
        &self,
        scene: Option<&Path>,
        settings: &RenderSettings,
        samples: u64,
        seed: u32,
        out: Option<&Path>,
        is_cancelled: &dyn Fn() -> bool,
    ) -> Result<BaselineRun, BaselineError> {
        let failed = |reason: io::Error| BaselineError::Run(reason.to_string());
        let RenderSettings { width, height, max_depth, .. } = settings;
        let mut command = Command::new(program_in(self.directory.path()));
        command.args([*width, *height].map(|x| x.to_string()));
        command.args([samples.to_string(), max_depth.to_string(), seed.to_string()]);
        if let Some(scene) = scene {
            command.arg("--scene").arg(scene);
        }
        if let Some(out) = out {
            command.arg("--out").arg(out);
        }
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().map_err(failed)?;
        let (lines, said) = mpsc::channel();
        let read = |pipe: std::process::ChildStdout| {
            move || {
                for line in BufReader::new(pipe).lines().map_while(Result::ok) {
                    // After a cancellation, nobody receives this.
                    let _ = lines.send((Instant::now(), line));
                }
            }
        };
        let reader = child.stdout.take().map(|pipe| std::thread::Builder::new().spawn(read(pipe)));
        let reader = reader.transpose().map_err(|reason| {
            // If it has just ended, there is nothing to kill.
            let _ = child.kill();
            failed(reason)
        })?;
        let (mut begin, mut run) = (None, None);
        loop {
            match said.recv_timeout(POLL) {
                Ok((now, line)) if line == "tracing" => begin = Some(now),
                Ok((now, line)) => run = begin.and_then(|begin| figures(&line, now - begin)).or(run),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            if is_cancelled() {
                // If it has just ended, there is nothing to kill.
                let _ = child.kill();
            }
        }
        if let Some(reader) = reader {
            // The thread only reads; a panic in it does not affect the run.
            let _ = reader.join();
        }
        let output = child.wait_with_output().map_err(failed)?;
        match run {
            _ if is_cancelled() => Err(BaselineError::Cancelled),
            Some(run) if output.status.success() => Ok(run),
            _ => {
                let complaint = String::from_utf8_lossy(&output.stderr);
                Err(BaselineError::Run(format!("{}, {}", output.status, complaint.trim())))
            }
        }
    }
}

fn program_in(directory: &Path) -> PathBuf {
    directory.join(format!("rt_weekend{}", std::env::consts::EXE_SUFFIX))
}

/// Parses `trace_seconds S paths P rays R`, which arrived `wall` after tracing began.
fn figures(line: &str, wall: Duration) -> Option<BaselineRun> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let ["trace_seconds", processor, "paths", paths, "rays", rays] = words[..] else { return None };
    Some(BaselineRun {
        seconds: wall.as_secs_f64(),
        processor_seconds: processor.parse().ok()?,
        paths: paths.parse().ok()?,
        rays: rays.parse().ok()?,
    })
}

/// A scene in the baseline's format.
fn scene_text(scene: &Scene, camera: &Camera) -> String {
    let three = |v: DVec3| format!("{:?} {:?} {:?}", v.x, v.y, v.z);
    // vup may be almost parallel to the view; this is the same direction, to all digits.
    let up = camera.basis().v;
    let mut text = format!(
        "camera {} {} {} {:?} {:?} {:?}\nsky {} {}\n",
        three(camera.look_from),
        three(camera.look_at),
        three(up),
        camera.vfov_degrees,
        camera.defocus_angle_degrees,
        camera.effective_focus_distance(),
        three(scene.sky.bottom),
        three(scene.sky.top)
    );
    for sphere in &scene.spheres {
        let place = format!("{} {:?}", three(sphere.center), sphere.radius);
        let material = scene.material_of(sphere);
        let words = material.parameters().into_iter().map(|(_, parameter)| match parameter {
            Parameter::Number(number) => format!(" {number:?}"),
            Parameter::Colour(colour) => format!(" {}", three(colour)),
        });
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{} {place}{}", material.kind(), words.collect::<String>());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, Sky};

    #[test]
    fn a_scene_file_has_the_lens_that_is_in_effect_and_every_number_in_its_place() {
        let mut scene = Scene {
            sky: Sky { bottom: DVec3::new(0.5, 0.25, 0.75), top: DVec3::new(1.0, 2.0, 3.0) },
            ..Scene::default()
        };
        let albedo = DVec3::new(0.1, 0.2, 0.3);
        let materials = [
            Material::Dielectric { refraction_index: 1.5 },
            Material::Metal { albedo, fuzz: 0.4 },
            Material::Lambertian { albedo },
        ];
        for (material, radius) in materials.into_iter().zip([0.5, 2.5, 100.0]) {
            let index = scene.add_material(material.kind(), material);
            scene.add_sphere(DVec3::new(4.0, 5.0, 6.0), radius, index);
        }
        // It looks along x, so what is up is y however far up is inclined.
        let camera = Camera {
            look_from: DVec3::new(3.0, 7.0, 8.0),
            look_at: DVec3::new(-1.0, 7.0, 8.0),
            vup: DVec3::new(3.0, 2.0, 0.0),
            vfov_degrees: 40.0,
            defocus_angle_degrees: 2.0,
            focus_distance: None,
        };
        let numbers = |line: &str| -> Vec<f64> {
            line.split(' ').skip(1).map(|word| word.parse().unwrap_or(f64::NAN)).collect()
        };
        let expected = [
            ("camera", &[3.0, 7.0, 8.0, -1.0, 7.0, 8.0, 0.0, 1.0, 0.0, 40.0, 2.0, 4.0][..]),
            ("sky", &[0.5, 0.25, 0.75, 1.0, 2.0, 3.0]),
            ("dielectric", &[4.0, 5.0, 6.0, 0.5, 1.5]),
            ("metal", &[4.0, 5.0, 6.0, 2.5, 0.1, 0.2, 0.3, 0.4]),
            ("lambertian", &[4.0, 5.0, 6.0, 100.0, 0.1, 0.2, 0.3]),
        ];
        let text = scene_text(&scene, &camera);
        assert_eq!(text.lines().count(), expected.len(), "{text}");
        for (line, (word, values)) in text.lines().zip(expected) {
            assert_eq!((line.split(' ').next(), numbers(line).as_slice()), (Some(word), values), "{text}");
        }
        let nearer = scene_text(&scene, &Camera { focus_distance: Some(2.5), ..camera });
        assert_eq!(nearer.lines().next().and_then(|line| line.split(' ').next_back()), Some("2.5"));
    }

    #[test]
    fn only_the_whole_line_of_figures_is_read() {
        let wall = Duration::from_millis(1600);
        let run = figures("trace_seconds 1.5 paths 30 rays 70", wall).expect("figures");
        assert_eq!(run, BaselineRun { seconds: 1.6, processor_seconds: 1.5, paths: 30, rays: 70 });
        for line in ["", "trace_seconds 1.5 paths 30", "trace_seconds x paths 30 rays 70", "paths 30 rays 70"]
        {
            assert_eq!(figures(line, wall), None, "{line}");
        }
    }
}
