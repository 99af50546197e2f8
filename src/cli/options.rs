//! Options that can be carried out, and how flags become them.

use super::Request;
use super::raw::{ProgressChoice, RawCompare, RawDevice, RawDiff, RawRender, RawReport, RawSwitch};
use super::sources::{self, CliError, Source};
use super::values::{Level, RawSide, Simd};
use crate::backends::BackendChoice;
use crate::output::{Encoding, OutputFormat};
use crate::progressive::Plan;
use crate::recipe::Recipe;
use crate::render::{RenderJob, RenderSettings, SAMPLE_LIMIT, SamplerKind};
use crate::render_cpu::{CpuOptions, Isa};
use crate::render_gpu::{Drill, Fault, GpuOptions};
use crate::stages::Stage;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What `--batch` renders.
#[derive(Debug)]
pub struct BatchOptions {
    /// The pictures, one or those of all stages.
    pub renders: Vec<RenderOptions>,
    /// The directory of all stages' pictures, to be made if need be.
    pub directory: Option<PathBuf>,
    /// A scene file to be written besides.
    pub save_scene: Option<SaveSceneOptions>,
    /// Who renders.
    pub backend: BackendChoice,
    /// Whether progress is shown.
    pub progress: ProgressChoice,
    /// Where the closing figures go.
    pub json: Option<JsonTarget>,
}

/// What the window opens with.
#[derive(Clone, Debug)]
pub struct WindowOptions {
    /// What is rendered.
    pub recipe: Recipe,
    /// The stage that it is from.
    pub stage: Option<&'static Stage>,
    /// The scene file that it is from.
    pub file: Option<PathBuf>,
    /// Who renders.
    pub backend: BackendChoice,
    /// Whether flags said who renders.
    pub is_device_given: bool,
    /// When it ends, if that was said.
    pub plan: Option<Plan>,
    /// The film that goes on.
    pub resume: Option<PathBuf>,
    /// Where the times of the window's frames go.
    pub frame_log: Option<PathBuf>,
}

/// One picture.
#[derive(Clone, Debug)]
pub struct RenderOptions {
    /// What is rendered.
    pub recipe: Recipe,
    /// The recipe, checked.
    pub job: RenderJob,
    /// The stage that it is from.
    pub stage: Option<&'static Stage>,
    /// When it ends.
    pub plan: Plan,
    /// The picture's file.
    pub out: PathBuf,
    /// Where the film is kept.
    pub checkpoint: Option<PathBuf>,
    /// The film that goes on.
    pub resume: Option<PathBuf>,
}

/// Where JSON goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum JsonTarget {
    /// Standard output.
    StandardOutput,
    /// A file.
    File(PathBuf),
}

/// A scene file to be written.
#[derive(Clone, Debug)]
pub struct SaveSceneOptions {
    /// What it will hold; it has been checked.
    pub recipe: Recipe,
    /// The file.
    pub path: PathBuf,
}

/// Films to be added.
#[derive(Clone, Debug)]
pub struct MergeOptions {
    /// The films.
    pub films: Vec<PathBuf>,
    /// Where the sum goes.
    pub out: PathBuf,
}

/// A path that is traced twice and compared.
#[derive(Clone, Debug)]
pub struct DiffOptions {
    /// What the job is called.
    pub scene: String,
    /// The job; that of a search is small unless a size was asked for.
    pub job: RenderJob,
    /// Which path.
    pub path: PathChoice,
    /// Who traces it.
    pub sides: [SideChoice; 2],
    /// Largest difference that counts as none, as a share of the larger value.
    pub tolerance: f64,
    /// Where both paths go as JSON.
    pub json: Option<JsonTarget>,
}

/// Two pictures that are compared.
#[derive(Clone, Debug)]
pub struct CompareOptions {
    /// The pictures.
    pub sides: [CompareSide; 2],
    /// What backends render: what flags ask for, else what a file beside them says, at the size of that file.
    pub recipe: Recipe,
    /// Samples per pixel of what is rendered, if that was said.
    pub samples: Option<u64>,
    /// What whole numbers stand for where the file does not say.
    pub encoding: Encoding,
    /// Where the map of differences goes.
    pub heat_map: Option<PathBuf>,
    /// Where the figures go as JSON.
    pub json: Option<JsonTarget>,
}

