//! The data of a page's stages.

use super::sliders::{Slider, sliders};
use crate::kernel::{GpuAside, Tag, WORKGROUP_SIZE, records};
use crate::render::{JobError, RenderJob, RenderSettings};
use crate::render_gpu::shader_source::{EntryPoint, shared};
use crate::render_gpu::{Exported, TURN_LIMIT};
use crate::scene::Camera;
use crate::stages::{Shading, Stage};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use std::collections::BTreeMap;
use thiserror::Error;

/// Why a stage has no data for a browser.
#[derive(Debug, Error)]
pub enum LiveError {
    /// The stage's scene, camera or settings are invalid.
    #[error("the stage {id} is invalid: {error}")]
    Job {
        /// The id of the stage.
        id: String,
        /// What is wrong with it.
        error: JobError,
    },
    /// The kernel cannot run the stage.
    #[error("the stage {id} cannot be prepared: {reason}")]
    Prepare {
        /// The id of the stage.
        id: String,
        /// What is in the way.
        reason: String,
    },
    /// The data could not be written as JSON.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
}

/// Everything that the script reads.
#[derive(Serialize)]
pub(super) struct LiveData {
    programs: Programs,
    constants: Constants,
    /// For each record, the byte offsets of its fields, and its size as an array element as `stride`.
    records: BTreeMap<String, BTreeMap<&'static str, usize>>,
    stages: BTreeMap<&'static str, StageData>,
}

/// The shaders, which all stages share. A module is `shared` followed by the text of its entry point.
#[derive(Serialize)]
struct Programs {
    shared: String,
    path_trace: &'static str,
    resolve: &'static str,
}

/// The numbers of [`crate::kernel`] and `render_gpu` that a host needs.
#[derive(Serialize)]
struct Constants {
    workgroup_size: u32,
    /// Bytes in which a thread puts its path aside.
    aside_size: usize,
    turn_limit: u32,
}

/// A stage.
#[derive(Serialize)]
struct StageData {
    width: u32,
    height: u32,
    /// Samples per pixel.
    samples: u64,
    /// Most rays per path.
    depth: u32,
    /// A `TRANSFER_` tag.
    transfer: u32,
    /// Whether the picture depends on the camera.
    has_rays: bool,
    camera: CameraData,
    /// The origin of the buffers' coordinates, in scene coordinates.
    origin: [f64; 3],
    sliders: Vec<Slider>,
    /// Loop turns over lists for one ray.
    turns_over_lists: u64,
    /// Most samples in a block.
    block_limit: u32,
    /// The values of the pipeline overrides.
    overrides: BTreeMap<String, f64>,
    /// The contents of the buffers of group 0 in base64.
    buffers: [String; 5],
}

/// A [`Camera`] under the names that the script uses; angles in degrees.
#[derive(Serialize)]
struct CameraData {
    from: [f64; 3],
    at: [f64; 3],
    up: [f64; 3],
    vfov: f64,
    defocus: f64,
    /// `None` means the distance from `from` to `at`.
    focus: Option<f64>,
}

impl LiveData {
    pub(super) fn new<'a>(stages: impl IntoIterator<Item = &'a Stage>) -> Result<Self, LiveError> {
        let stages = stages.into_iter().map(|stage| Ok((stage.id, StageData::new(stage)?)));
        let offsets = |(name, size, fields): records::Layout| {
            let fields = fields.into_iter().map(|field| (field.name, field.offset));
            (name, fields.chain([("stride", size)]).collect())
        };
        Ok(LiveData {
            programs: Programs {
                shared: shared(),
                path_trace: EntryPoint::PathTrace.text(),
                resolve: EntryPoint::Resolve.text(),
            },
            constants: Constants {
                workgroup_size: WORKGROUP_SIZE,
                aside_size: size_of::<GpuAside>(),
                turn_limit: TURN_LIMIT,
            },
            records: records::layouts().into_iter().map(offsets).collect(),
            stages: stages.collect::<Result<_, LiveError>>()?,
        })
    }
}

