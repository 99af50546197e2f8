//! The table of common mistakes of the book's readers, and of other ways to be right: explanation, where each can show,
//! and how to render it.

use super::hypothesis::{Added, Hypothesis, Mistake};
use super::tracer::{Random, on_circle, reflectance, schlick, surrounds};
use super::written::Order;
use crate::job::output::Encoding;
use crate::job::recipe::Recipe;
use crate::scene::{Camera, Material, Scene};
use crate::stages::{DielectricLaws, Diffuse, Shading, SurfaceRule, Transfer};
use glam::{DVec3, Vec3Swizzles};
use std::sync::Arc;

const SAME_POINT: &str = "use one point twice: `ray(ray_origin, pixel_sample - ray_origin)`";

const BRIGHTER: &str = "nothing is wrong, but it is brighter than the book's picture, which takes the square root in write_color";

const UNIT_VECTOR: &str = "draw points in the cube -1..1 until one is inside the unit sphere, then normalise it: `random_unit_vector()`";

const ATTENUATION: &str = "return `attenuation * ray_color(scattered, depth - 1, world)`";

/// Each row: id, section to reread, title, remedy, the recipes in which it can show, whether the picture is right all the
/// same, and how to render it.
macro_rules! mistakes {
    ($($id:literal, $section:literal, $title:literal, $remedy:expr, $applies:expr, $is_right:expr, $($change:expr),*;)*) => {
        /// All mistakes, those of the file and the camera first.
        pub static MISTAKES: &[Mistake] = &[$(Mistake {
            id: $id, section: $section, title: $title, remedy: $remedy, applies: $applies, is_right: $is_right,
            changes: &[$($change),*],
        }),*];
    };
}