/// A picture that is compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CompareSide {
    /// It is there.
    File(PathBuf),
    /// It is to be rendered.
    Backend {
        /// One of [`BackendChoice::NAMES`].
        name: String,
        /// What renders.
        choice: BackendChoice,
    },
}

/// Who traces a path that is compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SideChoice {
    /// `f32` on the CPU.
    Cpu(CpuOptions),
    /// `f64` on the CPU.
    Reference,
    /// A compute shader.
    Gpu(GpuOptions),
}

/// Which path is compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PathChoice {
    /// This one.
    Given {
        /// Column and row, within the picture.
        pixel: [u32; 2],
        /// Index of the sample.
        sample: u64,
    },
    /// That which differs most among samples `0 .. samples` of all pixels.
    Find {
        /// Samples of every pixel.
        samples: u64,
    },
}

/// Width that a search makes a picture at most, pixels.
const FIND_WIDTH: u32 = 200;

/// What `weekender diff` is asked for.
pub(super) fn diff(raw: RawDiff) -> Result<DiffOptions, CliError> {
    if raw.picture.stage.as_deref() == Some("all") {
        let reason = "one path is compared; choose one stage";
        return Err(CliError::Together { flag: "diff", other: "--stage all", reason });
    }
    for (flag, is_given, side, other) in [
        ("--adapter", raw.adapter.is_some(), RawSide::Gpu, "gpu among --sides"),
        ("--isa", raw.isa.0.is_some(), RawSide::Cpu, "cpu among --sides"),
    ] {
        if is_given && !raw.sides.contains(&side) {
            return Err(CliError::Needs { flag, other, reason: "it is for that side alone; leave it out" });
        }
    }
    let Source { mut recipe, stage } = sources::find(&raw.picture, None)?;
    sources::change(&mut recipe, &raw.picture, raw.estimate_error);
    if raw.find.is_some() && raw.picture.size.is_none() {
        narrow(&mut recipe.settings, FIND_WIDTH);
    }
    let (width, height) = (recipe.settings.width, recipe.settings.height);
    let path = match (raw.find, raw.pixel) {
        (Some(samples), _) => PathChoice::Find { samples },
        (None, pixel) => {
            let [x, y] = pixel.unwrap_or_default();
            if x >= width || y >= height {
                return Err(CliError::Pixel { x, y, width, height });
            }
            PathChoice::Given { pixel: [x, y], sample: raw.sample }
        }
    };
    let sides = raw.sides.map(|side| match side {
        RawSide::Cpu => SideChoice::Cpu(CpuOptions { isa: raw.isa.0, ..CpuOptions::default() }),
        RawSide::Baseline => {
            SideChoice::Cpu(CpuOptions { isa: Some(Isa::Baseline), ..CpuOptions::default() })
        }
        RawSide::Reference => SideChoice::Reference,
        RawSide::Gpu => SideChoice::Gpu(GpuOptions {
            adapter: raw.adapter.clone(),
            // Whoever names a software adapter wants it.
            allow_software: raw.adapter.is_some(),
            ..GpuOptions::default()
        }),
    });
    Ok(DiffOptions {
        scene: stage.map_or(recipe.name.clone(), |stage| stage.id.to_owned()),
        job: recipe.job()?,
        path,
        sides,
        tolerance: raw.tolerance,
        json: raw.json.map(json_target),
    })
}

/// What a report measures.
#[derive(Clone, Debug)]
pub struct ReportOptions {
    /// Scenes, at their size.
    pub scenes: Vec<Recipe>,
    /// Backends by their names.
    pub backends: Vec<(String, ReportBackend)>,
    /// Samplers.
    pub samplers: Vec<SamplerKind>,
    /// Pictures of each curve.
    pub seeds: u32,
    /// Width and height of all pictures.
    pub size: (u32, u32),
    /// Seconds of tracing for all pictures of a curve.
    pub time_limit: f64,
    /// Most samples per pixel.
    pub max_samples: u64,
    /// Whether samples are kept in two halves.
    pub estimate_error: bool,
    /// Errors that times are told for; the first is marked in the plot.
    pub targets: Vec<f64>,
    /// What errors are measured against.
    pub reference: ReferenceChoice,
    /// Where the report goes.
    pub out: PathBuf,
    /// Whether progress is shown.
    pub progress: ProgressChoice,
    /// What was typed.
    pub command: String,
}

/// What a curve of a report is rendered by.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ReportBackend {
    /// A backend of this program.
    Renderer(BackendChoice),
    /// The plain C89 program.
    Control {
        /// Whether it was asked for by name; otherwise it may be missing.
        is_asked_for: bool,
    },
}

