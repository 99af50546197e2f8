//! The mistakes that are known, each with what to change.

use crate::recipe::Recipe;
use crate::scene::Material;
use crate::stages::{DielectricLaws, Diffuse, Shading, SurfaceRule, Transfer};

/// A mistake that readers of the book make.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs, reason = "the titles say what they are")]
pub enum Mistake {
    FlippedRows,
    MirroredColumns,
    SwappedChannels,
    NoGamma,
    GammaEarly,
    GammaTwice,
    TimesInteger,
    Truncated,
    NoAntialiasing,
    HalfPixelUp,
    HalfPixelDown,
    WidthLessOne,
    IntegerAspect,
    VfovRadians,
    SkyReversed,
    HalfBSign,
    LastHitWins,
    ZeroTMin,
    NormalNotUnit,
    NormalsNotFlipped,
    Hemisphere,
    LambertianEarly,
    PointInSphere,
    BounceLimit,
    FuzzMissing,
    FuzzUnnormalised,
    RefractUnnormalised,
    IndexInverted,
    AlwaysRefract,
    SchlickMissing,
    HollowMissing,
    HollowIndex,
    LensCentre,
    FocusDistanceOne,
}

/// What is said about a mistake.
#[derive(Clone, Copy, Debug)]
pub struct About {
    /// The identifier in JSON.
    pub id: &'static str,
    /// The mistake in a few words.
    pub title: &'static str,
    /// What to change.
    pub remedy: &'static str,
}

impl Mistake {
    /// All mistakes, those of the file and the camera first.
    pub const ALL: [Mistake; 34] = [
        Mistake::FlippedRows,
        Mistake::MirroredColumns,
        Mistake::SwappedChannels,
        Mistake::NoGamma,
        Mistake::GammaEarly,
        Mistake::GammaTwice,
        Mistake::TimesInteger,
        Mistake::Truncated,
        Mistake::NoAntialiasing,
        Mistake::HalfPixelUp,
        Mistake::HalfPixelDown,
        Mistake::WidthLessOne,
        Mistake::IntegerAspect,
        Mistake::VfovRadians,
        Mistake::SkyReversed,
        Mistake::HalfBSign,
        Mistake::LastHitWins,
        Mistake::ZeroTMin,
        Mistake::NormalNotUnit,
        Mistake::NormalsNotFlipped,
        Mistake::Hemisphere,
        Mistake::LambertianEarly,
        Mistake::PointInSphere,
        Mistake::BounceLimit,
        Mistake::FuzzMissing,
        Mistake::FuzzUnnormalised,
        Mistake::RefractUnnormalised,
        Mistake::IndexInverted,
        Mistake::AlwaysRefract,
        Mistake::SchlickMissing,
        Mistake::HollowMissing,
        Mistake::HollowIndex,
        Mistake::LensCentre,
        Mistake::FocusDistanceOne,
    ];

