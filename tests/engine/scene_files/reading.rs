//! Defaults, and the forms that a file may have.

use super::common::{CAMERA, ONE_SPHERE, assert_round_trip};
use glam::DVec3;
use weekender::job::recipe::file::parse;
use weekender::job::render::RenderSettings;
use weekender::scene::{Material, Scene, Sky};
use weekender::stages::{Rules, SurfaceRule};

#[test]
fn missing_keys_have_defaults() {
    let recipe = parse(CAMERA, "bare").expect("enough");
    assert_eq!(recipe.name, "bare");
    assert_eq!(*recipe.scene, Scene::default());
    assert_eq!(recipe.rules, Rules::default());
    assert_eq!(recipe.settings, RenderSettings::default());
    assert_eq!((recipe.settings.width, recipe.settings.height), (800, 450));
    assert_eq!((recipe.samples_per_pixel, recipe.settings.max_depth), (200, 50));
    let camera = recipe.camera;
    assert_eq!((camera.vup, camera.defocus_angle_degrees), (DVec3::Y, 0.0));
    assert_eq!((camera.focus_distance, camera.effective_focus_distance()), (None, 3.0));

    let text =
        format!("{CAMERA}[render]\nwidth = 400\n[sky]\ntop = [0, 0, 1]\n[rules]\nsurface = \"acne\"\n");
    let recipe = parse(&text, "some").expect("enough");
    assert_eq!(recipe.settings, RenderSettings { width: 400, ..RenderSettings::default() });
    assert_eq!(recipe.scene.sky, Sky { top: DVec3::Z, ..Sky::default() });
    assert_eq!(recipe.rules, Rules { surface: SurfaceRule::Acne, ..Rules::default() });
}

#[test]
fn materials_are_named_or_inline() {
    let inline = "material = { kind = \"metal\", albedo = [1, 0.5, 0] }";
    let text = ONE_SPHERE.replace("material = \"ball\"", inline);
    let recipe = parse(&text, "inline").expect("valid");
    let sphere = &recipe.scene.spheres[0];
    let metal = Material::Metal { albedo: DVec3::new(1.0, 0.5, 0.0), fuzz: 0.0 };
    assert_eq!(recipe.scene.material_of(sphere), &metal);
    assert_eq!(recipe.scene.materials.len(), 2);
    assert_round_trip(&recipe);

    // A name that the reader would choose itself.
    let taken = text.replace("materials.ball", "materials.sphere-0");
    assert_round_trip(&parse(&taken, "taken").expect("valid"));
}