/// What errors are measured against.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ReferenceChoice {
    /// A film that is there.
    File(PathBuf),
    /// One that is made.
    Make {
        /// The backend's name.
        name: String,
        /// What renders it.
        choice: BackendChoice,
        /// Samples per pixel.
        samples: u64,
    },
}

/// What a report's flags stand for when they are left out.
struct ReportDefaults {
    scenes: &'static [&'static str],
    backends: &'static [&'static str],
    seeds: u32,
    size: (u32, u32),
    time_limit: f64,
    max_samples: u64,
    /// Times as many samples as the longest curve's has the reference.
    reference_factor: u64,
}

const RACE: ReportDefaults = ReportDefaults {
    scenes: &["three-spheres", "book"],
    backends: &["cpu", "scalar", "gpu", CONTROL],
    seeds: 8,
    size: (160, 90),
    time_limit: 12.0,
    max_samples: 1024,
    reference_factor: 4,
};

const CALIBRATION: ReportDefaults = ReportDefaults {
    scenes: &["three-spheres", "book", "close-up", sources::NEAR_GLASS],
    backends: &["cpu", "gpu"],
    seeds: 24,
    size: (96, 54),
    time_limit: 1e9,
    max_samples: 256,
    reference_factor: 16,
};

/// The control's name among a report's backends.
const CONTROL: &str = "c89";

/// Errors that times are told for in any case.
const TARGETS: [f64; 2] = [0.01, 0.001];

/// What `weekender report` is asked for; `command` is what was typed.
pub(super) fn report(raw: RawReport, command: String) -> Result<ReportOptions, CliError> {
    let defaults = if raw.calibration { CALIBRATION } else { RACE };
    let backends = report_backends(&raw, &defaults)?;
    let size = raw.size.unwrap_or(defaults.size);
    let scenes = report_scenes(&raw, &defaults, size)?;
    let max_samples = raw.max_samples.unwrap_or(defaults.max_samples);
    let reference = match raw.reference {
        Some(_) if scenes.len() > 1 => {
            let reason = "one film is the reference of one scene; say which with --scenes";
            return Err(CliError::Together { flag: "--reference", other: "several --scenes", reason });
        }
        Some(path) => ReferenceChoice::File(path),
        None => {
            let choice = backend_named(&raw.reference_backend, raw.adapter.as_deref(), &[])?;
            let samples = (defaults.reference_factor * max_samples).min(SAMPLE_LIMIT);
            let samples = raw.reference_samples.unwrap_or(samples);
            ReferenceChoice::Make { name: raw.reference_backend, choice, samples }
        }
    };
    let mut targets: Vec<f64> = raw.target.into_iter().collect();
    targets.extend(TARGETS.into_iter().filter(|target| raw.target != Some(*target)));
    Ok(ReportOptions {
        scenes,
        backends,
        samplers: raw.samplers.into_iter().map(Into::into).collect(),
        seeds: raw.seeds.unwrap_or(defaults.seeds),
        size,
        time_limit: raw.time_limit.unwrap_or(defaults.time_limit),
        max_samples,
        estimate_error: raw.estimate_error == RawSwitch::On,
        targets,
        reference,
        out: raw.out,
        progress: raw.progress,
        command,
    })
}

/// `more` are names that are possible besides.
fn backend_named(name: &str, adapter: Option<&str>, more: &[&str]) -> Result<BackendChoice, CliError> {
    BackendChoice::named(name, adapter).ok_or_else(|| {
        let choices = [&BackendChoice::NAMES[..], more].concat().join(", ");
        CliError::BackendName { name: name.to_owned(), choices }
    })
}

fn report_backends(
    raw: &RawReport,
    defaults: &ReportDefaults,
) -> Result<Vec<(String, ReportBackend)>, CliError> {
    let adapter = raw.adapter.as_deref();
    let is_asked_for = !raw.backends.is_empty();
    let names = if is_asked_for {
        raw.backends.clone()
    } else {
        let auto = || BackendChoice::auto(CpuOptions::default(), GpuOptions::default());
        let has_gpu = adapter.is_some() || matches!(auto(), BackendChoice::Gpu(_));
        let present = defaults.backends.iter().filter(|name| has_gpu || **name != "gpu");
        present.map(|name| (*name).to_owned()).collect()
    };
    if adapter.is_some() && !names.iter().chain([&raw.reference_backend]).any(|name| name == "gpu") {
        let reason = "it chooses among GPUs; leave it out";
        return Err(CliError::Needs { flag: "--adapter", other: "gpu among --backends", reason });
    }
    let of_name = |name: String| {
        let backend = match name.as_str() {
            CONTROL => ReportBackend::Control { is_asked_for },
            name => ReportBackend::Renderer(backend_named(name, adapter, &[CONTROL])?),
        };
        Ok((name, backend))
    };
    names.into_iter().map(of_name).collect()
}

