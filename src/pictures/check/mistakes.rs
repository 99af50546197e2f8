//! The table of mistakes that readers of the book are known to make: explanation, where each can show, and how to
//! render it.

use super::bytes::{is_same_seed, is_times_255, is_truncated};
use super::hypothesis::{Hypothesis, Mistake, Shows};
use super::tracer::Random;
use crate::job::output::Encoding;
use crate::job::recipe::Recipe;
use crate::scene::{Material, Scene};
use crate::stages::{DielectricLaws, Diffuse, Shading, SurfaceRule, Transfer};
use glam::DVec3;
use std::sync::Arc;

const BRIGHTER: &str = "nothing is wrong, but it is brighter than the book's picture, which takes the square root in write_color";

const SAME_POINT: &str = "use one point twice: ray(ray_origin, pixel_sample - ray_origin)";

/// Each row: id, the section to reread, title, remedy, in which recipes and where it can show, and how to render it.
macro_rules! mistakes {
    ($($id:literal, $section:literal, $title:literal, $remedy:expr, $applies:expr, $shows:expr, $($change:expr),*;)*) => {
        /// All mistakes, those of the file and the camera first.
        pub static MISTAKES: &[Mistake] = &[$(Mistake {
            id: $id, section: $section, title: $title, remedy: $remedy, applies: $applies, shows: $shows,
            changes: &[$($change),*],
        }),*];
    };
}

