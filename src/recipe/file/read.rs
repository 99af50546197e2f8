//! From TOML to a recipe.

use super::error::{FileError, Reason, Step, find_place, line_and_column};
use super::named;
use crate::files;
use crate::memory;
use crate::recipe::{DEFAULT_SAMPLES_PER_PIXEL, Recipe};
use crate::render::{DEPTH_LIMIT, JobError, RenderSettings, SAMPLE_LIMIT, SIZE_LIMIT, SamplerKind};
use crate::scene::{Camera, Material, Scene, SceneError, Sky};
use crate::stages::Rules;
use glam::DVec3;
use serde::de::{self, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::collections::{BTreeMap, HashMap};
use std::fmt;
use std::path::Path;
use std::sync::Arc;
use toml::Spanned;

/// Most bytes of a scene file: ten million spheres take about as many.
const FILE_LIMIT: u64 = 1 << 30;

/// What a value, key or line of a scene file takes while it is read, at most: measured with listed spheres, which take
/// the most, and with the shortest values.
const VALUE_BYTES: u64 = 260;

/// Reads a scene file; the recipe has the name of the file without its ending.
///
/// # Errors
/// [`FileError`] for a file that cannot be read, is malformed, or of which no picture can be made.
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

/// Reads the text of a scene file. `name` becomes the recipe's and stands in messages.
///
/// # Errors
/// [`FileError`] for a text that is malformed or of which no picture can be made.
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

/// serde speaks of Rust; the reader of the message wrote TOML.
fn in_toml_words(message: &str) -> String {
    message
        .replace("unknown field", "unknown key")
        .replace("missing field", "missing key")
        .replace("duplicate field", "duplicate key")
        .replace("expected f64", "expected a number")
        .replace("expected i64", "expected a whole number")
}

struct Refusal {
    path: Vec<Step>,
    reason: Reason,
}

fn refuse(path: &[&str], reason: impl Into<Reason>) -> Refusal {
    Refusal { path: path.iter().map(|key| Step::Key((*key).to_owned())).collect(), reason: reason.into() }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawFile {
    /// A built-in scene in place of the next three.
    scene: Option<String>,
    scene_mark: Option<String>,
    sky: Option<RawSky>,
    materials: Option<BTreeMap<Spanned<String>, RawMaterial>>,
    spheres: Option<Vec<RawSphere>>,
    camera: RawCamera,
    #[serde(default)]
    render: RawRender,
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

/// Whole numbers as TOML has them, so that any that is out of range is refused with its limits.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct RawRender {
    width: Option<i64>,
    height: Option<i64>,
    samples_per_pixel: Option<i64>,
    max_depth: Option<i64>,
    sampler: Option<SamplerKind>,
    seed: Option<i64>,
    estimate_error: Option<bool>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct RawSky {
    bottom: Option<Triple>,
    top: Option<Triple>,
}

/// The keys of all kinds; which of them belong is checked afterwards, for clearer messages.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawMaterial {
    kind: String,
    albedo: Option<Triple>,
    fuzz: Option<f64>,
    refraction_index: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawSphere {
    center: Triple,
    radius: f64,
    material: NamedOrInline,
}

enum NamedOrInline {
    Named(String),
    Inline(RawMaterial),
}

impl<'de> Deserialize<'de> for NamedOrInline {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = NamedOrInline;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(
                    "a material's name or a table such as { kind = \"metal\", albedo = [0.8, 0.8, 0.8] }",
                )
            }
            fn visit_str<E: de::Error>(self, name: &str) -> Result<NamedOrInline, E> {
                Ok(NamedOrInline::Named(name.to_owned()))
            }
            fn visit_string<E: de::Error>(self, name: String) -> Result<NamedOrInline, E> {
                Ok(NamedOrInline::Named(name))
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<NamedOrInline, A::Error> {
                RawMaterial::deserialize(de::value::MapAccessDeserializer::new(map))
                    .map(NamedOrInline::Inline)
            }
        }
        deserializer.deserialize_any(Either)
    }
}

/// Exactly three numbers.
struct Triple(DVec3);

impl<'de> Deserialize<'de> for Triple {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Three;
        impl<'de> Visitor<'de> for Three {
            type Value = Triple;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("three numbers, such as [0.0, 1.0, 0.0]")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut array: A) -> Result<Triple, A::Error> {
                let mut v = DVec3::ZERO;
                for index in 0..3 {
                    let length = || de::Error::invalid_length(index, &self);
                    v[index] = array.next_element()?.ok_or_else(length)?;
                }
                let mut count = 3;
                while array.next_element::<IgnoredAny>()?.is_some() {
                    count += 1;
                }
                if count == 3 { Ok(Triple(v)) } else { Err(de::Error::invalid_length(count, &self)) }
            }
        }
        deserializer.deserialize_seq(Three)
    }
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
    let recipe = Recipe {
        name: name.to_owned(),
        scene,
        camera: camera_of(&raw.camera),
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

/// The scene of this name; one of another mark is not that which the file was made with.
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

fn settings_of(raw: &RawRender) -> Result<(RenderSettings, u64), Refusal> {
    let whole = |key: &'static str, value: Option<i64>, default: u64, limits: [u64; 2], remedy| match value {
        None => Ok(default),
        Some(value) => u64::try_from(value)
            .ok()
            .filter(|value| (limits[0]..=limits[1]).contains(value))
            .ok_or_else(|| {
                let [lowest, highest] = limits;
                refuse(&["render", key], Reason::Whole { what: key, value, lowest, highest, remedy })
            }),
    };
    let small = |key, value, default: u32, limits: [u32; 2], remedy| {
        let wide = whole(key, value, u64::from(default), limits.map(u64::from), remedy)?;
        Ok(u32::try_from(wide).unwrap_or(limits[1]))
    };
    let default = RenderSettings::default();
    let size = [1, SIZE_LIMIT];
    let settings = RenderSettings {
        width: small("width", raw.width, default.width, size, "give pixels, such as 800")?,
        height: small("height", raw.height, default.height, size, "give pixels, such as 450")?,
        max_depth: small(
            "max_depth",
            raw.max_depth,
            default.max_depth,
            [1, DEPTH_LIMIT],
            "50 rays a path is the book's",
        )?,
        sampler: raw.sampler.unwrap_or(default.sampler),
        seed: small("seed", raw.seed, default.seed, [0, u32::MAX], "any such number will do")?,
        estimate_error: raw.estimate_error.unwrap_or(default.estimate_error),
    };
    let samples = whole(
        "samples_per_pixel",
        raw.samples_per_pixel,
        DEFAULT_SAMPLES_PER_PIXEL,
        [1, SAMPLE_LIMIT],
        "100 give a first impression",
    )?;
    Ok((settings, samples))
}

