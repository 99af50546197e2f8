//! From TOML to a recipe: serde checks the form, [`recipe_of`] the values.

use super::growing::GrowingScene;
use super::named;
use super::table::{Table, text_of};
use crate::job::recipe::{DEFAULT_SAMPLES_PER_PIXEL, Recipe};
use crate::job::render::{DEPTH_LIMIT, RenderSettings, SAMPLE_LIMIT, SIZE_LIMIT, SamplerKind};
use crate::scene::animation::{FRAME_LIMIT, Keyframe};
use crate::scene::{Camera, Material, Scene, Sky};
use crate::stages::Rules;
use crate::system::files::{self, ShownPath};
use crate::system::memory;
use anyhow::{Result, anyhow};
use glam::DVec3;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::fmt::{self, Display};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use toml::Spanned;

/// Longest scene file, bytes.
const FILE_LIMIT: u64 = 1 << 30;

/// Maximum bytes of memory per value, key or line of a scene file while it is read. Measured with listed spheres, which
/// need the most, and with the shortest values.
const VALUE_BYTES: u64 = 260;

/// The text of a scene file.
struct Source<'a> {
    text: &'a str,
    /// How messages name it.
    name: &'a str,
    /// Where its table is, if it names one.
    directory: Option<&'a Path>,
}

impl<'a> Source<'a> {
    /// The line of a byte, from 1, and the text before the byte on that line.
    fn line_at(&self, byte: usize) -> (usize, &'a str) {
        let before = self.text.get(..byte).unwrap_or(self.text);
        (1 + before.matches('\n').count(), before.rsplit('\n').next().unwrap_or_default())
    }

    /// An error at this place, with line and column in characters from 1.
    fn refuse(&self, place: Range<usize>, reason: impl Display) -> anyhow::Error {
        let (line, before) = self.line_at(place.start);
        anyhow!("{}:{line}:{}: {reason}", self.name, 1 + before.chars().count())
    }
}

/// Reads a scene file. The recipe is named after the file, without its extension.
///
/// # Errors
/// If the file cannot be read or is malformed, or if no picture can be made from it; with the line and what to do.
pub fn load(path: &Path) -> Result<Recipe> {
    let label = path.shown();
    let bytes = files::read(path, "a scene file", FILE_LIMIT)?;
    let text = text_of(path, bytes)?;
    let stem = path.file_stem().map_or_else(|| label.clone(), |stem| stem.to_string_lossy().into_owned());
    let directory = path.parent().unwrap_or(Path::new(""));
    let source = Source { text: &text, name: &label, directory: Some(directory) };
    Ok(Recipe { name: stem, ..read(&source)? })
}

/// Reads the text of a scene file. `name` becomes the name of the recipe, and messages start with it.
///
/// # Errors
/// If the text is malformed, or if no picture can be made from it; with the line and what to do.
pub fn parse(text: &str, name: &str) -> Result<Recipe> {
    read(&Source { text, name, directory: None })
}

fn read(source: &Source) -> Result<Recipe> {
    let Source { text, name, .. } = source;
    let outside_tables = text.split("'''").step_by(2).flat_map(str::bytes);
    let values = outside_tables.filter(|byte| b",=[{\n".contains(byte)).count() as u64;
    // A table is copied.
    let bytes = 2 * text.len() as u64 + VALUE_BYTES * values;
    let remedy = "use a scene of fewer spheres, or close other programs";
    memory::check(|| format!("reading {name}"), bytes, remedy)?;
    let raw = toml::from_str(text).map_err(|error| {
        let place = error.span().unwrap_or_default();
        let mut reason = toml_message(error);
        if has_decimal_comma(text, place.start) {
            reason += "; write a point in a number, not a comma";
        }
        if text.trim_start().starts_with(['{', '<', '%', '\0']) {
            reason += "; a scene file is TOML, as --save-scene FILE.toml writes it";
        }
        source.refuse(place, reason)
    })?;
    source.recipe(raw)
}

/// Whether the line at `place` has a comma between two digits outside a list.
fn has_decimal_comma(text: &str, place: usize) -> bool {
    let start = text.get(..place).and_then(|before| before.rfind('\n')).map_or(0, |end| end + 1);
    let line = text[start..].lines().next().unwrap_or_default();
    let is_comma = |three: &[u8]| matches!(three, [b'0'..=b'9', b',', b'0'..=b'9']);
    !line.contains('[') && line.as_bytes().windows(3).any(is_comma)
}

