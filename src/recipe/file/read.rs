//! From TOML to a recipe.

use super::error::{FileError, Reason, Refusal, refuse};
use super::keyframes::{RawKeyframe, keyframes_of};
use super::materials::{NamedOrInline, RawMaterial, material_of};
use super::named;
use super::place::{InlineNames, Step, find_place, line_and_column, name_inline_materials, path_of};
use super::settings::{RawSettings, settings_of};
use super::triple::Triple;
use crate::files;
use crate::memory;
use crate::recipe::Recipe;
use crate::render::JobError;
use crate::scene::{Camera, Scene, SceneError, Sky};
use crate::stages::Rules;
use serde::Deserialize;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::sync::Arc;
use toml::Spanned;

/// Longest scene file, bytes. Ten million spheres take about as many.
const FILE_LIMIT: u64 = 1 << 30;

/// Most bytes of memory per value, key or line of a scene file while it is read. Measured with listed spheres, which need
/// the most, and with the shortest values.
const VALUE_BYTES: u64 = 260;

/// Reads a scene file. The recipe is named after the file, without its extension.
///
/// # Errors
/// [`FileError`] if the file cannot be read or is malformed, or if no picture can be made from it.
pub fn load(path: &Path) -> Result<Recipe, FileError> {
    let label = path.display().to_string();
    let bytes = files::read(path, "a scene file", FILE_LIMIT)?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + good.iter().filter(|byte| **byte == b'\n').count();
        FileError::NotText { name: label.clone(), line }
    })?;
    let stem = path.file_stem().map_or_else(|| label.clone(), |stem| stem.to_string_lossy().into_owned());
    Ok(Recipe { name: stem, ..parse(&text, &label)? })
}

/// Reads the text of a scene file. `name` becomes the name of the recipe, and messages start with it.
///
/// # Errors
/// [`FileError`] if the text is malformed, or if no picture can be made from it.
pub fn parse(text: &str, name: &str) -> Result<Recipe, FileError> {
    let values = text.bytes().filter(|byte| b",=[{\n".contains(byte)).count() as u64;
    let bytes = text.len() as u64 + VALUE_BYTES * values;
    memory::check(
        || format!("reading {name}"),
        bytes,
        "use a scene of fewer spheres, or close other programs",
    )?;
    let raw: RawFile = toml::from_str(text).map_err(|error| {
        let (line, column) = line_and_column(text, error.span().map_or(0, |span| span.start));
        FileError::Malformed { name: name.to_owned(), line, column, message: in_toml_words(error.message()) }
    })?;
    recipe_of(raw, name).map_err(|refusal| {
        let (line, column) = line_and_column(text, find_place(text, &refusal.path).start);
        FileError::Refused { name: name.to_owned(), line, column, reason: refusal.reason }
    })
}