mistakes! {
    "flipped-rows", "2.2", "the rows are upside down",
        "write the top row first: count j upwards from 0, and let viewport_v point down (0, -viewport_height, 0)",
        always, Shows::InBlocks, |it| it.written.is_flipped = true;
    "mirrored-columns", "12.2", "left and right are swapped",
        "let viewport_u point right; with look_from and look_at, u = unit_vector(cross(vup, w)) in this order",
        always, Shows::InBlocks, |it| it.written.is_mirrored = true;
    "swapped-channels", "3.1", "the colour channels are swapped",
        "write red, green, blue in this order; check x, y, z of the colour and formats that want BGR",
        always, Shows::InBlocks, |it| swap(it, [2, 1, 0]), |it| swap(it, [1, 0, 2]), |it| swap(it, [0, 2, 1]),
        |it| swap(it, [1, 2, 0]), |it| swap(it, [2, 0, 1]);
    "no-gamma", "9.5", "gamma is missing",
        "take the square root of each channel in write_color, after dividing by the samples",
        has_gamma, Shows::InBlocks, |it| it.written.curve = Encoding::Gamma(1.0);
    "gamma-early", "9.5", "gamma is applied, though this section does not have it yet",
        "nothing is wrong if you have read on; section 9.5 adds the square root",
        |recipe| recipe.rules.transfer == Transfer::Linear,
        Shows::InBlocks, |it| it.written.curve = Encoding::Gamma(2.0);
    "gamma-twice", "9.5", "gamma is applied twice",
        "take the square root once: either in write_color or in your picture library, which may write sRGB from \
         linear values",
        has_gamma, Shows::InBlocks, |it| it.written.curve = Encoding::Gamma(4.0);
    "gamma-2.2", "9.5", "the curve is gamma 2.2, not the square root",
        BRIGHTER, has_gamma, Shows::InBlocks, |it| it.written.curve = Encoding::Gamma(2.2);
    "gamma-srgb", "9.5", "the curve is that of sRGB, not the square root",
        BRIGHTER, has_gamma, Shows::InBlocks, |it| it.written.curve = Encoding::Srgb;
    "wraps-to-0", "8.2", "the brightest values become 0",
        "clamp before the conversion: int(256 * clamp(x, 0, 0.999)); 256 does not fit into a byte, where it becomes 0",
        always, Shows::InBlocks, |it| it.written.wraps = true;
    "scale-255", "8.2", "channels are multiplied by 255 and cut off",
        "use int(256 * clamp(x, 0, 0.999)), or 255.999: with 255, only a value of exactly 1 becomes 255",
        always, Shows::InBytes(is_times_255), |it| it.written.levels = 255.0;
    "truncated", "3.1", "channels are cut to whole numbers before they are scaled",
        "scale first, then convert: int(256 * x), not int(x) * 256; divide as floating-point numbers",
        always, Shows::InBytes(is_truncated),;
    "no-antialiasing", "8.2", "all samples pass through the centre of the pixel",
        "add a random offset within -0.5..0.5 to i and j for each sample", |recipe| recipe.rules.antialiasing,
        Shows::AtEdges, |it| it.recipe.rules.antialiasing = false;
    "half-pixel-up", "4.2", "the picture is shifted by half a pixel, down and to the right",
        "let pixel00_loc be the centre of the first pixel: the upper left corner plus 0.5 * (pixel_delta_u + \
         pixel_delta_v)",
        has_rays, Shows::AtEdges, |it| it.plain().first_pixel = 0.0;
    "half-pixel-down", "8.2", "the picture is shifted by half a pixel, up and to the left",
        "draw the offsets of a sample from -0.5..0.5, not from 0..1: pixel00_loc is already the pixel's centre",
        has_rays, Shows::AtEdges, |it| it.plain().first_pixel = 1.0;
    "width-less-one", "4.2", "pixels are spaced by the width less one",
        "divide the viewport by image_width and image_height; older editions had image_width - 1",
        has_rays, Shows::AtEdges, |it| it.plain().spacings = |pixels| pixels - 1.0;
    "integer-aspect", "4.2", "the aspect ratio is a whole number",
        "divide as floating-point numbers: double(image_width) / image_height, and 16.0 / 9.0",
        has_rays, Shows::InBlocks, |it| it.plain().aspect = |width, height| (width / height).max(1).into();
    "vfov-radians", "12.1", "the field of view is used as radians",
        "convert it first: theta = degrees_to_radians(vfov)",
        has_rays, Shows::InBlocks, |it| {
            let vfov = &mut it.recipe.camera.vfov_degrees;
            *vfov = 2.0 * (*vfov / 2.0).tan().abs().atan().to_degrees();
        };
    "sky-reversed", "4.2", "the sky is upside down",
        "blend (1 - a) * white + a * blue, with a = 0.5 * (unit_direction.y + 1)",
        has_rays, Shows::InBlocks, |it| {
            let sky = &mut Arc::make_mut(&mut it.recipe.scene).sky;
            std::mem::swap(&mut sky.bottom, &mut sky.top);
        };
    "half-b-sign", "6.2", "the quadratic formula has the wrong sign",
        "with oc = center - origin, h = dot(direction, oc) and the roots are (h - sqrtd) / a and (h + sqrtd) / a; \
         with oc = origin - center, they are (-h - sqrtd) / a and (-h + sqrtd) / a",
        |recipe| has_rays(recipe) && has_spheres(recipe),
        Shows::InBlocks, |it| it.plain().roots = |a, h, sqrtd| [(-h - sqrtd) / a, (-h + sqrtd) / a];
    "last-hit-wins", "6.5", "the last sphere in the list hides nearer ones",
        "pass interval(ray_t.min, closest_so_far) to hit, and set closest_so_far = temp_rec.t after each hit",
        |recipe| has_rays(recipe) && recipe.scene.spheres.len() > 1,
        Shows::InBlocks, |it| it.plain().t_max = |_| f64::INFINITY;
    "zero-t-min", "9.3", "rays hit the surface that they start on (shadow acne)",
        "let hits begin at 0.001: world.hit(r, interval(0.001, infinity), rec)",
        |recipe| has_bounces(recipe) && recipe.rules.surface != SurfaceRule::Acne,
        Shows::InBlocks, |it| it.plain().t_min = Some(0.0);
    "normal-not-unit", "6.1", "the normal does not have length 1",
        "divide by the radius: outward_normal = (rec.p - center) / radius",
        |recipe| has_rays(recipe) && has_spheres(recipe),
        Shows::InBlocks, |it| it.plain().normal = |to_point, _| to_point;
    "normals-not-flipped", "6.4", "the normal is not turned against the ray inside a sphere",
        "call rec.set_face_normal(r, outward_normal) in sphere::hit, and use rec.front_face in dielectric::scatter",
        has_glass, Shows::InBlocks, |it| it.plain().is_front = |_, _| true;
    "hemisphere", "9.4", "matte surfaces scatter uniformly over the hemisphere",
        "let the direction be rec.normal + random_unit_vector()",
        |recipe| has_matte(recipe, Diffuse::Lambertian),
        Shows::InBlocks, |it| it.recipe.rules.diffuse = Diffuse::Hemisphere;
    "lambertian-early", "9.4", "matte surfaces are Lambertian, though this section is uniform over the hemisphere",
        "nothing is wrong if you have read on; section 9.4 adds it",
        |recipe| has_matte(recipe, Diffuse::Hemisphere),
        Shows::InBlocks, |it| it.recipe.rules.diffuse = Diffuse::Lambertian;
    "point-in-sphere", "9.4", "matte surfaces scatter to a point in the unit sphere, not on it",
        "normalise the random vector: rec.normal + random_unit_vector()",
        |recipe| has_matte(recipe, Diffuse::Lambertian),
        Shows::InBlocks, |it| it.plain().diffuse = Random::in_unit_sphere;
    "bounce-limit", "9.2", "paths end after too few bounces",
        "set max_depth to 50, and pass depth - 1 to the next call only",
        has_bounces, Shows::InBlocks, |it| limit(it, 1), |it| limit(it, 2), |it| limit(it, 3), |it| limit(it, 4),
        |it| limit(it, 5), |it| limit(it, 6), |it| limit(it, 8), |it| limit(it, 10), |it| limit(it, 15);
    "fuzz-missing", "10.6", "fuzz has no effect",
        "add fuzz * random_unit_vector() to the reflected direction, and store fuzz in the constructor",
        has_fuzz, Shows::InBlocks, |it| materials(it, |material| {
            if let Material::Metal { fuzz, .. } = material {
                *fuzz = 0.0;
            }
        });
    "fuzz-unnormalised", "10.6", "fuzz is added to a reflected direction of another length than 1",
        "normalise first: reflected = unit_vector(reflected) + (fuzz * random_unit_vector())",
        has_fuzz, Shows::InBlocks, |it| it.plain().before_fuzz = |direction| direction;
    "refract-unnormalised", "11.2", "the direction is not normalised before it is refracted or reflected",
        "use unit_direction = unit_vector(r_in.direction()) for cos_theta, refract and reflect",
        has_glass, Shows::InBlocks, |it| it.plain().before_glass = |direction| direction;
    "index-inverted", "11.2", "the refraction index is inverted",
        "write ri = rec.front_face ? (1.0 / refraction_index) : refraction_index",
        has_glass, Shows::InBlocks, |it| materials(it, invert);
    "glass-black", "11.2", "glass is black",
        "set attenuation = color(1.0, 1.0, 1.0) in dielectric::scatter, and return true",
        has_glass, Shows::InBlocks, |it| materials(it, |material| {
            if let Material::Dielectric { .. } = material {
                *material = Material::Lambertian { albedo: DVec3::ZERO };
            }
        });
    "glass-swapped", "11.3", "glass reflects where it should refract, and refracts where it should reflect",
        "if (cannot_refract || reflectance(cos_theta, ri) > random_double()) reflect, else refract",
        |recipe| has_glass(recipe) && recipe.rules.dielectric != DielectricLaws::RefractOnly,
        Shows::InBlocks, |it| it.plain().swaps_glass = true;
    "always-refract", "11.3", "glass refracts even where Snell's law has no solution",
        "reflect if ri * sin_theta > 1.0",
        |recipe| has_glass(recipe) && recipe.rules.dielectric != DielectricLaws::RefractOnly,
        Shows::InBlocks, |it| it.recipe.rules.dielectric = DielectricLaws::RefractOnly;
    "schlick-missing", "11.4", "glass does not reflect at grazing angles (Schlick's approximation)",
        "also reflect if reflectance(cos_theta, ri) > random_double()",
        |recipe| has_glass(recipe) && recipe.rules.dielectric == DielectricLaws::Schlick,
        Shows::InBlocks, |it| it.recipe.rules.dielectric = DielectricLaws::TotalReflection;
    "hollow-missing", "11.5", "the sphere of air inside the glass sphere is missing",
        "add a sphere of radius 0.4 at the same place, of dielectric(1.00 / 1.50)",
        has_bubble, Shows::InBlocks, |it| {
            let scene = Arc::make_mut(&mut it.recipe.scene);
            if let Some(index) = bubble(scene) {
                scene.spheres.remove(index);
            }
        };
    "hollow-index", "11.5", "the sphere inside the glass sphere is glass, too",
        "the inner sphere is air in glass: dielectric(1.00 / 1.50)",
        has_bubble, Shows::InBlocks, |it| {
            let scene = Arc::make_mut(&mut it.recipe.scene);
            if let Some(index) = bubble(scene) {
                invert(&mut scene.materials[scene.spheres[index].material].material);
            }
        };
    "lens-centre", "13.2", "all rays start at the centre of the lens",
        "let ray_origin = (defocus_angle <= 0) ? center : defocus_disk_sample(), and subtract it from pixel_sample",
        has_lens, Shows::InBlocks, |it| it.recipe.camera.defocus_angle_degrees = 0.0;
    "lens-origin", "13.2", "rays start at the centre of the lens, but are aimed from another point of it",
        SAME_POINT,
        has_lens, Shows::InBlocks, |it| it.plain().lens = |eye, on_lens, target| [eye, target - on_lens];
    "lens-aim", "13.2", "rays start anywhere on the lens, but are aimed from its centre",
        SAME_POINT,
        has_lens, Shows::InBlocks, |it| it.plain().lens = |eye, on_lens, target| [on_lens, target - eye];
    "focus-distance-one", "13.2", "the plane in focus is 1 away",
        "use focus_dist for the viewport: viewport_height = 2 * h * focus_dist, and center - focus_dist * w",
        has_lens, Shows::InBlocks, |it| it.recipe.camera.focus_distance = Some(1.0);
    "same-seed", "9.1", "every pixel uses the same random numbers",
        "seed the generator once, before the loops, not for each pixel",
        |recipe| recipe.rules.antialiasing && has_bounces(recipe),
        Shows::InNoise(is_same_seed), |it| it.plain().random = |_| 0;
}