/// Puts a TOML error on one line, with the key's path and without Rust's terms.
fn toml_message(mut error: toml::de::Error) -> String {
    error.set_input(None);
    [
        ("unknown field", "unknown key"),
        ("missing field", "missing key"),
        ("duplicate field", "duplicate key"),
        ("unknown variant", "unknown value"),
        (" as i128", ""),
        ("invalid type: map", "invalid type: table"),
        ("expected a sequence", "expected a list"),
        ("expected i64", "expected a whole number"),
        ("expected f64", "expected a number"),
        ("\n", " "),
    ]
    .iter()
    .fold(in_its_place(&error).unwrap_or(error.to_string().trim_end().to_owned()), |text, (from, to)| {
        text.replace(from, to)
    })
}

/// Where an unknown key belongs, if another table has it. The structs below list the keys: serde names them for a key
/// that is in none.
fn in_its_place(error: &toml::de::Error) -> Option<String> {
    fn keys<'a, T: Deserialize<'a>>(text: &'a str) -> String {
        let unknown = toml::from_str::<T>(text).err().map(|error| error.message().to_owned());
        unknown.unwrap_or_default().rsplit("expected").next().unwrap_or_default().to_owned()
    }
    const IN_MATERIAL: &str = "in a material of a kind that has it";
    let key = error.message().strip_prefix("unknown field ")?.split(',').next()?;
    let place = match key {
        "`scene`" | "`scene_mark`" | "`spheres`" => "above the first [table]",
        "`frame`" => "in [[keyframes]]",
        "`kind`" => IN_MATERIAL,
        _ => [
            (keys::<RawFile>("''=0"), "in square brackets, as a table of its own"),
            (keys::<RawCamera>("''=0"), "in [camera]"),
            (keys::<RawSettings>("''=0"), "in [render]"),
            (keys::<RawSky>("''=0"), "in [sky]"),
            (keys::<RawSphere>("''=0"), "in [[spheres]]"),
            (keys::<Material>("kind='metal'\n''=0"), IN_MATERIAL),
            (keys::<Material>("kind='dielectric'\n''=0"), IN_MATERIAL),
        ]
        .iter()
        .find_map(|(keys, place)| keys.contains(key).then_some(*place))?,
    };
    let text = error.to_string();
    let here = text.trim_end().rsplit_once('\n').map_or("here", |(_, here)| here);
    Some(format!("unknown key {key} {here}; write it {place}"))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawFile {
    /// A built-in scene, instead of sky, materials and spheres.
    scene: Option<Spanned<String>>,
    scene_mark: Option<Spanned<String>>,
    sky: Option<Spanned<RawSky>>,
    materials: Option<BTreeMap<Spanned<String>, Material>>,
    spheres: Option<Spanned<RawSpheres>>,
    camera: Spanned<RawCamera>,
    #[serde(default)]
    keyframes: Vec<Spanned<RawCamera>>,
    #[serde(default)]
    render: RawSettings,
    #[serde(default)]
    rules: Rules,
}

/// Exactly three numbers; glam and arrays would ignore a fourth.
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "Vec<f64>")]
struct Triple(DVec3);

impl TryFrom<Vec<f64>> for Triple {
    type Error = String;

    fn try_from(numbers: Vec<f64>) -> Result<Self, String> {
        let form = "expected three numbers with points, such as [0.0, 1.5, 0.0], but found";
        <[f64; 3]>::try_from(numbers)
            .map(|numbers| Triple(numbers.into()))
            .map_err(|numbers| format!("{form} {}", numbers.len()))
    }
}

/// A whole number from `LOWEST` to `HIGHEST`.
#[derive(Deserialize)]
#[serde(try_from = "i64")]
struct Whole<const LOWEST: i64, const HIGHEST: i64>(i64);

impl<const LOWEST: i64, const HIGHEST: i64> TryFrom<i64> for Whole<LOWEST, HIGHEST> {
    type Error = String;

    fn try_from(number: i64) -> Result<Self, String> {
        let is_within = (LOWEST..=HIGHEST).contains(&number);
        is_within.then_some(Whole(number)).ok_or(format!("{number} is not between {LOWEST} and {HIGHEST}"))
    }
}

type Size = Option<Whole<1, { SIZE_LIMIT as i64 }>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct RawSky {
    bottom: Option<Triple>,
    top: Option<Triple>,
}

enum RawSpheres {
    Listed(Vec<Spanned<RawSphere>>),
    /// A table, or the name of its file.
    Table(String),
}