mistakes! {
    "flipped-rows", "2.2", "the rows are upside down",
        "write the top row first: count j upwards from 0, and let `viewport_v` point down `(0, -viewport_height, 0)`",
        always, WRONG, |it| it.written.order = Order::Flipped;
    "mirrored-columns", "12.2", "left and right are swapped",
        "let `viewport_u` point right; with `look_from` and `look_at`, `u = unit_vector(cross(vup, w))` in this order",
        always, WRONG, |it| it.written.order = Order::Mirrored;
    "swapped-channels", "3.1", "the colour channels are swapped",
        "write red, green, blue in this order; check x, y, z of the colour and formats that want BGR",
        always, WRONG, |it| swap(it, [2, 1, 0]), |it| swap(it, [1, 0, 2]), |it| swap(it, [0, 2, 1]),
        |it| swap(it, [1, 2, 0]), |it| swap(it, [2, 0, 1]);
    "no-gamma", "9.5", "gamma is missing",
        "take the square root of each channel in `write_color`, after dividing by the samples",
        has_gamma, WRONG, |it| it.written.curve = Encoding::Book(Transfer::Linear);
    "gamma-early", "9.5", "gamma is applied, although this section does not use it yet",
        "nothing is wrong if you have read on; section 9.5 adds the square root",
        |recipe| recipe.rules.transfer == Transfer::Linear,
        RIGHT, |it| it.written.curve = Encoding::Book(Transfer::Gamma2);
    "gamma-of-samples", "9.5", "the square root is taken of each sample, not of the pixel's mean",
        "take the square root in `write_color`, of the mean",
        |recipe| has_gamma(recipe) && recipe.rules.antialiasing, WRONG, |it| {
            it.written.curve = Encoding::Book(Transfer::Linear);
            it.plain().sample = |light| DVec3::from(light.to_array().map(f64::sqrt));
        };
    "gamma-twice", "9.5", "gamma is applied twice",
        "take the square root once: either in `write_color` or in your picture library, which may write sRGB from linear values",
        has_gamma, WRONG, |it| it.written.curve = Encoding::Gamma(4.0);
    "gamma-2.2", "9.5", "the curve is gamma 2.2, not the square root",
        BRIGHTER, has_gamma, RIGHT, |it| it.written.curve = Encoding::Gamma(2.2);
    "gamma-srgb", "9.5", "the curve is that of sRGB, not the square root",
        BRIGHTER, has_gamma, RIGHT, |it| it.written.curve = Encoding::Srgb;
    "wraps-to-0", "8.2", "the brightest values become 0",
        "clamp before the conversion: `int(256 * clamp(x, 0, 0.999))`; 256 does not fit into a byte and becomes 0",
        always, WRONG, |it| it.written.wraps = true;
    "scale-255", "8.2", "channels are multiplied by 255 and truncated",
        "nothing is wrong; with `int(256 * clamp(x, 0, 0.999))`, all 256 values are as likely",
        always, RIGHT, |it| it.written.levels = 255.0;
    "no-antialiasing", "8.2", "all samples pass through the centre of the pixel",
        "add a random offset within -0.5..0.5 to i and j for each sample", has_antialiasing, WRONG, |it| fine(it).recipe.rules.antialiasing = false;
    "half-pixel-up", "4.2", "the picture is shifted by half a pixel, down and to the right",
        "let `pixel00_loc` be the centre of the first pixel: the upper left corner plus `0.5 * (pixel_delta_u + pixel_delta_v)`",
        has_rays, WRONG, |it| shift(it, [-0.5; 2]);
    "half-pixel-down", "8.2", "the picture is shifted by half a pixel, up and to the left",
        "draw the offsets of a sample from -0.5..0.5, not from 0..1: `pixel00_loc` is already the pixel's centre",
        has_rays, WRONG, |it| shift(it, [0.5; 2]);
    "width-less-one", "4.2", "pixels are spaced by the width less one",
        "divide the viewport by `image_width` and `image_height`; older editions had `image_width - 1`",
        has_rays, WRONG, |it| less_one(it, [0.5; 2]);
    "integer-aspect", "4.2", "the aspect ratio is a whole number",
        "divide as floating-point numbers: `double(image_width) / image_height`, and `16.0 / 9.0`",
        has_rays, WRONG, |it| {
            let [width, height] = it.size();
            it.viewport.scale[0] *= f64::from((width / height).max(1)) / (f64::from(width) / f64::from(height));
        };
    "integer-width", "4.2", "the width of the viewport is a whole number",
        "store it as a floating-point number: `double viewport_width = ...`",
        has_rays, WRONG, |it| whole_width(it, 1.0), |it| whole_width(it, 10.0);
    "corner-without-aspect", "4.2", "the corner of the viewport does not follow from its width",
        "`viewport_upper_left = camera_center - vec3(0, 0, focal_length) - viewport_u/2 - viewport_v/2`",
        has_rays, WRONG, |it| {
            let [width, height] = it.size().map(f64::from);
            it.viewport.shift[0] += (1.0 - height / width) / 2.0;
        };
    "vfov-radians", "12.1", "the field of view is used as radians",
        "convert it first: `theta = degrees_to_radians(vfov)`",
        has_rays, WRONG, |it| field_of_view(it, |half| half.to_degrees().tan());
    "sky-reversed", "4.2", "the sky is upside down",
        "blend `(1 - a) * white + a * blue`, with `a = 0.5 * (unit_direction.y + 1)`",
        has_rays, WRONG, |it| {
            let sky = &mut Arc::make_mut(&mut it.recipe.scene).sky;
            std::mem::swap(&mut sky.bottom, &mut sky.top);
        };
    "half-b-sign", "6.2", "the quadratic formula has the wrong sign",
        "with `oc = center - origin`, `h = dot(direction, oc)` and the roots are `(h - sqrtd) / a` and `(h + sqrtd) / a`; with `oc = origin - center`, they are `(-h - sqrtd) / a` and `(-h + sqrtd) / a`",
        has_solids,
        WRONG, |it| it.plain().roots = |a, h, c| [-1.0, 1.0].map(|sign| (-h + sign * (h * h - a * c).sqrt()) / a);
    "last-hit-wins", "6.5", "the last sphere in the list hides nearer ones",
        "pass `interval(ray_t.min, closest_so_far)` to `hit`, and set `closest_so_far = temp_rec.t` after each hit",
        |recipe| has_rays(recipe) && recipe.scene.spheres.len() > 1,
        WRONG, |it| it.plain().t_max = |_| f64::INFINITY, |it| {
            Arc::make_mut(&mut it.recipe.scene).spheres.reverse();
            it.plain().t_max = |_| f64::INFINITY;
        }, |it| {
            Arc::make_mut(&mut it.recipe.scene).spheres.rotate_left(1);
            it.plain().t_max = |_| f64::INFINITY;
        };
    "ball-missing", "10.5", "a ball is missing",
        "add all spheres of the section to the world", |recipe| has_rays(recipe) && recipe.scene.materials.len() > 2,
        WRONG, |it| without(it, &["left", "bubble", "right"]), |it| without(it, &["left", "bubble"]), |it| without(it, &["right"]),
        |it| without(it, &["center"]);
    "zero-t-min", "9.3", "rays hit the surface that they start on (shadow acne)",
        "let hits begin at 0.001: `world.hit(r, interval(0.001, infinity), rec)`",
        |recipe| has_bounces(recipe) && recipe.rules.surface != SurfaceRule::Acne && recipe.rules.diffuse != Diffuse::Hemisphere,
        WRONG, |it| it.plain().t_min = Some(0.0);
    "acne-early", "9.3", "rays hit the surface that they start on (shadow acne), as in the listings of 9.1 and 9.2",
        "nothing is wrong yet; section 9.3 lets hits begin at 0.001, which removes the acne",
        |recipe| has_matte(recipe, Diffuse::Hemisphere),
        RIGHT, |it| it.plain().t_min = Some(0.0), |it| acne(it, 10), |it| acne(it, 50);
    "normal-not-unit", "6.1", "the normal does not have length 1",
        "divide by the radius: `outward_normal = (rec.p - center) / radius`",
        has_solids,
        WRONG, |it| it.plain().normal = |to_point, _| to_point;
    "normals-not-flipped", "6.4", "the normal is not turned against the ray inside a sphere",
        "call `rec.set_face_normal(r, outward_normal)` in `sphere::hit`, and use `rec.front_face` in `dielectric::scatter`",
        has_glass, WRONG, |it| it.plain().is_front = |_, _| true;
    "hemisphere", "9.4", "matte surfaces scatter uniformly over the hemisphere",
        "let the direction be `rec.normal + random_unit_vector()`",
        |recipe| has_matte(recipe, Diffuse::Lambertian),
        WRONG, |it| it.recipe.rules.diffuse = Diffuse::Hemisphere;
    "lambertian-early", "9.4", "matte surfaces are Lambertian, although this section uses a uniform hemisphere",
        "nothing is wrong if you have read on; section 9.4 adds it",
        |recipe| has_matte(recipe, Diffuse::Hemisphere),
        RIGHT, |it| it.recipe.rules.diffuse = Diffuse::Lambertian;
    "point-in-sphere", "9.4", "matte surfaces scatter to a point in the unit sphere, not on it",
        "normalise the random vector: `rec.normal + random_unit_vector()`",
        |recipe| has_matte(recipe, Diffuse::Lambertian),
        WRONG, |it| it.plain().vector = Random::in_unit_sphere;
    "bounce-limit", "9.2", "paths end after too few bounces",
        "set `max_depth` to 50, and pass `depth - 1` to the next call only",
        has_bounces, WRONG, |it| limit(it, 1), |it| limit(it, 2), |it| limit(it, 3), |it| limit(it, 4),
        |it| limit(it, 5), |it| limit(it, 6), |it| limit(it, 8), |it| limit(it, 10), |it| limit(it, 15);
    "fuzz-missing", "10.6", "fuzz has no effect",
        "add `fuzz * random_unit_vector()` to the reflected direction, and store `fuzz` in the constructor",
        has_fuzz, WRONG, |it| materials(it, no_fuzz);
    "fuzz-unnormalised", "10.6", "the reflected direction is not normalised before fuzz is added",
        "normalise first: `reflected = unit_vector(reflected) + (fuzz * random_unit_vector())`",
        has_fuzz, WRONG, |it| it.plain().before_fuzz = |reflected, _| reflected;
    "refract-unnormalised", "11.2", "the direction is not normalised before it is refracted or reflected",
        "use `unit_direction = unit_vector(r_in.direction())` for `cos_theta`, `refract` and `reflect`",
        has_glass, WRONG, |it| it.plain().before_glass = |direction| direction;
    "index-inverted", "11.2", "the refraction index is inverted",
        "write `ri = rec.front_face ? (1.0 / refraction_index) : refraction_index`",
        has_glass, WRONG, |it| materials(it, invert);
    "glass-black", "11.2", "glass is black",
        "set `attenuation = color(1.0, 1.0, 1.0)` in `dielectric::scatter`, and return `true`",
        has_glass, WRONG, |it| materials(it, |material| {
            if let Material::Dielectric { .. } = material {
                *material = Material::Lambertian { albedo: DVec3::ZERO };
            }
        });
    "glass-swapped", "11.3", "glass reflects where it should refract, and refracts where it should reflect",
        "if `(cannot_refract || reflectance(cos_theta, ri) > random_double())` reflect, else refract",
        has_reflecting_glass,
        WRONG, |it| it.plain().swaps_glass = true;
    "always-refract", "11.3", "glass refracts even where Snell's law has no solution",
        "reflect if `ri * sin_theta > 1.0`",
        has_reflecting_glass,
        WRONG, |it| it.recipe.rules.dielectric = DielectricLaws::RefractOnly;
    "schlick-missing", "11.4", "glass does not reflect at grazing angles (Schlick's approximation)",
        "also reflect if `reflectance(cos_theta, ri) > random_double()`",
        has_schlick,
        WRONG, |it| it.recipe.rules.dielectric = DielectricLaws::TotalReflection;
    "hollow-missing", "11.5", "the sphere of air inside the glass sphere is missing",
        "add a sphere of radius 0.4 at the same place, of `dielectric(1.00 / 1.50)`",
        has_bubble, WRONG, |it| change_bubble(it, |scene, bubble| _ = scene.spheres.remove(bubble));
    "inner-only", "11.5", "the glass sphere around the sphere of air is missing",
        "keep the outer sphere, of radius 0.5 and `dielectric(1.50)`, and add the inner one",
        has_bubble, WRONG, |it| change_bubble(it, |scene, bubble| {
            let center = scene.spheres[bubble].center;
            let radius = scene.spheres[bubble].radius;
            scene.spheres.retain(|sphere| sphere.center != center || sphere.radius == radius);
        });
    "hollow-index", "11.5", "the sphere inside the glass sphere is glass, too",
        "the inner sphere is air in glass: `dielectric(1.00 / 1.50)`",
        has_bubble, WRONG,
        |it| change_bubble(it, |scene, bubble| invert(&mut scene.materials[scene.spheres[bubble].material].material));
    "lens-centre", "13.2", "all rays start at the centre of the lens",
        "let `ray_origin = (defocus_angle <= 0) ? center : defocus_disk_sample()`, and subtract it from `pixel_sample`",
        has_lens, WRONG, |it| it.recipe.camera.defocus_angle_degrees = 0.0;
    "lens-origin", "13.2", "rays start at the centre of the lens, but are aimed from another point of it",
        SAME_POINT,
        has_lens, WRONG, |it| it.plain().lens = |eye, on_lens, target| [eye, target - on_lens];
    "lens-aim", "13.2", "rays start anywhere on the lens, but are aimed from its centre",
        SAME_POINT,
        has_lens, WRONG, |it| it.plain().lens = |eye, on_lens, target| [on_lens, target - eye];
    "focus-distance-one", "13.2", "the plane in focus is 1 away",
        "use `focus_dist` for the viewport: `viewport_height = 2 * h * focus_dist`, and `center - focus_dist * w`",
        has_lens, WRONG, |it| it.recipe.camera.focus_distance = Some(1.0);
    "viewport-without-focus", "13.2", "the viewport's size lacks the focus distance",
        "`viewport_height = 2 * h * focus_dist`", has_lens, WRONG, |it| {
            let distance = it.recipe.camera.effective_focus_distance();
            it.viewport.scale = it.viewport.scale.map(|scale| scale / distance);
        }, |it| {
            let camera = &mut it.recipe.camera;
            camera.defocus_angle_degrees = 2.0 * camera.lens_radius().atan().to_degrees();
            camera.focus_distance = Some(1.0);
        };
    "same-seed", "9.1", "every pixel uses the same random numbers",
        "seed the generator once, before the loops, not for each pixel",
        |recipe| recipe.rules.antialiasing && has_bounces(recipe),
        WRONG, |it| it.plain().random = |_| 0;
    "rounds", "8.2", "values are rounded to the nearest of 255 steps, not truncated",
        "nothing is wrong", always, RIGHT, |it| (it.written.rounds, it.written.levels) = (true, 255.0);
    "rotated", "12.2", "the picture is turned by 180 degrees",
        "with `w = unit_vector(look_from - look_at)`: `u = unit_vector(cross(vup, w))` and `v = cross(w, u)`, in this order",
        always, WRONG, |it| it.written.order = Order::Rotated;
    "columns-first", "2.2", "the pixels are written column by column",
        "let the outer loop count rows and the inner one columns: for j, then for i",
        always, WRONG, |it| it.written.order = Order::Columns, |it| exchange(it, Order::Transposed);
    "sides-exchanged", "2.2", "width and height are exchanged in the header",
        "write `image_width` first, then `image_height`", always, WRONG, |it| exchange(it, Order::Exchanged);
    "planar", "2.2", "all red values come first, then all green ones, then all blue ones",
        "write the three values of a pixel one after the other", always, WRONG, |it| it.written.order = Order::Planar;
    "row-length", "2.2", "the rows are not as long as the header says",
        "let i run from 0 to `image_width - 1`, and write the same `image_width` to the header; a PPM has no padding",
        always, WRONG, |it| it.written.order = Order::Long, |it| it.written.order = Order::Short,
        |it| it.written.order = Order::Padded;
    "gradient-over-width", "2.2", "column and row are divided by width and height, so no value reaches 1",
        "divide by `image_width - 1` and `image_height - 1`: the last pixel is then 1",
        is_gradient, WRONG, |it| it.plain().gradient = |_, [x, y]| DVec3::new(x, y, 0.0),
        |it| it.plain().gradient = |_, [x, y]| (255.999 / 256.0) * DVec3::new(x, y, 0.0);
    "gradient-turned", "2.2", "red follows the rows and green the columns",
        "red is `i / (image_width - 1)`, green is `j / (image_height - 1)`",
        is_gradient, WRONG, |it| it.plain().gradient = |[x, y], _| DVec3::new(y, x, 0.0);
    "edition-gradient", "2.2", "the colours are those of an older edition, with blue and with rows counted from the bottom",
        "nothing is wrong; since edition 4, blue is 0 and green grows downwards", is_gradient, RIGHT,
        |it| older_gradient(it, |[x, y], _| DVec3::new(x, y, 0.25)),
        |it| older_gradient(it, |_, [x, y]| DVec3::new(x, y, 0.2));
    "edition-camera", "4.2", "the camera is that of an older edition",
        "nothing is wrong; since edition 4, pixels are spaced by the whole width, and rays pass through their centres",
        has_rays, RIGHT, edition_3_camera, |it| {
            if !it.recipe.rules.antialiasing {
                shift(it, [-0.5, 0.5]);
            }
        };
    "edition-diffuse", "9.1", "matte surfaces and the camera are those of edition 3",
        "nothing is wrong; edition 4 begins with the hemisphere, and edition 3 with points in the unit sphere",
        has_one_material, RIGHT,
        |it| edition_3_diffuse(it, 0.0), |it| edition_3_diffuse(it, 0.001);
    "edition-scene", "10.5", "scene and camera are those of an older edition",
        "nothing is wrong; edition 4 changed the colours, positions and views", has_metal, RIGHT,
        |it| older_scene(it, 0.4), |it| {
            older_scene(it, 0.4);
            it.plain().fuzz = Random::in_unit_sphere;
        }, edition_3_scene, |it| {
            edition_3_scene(it);
            it.plain().fuzz = Random::in_unit_sphere;
        };
    "edition-fuzz", "10.6", "fuzz is drawn from inside the unit sphere, as in older editions",
        "nothing is wrong; edition 4 uses `fuzz * random_unit_vector()`", has_fuzz, RIGHT,
        |it| it.plain().fuzz = Random::in_unit_sphere, |it| {
            edition_3_camera(it);
            it.plain().fuzz = Random::in_unit_sphere;
        };
    "listing-79", "11.5", "the golden ball has fuzz 0, as listing 79 of the book prints it",
        "nothing is wrong; the listing has a misprint: the book's picture has `metal(color(0.8, 0.6, 0.2), 1.0)`",
        |recipe| has_bubble(recipe) && recipe.camera == Camera::BOOK, RIGHT, |it| materials(it, no_fuzz);
    "reflectance", "9.5", "the surfaces do not reflect 50 % of the light",
        "nothing is wrong if you do the exercise of 9.5; the book's picture has 50 %",
        |recipe| has_one_material(recipe) && !recipe.rules.reflectance_strips, RIGHT,
        |it| grey(it, 0.1), |it| grey(it, 0.3), |it| grey(it, 0.7), |it| grey(it, 0.9);
    "brightness", "8.2", "the brightness is off by a constant factor",
        "divide the sum of a pixel's samples by their number, exactly once, before the square root",
        has_rays, WRONG, |it| it.added = Some(Added::Gain);
    "sum-kept", "8.2", "the sum of a pixel begins with the colour of the one before",
        "set `pixel_color` to `color(0, 0, 0)` inside the loop over the pixels",
        has_antialiasing, WRONG, |it| it.added = Some(Added::Carry);
    "wide-filter", "8.2", "the samples of a pixel are spread too widely, so the picture is blurred",
        "draw the offsets from -0.5..0.5: `vec3(random_double() - 0.5, random_double() - 0.5, 0)`",
        has_antialiasing, WRONG, |it| fine(it).plain().filter = 3.0,
        |it| fine(it).plain().filter = 4.0;
    "backwards", "12.2", "the camera looks backwards",
        "`w = unit_vector(look_from - look_at)` points back: subtract `focus_dist * w`, do not add it",
        has_rays, WRONG, |it| look_back(it, Order::Rows), |it| look_back(it, Order::Mirrored),
        |it| look_back(it, Order::Rotated);
    "sky-not-unit", "4.2", "the sky uses the direction before it is normalised",
        "`unit_direction = unit_vector(r.direction())`, and `a = 0.5 * (unit_direction.y() + 1.0)`",
        has_rays, WRONG, |it| it.plain().sky = |direction, _| 0.5 * (direction.y + 1.0);
    "sky-blend", "4.2", "the sky's gradient does not follow 0.5 * (y + 1)",
        "`a = 0.5 * (unit_direction.y() + 1.0)`, and `color = (1.0 - a) * white + a * blue`", has_rays, WRONG,
        |it| it.plain().sky = |direction, _| direction.normalize().y,
        |it| it.plain().sky = |direction, _| 0.5 * (direction.normalize().x + 1.0),
        |it| it.plain().sky = |direction, _| 0.5 * (direction.normalize().z + 1.0),
        |it| it.plain().sky = |_, _| 1.0, |it| it.plain().sky = |_, _| 0.0;
    "sky-of-camera", "4.2", "every bounce sees the sky in the direction of the camera's ray",
        "in `ray_color`, use the direction of the ray that has left the scene", has_bounces, WRONG,
        |it| it.plain().sky = |_, seen| 0.5 * (seen.normalize().y + 1.0);
    "far-root", "6.2", "the farther of the two roots is used",
        "try `(h - sqrtd) / a` first, and `(h + sqrtd) / a` only if that is outside the interval", has_solids, WRONG,
        |it| it.plain().roots = |a, h, c| [(h + (h * h - a * c).sqrt()) / a; 2],
        |it| it.plain().roots = |a, h, c| [1.0, -1.0].map(|sign| (h + sign * (h * h - a * c).sqrt()) / a);
    "root-shadowed", "6.2", "the second root is a new variable, so the hit is at the first one",
        "assign the second root to the same variable, without `auto`, `let`, `val` or `var`", has_solids, WRONG,
        |it| it.plain().root = |roots, interval| roots.into_iter().any(|t| surrounds(interval, t)).then_some(roots[0]);
    "near-root-only", "6.2", "only the nearer root is tried",
        "if `(h - sqrtd) / a` is outside the interval, try `(h + sqrtd) / a`", has_solids, WRONG,
        |it| it.plain().roots = |a, h, c| [(h - (h * h - a * c).sqrt()) / a; 2];
    "a-missing", "6.2", "the quadratic formula lacks a, as if directions had length 1",
        "`a = r.direction().length_squared()`, in the discriminant and below both roots", has_solids, WRONG,
        |it| it.plain().roots = |_, h, c| [-1.0, 1.0].map(|sign| h + sign * (h * h - c).sqrt()),
        |it| it.plain().roots = |a, h, c| [-1.0, 1.0].map(|sign| h + sign * (h * h - a * c).sqrt());
    "no-t-min", "6.3", "surfaces behind the start of a ray are hit",
        "accept a root only if it is inside the interval: `ray_t.surrounds(root)`", has_solids, WRONG,
        |it| it.plain().t_min = Some(f64::NEG_INFINITY);
    "point-at-unit", "6.2", "the hit point is computed with the normalised direction, but t belongs to the original",
        "`rec.p = r.at(rec.t)`, which is `origin + t * direction`", has_solids, WRONG, |it| it.plain().along = DVec3::normalize;
    "normal-reversed", "6.1", "the normal points inwards",
        "`outward_normal = (rec.p - center) / radius`, not `center - rec.p`", has_solids, WRONG,
        |it| {
            it.plain().normal = |to_point, radius| -to_point / radius;
            it.plain().is_front = |_, _| true;
        };
    "normal-colour", "6.1", "normals are shown without being moved to 0..1",
        "return `0.5 * color(N.x() + 1, N.y() + 1, N.z() + 1)`", |recipe| recipe.rules.shading == Shading::Normals, WRONG,
        |it| it.plain().normal_colour = |normal| normal, |it| it.plain().normal_colour = DVec3::abs;
    "vector-0-to-1", "9.1", "random vectors only have positive x, y and z",
        UNIT_VECTOR, has_bounces, WRONG, |it| vector(it, |random| random.triple().normalize()), |it| vector(it, Random::triple);
    "vector-cube", "9.1", "random vectors are drawn from a cube, so directions crowd at its corners",
        UNIT_VECTOR, has_bounces, WRONG, |it| vector(it, |random| (2.0 * random.triple() - 1.0).normalize()),
        |it| vector(it, |random| 2.0 * random.triple() - 1.0);
    "vector-polar", "9.1", "directions crowd at the poles, because both angles are uniform",
        "let the height z be uniform in -1..1 instead of the angle, or use `random_unit_vector()`",
        has_bounces, WRONG, |it| vector(it, |random| polar(random).xzy()), |it| vector(it, polar),
        |it| vector(it, |random| polar(random).zxy());
    "hemisphere-inverted", "9.1", "directions point into the surface: the test of the hemisphere is inverted",
        "return `on_unit_sphere` if `dot(on_unit_sphere, normal) > 0.0`, else `-on_unit_sphere`", has_bounces, WRONG,
        |it| it.plain().scatter = Some(|[v, _], normal, _| if v.dot(normal) > 0.0 { -v } else { v }),
        |it| it.plain().scatter = Some(|[v, _], normal, _| v - normal);
    "hemisphere-missing", "9.1", "directions point everywhere, even into the surface",
        "use `random_on_hemisphere(rec.normal)`, or `rec.normal + random_unit_vector()`", has_bounces, WRONG,
        |it| it.plain().scatter = Some(|[v, _], _, _| v);
    "hemisphere-around", "9.4", "matte surfaces scatter over a hemisphere and add the normal besides",
        "use one of the two: `rec.normal + random_unit_vector()`", has_bounces, WRONG,
        |it| it.plain().scatter = Some(|[v, w], normal, _| on_hemisphere(w, normal + v)),
        |it| it.plain().scatter = Some(|[v, _], normal, _| normal + on_hemisphere(v, normal));
    "scatter-to-point", "9.4", "matte surfaces scatter from the origin of space, not from the point",
        "the ray is `ray(rec.p, rec.normal + random_unit_vector())`: a direction, not a point", has_bounces, WRONG,
        |it| it.plain().scatter = Some(|[v, _], normal, point| point + normal + v),
        |it| it.plain().scatter = Some(|[v, _], _, point| point + v);
    "no-random-vector", "9.4", "matte surfaces scatter along the normal only",
        "add a random vector: `rec.normal + random_unit_vector()`", has_bounces, WRONG,
        |it| it.plain().scatter = Some(|_, normal, _| normal);
    "attenuation-missing", "9.2", "surfaces absorb nothing: the attenuation is not used",
        ATTENUATION, has_bounces, WRONG, |it| it.plain().combine = |_| [DVec3::ZERO, DVec3::ONE];
    "attenuation-twice", "10.4", "the attenuation is used twice",
        ATTENUATION, has_bounces, WRONG, |it| it.plain().combine = |albedo| [DVec3::ZERO, albedo * albedo];
    "attenuation-added", "10.4", "the attenuation is added instead of multiplied",
        ATTENUATION, has_bounces, WRONG, |it| it.plain().combine = |albedo| [albedo, DVec3::ONE],
        |it| it.plain().combine = |albedo| [albedo / 2.0, DVec3::splat(0.5)];
    "reflect-once", "10.2", "the reflected direction lacks the factor 2, so it runs along the surface",
        "return `v - 2 * dot(v, n) * n`", |recipe| has_metal(recipe) || has_glass(recipe), WRONG, |it| it.plain().reflects = 1.0;
    "reflect-plus", "10.2", "the reflected direction has a plus where the formula has a minus",
        "return `v - 2 * dot(v, n) * n`", |recipe| has_metal(recipe) || has_glass(recipe), WRONG,
        |it| it.plain().reflects = -2.0,
        |it| {
            it.plain().reflects = -2.0;
            it.plain().before_fuzz = |reflected, incoming| reflected / incoming.length();
        };
    "fuzz-below", "10.6", "fuzzy reflections that point below the surface are not absorbed",
        "return `(dot(scattered.direction(), rec.normal) > 0)`", has_fuzz, WRONG, |it| it.plain().absorbs_below = false;
    "fuzz-cube", "10.6", "fuzz is drawn from a cube",
        "`reflected = unit_vector(reflected) + (fuzz * random_unit_vector())`",
        has_fuzz, WRONG, |it| it.plain().fuzz = Random::triple,
        |it| it.plain().fuzz = |random| random.triple().normalize(),
        |it| it.plain().fuzz = |random| 2.0 * random.triple() - 1.0;
    "origin-moved", "11.2", "bounced rays start above the surface, even refracted ones",
        "start at `rec.p`, and let hits begin at 0.001", has_bounces, WRONG, |it| it.plain().lift = 0.001,
        |it| it.plain().lift = 0.01, |it| it.plain().lift = 0.1;
    "refract-outwards", "11.2", "the refracted direction leaves on the wrong side",
        "`r_out_parallel = -std::sqrt(std::fabs(1.0 - r_out_perp.length_squared())) * n`", has_glass, WRONG,
        |it| it.plain().inwards = |square| -square.abs().sqrt();
    "refract-nan", "11.3", "the root of a negative number: where Snell's law has no solution, the pixels are black",
        "reflect if `ri * sin_theta > 1.0`, and take `std::fabs` below the root", has_glass, WRONG,
        |it| {
            it.recipe.rules.dielectric = DielectricLaws::RefractOnly;
            it.plain().inwards = f64::sqrt;
            it.written.blackens = true;
        };
    "glass-reflects", "11.2", "glass only reflects", "refract unless `ri * sin_theta > 1.0`", has_glass, WRONG,
        |it| {
            it.plain().swaps_glass = true;
            it.recipe.rules.dielectric = DielectricLaws::RefractOnly;
        };
    "schlick-power", "11.4", "Schlick's formula uses a power other than 5",
        "return `r0 + (1 - r0) * std::pow(1 - cosine, 5)`", has_schlick, WRONG,
        |it| it.plain().reflectance = |cosine, ratio| reflectance(schlick(1.0, ratio), cosine, 1),
        |it| it.plain().reflectance = |cosine, ratio| reflectance(schlick(1.0, ratio), cosine, 2),
        |it| it.plain().reflectance = |cosine, ratio| reflectance(schlick(1.0, ratio), cosine, 3);
    "schlick-r0", "11.4", "Schlick's r0 is not squared",
        "`r0 = (1 - refraction_index) / (1 + refraction_index)`, then `r0 = r0 * r0`", has_schlick, WRONG,
        |it| it.plain().reflectance = |cosine, ratio| reflectance(((1.0 - ratio) / (1.0 + ratio)).abs(), cosine, 5),
        |it| it.plain().reflectance = |cosine, ratio| reflectance((1.0 - ratio) / (1.0 + ratio), cosine, 5);
    "schlick-coin", "11.4", "reflection is not decided by Schlick's reflectance and a random number",
        "reflect if `reflectance(cos_theta, ri) > random_double()`", has_schlick, WRONG,
        |it| it.plain().reflectance = |_, _| 0.5,
        |it| it.plain().reflectance = |cosine, ratio| f64::from(u8::from(schlick(cosine, ratio) > 0.5));
    "glass-tinted", "11.2", "glass absorbs light", "set `attenuation = color(1.0, 1.0, 1.0)` in `dielectric::scatter`", has_glass, WRONG,
        |it| it.plain().glass = DVec3::splat(0.9), |it| it.plain().glass = DVec3::splat(0.8),
        |it| it.plain().glass = DVec3::splat(0.5), |it| it.plain().glass = DVec3::new(0.5, 0.7, 1.0);
    "lens-radius", "13.2", "the radius of the lens lacks the focus distance",
        "`defocus_radius = focus_dist * std::tan(degrees_to_radians(defocus_angle / 2))`", has_lens, WRONG, |it| {
            let camera = &mut it.recipe.camera;
            let tangent = camera.defocus_tangent() / camera.effective_focus_distance();
            camera.defocus_angle_degrees = 2.0 * tangent.atan().to_degrees();
        };
    "lens-disk", "13.2", "the points on the lens are not spread evenly over a disk",
        "draw points in the square -1..1 until one is inside the unit disk", has_lens, WRONG,
        |it| fine(it).plain().disk = |pair| pair.map(|x| 2.0 * x - 1.0),
        |it| fine(it).plain().disk = |[u, v]| on_circle(u, v), |it| fine(it).plain().disk = |[_, v]| on_circle(1.0, v);
}

