//! Scene files of few lines, and the round trip.

use glam::DVec3;
use weekender::job::recipe::Recipe;
use weekender::job::recipe::file::{parse, to_toml};
use weekender::scene::Parameter;

/// The least that a file must contain.
pub const CAMERA: &str = "[camera]\nlook_from = [0, 0, 3]\nlook_at = [0, 0, 0]\nvfov_degrees = 40\n";

/// The material is on line 6, the radius on line 10.
pub const ONE_SPHERE: &str = "\
[camera]
look_from = [0, 0, 3]
look_at = [0, 0, 0]
vfov_degrees = 40
[materials.ball]
kind = \"lambertian\"
albedo = [0.5, 0.5, 0.5]
[[spheres]]
center = [0, 0, 0]
radius = 1
material = \"ball\"
";

/// Every number of a recipe in order, as bits, because `f64` equality does not distinguish -0 from 0.
pub fn bits(recipe: &Recipe) -> Vec<u64> {
    let Recipe { scene, camera, .. } = recipe;
    let vector = |v: DVec3| v.to_array().to_vec();
    let mut numbers = Vec::new();
    for v in [camera.look_from, camera.look_at, camera.vup, scene.sky.bottom, scene.sky.top] {
        numbers.extend(vector(v));
    }
    numbers.extend([camera.vfov_degrees, camera.defocus_angle_degrees]);
    numbers.extend(camera.focus_distance);
    for named in &scene.materials {
        for (_, parameter) in named.material.parameters() {
            match parameter {
                Parameter::Number(number) => numbers.push(number),
                Parameter::Colour(colour) => numbers.extend(vector(colour)),
            }
        }
    }
    for sphere in &scene.spheres {
        numbers.extend([vector(sphere.center), vec![sphere.radius]].concat());
    }
    numbers.into_iter().map(f64::to_bits).collect()
}

pub fn assert_round_trip(recipe: &Recipe) {
    let text = to_toml(recipe);
    let back = parse(&text, &recipe.name).unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(&back, recipe, "{text}");
    assert_eq!(bits(&back), bits(recipe), "{text}");
}