impl<'de> Deserialize<'de> for RawSpheres {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = RawSpheres;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str(
                    "a list of spheres, [[spheres]] for each, or above the first [table] a table of them, spheres = \"FILE.csv\"",
                )
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Self::Value, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(list)).map(RawSpheres::Listed)
            }

            fn visit_str<E>(self, text: &str) -> Result<Self::Value, E> {
                Ok(RawSpheres::Table(text.to_owned()))
            }
        }
        deserializer.deserialize_any(Either)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct RawSphere {
    center: Triple,
    radius: f64,
    /// The name of a material, or the table of one.
    material: toml::Value,
}

/// `[camera]`, or a keyframe, in which omitted keys are as in `[camera]`, except for the focus distance: without it, the
/// focus is on `look_at`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct RawCamera {
    frame: Option<Whole<0, { FRAME_LIMIT as i64 - 1 }>>,
    look_from: Option<Triple>,
    look_at: Option<Triple>,
    vup: Option<Triple>,
    vfov_degrees: Option<f64>,
    defocus_angle_degrees: Option<f64>,
    focus_distance: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct RawSettings {
    width: Size,
    height: Size,
    samples_per_pixel: Option<Whole<1, { SAMPLE_LIMIT as i64 }>>,
    max_depth: Option<Whole<1, { DEPTH_LIMIT as i64 }>>,
    sampler: Option<SamplerKind>,
    seed: Option<Whole<0, { u32::MAX as i64 }>>,
    estimate_error: Option<Spanned<bool>>,
}