/// Whether a picture with the mistake counts as right.
const WRONG: bool = false;
const RIGHT: bool = true;

pub fn applying_to(recipe: &Recipe) -> impl Iterator<Item = &'static Mistake> {
    MISTAKES.iter().filter(|mistake| (mistake.applies)(recipe))
}

/// Takes away the balls of these materials.
fn without(picture: &mut Hypothesis, names: &[&str]) {
    picture.note = Some(format!("it seems that you lack: {}", names.join(", ")));
    let scene = Arc::make_mut(&mut picture.recipe.scene);
    let materials: Vec<&str> = scene.materials.iter().map(|named| named.name.as_str()).collect();
    scene.spheres.retain(|sphere| !names.contains(&materials[sphere.material]));
}

fn swap(picture: &mut Hypothesis, order: [usize; 3]) {
    let names = order.map(|channel| ["red", "green", "blue"][channel]).join(", ");
    picture.note = Some(format!("the channels seem to be {names}"));
    picture.written.channels = order;
}

fn acne(picture: &mut Hypothesis, max_depth: u32) {
    picture.recipe.settings.max_depth = max_depth;
    picture.plain().t_min = Some(0.0);
}

/// Limits paths to `limit` rays.
fn limit(picture: &mut Hypothesis, limit: u32) {
    picture.note = Some(format!("it looks like max_depth = {limit}"));
    let max_depth = &mut picture.recipe.settings.max_depth;
    *max_depth = limit.min(*max_depth);
}

