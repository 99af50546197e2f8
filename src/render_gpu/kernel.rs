//! Kernels: a shader specialised by override constants, compiled once for each set of them.

use super::device::Gpu;
use super::layout::{UNIFORM_ANCHORED, UNIFORM_SPHERES};
use super::shader_source::{EntryPoint, laws_tag, shading_tag, source};
use crate::render::{RenderJob, SamplerKind};
use crate::stages::{DielectricLaws, Diffuse, Shading, Surface};
use crate::tables::Tables;
use std::collections::HashMap;
use std::time::{Duration, Instant};

/// What a kernel is specialised by. Code that a flag switches off is not in the kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Overrides {
    /// Lambertian surfaces.
    pub lambertian: bool,
    /// Metals.
    pub metal: bool,
    /// Metals with fuzz.
    pub fuzz: bool,
    /// Glass.
    pub glass: bool,
    /// A lens.
    pub lens: bool,
    /// Spheres that a ray can be inside of.
    pub two_root: bool,
    /// Huge spheres.
    pub anchored: bool,
    /// The hierarchy.
    pub hierarchy: bool,
    /// The spheres fit the uniform buffer, and the next two counts are those of the scene.
    pub few_spheres: bool,
    /// Spheres of one root.
    pub opaque_count: u32,
    /// Spheres of two.
    pub two_root_count: u32,
    /// The huge spheres fit the uniform buffer, and the next count is that of the scene.
    pub few_anchored: bool,
    /// Huge spheres.
    pub anchored_count: u32,
    /// The Sobol sampler, else independent numbers.
    pub sobol: bool,
    /// Samples are spread over the pixel.
    pub antialiasing: bool,
    /// Rays are traced at all.
    pub rays: bool,
    /// The book's lower bound of 0.
    pub acne: bool,
    /// Lambertian surfaces send light evenly over the hemisphere.
    pub hemisphere: bool,
    /// The reflectance is that of the picture's strip.
    pub reflectance_strips: bool,
    /// What a ray brings back.
    pub shading: Shading,
    /// The laws of glass.
    pub dielectric_laws: DielectricLaws,
}

/// The value of an override constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Constant {
    /// A `bool`.
    Flag(bool),
    /// A `u32`.
    Number(u32),
}

impl Constant {
    fn value(self) -> f64 {
        match self {
            Constant::Flag(flag) => f64::from(u8::from(flag)),
            Constant::Number(number) => f64::from(number),
        }
    }
}

impl Default for Overrides {
    /// The kernel that leaves nothing out but the hierarchy and the stages' rules.
    fn default() -> Self {
        Overrides {
            lambertian: true,
            metal: true,
            fuzz: true,
            glass: true,
            lens: true,
            two_root: true,
            anchored: true,
            hierarchy: false,
            few_spheres: false,
            opaque_count: 0,
            two_root_count: 0,
            few_anchored: false,
            anchored_count: 0,
            sobol: true,
            antialiasing: true,
            rays: true,
            acne: false,
            hemisphere: false,
            reflectance_strips: false,
            shading: Shading::Path,
            dielectric_laws: DielectricLaws::Schlick,
        }
    }
}

impl Overrides {
    /// The kernel that carries no more than a job needs.
    pub fn specialised(job: &RenderJob, tables: &Tables<f32>) -> Self {
        let features = job.features();
        let rules = job.rules();
        let listed = tables.opaque.len() + tables.two_root.len();
        let few_spheres = tables.hierarchy.is_none() && listed <= UNIFORM_SPHERES;
        let few_anchored = tables.anchored.len() <= UNIFORM_ANCHORED;
        Overrides {
            lambertian: features.lambertian,
            metal: features.metal,
            fuzz: features.fuzz,
            glass: features.dielectric,
            lens: features.lens,
            two_root: !tables.two_root.is_empty(),
            anchored: !tables.anchored.is_empty(),
            few_spheres,
            opaque_count: if few_spheres { tables.opaque.len() as u32 } else { 0 },
            two_root_count: if few_spheres { tables.two_root.len() as u32 } else { 0 },
            few_anchored,
            anchored_count: if few_anchored { tables.anchored.len() as u32 } else { 0 },
            hierarchy: tables.hierarchy.is_some(),
            rays: features.rays,
            sobol: job.settings().sampler == SamplerKind::Sobol,
            antialiasing: rules.antialiasing,
            acne: rules.surface == Surface::Acne,
            hemisphere: rules.diffuse == Diffuse::Hemisphere,
            reflectance_strips: rules.reflectance_strips,
            shading: rules.shading,
            dielectric_laws: rules.dielectric,
        }
    }