fn report_scenes(
    raw: &RawReport,
    defaults: &ReportDefaults,
    size: (u32, u32),
) -> Result<Vec<Recipe>, CliError> {
    let sized = |recipe: Result<Recipe, CliError>| {
        let mut recipe = recipe?;
        (recipe.settings.width, recipe.settings.height) = size;
        recipe.job()?;
        Ok(recipe)
    };
    if raw.scenes.is_empty() {
        defaults.scenes.iter().map(|name| sized(sources::carried(name))).collect()
    } else {
        raw.scenes.iter().map(|name| sized(sources::scene(name))).collect()
    }
}

/// Samples that are compared unless a number is asked for.
const COMPARE_SAMPLES: u64 = 64;

/// Width that pictures which are rendered to be compared have at most, pixels, unless a size is asked for.
const COMPARE_WIDTH: u32 = 400;

/// What `weekender compare` is asked for.
pub(super) fn compare(raw: RawCompare) -> Result<CompareOptions, CliError> {
    if raw.picture.stage.as_deref() == Some("all") {
        let reason = "two pictures are compared; choose one stage";
        return Err(CliError::Together { flag: "compare", other: "--stage all", reason });
    }
    let adapter = raw.adapter.as_deref();
    let side = |name: String| match BackendChoice::named(&name, adapter) {
        Some(choice) => CompareSide::Backend { name, choice },
        None => CompareSide::File(PathBuf::from(name)),
    };
    let is_gpu = [&raw.first, &raw.second].into_iter().any(|name| name == "gpu");
    if adapter.is_some() && !is_gpu {
        let reason = "it chooses among GPUs; leave it out";
        return Err(CliError::Needs { flag: "--adapter", other: "gpu as a side", reason });
    }
    let sides = [side(raw.first), side(raw.second)];
    // Pictures of other programs do not say what they show.
    let told = sides.iter().find_map(|side| match side {
        CompareSide::File(path) => sources::find(&raw.picture, Some(path)).ok(),
        CompareSide::Backend { .. } => None,
    });
    let Source { mut recipe, .. } = match told {
        Some(source) => source,
        None => sources::find(&raw.picture, None)?,
    };
    sources::change(&mut recipe, &raw.picture, None);
    if raw.picture.size.is_none() {
        narrow(&mut recipe.settings, COMPARE_WIDTH);
    }
    recipe.samples_per_pixel = COMPARE_SAMPLES;
    recipe.job()?;
    Ok(CompareOptions {
        sides,
        recipe,
        samples: raw.samples,
        encoding: raw.encoding.into(),
        heat_map: raw.heat_map,
        json: raw.json.map(json_target),
    })
}

/// Makes a picture at most `width` pixels wide, of the same shape.
fn narrow(settings: &mut RenderSettings, width: u32) {
    if settings.width > width {
        let height = f64::from(settings.height) * f64::from(width) / f64::from(settings.width);
        (settings.width, settings.height) = (width, (height.round() as u32).max(1));
    }
}

/// What the flags ask for, but `--list` and the subcommands.
pub(super) fn request(raw: RawRender) -> Result<Request, CliError> {
    let backend = backend(&raw)?;
    check_film_names(&raw)?;
    if !raw.batch && raw.save_scene.is_none() {
        return Ok(Request::Window(Box::new(window(&raw, backend)?)));
    }
    let (renders, directory) = if raw.picture.stage.as_deref() == Some("all") {
        let directory = directory_of_all(&raw)?;
        let renders = Stage::ALL
            .iter()
            .map(|stage| {
                let source = Source { recipe: stage.recipe(), stage: Some(stage) };
                render(source, &raw, directory.join(format!("{}.png", stage.id)))
            })
            .collect::<Result<_, _>>()?;
        (renders, Some(directory))
    } else {
        let source = sources::find(&raw.picture, raw.resume.as_deref())?;
        let out = raw.out.clone().unwrap_or_else(|| default_name(&source));
        (vec![render(source, &raw, out)?], None)
    };
    let save_scene = match (&raw.save_scene, renders.as_slice()) {
        (Some(path), [only]) => Some(SaveSceneOptions { recipe: only.recipe.clone(), path: path.clone() }),
        _ => None,
    };
    match save_scene {
        Some(options) if !raw.batch => Ok(Request::SaveScene(Box::new(options))),
        save_scene => Ok(Request::Batch(Box::new(BatchOptions {
            renders,
            directory,
            save_scene,
            backend,
            progress: raw.progress,
            json: raw.json.map(json_target),
        }))),
    }
}

