//! Random and extreme scenes, what becomes of them before they are rendered, and what is warned of.

use crate::common::{at_once, check, digest_of};
use crate::scenes::prepared;
use glam::DVec3;
use std::fmt::Write as _;
use std::sync::Arc;
use weekender::prepared::PreparedScene;
use weekender::recipe::Recipe;
use weekender::scene::{Camera, Material, Scene};
use weekender::stress::{cases, random_scene};

/// All that a random scene consists of. The last digits depend on the system's functions, so nine are enough.
fn told(recipe: &Recipe) -> String {
    let Recipe { scene, camera, settings, .. } = recipe;
    let mut text = String::new();
    writeln!(
        text,
        "{}, {}x{}, {} samples, depth {}, seed {}",
        recipe.name,
        settings.width,
        settings.height,
        recipe.samples_per_pixel,
        settings.max_depth,
        settings.seed
    )
    .unwrap();
    writeln!(text, "  sky {} to {}", scene.sky.bottom, scene.sky.top).unwrap();
    let vector = |v: DVec3| format!("{:.8e} {:.8e} {:.8e}", v.x, v.y, v.z);
    writeln!(
        text,
        "  from {} to {}, up {}, view {:.8e}, lens {:.8e}, focus {:?}",
        vector(camera.look_from),
        vector(camera.look_at),
        camera.vup,
        camera.vfov_degrees,
        camera.defocus_angle_degrees,
        camera.focus_distance
    )
    .unwrap();
    for sphere in &scene.spheres {
        let named = &scene.materials[sphere.material];
        let (name, kind) = (&named.name, named.material.kind());
        writeln!(text, "  {name} {kind} at {}, radius {:.8e}", vector(sphere.center), sphere.radius).unwrap();
    }
    for named in &scene.materials {
        writeln!(text, "  {}: {:.8?}", named.name, named.material).unwrap();
    }
    text
}

#[test]
fn random_scenes_are_as_kept() {
    let mut text = String::new();
    for number in 0..12 {
        text.push_str(&told(&random_scene(1, number)));
    }
    for seed in [2, 3] {
        for number in 0..100 {
            let recipe = random_scene(seed, number);
            writeln!(text, "{} {}", recipe.name, digest_of(told(&recipe).as_bytes())).unwrap();
        }
    }
    check("random_scenes", &text);
}

#[test]
fn extreme_scenes_are_prepared_as_kept() {
    let random = (0..150).map(|number| random_scene(4, number)).map(|recipe| (recipe.name.clone(), recipe));
    let cases = cases().iter().filter(|case| case.recipe.scene.spheres.len() < 5000);
    let cases = cases.flat_map(|case| {
        case.forms().iter().map(move |form| (format!("{} {}", case.id, form.name()), case.recipe_in(*form)))
    });
    let recipes: Vec<(String, Recipe)> = cases.chain(random).collect();
    let texts = at_once(&recipes, |(name, recipe)| {
        let text = prepared::<f32>(recipe);
        let rows = text.lines().next().unwrap_or_default();
        format!("{name}:{rows}, all {}\n", digest_of(text.as_bytes()))
    });
    check("extreme_scenes", &texts.concat());
}

/// Two balls around the same place and the eye at some distance from them.
fn layer([gap, shift]: [f64; 2], materials: [Material; 2], camera: Camera) -> Vec<String> {
    let mut scene = Scene::default();
    let outer = scene.add_material("outer", materials[0]);
    let inner = scene.add_material("inner", materials[1]);
    scene.add_sphere(DVec3::ZERO, 1.0, outer);
    scene.add_sphere(DVec3::new(0.6, 0.0, 0.8) * shift, 1.0 - gap, inner);
    let mut recipe = Recipe::find("three-spheres").unwrap();
    (recipe.scene, recipe.camera) = (Arc::new(scene), camera);
    PreparedScene::<f32>::new(&recipe.job().unwrap()).warnings().to_vec()
}