impl Source<'_> {
    /// Checks every value here, where its position in the text is known.
    fn recipe(&self, raw: RawFile) -> Result<Recipe> {
        let scene = match raw.scene {
            Some(scene) if raw.sky.is_some() || raw.materials.is_some() || raw.spheres.is_some() => {
                let reason = "sky, materials and spheres cannot be combined with scene, which has its own; remove one of them";
                return Err(self.refuse(scene.span(), reason));
            }
            Some(scene) => self.builtin_scene(&scene, raw.scene_mark.as_ref())?,
            None => {
                let mut scene = self.painted_scene(self.sky(raw.sky)?, raw.materials.unwrap_or_default())?;
                let line = raw.spheres.as_ref().map_or(1, |spheres| self.line_at(spheres.span().start).0);
                match raw.spheres.map(Spanned::into_inner) {
                    Some(RawSpheres::Listed(spheres)) => self.add_listed(spheres, &mut scene)?,
                    Some(RawSpheres::Table(text)) => {
                        Table::open(text, line, self.name, self.directory)?.add_to(&mut scene)?;
                    }
                    None => {}
                }
                Arc::new(scene.scene)
            }
        };
        if raw.camera.get_ref().frame.is_some() {
            return Err(self.refuse(raw.camera.span(), "unknown key `frame` here; write it in [[keyframes]]"));
        }
        let camera = self.camera(&raw.camera, None)?;
        let (default, own) = (RenderSettings::default(), raw.render);
        if let Some(value) = own.estimate_error.filter(|value| !value.get_ref()) {
            return Err(self.refuse(value.span(), "the error is always estimated; remove this line"));
        }
        Ok(Recipe {
            name: self.name.to_owned(),
            scene,
            camera,
            keyframes: self.keyframes(raw.keyframes, &camera)?,
            settings: RenderSettings {
                width: own.width.map_or(default.width, |Whole(pixels)| pixels as u32),
                height: own.height.map_or(default.height, |Whole(pixels)| pixels as u32),
                max_depth: own.max_depth.map_or(default.max_depth, |Whole(rays)| rays as u32),
                sampler: own.sampler.unwrap_or(default.sampler),
                seed: own.seed.map_or(default.seed, |Whole(seed)| seed as u32),
            },
            rules: raw.rules,
            samples_per_pixel: own
                .samples_per_pixel
                .map_or(DEFAULT_SAMPLES_PER_PIXEL, |Whole(samples)| samples as u64),
        })
    }

    /// The built-in scene of this name. Refused if its mark differs from that in the file.
    fn builtin_scene(&self, name: &Spanned<String>, mark: Option<&Spanned<String>>) -> Result<Arc<Scene>> {
        let scene = Recipe::find(name.get_ref()).map_err(|error| self.refuse(name.span(), error))?.scene;
        if let Some(mark) = mark.filter(|mark| *mark.get_ref() != named::mark(&scene)) {
            let reason = format!(
                "the built-in scene {:?} has changed since this file was made; use the version that made it, or remove \
                 scene_mark to use the current scene",
                name.get_ref()
            );
            return Err(self.refuse(mark.span(), reason));
        }
        Ok(scene)
    }

    fn sky(&self, raw: Option<Spanned<RawSky>>) -> Result<Sky> {
        let mut sky = Sky::default();
        if let Some(raw) = raw {
            let RawSky { bottom, top } = raw.get_ref();
            sky.bottom = bottom.map_or(sky.bottom, |Triple(colour)| colour);
            sky.top = top.map_or(sky.top, |Triple(colour)| colour);
            sky.validate().map_err(|error| self.refuse(raw.span(), error))?;
        }
        Ok(sky)
    }

    /// A scene without spheres.
    fn painted_scene(
        &self,
        sky: Sky,
        materials: BTreeMap<Spanned<String>, Material>,
    ) -> Result<GrowingScene> {
        let mut scene = GrowingScene::default();
        scene.scene.sky = sky;
        // Restore the file's order; the map sorted them by name.
        let mut named: Vec<_> = materials.into_iter().collect();
        named.sort_by_key(|(name, _)| name.span().start);
        for (name, material) in named {
            let place = name.span();
            let name = name.into_inner();
            material.validate(format_args!("materials.{name}")).map_err(|error| self.refuse(place, error))?;
            scene.add_material(name, material);
        }
        Ok(scene)
    }

    fn add_listed(&self, spheres: Vec<Spanned<RawSphere>>, scene: &mut GrowingScene) -> Result<()> {
        scene.scene.spheres.reserve_exact(spheres.len());
        for sphere in spheres {
            let place = sphere.span();
            add_sphere(sphere.into_inner(), scene).map_err(|reason| self.refuse(place, reason))?;
        }
        Ok(())
    }

    /// The camera. `base` has the values of missing keys; without it, some keys are required.
    fn camera(&self, raw: &Spanned<RawCamera>, base: Option<&Camera>) -> Result<Camera> {
        let (place, raw) = (raw.span(), raw.get_ref());
        let required = [
            ("look_from", raw.look_from.is_some()),
            ("look_at", raw.look_at.is_some()),
            ("vfov_degrees", raw.vfov_degrees.is_some()),
        ];
        if let Some((key, _)) = required.iter().find(|(_, is_there)| base.is_none() && !is_there) {
            return Err(self.refuse(place, format!("missing key `{key}`")));
        }
        let base = base.unwrap_or(&Camera::BOOK);
        let vector = |own: Option<Triple>, base: DVec3| own.map_or(base, |Triple(vector)| vector);
        let camera = Camera {
            look_from: vector(raw.look_from, base.look_from),
            look_at: vector(raw.look_at, base.look_at),
            vup: vector(raw.vup, base.vup),
            vfov_degrees: raw.vfov_degrees.unwrap_or(base.vfov_degrees),
            defocus_angle_degrees: raw.defocus_angle_degrees.unwrap_or(base.defocus_angle_degrees),
            focus_distance: raw.focus_distance,
        };
        camera.validate().map_err(|error| self.refuse(place, error))?;
        Ok(camera)
    }

    /// The keyframes, completed from `camera`.
    fn keyframes(&self, raw: Vec<Spanned<RawCamera>>, camera: &Camera) -> Result<Vec<Keyframe>> {
        let mut keyframes: Vec<Keyframe> = Vec::with_capacity(raw.len());
        for raw in raw {
            let Some(Whole(frame)) = raw.get_ref().frame else {
                return Err(self.refuse(raw.span(), "missing key `frame`"));
            };
            let frame = frame as u32;
            if let Some(before) = keyframes.last().filter(|before| before.frame >= frame) {
                let reason = format!(
                    "frame is {frame}, but the keyframe before it has {}; list keyframes in ascending order, each frame \
                 once",
                    before.frame
                );
                return Err(self.refuse(raw.span(), reason));
            }
            keyframes.push(Keyframe { frame, camera: self.camera(&raw, Some(camera))? });
        }
        Ok(keyframes)
    }
}

fn add_sphere(sphere: RawSphere, scene: &mut GrowingScene) -> Result<(), String> {
    let RawSphere { center: Triple(center), radius, material } = sphere;
    let index = scene.scene.spheres.len();
    let what = format_args!("spheres[{index}].material");
    let material = match material {
        toml::Value::String(name) => scene.material(&name)?,
        table @ toml::Value::Table(_) => {
            let material = Material::deserialize(table);
            scene.own_material(material.map_err(|error| format!("{what}: {}", toml_message(error)))?)?
        }
        other => {
            return Err(format!(
                "{what} is {other}, but must be a material's name or a table such as {{ kind = \"metal\", albedo = [0.8, 0.8, \
                 0.8] }}"
            ));
        }
    };
    scene.add_sphere(center, radius, material)
}
