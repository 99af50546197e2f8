//! Data with which a browser runs a stage: the shaders, their buffers, and the numbers that a reader can change.
//!
//! A page has `assets/live.css` in `<style>`, `scene.js`, `film.js` and `live.js` from there in `<script
//! type="module">`, and [`live_data`] in `<script type="application/json" id="live-data">` or in `later.js` beside it.
//! The script adds a switch to each `.panel[data-stage]`. A page opened from disk may use WebGPU, too.

mod sliders;
mod state;

pub use state::{filled, set};

use anyhow::{Context, Result};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Map, Value, json};
use sliders::sliders;
use weekender::film::PixelSum;
use weekender::job::render::RenderJob;
use weekender::kernel::{GpuSuspendedPath, Tag, WORKGROUP_SIZE, records};
use weekender::render_gpu::shader_source::{EntryPoint, shared};
use weekender::render_gpu::{
    BUDGET_LIMITS, BUSY_THREADS_OF_SOFTWARE, Exported, FIRST_PATHS, GROWTH_LIMIT, ITERATION_LIMIT,
    SOFTWARE_THREADS_IN_STEP,
};
use weekender::stages::Stage;

/// Target time of a dispatch in a browser, which can show a picture after each.
const DISPATCH_MS: f64 = 20.0;

/// Maximum number of threads in a dispatch in a browser; each can suspend its path.
const THREAD_LIMIT: u32 = 1 << 18;

/// Everything that the script reads, as JSON that is safe inside a `<script>` element.
///
/// # Errors
/// If a stage cannot be rendered.
pub fn live_data<'a>(stages: impl IntoIterator<Item = &'a Stage>) -> Result<String> {
    let stages = stages.into_iter().map(|stage| {
        let data = stage_data(stage).with_context(|| format!("the stage {} cannot be prepared", stage.id))?;
        Ok((stage.id.to_owned(), data))
    });
    let data = json!({
        // A module is `shared` followed by the text of its entry point.
        "programs": {
            "shared": shared(),
            "path_trace": EntryPoint::PathTrace.text(),
            "resolve": EntryPoint::Resolve.text(),
        },
        "constants": {
            "workgroup_size": WORKGROUP_SIZE,
            "suspended_size": size_of::<GpuSuspendedPath>(),
            "pixel_size": size_of::<PixelSum>(),
            "iteration_limit": ITERATION_LIMIT,
            "thread_limit": THREAD_LIMIT,
            "dispatch_ms": DISPATCH_MS,
            "first_paths": FIRST_PATHS,
            "growth_limit": GROWTH_LIMIT,
            "budget_limits": BUDGET_LIMITS,
            "software_busy_threads": BUSY_THREADS_OF_SOFTWARE,
            "software_threads_in_step": SOFTWARE_THREADS_IN_STEP,
        },
        "records": records::layouts().into_iter().map(record).collect::<Map<_, _>>(),
        "stages": stages.collect::<Result<Map<_, _>>>()?,
    });
    // Only strings contain these characters, and HTML would end the element there or start a comment.
    Ok(data.to_string().replace("</", "<\\/").replace("<!--", "\\u003c!--"))
}

/// A record's field offsets in bytes, and its size as an array element as `stride`.
fn record((name, size, fields): records::Layout) -> (String, Value) {
    let fields = fields.into_iter().map(|field| (field.name.to_owned(), field.offset.into()));
    (name, Value::Object(fields.chain([("stride".to_owned(), size.into())]).collect()))
}

fn stage_data(stage: &Stage) -> Result<Value> {
    let recipe = stage.recipe();
    let (settings, camera, rules) = (recipe.settings, recipe.camera, recipe.rules);
    let job = RenderJob::new(recipe.scene, camera, settings, rules)?;
    let exported = Exported::new(&job);
    let overrides = exported.features.overrides().into_iter().map(|(name, value)| (name, value.into()));
    Ok(json!({
        "width": settings.width,
        "height": settings.height,
        "samples": recipe.samples_per_pixel,
        "depth": settings.max_depth,
        "transfer": rules.transfer.tag(),
        // Whether the picture depends on the camera.
        "has_rays": rules.has_rays(),
        "camera": {
            "from": camera.look_from.to_array(),
            "at": camera.look_at.to_array(),
            "up": camera.vup.to_array(),
            // Degrees.
            "vfov": camera.vfov_degrees,
            "defocus": camera.defocus_angle_degrees,
            // Null means the distance from `from` to `at`.
            "focus": camera.focus_distance,
        },
        // The origin of the buffers' coordinates, in scene coordinates.
        "origin": exported.origin.to_array(),
        "sliders": sliders(&job, recipe.samples_per_pixel, &exported.scene_index),
        // Iterations over lists for one ray.
        "iterations_over_lists": exported.iterations_over_lists,
        // Maximum number of samples per block.
        "block_limit": exported.block_limit,
        "overrides": overrides.collect::<Map<_, _>>(),
        // Contents of the buffers of group 0.
        "buffers": exported.buffers.map(|bytes| STANDARD.encode(bytes)),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stage_data_matches_recipe() {
        for stage in Stage::ALL {
            let (data, setup) = (stage_data(stage).unwrap(), stage.setup);
            assert_eq!([&data["width"], &data["height"]], [setup.width, setup.height], "{}", stage.id);
            assert_eq!(data["samples"], setup.samples_per_pixel, "{}", stage.id);
            assert_eq!(data["depth"], setup.max_depth, "{}", stage.id);
            assert_eq!(data["transfer"], setup.rules.transfer.tag(), "{}", stage.id);
            let [from, at] =
                [setup.camera.look_from, setup.camera.look_at].map(|point| json!(point.to_array()));
            assert_eq!([&data["camera"]["from"], &data["camera"]["at"]], [&from, &at], "{}", stage.id);
        }
    }
}