pub fn applying_to(recipe: &Recipe) -> impl Iterator<Item = &'static Mistake> {
    MISTAKES.iter().filter(|mistake| (mistake.applies)(recipe))
}

fn swap(picture: &mut Hypothesis, order: [usize; 3]) {
    let names = order.map(|channel| ["red", "green", "blue"][channel]).join(", ");
    picture.note = Some(format!("the channels seem to be {names}"));
    picture.written.channels = order;
}

/// Cuts paths off at `limit` rays, if they may be longer.
fn limit(picture: &mut Hypothesis, limit: u32) {
    picture.note = Some(format!("it looks as with max_depth = {limit}"));
    let max_depth = &mut picture.recipe.settings.max_depth;
    *max_depth = limit.min(*max_depth);
}

fn materials(picture: &mut Hypothesis, change: fn(&mut Material)) {
    Arc::make_mut(&mut picture.recipe.scene)
        .materials
        .iter_mut()
        .for_each(|named| change(&mut named.material));
}

fn invert(material: &mut Material) {
    if let Material::Dielectric { refraction_index } = material {
        *refraction_index = refraction_index.recip();
    }
}

fn always(_: &Recipe) -> bool {
    true
}

fn has_gamma(recipe: &Recipe) -> bool {
    recipe.rules.transfer == Transfer::Gamma2
}