    /// What is said about it.
    pub fn about(self) -> About {
        let (id, title, remedy) = match self {
            Mistake::FlippedRows => (
                "flipped-rows",
                "the rows are upside down",
                "write the top row first: count j upwards from 0, and let viewport_v point down (0, -viewport_height, 0)",
            ),
            Mistake::MirroredColumns => (
                "mirrored-columns",
                "left and right are swapped",
                "let viewport_u point right; with look_from and look_at, u = unit_vector(cross(vup, w)) in this order",
            ),
            Mistake::SwappedChannels => (
                "swapped-channels",
                "the colour channels are swapped",
                "write red, green, blue in this order; check x, y, z of the colour and formats that want BGR",
            ),
            Mistake::NoGamma => (
                "no-gamma",
                "gamma is missing",
                "take the square root of each channel in write_color, after dividing by the samples",
            ),
            Mistake::GammaEarly => (
                "gamma-early",
                "gamma is applied, though this section does not have it yet",
                "nothing is wrong if you have read on; section 9.5 adds the square root",
            ),
            Mistake::GammaTwice => (
                "gamma-twice",
                "gamma is applied twice",
                "take the square root once: either in write_color or in your picture library, which may write sRGB from \
                 linear values",
            ),
            Mistake::TimesInteger => (
                "scale-255",
                "channels are multiplied by 255 and cut off",
                "use int(256 * clamp(x, 0, 0.999)), or 255.999: with 255, only a value of exactly 1 becomes 255",
            ),
            Mistake::Truncated => (
                "truncated",
                "channels are cut to whole numbers before they are scaled",
                "scale first, then convert: int(256 * x), not int(x) * 256; divide as floating-point numbers",
            ),
            Mistake::NoAntialiasing => (
                "no-antialiasing",
                "all samples pass through the centre of the pixel",
                "add a random offset within -0.5..0.5 to i and j for each sample",
            ),
            Mistake::HalfPixelUp => (
                "half-pixel-up",
                "the picture is shifted by half a pixel, down and to the right",
                "let pixel00_loc be the centre of the first pixel: the upper left corner plus 0.5 * (pixel_delta_u + \
                 pixel_delta_v)",
            ),
            Mistake::HalfPixelDown => (
                "half-pixel-down",
                "the picture is shifted by half a pixel, up and to the left",
                "draw the offsets of a sample from -0.5..0.5, not from 0..1: pixel00_loc is already the pixel's centre",
            ),
            Mistake::WidthLessOne => (
                "width-less-one",
                "pixels are spaced by the width less one",
                "divide the viewport by image_width and image_height; older editions had image_width - 1",
            ),
            Mistake::IntegerAspect => (
                "integer-aspect",
                "the aspect ratio is a whole number",
                "divide as floating-point numbers: double(image_width) / image_height, and 16.0 / 9.0",
            ),
            Mistake::VfovRadians => (
                "vfov-radians",
                "the field of view is used as radians",
                "convert it first: theta = degrees_to_radians(vfov)",
            ),
            Mistake::SkyReversed => (
                "sky-reversed",
                "the sky is upside down",
                "blend (1 - a) * white + a * blue, with a = 0.5 * (unit_direction.y + 1)",
            ),
            Mistake::HalfBSign => (
                "half-b-sign",
                "the quadratic formula has the wrong sign",
                "with oc = center - origin, h = dot(direction, oc) and the roots are (h - sqrtd) / a and (h + sqrtd) / a; \
                 with oc = origin - center, they are (-h - sqrtd) / a and (-h + sqrtd) / a",
            ),
            Mistake::LastHitWins => (
                "last-hit-wins",
                "the last sphere in the list hides nearer ones",
                "pass interval(ray_t.min, closest_so_far) to hit, and set closest_so_far = temp_rec.t after each hit",
            ),
            Mistake::ZeroTMin => (
                "zero-t-min",
                "rays hit the surface that they start on (shadow acne)",
                "let hits begin at 0.001: world.hit(r, interval(0.001, infinity), rec)",
            ),
            Mistake::NormalNotUnit => (
                "normal-not-unit",
                "the normal does not have length 1",
                "divide by the radius: outward_normal = (rec.p - center) / radius",
            ),
            Mistake::NormalsNotFlipped => (
                "normals-not-flipped",
                "the normal is not turned against the ray inside a sphere",
                "call rec.set_face_normal(r, outward_normal) in sphere::hit, and use rec.front_face in dielectric::scatter",
            ),
            Mistake::Hemisphere => (
                "hemisphere",
                "matte surfaces scatter uniformly over the hemisphere",
                "let the direction be rec.normal + random_unit_vector()",
            ),
            Mistake::LambertianEarly => (
                "lambertian-early",
                "matte surfaces are Lambertian, though this section is uniform over the hemisphere",
                "nothing is wrong if you have read on; section 9.4 adds it",
            ),
            Mistake::PointInSphere => (
                "point-in-sphere",
                "matte surfaces scatter to a point in the unit sphere, not on it",
                "normalise the random vector: rec.normal + random_unit_vector()",
            ),
            Mistake::BounceLimit => (
                "bounce-limit",
                "paths end after too few bounces",
                "set max_depth to 50, and pass depth - 1 to the next call only",
            ),
            Mistake::FuzzMissing => (
                "fuzz-missing",
                "fuzz has no effect",
                "add fuzz * random_unit_vector() to the reflected direction, and store fuzz in the constructor",
            ),
            Mistake::FuzzUnnormalised => (
                "fuzz-unnormalised",
                "fuzz is added to a reflected direction of another length than 1",
                "normalise first: reflected = unit_vector(reflected) + (fuzz * random_unit_vector())",
            ),
            Mistake::RefractUnnormalised => (
                "refract-unnormalised",
                "the direction is not normalised before it is refracted or reflected",
                "use unit_direction = unit_vector(r_in.direction()) for cos_theta, refract and reflect",
            ),
            Mistake::IndexInverted => (
                "index-inverted",
                "the refraction index is inverted",
                "ri = rec.front_face ? (1.0 / refraction_index) : refraction_index",
            ),
            Mistake::AlwaysRefract => (
                "always-refract",
                "glass refracts even where Snell's law has no solution",
                "reflect if ri * sin_theta > 1.0",
            ),
            Mistake::SchlickMissing => (
                "schlick-missing",
                "glass does not reflect at grazing angles (Schlick's approximation)",
                "also reflect if reflectance(cos_theta, ri) > random_double()",
            ),
            Mistake::HollowMissing => (
                "hollow-missing",
                "the sphere of air inside the glass sphere is missing",
                "add a sphere of radius 0.4 at the same place, of dielectric(1.00 / 1.50)",
            ),
            Mistake::HollowIndex => (
                "hollow-index",
                "the sphere inside the glass sphere is glass, too",
                "the inner sphere is air in glass: dielectric(1.00 / 1.50)",
            ),
            Mistake::LensCentre => (
                "lens-centre",
                "all rays start at the centre of the lens",
                "let ray_origin = (defocus_angle <= 0) ? center : defocus_disk_sample(), and subtract it from pixel_sample",
            ),
            Mistake::FocusDistanceOne => (
                "focus-distance-one",
                "the plane in focus is 1 away",
                "use focus_dist for the viewport: viewport_height = 2 * h * focus_dist, and center - focus_dist * w",
            ),
        };
        About { id, title, remedy }
    }