/// Replaces Rust's words in serde's messages by TOML's.
fn in_toml_words(message: &str) -> String {
    message
        .replace("unknown field", "unknown key")
        .replace("missing field", "missing key")
        .replace("duplicate field", "duplicate key")
        .replace("expected f64", "expected a number")
        .replace("expected i64", "expected a whole number")
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawFile {
    /// A built-in scene, instead of sky, materials and spheres.
    scene: Option<String>,
    scene_mark: Option<String>,
    sky: Option<RawSky>,
    materials: Option<BTreeMap<Spanned<String>, RawMaterial>>,
    spheres: Option<Vec<RawSphere>>,
    camera: RawCamera,
    #[serde(default)]
    keyframes: Vec<RawKeyframe>,
    #[serde(default)]
    render: RawSettings,
    #[serde(default)]
    rules: Rules,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCamera {
    look_from: Triple,
    look_at: Triple,
    vup: Option<Triple>,
    vfov_degrees: f64,
    #[serde(default)]
    defocus_angle_degrees: f64,
    focus_distance: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct RawSky {
    bottom: Option<Triple>,
    top: Option<Triple>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawSphere {
    center: Triple,
    radius: f64,
    material: NamedOrInline,
}

fn recipe_of(raw: RawFile, name: &str) -> Result<Recipe, Refusal> {
    let (settings, samples_per_pixel) = settings_of(&raw.render)?;
    let (scene, inline) = match raw.scene {
        Some(builtin) => {
            let parts = [
                ("sky", raw.sky.is_some()),
                ("materials", raw.materials.is_some()),
                ("spheres", raw.spheres.is_some()),
            ];
            if let Some((part, _)) = parts.into_iter().find(|(_, is_there)| *is_there) {
                return Err(refuse(&[part], Reason::BesideScene { part }));
            }
            (builtin_scene(&builtin, raw.scene_mark)?, InlineNames::new())
        }
        None => {
            let sky = sky_of(raw.sky.unwrap_or_default());
            let (scene, inline) =
                listed_scene(sky, raw.materials.unwrap_or_default(), raw.spheres.unwrap_or_default())?;
            (Arc::new(scene), inline)
        }
    };
    let camera = camera_of(&raw.camera);
    let recipe = Recipe {
        name: name.to_owned(),
        scene,
        camera,
        keyframes: keyframes_of(&raw.keyframes, &camera)?,
        settings,
        rules: raw.rules,
        samples_per_pixel,
    };
    recipe.check_samples().map_err(|error| refuse(&["render", "samples_per_pixel"], error))?;
    recipe.job().map_err(|error| {
        let error = name_inline_materials(error, &inline);
        Refusal { path: path_of(&error), reason: error.into() }
    })?;
    Ok(recipe)
}

fn sky_of(raw: RawSky) -> Sky {
    let default = Sky::default();
    Sky {
        bottom: raw.bottom.map_or(default.bottom, |colour| colour.0),
        top: raw.top.map_or(default.top, |colour| colour.0),
    }
}

/// The built-in scene of this name. Refused if its mark differs from that in the file.
fn builtin_scene(name: &str, mark: Option<String>) -> Result<Arc<Scene>, Refusal> {
    let scene = Recipe::find(name).map_err(|error| refuse(&["scene"], error))?.scene;
    match mark {
        Some(mark) if mark != named::mark(&scene) => {
            Err(refuse(&["scene_mark"], Reason::OtherScene { name: name.to_owned() }))
        }
        _ => Ok(scene),
    }
}

fn camera_of(raw: &RawCamera) -> Camera {
    Camera {
        look_from: raw.look_from.0,
        look_at: raw.look_at.0,
        vup: raw.vup.as_ref().map_or(Camera::BOOK.vup, |vup| vup.0),
        vfov_degrees: raw.vfov_degrees,
        defocus_angle_degrees: raw.defocus_angle_degrees,
        focus_distance: raw.focus_distance,
    }
}

fn listed_scene(
    sky: Sky,
    raw_materials: BTreeMap<Spanned<String>, RawMaterial>,
    raw_spheres: Vec<RawSphere>,
) -> Result<(Scene, InlineNames), Refusal> {
    let mut scene = Scene { sky, ..Scene::default() };
    // In the order of the file; the map has sorted them by name.
    let mut named: Vec<_> = raw_materials.into_iter().collect();
    named.sort_by_key(|(name, _)| name.span().start);
    let mut index_of = HashMap::with_capacity(named.len());
    for (name, raw) in named {
        let name = name.into_inner();
        let material = material_of(&raw, &format!("materials.{name}"))
            .map_err(|(key, reason)| refuse(&["materials", &name, key], reason))?;
        index_of.insert(name.clone(), scene.add_material(name, material));
    }
    let mut inline = InlineNames::new();
    scene.spheres.reserve_exact(raw_spheres.len());
    for (index, sphere) in raw_spheres.into_iter().enumerate() {
        let in_sphere = |keys: &[&str], reason: Reason| {
            let mut path = vec![Step::Key("spheres".into()), Step::Index(index)];
            path.extend(keys.iter().map(|key| Step::Key((*key).to_owned())));
            Refusal { path, reason }
        };
        let material = match sphere.material {
            NamedOrInline::Named(material) => *index_of.get(&material).ok_or_else(|| {
                let error = SceneError::MissingMaterial { sphere: index, material };
                in_sphere(&["material"], JobError::from(error).into())
            })?,
            NamedOrInline::Inline(raw) => {
                let material = material_of(&raw, &format!("spheres[{index}].material"))
                    .map_err(|(key, reason)| in_sphere(&["material", key], reason))?;
                let mut name = format!("sphere-{index}");
                while index_of.contains_key(&name) {
                    name.push('*');
                }
                inline.insert(name.clone(), index);
                let place = scene.add_material(name.clone(), material);
                index_of.insert(name, place);
                place
            }
        };
        scene.add_sphere(sphere.center.0, sphere.radius, material);
    }
    Ok((scene, inline))
}