fn has_rays(recipe: &Recipe) -> bool {
    recipe.rules.shading != Shading::ImageGradient
}

fn has_spheres(recipe: &Recipe) -> bool {
    !recipe.scene.spheres.is_empty()
}

fn has_bounces(recipe: &Recipe) -> bool {
    recipe.rules.shading == Shading::Path && has_spheres(recipe)
}

fn has_material(recipe: &Recipe, is_so: impl Fn(&Material) -> bool) -> bool {
    recipe.rules.shading == Shading::Path && recipe.scene.materials.iter().any(|named| is_so(&named.material))
}

fn has_glass(recipe: &Recipe) -> bool {
    has_material(recipe, |material| matches!(material, Material::Dielectric { .. }))
}

fn has_fuzz(recipe: &Recipe) -> bool {
    has_material(recipe, |material| material.effective_fuzz() > 0.0)
}

fn has_matte(recipe: &Recipe, diffuse: Diffuse) -> bool {
    recipe.rules.diffuse == diffuse
        && has_material(recipe, |material| matches!(material, Material::Lambertian { .. }))
}

fn has_bubble(recipe: &Recipe) -> bool {
    has_glass(recipe) && bubble(&recipe.scene).is_some()
}

fn has_lens(recipe: &Recipe) -> bool {
    recipe.camera.defocus_angle_degrees > 0.0
}

/// Index of the air bubble inside a glass sphere.
pub(super) fn bubble(scene: &Scene) -> Option<usize> {
    let index = |material: usize| match scene.materials.get(material).map(|named| named.material) {
        Some(Material::Dielectric { refraction_index }) => Some(refraction_index),
        _ => None,
    };
    scene.spheres.iter().position(|inner| {
        let mut around =
            scene.spheres.iter().filter(|outer| outer.radius > inner.radius && outer.center == inner.center);
        index(inner.material).is_some_and(|index| index < 1.0)
            && around.any(|outer| index(outer.material).is_some())
    })
}