    /// Whether only the way from values to bytes is wrong.
    pub fn is_of_output(self) -> bool {
        matches!(
            self,
            Mistake::FlippedRows
                | Mistake::MirroredColumns
                | Mistake::SwappedChannels
                | Mistake::NoGamma
                | Mistake::GammaEarly
                | Mistake::GammaTwice
        )
    }

    /// Whether the mistake shows at edges only.
    pub fn is_of_pixels(self) -> bool {
        matches!(
            self,
            Mistake::NoAntialiasing | Mistake::HalfPixelUp | Mistake::HalfPixelDown | Mistake::WidthLessOne
        )
    }

    /// Whether the mistake can show in a picture of `recipe`.
    pub fn applies_to(self, recipe: &Recipe) -> bool {
        let rules = &recipe.rules;
        let has =
            |test: fn(&Material) -> bool| recipe.scene.materials.iter().any(|named| test(&named.material));
        let is_path = rules.shading == Shading::Path;
        let has_glass = is_path && has(|material| matches!(material, Material::Dielectric { .. }));
        let has_fuzz = is_path && has(|material| material.effective_fuzz() > 0.0);
        let has_matte = is_path && has(|material| matches!(material, Material::Lambertian { .. }));
        let has_spheres = !recipe.scene.spheres.is_empty();
        let has_lens = recipe.camera.defocus_angle_degrees > 0.0;
        let is_hollow = has_glass && bubble(recipe).is_some();
        let is_gradient = rules.shading == Shading::ImageGradient;
        match self {
            Mistake::FlippedRows | Mistake::MirroredColumns | Mistake::SwappedChannels => true,
            Mistake::TimesInteger | Mistake::Truncated => true,
            Mistake::NoGamma | Mistake::GammaTwice => rules.transfer == Transfer::Gamma2,
            Mistake::GammaEarly => rules.transfer == Transfer::Linear,
            Mistake::NoAntialiasing => rules.antialiasing,
            Mistake::HalfPixelUp | Mistake::HalfPixelDown | Mistake::WidthLessOne => !is_gradient,
            Mistake::IntegerAspect | Mistake::VfovRadians | Mistake::SkyReversed => !is_gradient,
            Mistake::HalfBSign | Mistake::NormalNotUnit => !is_gradient && has_spheres,
            Mistake::LastHitWins => !is_gradient && recipe.scene.spheres.len() > 1,
            Mistake::ZeroTMin => is_path && has_spheres && rules.surface != SurfaceRule::Acne,
            Mistake::NormalsNotFlipped => has_glass,
            Mistake::Hemisphere | Mistake::PointInSphere => has_matte && rules.diffuse == Diffuse::Lambertian,
            Mistake::LambertianEarly => has_matte && rules.diffuse == Diffuse::Hemisphere,
            Mistake::BounceLimit => is_path && has_spheres,
            Mistake::FuzzMissing | Mistake::FuzzUnnormalised => has_fuzz,
            Mistake::RefractUnnormalised | Mistake::IndexInverted => has_glass,
            Mistake::AlwaysRefract => has_glass && rules.dielectric != DielectricLaws::RefractOnly,
            Mistake::SchlickMissing => has_glass && rules.dielectric == DielectricLaws::Schlick,
            Mistake::HollowMissing | Mistake::HollowIndex => is_hollow,
            Mistake::LensCentre => has_lens,
            Mistake::FocusDistanceOne => has_lens,
        }
    }
}