/// The numbers of a sentence, and whether it is about surfaces that cross.
fn numbers(warning: &str) -> String {
    let has_digit = |word: &&str| word.contains(|c: char| c.is_ascii_digit());
    let numbers: Vec<&str> = warning.split(' ').filter(has_digit).collect();
    format!("{} {}", if warning.contains("touch or cross") { "crossing" } else { "thin" }, numbers.join(" "))
}

#[test]
fn thin_layers_are_warned_of_as_kept() {
    let matte = Material::Lambertian { albedo: DVec3::splat(0.5) };
    let glass = Material::Dielectric { refraction_index: 1.5 };
    let layers = [
        [4e-7, 0.0],
        [8e-7, 0.0],
        [1.2e-6, 0.0],
        [1.6e-6, 0.0],
        [1e-5, 0.0],
        [1e-5, 0.98e-5],
        [0.0, 5e-5],
        [0.0, 1.2e-4],
        [0.0, 2e-4],
        [2e-4, 2e-4],
        [0.0, 9e-3],
        [0.0, 9.99e-3],
        [0.0, 1.1e-2],
    ];
    let at = |distance: f64, degrees: f64| {
        let look_from = DVec3::new(0.0, distance, 0.0);
        let (look_at, vup) = (look_from + DVec3::X, DVec3::Y);
        Camera { look_from, look_at, vup, vfov_degrees: 20.0, defocus_angle_degrees: degrees, ..Camera::BOOK }
    };
    // A lens of 90 degrees reaches as far as the plane in focus, which is 1 away.
    let cameras = [
        ("afar", at(30.0, 0.0)),
        ("in front", at(3.0, 0.0)),
        ("above", at(1.5, 0.0)),
        ("with a lens that ends above", at(2.1, 90.0)),
        ("with a lens that reaches in", at(1.9, 90.0)),
        ("almost on it", at(1.0 + 5e-6, 0.0)),
        ("a little above", at(1.0 + 2e-5, 0.0)),
        ("almost on it from inside", at(1.0 - 5e-6, 0.0)),
        ("inside", at(0.25, 0.0)),
    ];
    let mut text = String::new();
    for (kinds, materials) in
        [("matte", [matte; 2]), ("glass", [glass; 2]), ("matte in glass", [glass, matte])]
    {
        for (place, camera) in &cameras {
            for thickness in layers {
                let warnings = layer(thickness, materials, *camera);
                let told: Vec<String> = warnings.iter().map(|warning| numbers(warning)).collect();
                let [gap, shift] = thickness;
                writeln!(text, "{kinds}, eye {place}, {gap:e} {shift:e}: {}", told.join("; ")).unwrap();
            }
        }
    }
    check("thin_layers", &text);
}

#[test]
fn several_layers_are_told_as_one_with_their_number() {
    let mut scene = Scene::default();
    let matte = scene.add_material("matte", Material::Lambertian { albedo: DVec3::splat(0.5) });
    let layers = [[4e-7, 0.0], [2e-7, 0.0], [3e-7, 0.0], [0.0, 5e-5], [0.0, 2e-5]];
    for ([gap, shift], place) in layers.into_iter().zip(0_u32..) {
        let center = DVec3::new(4.0 * f64::from(place), 0.0, 0.0);
        scene.add_sphere(center, 1.0, matte);
        scene.add_sphere(center + DVec3::Y * shift, 1.0 - gap, matte);
    }
    let mut recipe = Recipe::find("three-spheres").unwrap();
    let camera = Camera { look_from: DVec3::new(8.0, 0.0, 30.0), look_at: DVec3::ZERO, ..Camera::BOOK };
    (recipe.scene, recipe.camera) = (Arc::new(scene), camera);
    let prepared = PreparedScene::<f32>::new(&recipe.job().unwrap());
    let [thin, crossing] = prepared.warnings() else { panic!("{:?}", prepared.warnings()) };
    assert!(thin.contains("spheres 2 and 3 are at most 2.0e-7 apart"), "{thin}");
    assert!(thin.contains("(3 such layers in all)"), "{thin}");
    assert!(
        crossing.contains("spheres 8 and 9 touch or cross") && crossing.contains("(2 such"),
        "{crossing}"
    );
}
