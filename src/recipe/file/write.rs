//! From a recipe to TOML.

use super::named::{mark, name_of};
use crate::animation::Keyframe;
use crate::recipe::Recipe;
use crate::render::{RenderSettings, SettingValue};
use crate::scene::{Camera, Parameter, Scene, Sphere, toml_key, toml_string};
use crate::stages::Rules;
use glam::DVec3;
use std::fmt::Write;

/// With more spheres than this, each takes one line, and they come first in the file.
const LONG_FORM_LIMIT: usize = 40;

/// The recipe as a scene file, without its name. Numbers have the fewest digits that give the same bits again.
///
/// A recipe that is not valid is written as it is; reading it back reports what is wrong.
pub fn to_toml(recipe: &Recipe) -> String {
    let mut text = String::with_capacity(1000 + 100 * recipe.scene.spheres.len());
    // Writing to a string cannot fail.
    let _ = write_listed(&mut text, recipe);
    text
}

/// Like [`to_toml`], for the description of a picture: a large, unchanged built-in field is named, not listed.
pub fn to_picture_toml(recipe: &Recipe) -> String {
    let Some(name) = name_of(&recipe.scene) else { return to_toml(recipe) };
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_named(&mut text, recipe, &name);
    text
}

fn write_named(out: &mut String, recipe: &Recipe, name: &str) -> std::fmt::Result {
    writeln!(out, "scene = {} # {} spheres", toml_string(name), recipe.scene.spheres.len())?;
    writeln!(out, "scene_mark = {}\n", toml_string(&mark(&recipe.scene)))?;
    write_camera(out, &recipe.camera)?;
    write_keyframes(out, &recipe.keyframes)?;
    write_render(out, recipe)?;
    write_rules(out, &recipe.rules)
}

fn write_listed(out: &mut String, recipe: &Recipe) -> std::fmt::Result {
    let is_long = recipe.scene.spheres.len() > LONG_FORM_LIMIT;
    if is_long {
        writeln!(out, "# Camera, render settings, sky and materials follow the spheres.")?;
        write_sphere_lines(out, &recipe.scene)?;
        writeln!(out)?;
    }
    write_camera(out, &recipe.camera)?;
    write_keyframes(out, &recipe.keyframes)?;
    write_render(out, recipe)?;
    write_rules(out, &recipe.rules)?;
    let sky = recipe.scene.sky;
    writeln!(out, "\n[sky] # radiance, linear RGB")?;
    writeln!(out, "bottom = {}", vector(sky.bottom))?;
    writeln!(out, "top = {}", vector(sky.top))?;
    write_materials(out, &recipe.scene)?;
    if !is_long {
        for sphere in &recipe.scene.spheres {
            writeln!(out, "\n[[spheres]]")?;
            writeln!(out, "center = {}", vector(sphere.center))?;
            writeln!(out, "radius = {}", number(sphere.radius))?;
            writeln!(out, "material = {}", toml_string(material_name(&recipe.scene, sphere)))?;
        }
    }
    Ok(())
}

fn write_camera(out: &mut String, camera: &Camera) -> std::fmt::Result {
    writeln!(out, "[camera] # lengths in scene units")?;
    write_camera_keys(out, camera)
}

fn write_keyframes(out: &mut String, keyframes: &[Keyframe]) -> std::fmt::Result {
    for Keyframe { frame, camera } in keyframes {
        writeln!(out, "\n[[keyframes]]\nframe = {frame}")?;
        write_camera_keys(out, camera)?;
    }
    Ok(())
}

fn write_camera_keys(out: &mut String, camera: &Camera) -> std::fmt::Result {
    writeln!(out, "look_from = {}", vector(camera.look_from))?;
    writeln!(out, "look_at = {}", vector(camera.look_at))?;
    writeln!(out, "vup = {}", vector(camera.vup))?;
    writeln!(out, "vfov_degrees = {}", number(camera.vfov_degrees))?;
    writeln!(out, "defocus_angle_degrees = {}", number(camera.defocus_angle_degrees))?;
    match camera.focus_distance {
        Some(distance) => writeln!(out, "focus_distance = {}", number(distance)),
        None => Ok(()),
    }
}

fn write_render(out: &mut String, recipe: &Recipe) -> std::fmt::Result {
    let settings = &recipe.settings;
    writeln!(out, "\n[render]")?;
    writeln!(out, "width = {} # pixels", settings.width)?;
    writeln!(out, "height = {}", settings.height)?;
    writeln!(out, "samples_per_pixel = {}", recipe.samples_per_pixel)?;
    for named in RenderSettings::NAMED {
        let value = match (named.value)(settings) {
            SettingValue::Number(number) => number.to_string(),
            SettingValue::Name(name) => toml_string(name),
            SettingValue::Switch(is_on) => is_on.to_string(),
        };
        let comment = if named.comment.is_empty() { String::new() } else { format!(" # {}", named.comment) };
        writeln!(out, "{} = {value}{comment}", named.key)?;
    }
    Ok(())
}

/// Writes only the rules that differ from the finished renderer's.
fn write_rules(out: &mut String, rules: &Rules) -> std::fmt::Result {
    let table = |rules: &Rules| toml::Table::try_from(rules).unwrap_or_default();
    let finished = table(&Rules::FINISHED);
    let different: Vec<_> =
        table(rules).into_iter().filter(|(key, value)| finished.get(key) != Some(value)).collect();
    if different.is_empty() {
        return Ok(());
    }
    writeln!(out, "\n[rules] # where they differ from the finished renderer's")?;
    different.iter().try_for_each(|(key, value)| writeln!(out, "{key} = {value}"))
}

fn write_materials(out: &mut String, scene: &Scene) -> std::fmt::Result {
    if scene.materials.is_empty() {
        return Ok(());
    }
    writeln!(out, "\n[materials]")?;
    for named in &scene.materials {
        let keys = named.material.parameters().into_iter().map(|(key, parameter)| match parameter {
            Parameter::Number(value) => format!("{key} = {}", number(value)),
            Parameter::Colour(colour) => format!("{key} = {}", vector(colour)),
        });
        let keys = keys.collect::<Vec<_>>().join(", ");
        writeln!(out, "{} = {{ kind = \"{}\", {keys} }}", toml_key(&named.name), named.material.kind())?;
    }
    Ok(())
}

fn write_sphere_lines(out: &mut String, scene: &Scene) -> std::fmt::Result {
    writeln!(out, "spheres = [")?;
    for sphere in &scene.spheres {
        let (center, radius) = (vector(sphere.center), number(sphere.radius));
        let material = toml_string(material_name(scene, sphere));
        writeln!(out, "  {{ center = {center}, radius = {radius}, material = {material} }},")?;
    }
    writeln!(out, "]")
}

fn material_name<'a>(scene: &'a Scene, sphere: &Sphere) -> &'a str {
    scene.materials.get(sphere.material).map_or("", |named| &named.name)
}

fn vector(v: DVec3) -> String {
    format!("[{}, {}, {}]", number(v.x), number(v.y), number(v.z))
}

/// Rust's shortest form, which TOML can read, except for NaN.
fn number(x: f64) -> String {
    if x.is_nan() { "nan".to_owned() } else { format!("{x:?}") }
}