/// The index of a sphere of air inside a sphere of glass.
pub(super) fn bubble(recipe: &Recipe) -> Option<usize> {
    let index = |material: usize| match recipe.scene.materials.get(material).map(|named| named.material) {
        Some(Material::Dielectric { refraction_index }) => Some(refraction_index),
        _ => None,
    };
    let spheres = &recipe.scene.spheres;
    spheres.iter().position(|inner| {
        let is_around = |outer: &&crate::scene::Sphere| {
            outer.radius > inner.radius && outer.center == inner.center && index(outer.material).is_some()
        };
        index(inner.material).is_some_and(|index| index < 1.0)
            && spheres.iter().any(|outer| is_around(&outer))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::Stage;

    #[test]
    fn mistakes_of_bounces_need_both_paths_and_spheres() {
        for (id, can_show) in [("sky", false), ("normals-world", false), ("lambertian-gamma", true)] {
            let recipe = Stage::find(id).unwrap().recipe();
            for mistake in [Mistake::ZeroTMin, Mistake::BounceLimit] {
                assert_eq!(mistake.applies_to(&recipe), can_show, "{mistake:?} in {id}");
            }
        }
    }

    #[test]
    fn a_bubble_is_a_smaller_sphere_of_air_around_the_middle_of_a_sphere_of_glass() {
        use glam::DVec3;
        use std::sync::Arc;
        let (glass, air) = (1.5, 1.0 / 1.5);
        let found = |spheres: &[(f64, f64, f64)]| {
            let mut recipe = Stage::find("metal").unwrap().recipe();
            let scene = Arc::make_mut(&mut recipe.scene);
            scene.spheres.clear();
            let matte = scene.add_material("m", Material::Lambertian { albedo: DVec3::ONE });
            for (index, (x, radius, refraction_index)) in spheres.iter().copied().enumerate() {
                let clear = Material::Dielectric { refraction_index };
                let material = if refraction_index > 0.0 {
                    scene.add_material(format!("{index}"), clear)
                } else {
                    matte
                };
                scene.add_sphere(DVec3::X * x, radius, material);
            }
            bubble(&recipe)
        };
        assert_eq!(found(&[(0.0, 0.5, glass), (0.0, 0.4, air)]), Some(1));
        assert_eq!(found(&[(1.0, 0.4, air), (0.0, 0.4, air), (0.0, 0.5, glass)]), Some(1));
        assert_eq!(found(&[(0.0, 0.4, air)]), None, "alone");
        assert_eq!(found(&[(0.0, 0.4, glass), (0.0, 0.4, air)]), None, "as large");
        assert_eq!(found(&[(0.0, 0.3, glass), (0.0, 0.4, air)]), None, "larger");
        assert_eq!(found(&[(0.1, 0.5, glass), (0.0, 0.4, air)]), None, "beside the middle");
        assert_eq!(found(&[(0.0, 0.5, 0.0), (0.0, 0.4, air)]), None, "in matte");
        assert_eq!(found(&[(0.0, 0.5, glass), (0.0, 0.4, 1.0)]), None, "of nothing");
        assert_eq!(found(&[(0.0, 0.5, glass), (0.0, 0.4, glass)]), None, "of glass");
    }
}