fn window(raw: &RawRender, backend: BackendChoice) -> Result<WindowOptions, CliError> {
    if raw.picture.stage.as_deref() == Some("all") {
        return Err(CliError::Needs {
            flag: "--stage all",
            other: "--batch",
            reason: "the window shows one stage at a time, and leads from each to the next",
        });
    }
    for (flag, is_given) in [
        ("--out", raw.out.is_some()),
        ("--checkpoint", raw.checkpoint.is_some()),
        ("--json", raw.json.is_some()),
        ("--sample-range", raw.sample_range.is_some()),
    ] {
        if is_given {
            let reason = "it is for rendering to files; in the window, use the File menu";
            return Err(CliError::Needs { flag, other: "--batch", reason });
        }
    }
    let mut source = sources::find(&raw.picture, raw.resume.as_deref())?;
    sources::change(&mut source.recipe, &raw.picture, raw.estimate_error);
    source.recipe.samples_per_pixel = raw.samples.unwrap_or(source.recipe.samples_per_pixel);
    source.recipe.job()?;
    let ends = raw.samples.is_some() || raw.time_limit.is_some() || raw.noise_target.is_some();
    let is_file = raw.picture.scene.as_deref().is_some_and(sources::is_file);
    Ok(WindowOptions {
        plan: ends.then(|| plan(raw, &source.recipe)),
        recipe: source.recipe,
        stage: source.stage,
        file: raw.picture.scene.as_ref().filter(|_| is_file).map(PathBuf::from),
        backend,
        is_device_given: raw.device != RawDevice::Auto
            || raw.threads.is_some()
            || raw.adapter.is_some()
            || (raw.simd, raw.isa) != (Simd(None), Level(None)),
        resume: raw.resume.clone(),
        frame_log: raw.frame_log.clone(),
    })
}

fn render(mut source: Source, raw: &RawRender, out: PathBuf) -> Result<RenderOptions, CliError> {
    sources::change(&mut source.recipe, &raw.picture, raw.estimate_error);
    source.recipe.samples_per_pixel = raw.samples.unwrap_or(source.recipe.samples_per_pixel);
    let job = source.recipe.job()?;
    if raw.noise_target.is_some() && !source.recipe.settings.estimate_error {
        return Err(CliError::Needs {
            flag: "--noise-target",
            other: "--estimate-error on",
            reason: "the error is estimated from the film's two halves",
        });
    }
    OutputFormat::from_path(&out)?;
    check_distinct(raw, &out)?;
    Ok(RenderOptions {
        plan: plan(raw, &source.recipe),
        recipe: source.recipe,
        job,
        stage: source.stage,
        out,
        checkpoint: raw.checkpoint.clone(),
        resume: raw.resume.clone(),
    })
}

fn check_film_names(raw: &RawRender) -> Result<(), CliError> {
    for (flag, path) in [("--checkpoint", &raw.checkpoint), ("--resume", &raw.resume)] {
        if let Some(path) = path
            && !path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr"))
        {
            return Err(CliError::FilmEnding { flag, path: path.clone() });
        }
    }
    Ok(())
}

/// Refuses two outputs of one name: the second would replace the first.
fn check_distinct(raw: &RawRender, out: &Path) -> Result<(), CliError> {
    let json = raw.json.as_deref().filter(|path| *path != Path::new("-"));
    let outputs = [
        ("--out", Some(out)),
        ("--checkpoint", raw.checkpoint.as_deref()),
        ("--save-scene", raw.save_scene.as_deref()),
        ("--json", json),
    ];
    for (index, (second, path)) in outputs.iter().enumerate() {
        let Some(path) = path else { continue };
        if let Some((first, _)) = outputs[..index].iter().find(|(_, other)| other.as_ref() == Some(path)) {
            return Err(CliError::SameFile { first, second, path: path.to_path_buf() });
        }
    }
    Ok(())
}