/// The picture of a mistake that only pixels at edges show.
fn fine(picture: &mut Hypothesis) -> &mut Hypothesis {
    picture.is_fine = true;
    picture
}

fn exchange(picture: &mut Hypothesis, order: Order) {
    let settings = &mut picture.recipe.settings;
    std::mem::swap(&mut settings.width, &mut settings.height);
    picture.written.order = order;
}

fn older_gradient(picture: &mut Hypothesis, gradient: fn([f64; 2], [f64; 2]) -> DVec3) {
    picture.plain().gradient = gradient;
    picture.written.order = Order::Flipped;
}

/// Edition 3 counts columns and rows from the lower left corner, and divides by width and height less one.
fn edition_3_camera(picture: &mut Hypothesis) {
    let is_spread = picture.recipe.rules.antialiasing;
    less_one(picture, if is_spread { [0.5, -0.5] } else { [0.0; 2] });
}

fn edition_3_diffuse(picture: &mut Hypothesis, t_min: f64) {
    edition_3_camera(picture);
    let steps = picture.plain();
    steps.t_min = Some(t_min);
    steps.scatter = Some(|[vector, _], normal, _| normal + vector);
    steps.vector = Random::in_unit_sphere;
}

/// Pixels are spaced by width and height less one, and the first one's centre is here, in spacings from the corner.
fn less_one(picture: &mut Hypothesis, first: [f64; 2]) {
    let size = picture.size();
    for axis in 0..2 {
        let pixels = f64::from(size[axis]);
        let scale = pixels / (pixels - 1.0);
        picture.viewport.scale[axis] *= scale;
        picture.viewport.shift[axis] += (scale - 1.0) / 2.0 + (first[axis] - 0.5) * scale / pixels;
    }
}

