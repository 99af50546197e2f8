//! From TOML to a recipe.

use super::error::{FileError, Reason, Refusal, refuse};
use super::keyframes::{RawKeyframe, keyframes_of};
use super::materials::{NamedOrInline, RawMaterial, material_of};
use super::named;
use super::numbers::Real;
use super::overflow;
use super::place::{InlineNames, Step, find_place, line_and_column, name_inline_materials, path_of};
use super::settings::{RawSettings, settings_of};
use super::triple::Triple;
use crate::files::{self, ShownPath};
use crate::memory;
use crate::recipe::Recipe;
use crate::render::JobError;
use crate::scene::{Camera, Scene, SceneError, Sky};
use crate::stages::Rules;
use serde::Deserialize;
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
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
    let label = path.shown();
    let bytes = files::read(path, "a scene file", FILE_LIMIT)?;
    if is_wide(&bytes) {
        let remedy = "it looks like UTF-16: save it as UTF-8";
        return Err(FileError::NotText { name: label, line: 1, remedy });
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + good.iter().filter(|byte| **byte == b'\n').count();
        let is_toml = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
        let remedy = if is_toml { "save it as UTF-8" } else { "save it as UTF-8, or name a .toml file" };
        FileError::NotText { name: label.clone(), line, remedy }
    })?;
    let stem = path.file_stem().map_or_else(|| label.clone(), |stem| stem.to_string_lossy().into_owned());
    Ok(Recipe { name: stem, ..parse(&text, &label)? })
}

/// Whether the bytes are text in UTF-16, by its byte order mark or by the zero in the first of its characters.
fn is_wide(bytes: &[u8]) -> bool {
    match bytes {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => true,
        [first, second, ..] => (*first == 0) != (*second == 0),
        _ => false,
    }
}

/// Reads the text of a scene file. `name` becomes the name of the recipe, and messages start with it.
///
/// # Errors
/// [`FileError`] if the text is malformed, or if no picture can be made from it.
pub fn parse(text: &str, name: &str) -> Result<Recipe, FileError> {
    recipe_in(text, name).map_err(|Fault { error, overflow }| match overflow {
        None => *error,
        Some(place) => overflow::explained(*error, text, place, |text| match recipe_in(text, name) {
            Ok(_) => Ok(()),
            Err(fault) => Err(*fault.error),
        }),
    })
}

/// What is wrong with a text, and the place of the number that is too large for the parser, if that is it.
struct Fault {
    error: Box<FileError>,
    overflow: Option<Range<usize>>,
}

impl From<FileError> for Fault {
    fn from(error: FileError) -> Self {
        Fault { error: Box::new(error), overflow: None }
    }
}

fn recipe_in(text: &str, name: &str) -> Result<Recipe, Fault> {
    let values = text.bytes().filter(|byte| b",=[{\n".contains(byte)).count() as u64;
    let bytes = text.len() as u64 + VALUE_BYTES * values;
    let remedy = "use a scene of fewer spheres, or close other programs";
    memory::check(|| format!("reading {name}"), bytes, remedy).map_err(FileError::from)?;
    let raw: RawFile = toml::from_str(text).map_err(|error| {
        let span = error.span().unwrap_or_default();
        let (line, column) = line_and_column(text, span.start);
        let overflow = overflow::is_meant(error.message()).then(|| span.clone());
        let message = match text.get(span) {
            Some(key) if error.message() == DUPLICATE_KEY && !key.trim().is_empty() => {
                format!("{DUPLICATE_KEY} `{}`; keep one of them", key.trim())
            }
            _ => in_toml_words(error.message()),
        };
        let error = FileError::Malformed { name: name.to_owned(), line, column, message };
        Fault { error: Box::new(error), overflow }
    })?;
    recipe_of(raw, name).map_err(|refusal| {
        let (line, column) = line_and_column(text, find_place(text, &refusal.path).start);
        FileError::Refused { name: name.to_owned(), line, column, reason: refusal.reason }.into()
    })
}

/// What the TOML parser says of a key that is there twice; it leaves out which.
const DUPLICATE_KEY: &str = "duplicate key";

/// Replaces Rust's words in serde's messages by TOML's.
fn in_toml_words(message: &str) -> String {
    message
        .replace("unknown field", "unknown key")
        .replace("missing field", "missing key")
        .replace("duplicate field", DUPLICATE_KEY)
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
    vfov_degrees: Real,
    #[serde(default)]
    defocus_angle_degrees: Real,
    focus_distance: Option<Real>,
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
    radius: Real,
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
        vfov_degrees: raw.vfov_degrees.0,
        defocus_angle_degrees: raw.defocus_angle_degrees.0,
        focus_distance: raw.focus_distance.map(|Real(number)| number),
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
        scene.add_sphere(sphere.center.0, sphere.radius.0, material);
    }
    Ok((scene, inline))
}
