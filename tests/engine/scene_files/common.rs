//! Scene files of few lines, and the round trip.

use weekender::job::recipe::Recipe;
use weekender::job::recipe::file::{parse, to_toml};

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

pub fn assert_round_trip(recipe: &Recipe) {
    let text = to_toml(recipe);
    let back = parse(&text, &recipe.name).unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(&back, recipe, "{text}");
    // Unlike equality, the text distinguishes -0 from 0.
    assert_eq!(format!("{back:?}"), format!("{recipe:?}"));
}