    /// The kernel that leaves out nothing that leaves the job's samples as they are: to measure what
    /// specialising gains.
    pub fn general(job: &RenderJob, tables: &Tables<f32>) -> Self {
        let needed = Overrides::specialised(job, tables);
        Overrides {
            hierarchy: needed.hierarchy,
            rays: needed.rays,
            sobol: needed.sobol,
            antialiasing: needed.antialiasing,
            acne: needed.acne,
            hemisphere: needed.hemisphere,
            reflectance_strips: needed.reflectance_strips,
            shading: needed.shading,
            dielectric_laws: needed.dielectric_laws,
            ..Overrides::default()
        }
    }

    /// Names in the shader and values.
    pub fn constants(&self) -> Vec<(&'static str, Constant)> {
        use Constant::{Flag, Number};
        vec![
            ("LAMBERTIAN", Flag(self.lambertian)),
            ("METAL", Flag(self.metal)),
            ("FUZZ", Flag(self.fuzz)),
            ("GLASS", Flag(self.glass)),
            ("LENS", Flag(self.lens)),
            ("TWO_ROOT", Flag(self.two_root)),
            ("ANCHORED", Flag(self.anchored)),
            ("HIERARCHY", Flag(self.hierarchy)),
            ("FEW_SPHERES", Flag(self.few_spheres)),
            ("OPAQUE_COUNT", Number(self.opaque_count)),
            ("TWO_ROOT_COUNT", Number(self.two_root_count)),
            ("FEW_ANCHORED", Flag(self.few_anchored)),
            ("ANCHORED_COUNT", Number(self.anchored_count)),
            ("SOBOL", Flag(self.sobol)),
            ("ANTIALIASING", Flag(self.antialiasing)),
            ("RAYS", Flag(self.rays)),
            ("ACNE", Flag(self.acne)),
            ("HEMISPHERE", Flag(self.hemisphere)),
            ("REFLECTANCE_STRIPS", Flag(self.reflectance_strips)),
            ("SHADING", Number(shading_tag(self.shading))),
            ("DIELECTRIC_LAWS", Number(laws_tag(self.dielectric_laws))),
        ]
    }

    /// What the kernel contains, for reports: `lambertian, metal, glass, 5 spheres in constants`.
    pub fn summary(&self) -> String {
        let mut words: Vec<String> = [
            (self.lambertian, "lambertian"),
            (self.metal, "metal"),
            (self.fuzz, "fuzz"),
            (self.glass, "glass"),
            (self.lens, "lens"),
            (self.two_root, "two roots"),
            (self.anchored, "anchored"),
            (self.hierarchy, "hierarchy"),
            (self.acne, "acne"),
            (self.hemisphere, "hemisphere"),
            (self.reflectance_strips, "strips"),
        ]
        .into_iter()
        .filter(|(on, _)| *on)
        .map(|(_, word)| word.to_owned())
        .collect();
        if self.few_spheres {
            words.push(format!("{} spheres in constants", self.opaque_count + self.two_root_count));
        }
        words.join(", ")
    }
}

/// A compiled kernel.
#[derive(Clone, Debug)]
pub struct Kernel {
    /// The pipeline.
    pub pipeline: wgpu::ComputePipeline,
    /// What compiling it took.
    pub compile_time: Duration,
}

/// All kernels of a device.
#[derive(Debug, Default)]
pub struct Kernels {
    modules: HashMap<EntryPoint, wgpu::ShaderModule>,
    compiled: HashMap<(EntryPoint, Overrides, u32), Kernel>,
}

impl Kernels {
    /// A kernel, compiled when it is asked for first. `probe` matters to [`EntryPoint::Probe`] alone.
    ///
    /// # Errors
    /// What the device said.
    pub fn get(
        &mut self,
        gpu: &Gpu,
        entry_point: EntryPoint,
        overrides: &Overrides,
        probe: u32,
    ) -> Result<Kernel, String> {
        let key = (entry_point, *overrides, probe);
        if let Some(kernel) = self.compiled.get(&key) {
            return Ok(kernel.clone());
        }
        let start = Instant::now();
        let label = Some(entry_point.name());
        let modules = &mut self.modules;
        let pipeline = gpu.guarded(|| {
            let module = modules.entry(entry_point).or_insert_with(|| {
                let source = wgpu::ShaderSource::Wgsl(source(entry_point).into());
                gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label, source })
            });
            let mut constants: Vec<(&str, f64)> =
                overrides.constants().into_iter().map(|(name, value)| (name, value.value())).collect();
            constants.push(("PROBE", f64::from(probe)));
            gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label,
                layout: Some(&gpu.layouts.pipeline),
                module,
                entry_point: label,
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &constants,
                    ..Default::default()
                },
                cache: None,
            })
        })?;
        let kernel = Kernel { pipeline, compile_time: start.elapsed() };
        self.compiled.insert(key, kernel.clone());
        Ok(kernel)
    }
}