/// Moves the rays to the right and down by these numbers of pixels.
fn shift(picture: &mut Hypothesis, by: [f64; 2]) {
    let size = picture.size();
    (0..2).for_each(|axis| picture.viewport.shift[axis] += by[axis] / f64::from(size[axis]));
}

/// Cuts the viewport's width to a whole number, if the focal length is this.
fn whole_width(picture: &mut Hypothesis, focal: f64) {
    let [width, height] = picture.size().map(f64::from);
    let half = (picture.recipe.camera.vfov_degrees.to_radians() / 2.0).tan();
    let whole = 2.0 * half * focal * width / height;
    if whole >= 1.0 {
        picture.viewport.scale[0] *= whole.floor() / whole;
    }
}

/// Balls, colours and metal of older editions.
fn older_scene(picture: &mut Hypothesis, bubble_radius: f64) {
    let scene = Arc::make_mut(&mut picture.recipe.scene);
    let material = |name: &str| scene.materials.iter().position(|named| named.name == name);
    let [center, left, right] = ["center", "left", "right"].map(material);
    let is_metal = |index: usize| matches!(scene.materials[index].material, Material::Metal { .. });
    let is_fuzzy = |index: usize| scene.materials[index].material.effective_fuzz() > 0.0;
    let (is_metals, has_fuzz) = (left.is_some_and(is_metal), left.is_some_and(is_fuzzy));
    if let Some(bubble) = bubble(scene) {
        scene.spheres[bubble].radius = bubble_radius;
    }
    for sphere in &mut scene.spheres {
        if Some(sphere.material) == center {
            sphere.center.z = -1.0;
        }
    }
    if let Some(center) = center.filter(|_| is_metals) {
        scene.materials[center].material = Material::Lambertian { albedo: DVec3::new(0.7, 0.3, 0.3) };
    }
    if let Some(right) =
        right.filter(|_| !has_fuzz && picture.recipe.rules.dielectric != DielectricLaws::RefractOnly)
    {
        no_fuzz(&mut scene.materials[right].material);
    }
    if let Some(left) = left.filter(|_| picture.recipe.rules.dielectric == DielectricLaws::TotalReflection) {
        scene.materials[left].material = Material::Dielectric { refraction_index: 1.5 };
    }
    if let (Some(left), Some(center)) = (left, center)
        && picture.recipe.rules.dielectric == DielectricLaws::RefractOnly
    {
        scene.materials[center] = scene.materials[left].clone();
        scene.materials[center].name = "center".to_owned();
    }
}

