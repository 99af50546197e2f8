//! The table of mistakes that readers of the book are known to make: explanation, where each can show, and how to
//! render it.

use super::bytes::{is_same_seed, is_times_255, is_truncated};
use super::hypothesis::{Change, Curve, Hypothesis, Making, Mistake};
use super::tracer::Random;
use crate::job::recipe::Recipe;
use crate::job::render::RenderSettings;
use crate::scene::{Material, Scene};
use crate::stages::{DielectricLaws, Diffuse, Shading, SurfaceRule, Transfer};
use glam::DVec3;
use std::sync::Arc;

const BRIGHTER: &str = "nothing is wrong, but it is brighter than the book's picture, which takes the square root in write_color";

const SAME_POINT: &str = "use one point twice: ray(ray_origin, pixel_sample - ray_origin)";

/// All mistakes, those of the file and the camera first.
pub static MISTAKES: [Mistake; 42] = [
    Mistake {
        id: "flipped-rows",
        section: "2.2",
        title: "the rows are upside down",
        remedy: "write the top row first: count j upwards from 0, and let viewport_v point down (0, -viewport_height, 0)",
        applies: always,
        change: Change::Written(|written| written.is_flipped = true),
    },
    Mistake {
        id: "mirrored-columns",
        section: "12.2",
        title: "left and right are swapped",
        remedy: "let viewport_u point right; with look_from and look_at, u = unit_vector(cross(vup, w)) in this order",
        applies: always,
        change: Change::Written(|written| written.is_mirrored = true),
    },
    Mistake {
        id: "swapped-channels",
        section: "3.1",
        title: "the colour channels are swapped",
        remedy: "write red, green, blue in this order; check x, y, z of the colour and formats that want BGR",
        applies: always,
        change: Change::Several(|recipe| {
            [[2, 1, 0], [1, 0, 2], [0, 2, 1], [1, 2, 0], [2, 0, 1]].map(|order| swapped(recipe, order)).into()
        }),
    },
    Mistake {
        id: "no-gamma",
        section: "9.5",
        title: "gamma is missing",
        remedy: "take the square root of each channel in write_color, after dividing by the samples",
        applies: has_gamma,
        change: Change::Written(|written| written.curve = Curve::Gamma(1.0)),
    },
    Mistake {
        id: "gamma-early",
        section: "9.5",
        title: "gamma is applied, though this section does not have it yet",
        remedy: "nothing is wrong if you have read on; section 9.5 adds the square root",
        applies: |recipe| recipe.rules.transfer == Transfer::Linear,
        change: Change::Written(|written| written.curve = Curve::Gamma(2.0)),
    },
    Mistake {
        id: "gamma-twice",
        section: "9.5",
        title: "gamma is applied twice",
        remedy: "take the square root once: either in write_color or in your picture library, which may write sRGB from \
                 linear values",
        applies: has_gamma,
        change: Change::Written(|written| written.curve = Curve::Gamma(4.0)),
    },
    Mistake {
        id: "gamma-2.2",
        section: "9.5",
        title: "the curve is gamma 2.2, not the square root",
        remedy: BRIGHTER,
        applies: has_gamma,
        change: Change::Written(|written| written.curve = Curve::Gamma(2.2)),
    },
    Mistake {
        id: "gamma-srgb",
        section: "9.5",
        title: "the curve is that of sRGB, not the square root",
        remedy: BRIGHTER,
        applies: has_gamma,
        change: Change::Written(|written| written.curve = Curve::Srgb),
    },
    Mistake {
        id: "wraps-to-0",
        section: "8.2",
        title: "the brightest values become 0",
        remedy: "clamp before the conversion: int(256 * clamp(x, 0, 0.999)); 256 does not fit into a byte, where it becomes 0",
        applies: always,
        change: Change::Written(|written| written.wraps = true),
    },
    Mistake {
        id: "scale-255",
        section: "8.2",
        title: "channels are multiplied by 255 and cut off",
        remedy: "use int(256 * clamp(x, 0, 0.999)), or 255.999: with 255, only a value of exactly 1 becomes 255",
        applies: always,
        change: Change::InBytes(is_times_255, &Change::Written(|written| written.levels = 255.0)),
    },
    Mistake {
        id: "truncated",
        section: "3.1",
        title: "channels are cut to whole numbers before they are scaled",
        remedy: "scale first, then convert: int(256 * x), not int(x) * 256; divide as floating-point numbers",
        applies: always,
        change: Change::InBytes(is_truncated, &Change::Several(|_| Vec::new())),
    },
    Mistake {
        id: "no-antialiasing",
        section: "8.2",
        title: "all samples pass through the centre of the pixel",
        remedy: "add a random offset within -0.5..0.5 to i and j for each sample",
        applies: |recipe| recipe.rules.antialiasing,
        change: Change::AtEdges(&Change::Recipe(|recipe| recipe.rules.antialiasing = false)),
    },
    Mistake {
        id: "half-pixel-up",
        section: "4.2",
        title: "the picture is shifted by half a pixel, down and to the right",
        remedy: "let pixel00_loc be the centre of the first pixel: the upper left corner plus 0.5 * (pixel_delta_u + \
                 pixel_delta_v)",
        applies: has_rays,
        change: Change::AtEdges(&Change::Steps(|steps| steps.first_pixel = 0.0)),
    },
    Mistake {
        id: "half-pixel-down",
        section: "8.2",
        title: "the picture is shifted by half a pixel, up and to the left",
        remedy: "draw the offsets of a sample from -0.5..0.5, not from 0..1: pixel00_loc is already the pixel's centre",
        applies: has_rays,
        change: Change::AtEdges(&Change::Steps(|steps| steps.first_pixel = 1.0)),
    },
    Mistake {
        id: "width-less-one",
        section: "4.2",
        title: "pixels are spaced by the width less one",
        remedy: "divide the viewport by image_width and image_height; older editions had image_width - 1",
        applies: has_rays,
        change: Change::AtEdges(&Change::Steps(|steps| steps.spacings = |pixels| pixels - 1.0)),
    },
    Mistake {
        id: "integer-aspect",
        section: "4.2",
        title: "the aspect ratio is a whole number",
        remedy: "divide as floating-point numbers: double(image_width) / image_height, and 16.0 / 9.0",
        applies: has_rays,
        change: Change::Steps(|steps| steps.aspect = |width, height| (width / height).max(1).into()),
    },
    Mistake {
        id: "vfov-radians",
        section: "12.1",
        title: "the field of view is used as radians",
        remedy: "convert it first: theta = degrees_to_radians(vfov)",
        applies: has_rays,
        change: Change::Recipe(|recipe| {
            let vfov = &mut recipe.camera.vfov_degrees;
            *vfov = 2.0 * (*vfov / 2.0).tan().abs().atan().to_degrees();
        }),
    },
    Mistake {
        id: "sky-reversed",
        section: "4.2",
        title: "the sky is upside down",
        remedy: "blend (1 - a) * white + a * blue, with a = 0.5 * (unit_direction.y + 1)",
        applies: has_rays,
        change: Change::Recipe(|recipe| {
            let sky = &mut Arc::make_mut(&mut recipe.scene).sky;
            std::mem::swap(&mut sky.bottom, &mut sky.top);
        }),
    },
    Mistake {
        id: "half-b-sign",
        section: "6.2",
        title: "the quadratic formula has the wrong sign",
        remedy: "with oc = center - origin, h = dot(direction, oc) and the roots are (h - sqrtd) / a and (h + sqrtd) / a; \
                 with oc = origin - center, they are (-h - sqrtd) / a and (-h + sqrtd) / a",
        applies: |recipe| has_rays(recipe) && has_spheres(recipe),
        change: Change::Steps(|steps| steps.roots = |a, h, sqrtd| [(-h - sqrtd) / a, (-h + sqrtd) / a]),
    },
    Mistake {
        id: "last-hit-wins",
        section: "6.5",
        title: "the last sphere in the list hides nearer ones",
        remedy: "pass interval(ray_t.min, closest_so_far) to hit, and set closest_so_far = temp_rec.t after each hit",
        applies: |recipe| has_rays(recipe) && recipe.scene.spheres.len() > 1,
        change: Change::Steps(|steps| steps.t_max = |_| f64::INFINITY),
    },
    Mistake {
        id: "zero-t-min",
        section: "9.3",
        title: "rays hit the surface that they start on (shadow acne)",
        remedy: "let hits begin at 0.001: world.hit(r, interval(0.001, infinity), rec)",
        applies: |recipe| has_bounces(recipe) && recipe.rules.surface != SurfaceRule::Acne,
        change: Change::Steps(|steps| steps.t_min = Some(0.0)),
    },
    Mistake {
        id: "normal-not-unit",
        section: "6.1",
        title: "the normal does not have length 1",
        remedy: "divide by the radius: outward_normal = (rec.p - center) / radius",
        applies: |recipe| has_rays(recipe) && has_spheres(recipe),
        change: Change::Steps(|steps| steps.normal = |to_point, _| to_point),
    },
    Mistake {
        id: "normals-not-flipped",
        section: "6.4",
        title: "the normal is not turned against the ray inside a sphere",
        remedy: "call rec.set_face_normal(r, outward_normal) in sphere::hit, and use rec.front_face in dielectric::scatter",
        applies: has_glass,
        change: Change::Steps(|steps| steps.is_front = |_, _| true),
    },
    Mistake {
        id: "hemisphere",
        section: "9.4",
        title: "matte surfaces scatter uniformly over the hemisphere",
        remedy: "let the direction be rec.normal + random_unit_vector()",
        applies: |recipe| has_matte(recipe, Diffuse::Lambertian),
        change: Change::Recipe(|recipe| recipe.rules.diffuse = Diffuse::Hemisphere),
    },
    Mistake {
        id: "lambertian-early",
        section: "9.4",
        title: "matte surfaces are Lambertian, though this section is uniform over the hemisphere",
        remedy: "nothing is wrong if you have read on; section 9.4 adds it",
        applies: |recipe| has_matte(recipe, Diffuse::Hemisphere),
        change: Change::Recipe(|recipe| recipe.rules.diffuse = Diffuse::Lambertian),
    },
    Mistake {
        id: "point-in-sphere",
        section: "9.4",
        title: "matte surfaces scatter to a point in the unit sphere, not on it",
        remedy: "normalise the random vector: rec.normal + random_unit_vector()",
        applies: |recipe| has_matte(recipe, Diffuse::Lambertian),
        change: Change::Steps(|steps| steps.diffuse = Random::in_unit_sphere),
    },
    Mistake {
        id: "bounce-limit",
        section: "9.2",
        title: "paths end after too few bounces",
        remedy: "set max_depth to 50, and pass depth - 1 to the next call only",
        applies: has_bounces,
        change: Change::Several(|recipe| {
            [1, 2, 3, 4, 5, 6, 8, 10, 15].into_iter().filter_map(|limit| limited(recipe, limit)).collect()
        }),
    },
    Mistake {
        id: "fuzz-missing",
        section: "10.6",
        title: "fuzz has no effect",
        remedy: "add fuzz * random_unit_vector() to the reflected direction, and store fuzz in the constructor",
        applies: has_fuzz,
        change: Change::Materials(|material| {
            if let Material::Metal { fuzz, .. } = material {
                *fuzz = 0.0;
            }
        }),
    },
    Mistake {
        id: "fuzz-unnormalised",
        section: "10.6",
        title: "fuzz is added to a reflected direction of another length than 1",
        remedy: "normalise first: reflected = unit_vector(reflected) + (fuzz * random_unit_vector())",
        applies: has_fuzz,
        change: Change::Steps(|steps| steps.before_fuzz = |direction| direction),
    },
    Mistake {
        id: "refract-unnormalised",
        section: "11.2",
        title: "the direction is not normalised before it is refracted or reflected",
        remedy: "use unit_direction = unit_vector(r_in.direction()) for cos_theta, refract and reflect",
        applies: has_glass,
        change: Change::Steps(|steps| steps.before_glass = |direction| direction),
    },
    Mistake {
        id: "index-inverted",
        section: "11.2",
        title: "the refraction index is inverted",
        remedy: "write ri = rec.front_face ? (1.0 / refraction_index) : refraction_index",
        applies: has_glass,
        change: Change::Materials(invert),
    },
    Mistake {
        id: "glass-black",
        section: "11.2",
        title: "glass is black",
        remedy: "set attenuation = color(1.0, 1.0, 1.0) in dielectric::scatter, and return true",
        applies: has_glass,
        change: Change::Materials(|material| {
            if let Material::Dielectric { .. } = material {
                *material = Material::Lambertian { albedo: DVec3::ZERO };
            }
        }),
    },
    Mistake {
        id: "glass-swapped",
        section: "11.3",
        title: "glass reflects where it should refract, and refracts where it should reflect",
        remedy: "if (cannot_refract || reflectance(cos_theta, ri) > random_double()) reflect, else refract",
        applies: |recipe| has_glass(recipe) && recipe.rules.dielectric != DielectricLaws::RefractOnly,
        change: Change::Steps(|steps| steps.swaps_glass = true),
    },
    Mistake {
        id: "always-refract",
        section: "11.3",
        title: "glass refracts even where Snell's law has no solution",
        remedy: "reflect if ri * sin_theta > 1.0",
        applies: |recipe| has_glass(recipe) && recipe.rules.dielectric != DielectricLaws::RefractOnly,
        change: Change::Recipe(|recipe| recipe.rules.dielectric = DielectricLaws::RefractOnly),
    },
    Mistake {
        id: "schlick-missing",
        section: "11.4",
        title: "glass does not reflect at grazing angles (Schlick's approximation)",
        remedy: "also reflect if reflectance(cos_theta, ri) > random_double()",
        applies: |recipe| has_glass(recipe) && recipe.rules.dielectric == DielectricLaws::Schlick,
        change: Change::Recipe(|recipe| recipe.rules.dielectric = DielectricLaws::TotalReflection),
    },
    Mistake {
        id: "hollow-missing",
        section: "11.5",
        title: "the sphere of air inside the glass sphere is missing",
        remedy: "add a sphere of radius 0.4 at the same place, of dielectric(1.00 / 1.50)",
        applies: |recipe| has_glass(recipe) && bubble(&recipe.scene).is_some(),
        change: Change::Recipe(|recipe| {
            let scene = Arc::make_mut(&mut recipe.scene);
            if let Some(index) = bubble(scene) {
                scene.spheres.remove(index);
            }
        }),
    },
    Mistake {
        id: "hollow-index",
        section: "11.5",
        title: "the sphere inside the glass sphere is glass, too",
        remedy: "the inner sphere is air in glass: dielectric(1.00 / 1.50)",
        applies: |recipe| has_glass(recipe) && bubble(&recipe.scene).is_some(),
        change: Change::Recipe(|recipe| {
            let scene = Arc::make_mut(&mut recipe.scene);
            if let Some(index) = bubble(scene) {
                invert(&mut scene.materials[scene.spheres[index].material].material);
            }
        }),
    },
    Mistake {
        id: "lens-centre",
        section: "13.2",
        title: "all rays start at the centre of the lens",
        remedy: "let ray_origin = (defocus_angle <= 0) ? center : defocus_disk_sample(), and subtract it from pixel_sample",
        applies: has_lens,
        change: Change::Recipe(|recipe| recipe.camera.defocus_angle_degrees = 0.0),
    },
    Mistake {
        id: "lens-origin",
        section: "13.2",
        title: "rays start at the centre of the lens, but are aimed from another point of it",
        remedy: SAME_POINT,
        applies: has_lens,
        change: Change::Steps(|steps| steps.lens = |eye, on_lens, target| [eye, target - on_lens]),
    },
    Mistake {
        id: "lens-aim",
        section: "13.2",
        title: "rays start anywhere on the lens, but are aimed from its centre",
        remedy: SAME_POINT,
        applies: has_lens,
        change: Change::Steps(|steps| steps.lens = |eye, on_lens, target| [on_lens, target - eye]),
    },
    Mistake {
        id: "focus-distance-one",
        section: "13.2",
        title: "the plane in focus is 1 away",
        remedy: "use focus_dist for the viewport: viewport_height = 2 * h * focus_dist, and center - focus_dist * w",
        applies: has_lens,
        change: Change::Recipe(|recipe| recipe.camera.focus_distance = Some(1.0)),
    },
    Mistake {
        id: "same-seed",
        section: "9.1",
        title: "every pixel uses the same random numbers",
        remedy: "seed the generator once, before the loops, not for each pixel",
        applies: |recipe| recipe.rules.antialiasing && has_bounces(recipe),
        change: Change::InNoise(is_same_seed, &Change::Steps(|steps| steps.random = |_| 0)),
    },
];

pub fn applying_to(recipe: &Recipe) -> impl Iterator<Item = &'static Mistake> {
    MISTAKES.iter().filter(|mistake| (mistake.applies)(recipe))
}

fn swapped(recipe: &Recipe, order: [usize; 3]) -> Hypothesis {
    let names = order.map(|channel| ["red", "green", "blue"][channel]).join(", ");
    let mut picture = Hypothesis::right(recipe);
    picture.written.channels = order;
    Hypothesis { note: Some(format!("the channels seem to be {names}")), ..picture }
}

/// Cuts paths off at `limit` rays; `None` if they are no longer than that.
fn limited(recipe: &Recipe, limit: u32) -> Option<Hypothesis> {
    let settings = RenderSettings { max_depth: limit, ..recipe.settings };
    let making = Making::Fast(Box::new(Recipe { settings, ..recipe.clone() }));
    let note = Some(format!("it looks as with max_depth = {limit}"));
    (limit < recipe.settings.max_depth).then(|| Hypothesis { making, note, ..Hypothesis::right(recipe) })
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