impl StageData {
    fn new(stage: &Stage) -> Result<Self, LiveError> {
        let id = || stage.id.to_owned();
        let recipe = stage.recipe();
        // The page shows no error estimate, so one half is enough.
        let settings = RenderSettings { estimate_error: false, ..recipe.settings };
        let job = RenderJob::new(recipe.scene, recipe.camera, settings, recipe.rules)
            .map_err(|error| LiveError::Job { id: id(), error })?;
        let exported = Exported::new(&job).map_err(|reason| LiveError::Prepare { id: id(), reason })?;
        Ok(StageData {
            width: settings.width,
            height: settings.height,
            samples: recipe.samples_per_pixel,
            depth: settings.max_depth,
            transfer: recipe.rules.transfer.tag(),
            has_rays: recipe.rules.shading != Shading::ImageGradient,
            camera: CameraData::of(&recipe.camera),
            origin: exported.origin.to_array(),
            sliders: sliders(&job, recipe.samples_per_pixel, &exported.scene_index),
            turns_over_lists: exported.turns_over_lists,
            block_limit: exported.block_limit,
            overrides: exported.features.overrides().into_iter().collect(),
            buffers: exported.buffers.map(|bytes| STANDARD.encode(bytes)),
        })
    }
}

impl CameraData {
    fn of(camera: &Camera) -> Self {
        CameraData {
            from: camera.look_from.to_array(),
            at: camera.look_at.to_array(),
            up: camera.vup.to_array(),
            vfov: camera.vfov_degrees,
            defocus: camera.defocus_angle_degrees,
            focus: camera.focus_distance,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, Scene};
    use crate::stages::{Setup, Transfer};
    use glam::DVec3;

    #[test]
    fn only_a_picture_that_traces_no_rays_does_not_depend_on_the_camera() {
        for (shading, has_rays) in [
            (Shading::ImageGradient, false),
            (Shading::FirstHitRed, true),
            (Shading::Normals, true),
            (Shading::Path, true),
        ] {
            let stage = Stage::ALL.iter().find(|stage| stage.setup.rules.shading == shading).unwrap();
            assert_eq!(StageData::new(stage).unwrap().has_rays, has_rays, "{}", stage.id);
        }
    }

    #[test]
    fn a_stage_has_the_numbers_of_its_recipe() {
        for transfer in Transfer::ALL {
            let stage = Stage::ALL.iter().find(|stage| stage.setup.rules.transfer == *transfer).unwrap();
            let (data, setup) = (StageData::new(stage).unwrap(), stage.setup);
            assert_eq!(data.transfer, transfer.tag(), "{}", stage.id);
            assert_eq!((data.width, data.height), (setup.width, setup.height), "{}", stage.id);
            assert_eq!(
                (data.samples, data.depth),
                (setup.samples_per_pixel, setup.max_depth),
                "{}",
                stage.id
            );
        }
    }

    #[test]
    fn a_stage_has_its_camera() {
        let stage = Stage::find("defocus").unwrap();
        let (data, camera) = (StageData::new(stage).unwrap().camera, stage.setup.camera);
        let vectors = [camera.look_from, camera.look_at, camera.vup].map(|vector| vector.to_array());
        assert_eq!([data.from, data.at, data.up], vectors);
        assert_eq!((data.vfov, data.defocus), (camera.vfov_degrees, camera.defocus_angle_degrees));
        assert_eq!(data.focus, camera.focus_distance);
        assert!(data.focus.is_some() && data.defocus > 0.0);
    }

    #[test]
    fn a_scene_far_away_has_an_origin_of_its_own() {
        const AWAY: DVec3 = DVec3::new(4096.0, 0.0, -65_536.0);
        let near = Stage::find("normals").unwrap();
        assert_eq!(StageData::new(near).unwrap().origin, [0.0; 3]);
        let scene = || {
            let mut scene = Scene::default();
            let matte = scene.add_material("matte", Material::Lambertian { albedo: DVec3::splat(0.5) });
            scene.add_sphere(AWAY + DVec3::NEG_Z, 0.5, matte);
            scene
        };
        let book = Camera::BOOK;
        let camera = Camera { look_from: AWAY + book.look_from, look_at: AWAY + book.look_at, ..book };
        let far = Stage { setup: Setup { scene, camera, ..near.setup }, ..*near };
        assert_eq!(StageData::new(&far).unwrap().origin, AWAY.to_array());
    }
}