/// The same with edition 3's cameras.
fn edition_3_scene(picture: &mut Hypothesis) {
    let is_moved = picture.recipe.camera.look_from != DVec3::ZERO;
    older_scene(picture, if is_moved { 0.45 } else { 0.4 });
    edition_3_camera(picture);
    let camera = &mut picture.recipe.camera;
    if camera.defocus_angle_degrees > 0.0 {
        camera.look_from = DVec3::new(3.0, 3.0, 2.0);
        let distance = camera.look_from.distance(camera.look_at);
        camera.focus_distance = Some(distance);
        camera.defocus_angle_degrees = 2.0 * distance.recip().atan().to_degrees();
    }
}

fn no_fuzz(material: &mut Material) {
    if let Material::Metal { fuzz, .. } = material {
        *fuzz = 0.0;
    }
}

fn grey(picture: &mut Hypothesis, share: f64) {
    picture.note = Some(format!("it looks like {:.0} %", 100.0 * share));
    materials(picture, |_| {});
    for named in &mut Arc::make_mut(&mut picture.recipe.scene).materials {
        named.material = Material::Lambertian { albedo: DVec3::splat(share) };
    }
}

fn look_back(picture: &mut Hypothesis, order: Order) {
    picture.written.order = order;
    let camera = &mut picture.recipe.camera;
    camera.focus_distance = Some(camera.effective_focus_distance());
    camera.look_at = 2.0 * camera.look_from - camera.look_at;
}

