//! From a recipe to TOML.

use super::named::{mark, name_of};
use super::table;
use crate::job::recipe::Recipe;
use crate::job::render::RenderSettings;
use crate::scene::animation::Keyframe;
use crate::scene::{Camera, NamedMaterial, Parameter, Scene, Sphere, toml_key, toml_string};
use crate::stages::Rules;
use glam::DVec3;

/// More spheres than these are a table, which comes first in the file.
const LIST_LIMIT: usize = 40;

/// The recipe as a scene file, without its name. Numbers have the fewest digits that give the same bits again.
///
/// A recipe that is not valid is written as it is; reading it back reports what is wrong.
pub fn to_toml(recipe: &Recipe) -> String {
    let Scene { materials, spheres, sky } = &*recipe.scene;
    let table = (spheres.len() > LIST_LIMIT).then(|| table::to_value(&recipe.scene)).flatten();
    let mut text = String::new();
    if let Some(table) = &table {
        text += "# Camera, render settings, sky and materials follow the spheres.\nspheres = ";
        text += table;
        text += "\n\n";
    }
    text += &settings(recipe);
    let (bottom, top) = (vector(sky.bottom), vector(sky.top));
    text += &format!("\n[sky] # radiance, linear RGB\nbottom = {bottom}\ntop = {top}\n");
    if !materials.is_empty() {
        text.push_str("\n[materials]\n");
        text.extend(materials.iter().map(material_line));
    }
    if table.is_some() {
        return text;
    }
    for Sphere { center, radius, material } in spheres {
        let (center, radius) = (vector(*center), number(*radius));
        let material = toml_string(materials.get(*material).map_or("", |named| &named.name));
        text += &format!("\n[[spheres]]\ncenter = {center}\nradius = {radius}\nmaterial = {material}\n");
    }
    text
}

/// Like [`to_toml`], for the description of a picture: a large, unchanged built-in field is named, not listed.
pub fn to_picture_toml(recipe: &Recipe) -> String {
    let Some(name) = name_of(&recipe.scene) else { return to_toml(recipe) };
    let (name, mark) = (toml_string(&name), toml_string(&mark(&recipe.scene)));
    let count = recipe.scene.spheres.len();
    format!("scene = {name} # {count} spheres\nscene_mark = {mark}\n\n{}", settings(recipe))
}

/// Everything but the scene.
fn settings(recipe: &Recipe) -> String {
    let mut text = format!("[camera] # lengths in scene units\n{}", camera_keys(&recipe.camera));
    for Keyframe { frame, camera } in &recipe.keyframes {
        text += &format!("\n[[keyframes]]\nframe = {frame}\n{}", camera_keys(camera));
    }
    let RenderSettings { width, height, max_depth, sampler, seed } = recipe.settings;
    let (samples, sampler) = (recipe.samples_per_pixel, sampler.name());
    text += &format!(
        "\n[render]\nwidth = {width} # pixels\nheight = {height}\nsamples_per_pixel = {samples}\nmax_depth = {max_depth} # \
         rays of a path\nsampler = \"{sampler}\"\nseed = {seed}\n"
    );
    text + &rules(&recipe.rules)
}

fn camera_keys(camera: &Camera) -> String {
    let Camera { look_from, look_at, vup, vfov_degrees, defocus_angle_degrees, focus_distance } = camera;
    let vectors = [("look_from", look_from), ("look_at", look_at), ("vup", vup)];
    let numbers = [("vfov_degrees", vfov_degrees), ("defocus_angle_degrees", defocus_angle_degrees)];
    let focus = focus_distance.as_ref().map(|distance| ("focus_distance", distance));
    let vectors = vectors.map(|(key, value)| format!("{key} = {}\n", vector(*value)));
    let numbers =
        numbers.into_iter().chain(focus).map(|(key, value)| format!("{key} = {}\n", number(*value)));
    vectors.into_iter().chain(numbers).collect()
}

/// Only the rules that differ from the finished renderer's.
fn rules(rules: &Rules) -> String {
    let table = |rules: &Rules| toml::Table::try_from(rules).unwrap_or_default();
    let finished = table(&Rules::FINISHED);
    let different = table(rules).into_iter().filter(|(key, value)| finished.get(key) != Some(value));
    let lines: String = different.map(|(key, value)| format!("{key} = {value}\n")).collect();
    if lines.is_empty() {
        return lines;
    }
    format!("\n[rules] # where they differ from the finished renderer's\n{lines}")
}

fn material_line(NamedMaterial { name, material }: &NamedMaterial) -> String {
    let keys = material.parameters().into_iter().map(|(key, parameter)| match parameter {
        Parameter::Number(value) => format!("{key} = {}", number(value)),
        Parameter::Colour(colour) => format!("{key} = {}", vector(colour)),
    });
    let keys = keys.collect::<Vec<_>>().join(", ");
    format!("{} = {{ kind = \"{}\", {keys} }}\n", toml_key(name), material.kind())
}

fn vector(v: DVec3) -> String {
    format!("[{}, {}, {}]", number(v.x), number(v.y), number(v.z))
}

/// Rust's shortest form, which TOML can read, except for NaN.
fn number(x: f64) -> String {
    if x.is_nan() { "nan".to_owned() } else { format!("{x:?}") }
}