fn plan(raw: &RawRender, recipe: &Recipe) -> Plan {
    let ends_otherwise = raw.time_limit.is_some() || raw.noise_target.is_some();
    let samples = match (&raw.sample_range, raw.samples) {
        (Some(range), _) => range.clone(),
        (None, None) if ends_otherwise => 0..SAMPLE_LIMIT,
        (None, _) => 0..recipe.samples_per_pixel,
    };
    Plan {
        samples,
        time_limit: raw.time_limit.map(Duration::from_secs_f64),
        noise_target: raw.noise_target,
        pass_target: Plan::BATCH_PASS,
    }
}

fn backend(raw: &RawRender) -> Result<BackendChoice, CliError> {
    let (Simd(lanes), Level(isa)) = (raw.simd, raw.isa);
    let threads = raw.threads.and_then(|threads| usize::try_from(threads).ok());
    let cpu = CpuOptions { isa, lanes, threads, gives_way: false };
    let drills = [
        (raw.simulate_device_lost, Fault::Lost, "--simulate-device-lost"),
        (raw.simulate_out_of_memory, Fault::OutOfMemory, "--simulate-out-of-memory"),
        (raw.simulate_invalid_call, Fault::Invalid, "--simulate-invalid-call"),
    ];
    let drill =
        drills.into_iter().find_map(|(after, fault, flag)| after.map(|after| (Drill { fault, after }, flag)));
    let gpu = GpuOptions {
        adapter: raw.adapter.clone(),
        // Whoever names a software adapter wants it.
        allow_software: raw.adapter.is_some(),
        drill: drill.map(|(drill, _)| drill),
        ..GpuOptions::default()
    };
    let gpu_flag = if raw.adapter.is_some() { Some("--adapter") } else { drill.map(|(_, flag)| flag) };
    if let (Some(flag), RawDevice::Cpu | RawDevice::Reference) = (gpu_flag, raw.device) {
        let other = if raw.device == RawDevice::Cpu { "--device cpu" } else { "--device reference" };
        return Err(CliError::Together { flag, other, reason: "it is for the GPU; leave one of them out" });
    }
    match raw.device {
        RawDevice::Auto if raw.adapter.is_some() => Ok(BackendChoice::Gpu(gpu)),
        RawDevice::Auto => Ok(BackendChoice::auto(cpu, gpu)),
        RawDevice::Cpu => Ok(BackendChoice::Cpu(cpu)),
        RawDevice::Gpu => Ok(BackendChoice::Gpu(gpu)),
        RawDevice::Both => Ok(BackendChoice::Both(cpu, gpu)),
        RawDevice::Reference if lanes.is_some() || isa.is_some() => Err(CliError::Together {
            flag: if lanes.is_some() { "--simd" } else { "--isa" },
            other: "--device reference",
            reason: "the reference is scalar; leave one of them out",
        }),
        RawDevice::Reference => Ok(BackendChoice::Reference { threads }),
    }
}

/// The directory of `--stage all`, which goes with few other flags.
fn directory_of_all(raw: &RawRender) -> Result<PathBuf, CliError> {
    let single = [
        ("--checkpoint", raw.checkpoint.is_some()),
        ("--resume", raw.resume.is_some()),
        ("--save-scene", raw.save_scene.is_some()),
    ];
    if let Some((flag, _)) = single.into_iter().find(|(_, is_given)| *is_given) {
        let reason = "it stands for one picture; choose one stage";
        return Err(CliError::Together { flag, other: "--stage all", reason });
    }
    raw.out.clone().ok_or(CliError::Needs {
        flag: "--stage all",
        other: "--out DIR",
        reason: "it writes a picture for every stage",
    })
}

pub(super) fn json_target(path: PathBuf) -> JsonTarget {
    if path == Path::new("-") { JsonTarget::StandardOutput } else { JsonTarget::File(path) }
}

/// `SCENE.png` in the current directory.
fn default_name(source: &Source) -> PathBuf {
    let name = source.stage.map_or(source.recipe.name.as_str(), |stage| stage.id);
    let is_plain = |c: char| c.is_alphanumeric() || "-_. ".contains(c);
    let name: String = name.chars().map(|c| if is_plain(c) { c } else { '-' }).collect();
    PathBuf::from(format!("{name}.png"))
}