/// Changes the tangent of half the field of view, given half the field of view in radians.
fn field_of_view(picture: &mut Hypothesis, tangent: fn(f64) -> f64) {
    let vfov = &mut picture.recipe.camera.vfov_degrees;
    let tangent = tangent(vfov.to_radians() / 2.0).abs();
    *vfov = 2.0 * tangent.min(50.0).atan().to_degrees();
}

fn vector(picture: &mut Hypothesis, vector: fn(&mut Random) -> DVec3) {
    let steps = picture.plain();
    (steps.vector, steps.fuzz) = (vector, vector);
}

/// The vector or its opposite, on the side of the normal.
fn on_hemisphere(vector: DVec3, normal: DVec3) -> DVec3 {
    if vector.dot(normal) > 0.0 { vector } else { -vector }
}

/// A direction whose two angles are uniform; its pole is z.
fn polar(random: &mut Random) -> DVec3 {
    let [u, v] = random.pair();
    let (sin, cos) = (std::f64::consts::PI * u).sin_cos();
    let [x, y] = on_circle(sin, v);
    DVec3::new(x, y, cos)
}

fn change_bubble(picture: &mut Hypothesis, change: fn(&mut Scene, usize)) {
    let scene = Arc::make_mut(&mut picture.recipe.scene);
    if let Some(index) = bubble(scene) {
        change(scene, index);
    }
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

fn has_antialiasing(recipe: &Recipe) -> bool {
    recipe.rules.antialiasing
}

fn is_gradient(recipe: &Recipe) -> bool {
    !has_rays(recipe)
}

fn has_solids(recipe: &Recipe) -> bool {
    has_rays(recipe) && has_spheres(recipe)
}

fn has_metal(recipe: &Recipe) -> bool {
    has_material(recipe, |material| matches!(material, Material::Metal { .. }))
}

fn has_reflecting_glass(recipe: &Recipe) -> bool {
    has_glass(recipe) && recipe.rules.dielectric != DielectricLaws::RefractOnly
}

fn has_schlick(recipe: &Recipe) -> bool {
    has_glass(recipe) && recipe.rules.dielectric == DielectricLaws::Schlick
}

fn has_spheres(recipe: &Recipe) -> bool {
    !recipe.scene.spheres.is_empty()
}

fn has_bounces(recipe: &Recipe) -> bool {
    recipe.rules.shading == Shading::Path && has_spheres(recipe)
}

fn has_one_material(recipe: &Recipe) -> bool {
    has_bounces(recipe) && recipe.scene.materials.len() == 1
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