/// Names that inline materials were given, and the spheres that hold them.
type InlineNames = HashMap<String, usize>;

fn listed_scene(
    sky: Sky,
    raw_materials: BTreeMap<Spanned<String>, RawMaterial>,
    raw_spheres: Vec<RawSphere>,
) -> Result<(Scene, InlineNames), Refusal> {
    let mut scene = Scene { sky, ..Scene::default() };
    // In the order of the file, not of the alphabet.
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

/// The material, or the key that is wrong and why.
fn material_of(raw: &RawMaterial, what: &str) -> Result<Material, (&'static str, Reason)> {
    let missing =
        |kind, key, example| (key, Reason::MissingKey { what: what.to_owned(), kind, key, example });
    let none_of =
        |kind, keys, foreign: &[(&'static str, bool)]| match foreign.iter().find(|(_, is_there)| *is_there) {
            None => Ok(()),
            Some((key, _)) => Err((*key, Reason::ForeignKey { what: what.to_owned(), kind, key, keys })),
        };
    let albedo = |kind| match &raw.albedo {
        Some(albedo) => Ok(albedo.0),
        None => Err(missing(kind, "albedo", "albedo = [0.5, 0.5, 0.5]")),
    };
    let (has_albedo, has_fuzz) = (("albedo", raw.albedo.is_some()), ("fuzz", raw.fuzz.is_some()));
    let has_index = ("refraction_index", raw.refraction_index.is_some());
    match raw.kind.as_str() {
        "lambertian" => {
            none_of("lambertian", "albedo", &[has_fuzz, has_index])?;
            Ok(Material::Lambertian { albedo: albedo("lambertian")? })
        }
        "metal" => {
            none_of("metal", "albedo and fuzz", &[has_index])?;
            Ok(Material::Metal { albedo: albedo("metal")?, fuzz: raw.fuzz.unwrap_or(0.0) })
        }
        "dielectric" => {
            none_of("dielectric", "refraction_index", &[has_albedo, has_fuzz])?;
            let missing = || missing("dielectric", "refraction_index", "refraction_index = 1.5");
            Ok(Material::Dielectric { refraction_index: raw.refraction_index.ok_or_else(missing)? })
        }
        kind => Err(("kind", Reason::UnknownKind { what: what.to_owned(), kind: kind.to_owned() })),
    }
}

/// A scene knows materials by name only; says instead which sphere of the file holds the one that is meant.
fn name_inline_materials(error: JobError, inline: &InlineNames) -> JobError {
    let renamed = |what: String| match split_material(&what) {
        Some((name, key)) => match inline.get(name) {
            Some(sphere) => format!("spheres[{sphere}].material.{key}"),
            None => what,
        },
        None => what,
    };
    match error {
        JobError::Scene(SceneError::NotFinite { what, value }) => {
            SceneError::NotFinite { what: renamed(what), value }.into()
        }
        JobError::Scene(SceneError::OutOfRange { what, value, limit, remedy }) => {
            SceneError::OutOfRange { what: renamed(what), value, limit, remedy }.into()
        }
        JobError::Scene(SceneError::Colour { what, value, limit }) => {
            SceneError::Colour { what: renamed(what), value, limit }.into()
        }
        other => other,
    }
}

/// Name and key of `materials.NAME.KEY`, where the name may hold dots, and the key an axis.
fn split_material(what: &str) -> Option<(&str, &str)> {
    let rest = what.strip_prefix("materials.")?;
    let key_start = ["albedo", "fuzz", "refraction_index"]
        .into_iter()
        .filter_map(|key| rest.rfind(&format!(".{key}")))
        .max()?;
    Some((&rest[..key_start], &rest[key_start + 1..]))
}

/// Where in the file the value stands that an error is about.
fn path_of(error: &JobError) -> Vec<Step> {
    let keys = |keys: &[&str]| keys.iter().map(|key| Step::Key((*key).to_owned())).collect();
    match error {
        JobError::Size { what, .. } => keys(&["render", what]),
        JobError::Depth { .. } => keys(&["render", "max_depth"]),
        JobError::Scene(SceneError::NoDirection { .. }) => keys(&["camera", "look_at"]),
        JobError::Scene(SceneError::DuplicateMaterial { name }) => keys(&["materials", name]),
        JobError::Scene(SceneError::MissingMaterial { sphere, .. }) => {
            vec![Step::Key("spheres".to_owned()), Step::Index(*sphere), Step::Key("material".to_owned())]
        }
        JobError::Scene(
            SceneError::NotFinite { what, .. }
            | SceneError::OutOfRange { what, .. }
            | SceneError::Colour { what, .. },
        ) => path_of_value(what),
    }
}

/// The same for the words that [`SceneError`] has for a place.
fn path_of_value(what: &str) -> Vec<Step> {
    let key = |key: &str| Step::Key(key.to_owned());
    if let Some((name, rest)) = split_material(what) {
        let mut path = vec![key("materials"), key(name)];
        path.extend(rest.split('.').map(key));
        return path;
    }
    if let Some((index, rest)) = what.strip_prefix("spheres[").and_then(|rest| rest.split_once("].")) {
        let mut path = vec![key("spheres")];
        path.extend(index.parse().ok().map(Step::Index));
        path.extend(rest.split('.').map(key));
        return path;
    }
    if what.starts_with("sky.") {
        return what.split('.').map(key).collect();
    }
    // "look_from.x" and "focus_distance (that from look_from to look_at)" alike.
    let first = what.split(['.', ' ']).next().unwrap_or(what);
    vec![key("camera"), key(first)]
}
