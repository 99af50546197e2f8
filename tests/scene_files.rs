//! Scene files: what is written is read back to the bit, and what is wrong is named with its line.

use glam::DVec3;
use proptest::prelude::*;
use std::path::Path;
use weekender::files::InputError;
use weekender::recipe::Recipe;
use weekender::recipe::file::{FileError, load, parse, to_picture_toml, to_toml};
use weekender::render::{RenderSettings, SamplerKind};
use weekender::scene::builtin::BuiltinScene;
use weekender::scene::{Camera, Material, Scene, Sky};
use weekender::stages::{DielectricLaws, Diffuse, Rules, Shading, Stage, SurfaceRule, Transfer};

/// The least that a file must hold.
const CAMERA: &str = "[camera]\nlook_from = [0, 0, 3]\nlook_at = [0, 0, 0]\nvfov_degrees = 40\n";

/// Line 6 has the material, line 10 the radius.
const ONE_SPHERE: &str = "\
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

/// Every number of a recipe in order, as bits: equality of `f64` would let -0 pass for 0.
fn bits(recipe: &Recipe) -> Vec<u64> {
    let Recipe { scene, camera, .. } = recipe;
    let vector = |v: DVec3| v.to_array().to_vec();
    let mut numbers = Vec::new();
    for v in [camera.look_from, camera.look_at, camera.vup, scene.sky.bottom, scene.sky.top] {
        numbers.extend(vector(v));
    }
    numbers.extend([camera.vfov_degrees, camera.defocus_angle_degrees]);
    numbers.extend(camera.focus_distance);
    for named in &scene.materials {
        match named.material {
            Material::Lambertian { albedo } => numbers.extend(vector(albedo)),
            Material::Metal { albedo, fuzz } => numbers.extend([vector(albedo), vec![fuzz]].concat()),
            Material::Dielectric { refraction_index } => numbers.push(refraction_index),
        }
    }
    for sphere in &scene.spheres {
        numbers.extend([vector(sphere.center), vec![sphere.radius]].concat());
    }
    numbers.into_iter().map(f64::to_bits).collect()
}

fn assert_round_trip(recipe: &Recipe) {
    let text = to_toml(recipe);
    let back = parse(&text, &recipe.name).unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(&back, recipe, "{text}");
    assert_eq!(bits(&back), bits(recipe), "{text}");
}

#[test]
fn every_scene_and_stage_is_read_back_to_the_bit() {
    for builtin in BuiltinScene::ALL {
        assert_round_trip(&Recipe::builtin(builtin.name).expect("in the registry"));
    }
    for stage in Stage::ALL {
        assert_round_trip(&stage.recipe());
    }
}

fn number(within: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    let (low, high) = (within.start, within.end);
    prop_oneof![
        8 => within,
        1 => Just(low),
        1 => (0.0..1.0_f64, -18..0).prop_map(move |(m, e)| (m * 10_f64.powi(e)).clamp(low, high)),
    ]
}

fn vector(within: std::ops::Range<f64>) -> impl Strategy<Value = DVec3> {
    [number(within.clone()), number(within.clone()), number(within)].prop_map(DVec3::from_array)
}

fn material() -> impl Strategy<Value = Material> {
    prop_oneof![
        vector(0.0..1.0).prop_map(|albedo| Material::Lambertian { albedo }),
        (vector(0.0..1.0), number(0.0..9.0)).prop_map(|(albedo, fuzz)| Material::Metal { albedo, fuzz }),
        number(1e-9..1e9).prop_map(|refraction_index| Material::Dielectric { refraction_index }),
    ]
}

fn rules() -> impl Strategy<Value = Rules> {
    let shading = prop::sample::select(vec![
        Shading::ImageGradient,
        Shading::FirstHitRed,
        Shading::Normals,
        Shading::Path,
    ]);
    let diffuse = prop::sample::select(vec![Diffuse::Hemisphere, Diffuse::Lambertian]);
    let dielectric = prop::sample::select(vec![
        DielectricLaws::RefractOnly,
        DielectricLaws::TotalReflection,
        DielectricLaws::Schlick,
    ]);
    let surface = prop::sample::select(vec![SurfaceRule::Exact, SurfaceRule::Acne, SurfaceRule::Book]);
    let transfer =
        prop::sample::select(vec![Transfer::Linear, Transfer::Gamma2, Transfer::LinearAboveGamma2]);
    (shading, diffuse, dielectric, surface, any::<bool>(), any::<bool>(), transfer).prop_map(
        |(shading, diffuse, dielectric, surface, reflectance_strips, antialiasing, transfer)| Rules {
            shading,
            diffuse,
            dielectric,
            surface,
            reflectance_strips,
            antialiasing,
            transfer,
        },
    )
}

fn scene() -> impl Strategy<Value = Scene> {
    let materials = prop::collection::btree_map(any::<String>(), material(), 0..6);
    let sphere = (vector(-1e18..1e18), number(1e-18..1e18), any::<prop::sample::Index>());
    let sky = (vector(0.0..100.0), vector(0.0..100.0)).prop_map(|(bottom, top)| Sky { bottom, top });
    (materials, prop::collection::vec(sphere, 0..60), sky, any::<bool>()).prop_map(
        |(materials, spheres, sky, is_reversed)| {
            let mut scene = Scene { sky, ..Scene::default() };
            for (name, material) in materials {
                scene.add_material(name, material);
            }
            if is_reversed {
                scene.materials.reverse();
            }
            for (center, radius, index) in spheres {
                if !scene.materials.is_empty() {
                    scene.add_sphere(center, radius, index.index(scene.materials.len()));
                }
            }
            scene
        },
    )
}

fn camera() -> impl Strategy<Value = Camera> {
    let focus = prop::option::of(number(1e-18..1e18));
    (vector(-1e3..1e3), vector(-1e3..1e3), vector(-2.0..2.0), number(0.01..179.0), number(0.0..179.0), focus)
        .prop_filter("a direction", |(look_from, look_at, ..)| look_from.distance(*look_at) > 1e-3)
        .prop_map(|(look_from, look_at, vup, vfov_degrees, defocus_angle_degrees, focus_distance)| Camera {
            look_from,
            look_at,
            vup,
            vfov_degrees,
            defocus_angle_degrees,
            focus_distance,
        })
}

fn recipe() -> impl Strategy<Value = Recipe> {
    let settings =
        (1..=16_384_u32, 1..=16_384_u32, 1..=10_000_u32, any::<bool>(), any::<u32>(), any::<bool>())
            .prop_map(|(width, height, max_depth, is_sobol, seed, estimate_error)| RenderSettings {
                width,
                height,
                max_depth,
                sampler: if is_sobol { SamplerKind::Sobol } else { SamplerKind::Independent },
                seed,
                estimate_error,
            });
    (any::<String>(), scene(), camera(), settings, rules(), 1..=1_u64 << 32).prop_map(
        |(name, scene, camera, settings, rules, samples_per_pixel)| Recipe {
            name,
            scene: scene.into(),
            camera,
            settings,
            rules,
            samples_per_pixel,
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_recipes_are_read_back_to_the_bit(recipe in recipe()) {
        assert_round_trip(&recipe);
    }

    #[test]
    fn no_text_makes_the_reader_panic(text in any::<String>(), cut in 0..ONE_SPHERE.len(), byte in 32_u8..127) {
        let _ = parse(&text, "random.toml");
        let _ = parse(&ONE_SPHERE[..cut], "cut.toml");
        let mut damaged = ONE_SPHERE.as_bytes().to_vec();
        damaged[cut] = byte;
        let _ = parse(&String::from_utf8(damaged).expect("ASCII"), "damaged.toml");
    }
}

#[test]
fn what_is_left_out_has_defaults() {
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

    // A name that the reader would have given itself.
    let taken = text.replace("materials.ball", "materials.sphere-0");
    assert_round_trip(&parse(&taken, "taken").expect("valid"));
}

#[test]
fn materials_keep_their_order() {
    let text = format!(
        "{CAMERA}[materials.zinc]\nkind = \"metal\"\nalbedo = [1, 1, 1]\n\
         [materials]\n\"a b\" = {{ kind = \"dielectric\", refraction_index = 1.5 }}\n"
    );
    let recipe = parse(&text, "order").expect("valid");
    let names: Vec<_> = recipe.scene.materials.iter().map(|named| named.name.as_str()).collect();
    assert_eq!(names, ["zinc", "a b"]);
}

/// The message for `text`, which must begin with the file's name and `line`.
fn refusal(text: &str, line: usize) -> String {
    let message = match parse(text, "bad.toml") {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(error) => error.to_string(),
    };
    assert!(message.starts_with(&format!("bad.toml:{line}:")), "line {line} expected: {message}\n{text}");
    message
}

/// The refusal of the one-sphere file with one line exchanged.
fn refusal_with(old: &str, new: &str, expected: &[&str]) {
    assert!(ONE_SPHERE.contains(old), "{old}");
    let text = ONE_SPHERE.replace(old, new);
    let line = 1 + ONE_SPHERE[..ONE_SPHERE.find(old).unwrap_or(0)].matches('\n').count();
    let message = refusal(&text, line);
    for part in expected {
        assert!(message.contains(part), "{part:?} is not in {message:?}");
    }
}

#[test]
fn bad_spheres_are_refused() {
    // Case 37.
    refusal_with("radius = 1", "radius = 0", &["spheres[0].radius is 0", "within 1e-18 and 1e18"]);
    refusal_with("radius = 1", "radius = -0.5", &["spheres[0].radius is -0.5", "hollow glass"]);
    refusal_with("radius = 1", "radius = nan", &["spheres[0].radius is NaN", "finite"]);
    refusal_with("radius = 1", "radius = inf", &["spheres[0].radius is inf", "finite"]);
    refusal_with("radius = 1", "radius = \"big\"", &["invalid type", "expected a number"]);
    refusal_with("center = [0, 0, 0]", "center = [0, nan, 0]", &["spheres[0].center.y is NaN"]);
    refusal_with("center = [0, 0, 0]", "center = [0, 0]", &["length 2", "three numbers"]);
    refusal_with("center = [0, 0, 0]", "center = [0, 0, 0, 0]", &["length 4", "three numbers"]);
    refusal_with("center = [0, 0, 0]", "center = 0", &["invalid type", "three numbers"]);
    refusal_with("material = \"ball\"", "material = \"bell\"", &["\"bell\"", "add [materials.bell]"]);
    refusal_with("material = \"ball\"", "material = 3", &["invalid type", "a material's name or a table"]);
    refusal_with("radius = 1", "radious = 1", &["unknown key `radious`", "`radius`"]);
    refusal_with("[[spheres]]\ncenter = [0, 0, 0]\n", "[[spheres]]\n", &["missing key `center`"]);
}

#[test]
fn bad_materials_are_refused() {
    let albedo = "albedo = [0.5, 0.5, 0.5]";
    refusal_with(
        albedo,
        "albedo = [0.5, 1.5, 0.5]",
        &["materials.ball.albedo is [0.5, 1.5, 0.5]", "within 0 and 1"],
    );
    refusal_with(albedo, "albedo = [0.5, 0.5, inf]", &["materials.ball.albedo.z is inf"]);
    refusal_with(
        "kind = \"lambertian\"",
        "kind = \"matte\"",
        &["materials.ball.kind is \"matte\"", "\"metal\""],
    );
}

#[test]
fn keys_of_a_material_suit_its_kind() {
    let with = |keys: &str| ONE_SPHERE.replace("kind = \"lambertian\"\nalbedo = [0.5, 0.5, 0.5]\n", keys);
    let lambertian = "kind = \"lambertian\"\nalbedo = [0, 0, 0]\n";

    let message = refusal(&with(&format!("{lambertian}fuzz = 0.1\n")), 8);
    assert!(message.contains("materials.ball.fuzz has no meaning for lambertian"), "{message}");
    let message = refusal(&with("kind = \"dielectric\"\nrefraction_index = 1.5\nalbedo = [1, 1, 1]\n"), 8);
    assert!(message.contains("has only refraction_index"), "{message}");
    let message = refusal(&with("kind = \"metal\"\nfuzz = 0.1\n"), 5);
    assert!(message.contains("materials.ball is metal and needs the key \"albedo\""), "{message}");
    let message = refusal(&with("kind = \"dielectric\"\n"), 5);
    assert!(message.contains("refraction_index = 1.5"), "{message}");
    let message = refusal(&with("albedo = [0, 0, 0]\n"), 5);
    assert!(message.contains("missing key `kind`"), "{message}");
    let message = refusal(&with(&format!("{lambertian}glow = 1\n")), 8);
    assert!(message.contains("unknown key `glow`"), "{message}");
    let message = refusal(&with("kind = \"metal\"\nalbedo = [0, 0, 0]\nfuzz = -1\n"), 8);
    assert!(message.contains("materials.ball.fuzz is -1, but must be 0 or more"), "{message}");
    let message = refusal(&with("kind = \"dielectric\"\nrefraction_index = 0\n"), 7);
    assert!(message.contains("materials.ball.refraction_index is 0"), "{message}");
}

#[test]
fn inline_materials_are_named_by_their_sphere() {
    let with = |table: &str| ONE_SPHERE.replace("\"ball\"\n", &format!("{table}\n"));
    for (table, expected) in [
        ("{ kind = \"metal\", albedo = [1, 1, 2] }", "spheres[0].material.albedo is [1, 1, 2]"),
        ("{ kind = \"metal\", albedo = [1, 1, 1], fuzz = nan }", "spheres[0].material.fuzz is NaN"),
        ("{ kind = \"glass\" }", "spheres[0].material.kind is \"glass\""),
        ("{ kind = \"metal\" }", "spheres[0].material is metal and needs"),
        ("{ kind = \"metal\", colour = 3 }", "unknown key `colour`"),
    ] {
        let message = refusal(&with(table), 11);
        assert!(message.contains(expected), "{expected:?} is not in {message:?}");
    }
}

#[test]
fn bad_cameras_are_refused() {
    // Case 32.
    for vfov in ["0", "180", "-20.0"] {
        let expected = ["vfov_degrees is", "within 0.01 and 179 degrees"];
        refusal_with("vfov_degrees = 40", &format!("vfov_degrees = {vfov}"), &expected);
    }
    refusal_with("vfov_degrees = 40", "vfov_degrees = nan", &["vfov_degrees is NaN", "finite"]);
    // Case 31.
    refusal_with("look_at = [0, 0, 0]", "look_at = [0, 0, 3]", &["look_from and look_at are both [0, 0, 3]"]);
    // Case 33.
    let with = |line: &str| ONE_SPHERE.replace("[materials.ball]", &format!("{line}\n[materials.ball]"));
    for (line, expected) in [
        ("focus_distance = 0", "focus_distance is 0, but must be within"),
        ("focus_distance = -1.5", "focus_distance is -1.5"),
        ("defocus_angle_degrees = 180", "below 179 degrees"),
        ("defocus_angle_degrees = -1", "use 0 for a pinhole"),
        ("defocus_angle_degrees = inf", "defocus_angle_degrees is inf"),
        ("vup = [0, 0, nan]", "vup.z is NaN"),
        ("vup = [0, 0]", "three numbers"),
        ("roll = 3", "unknown key `roll`"),
    ] {
        let message = refusal(&with(line), 5);
        assert!(message.contains(expected), "{expected:?} is not in {message:?}");
    }
    refusal_with("look_from = [0, 0, 3]", "look_from = [0, inf, 3]", &["look_from.y is inf"]);
    refusal_with("look_from = [0, 0, 3]", "look_from = [0, 1e30, 3]", &["look_from.y is", "scale the scene"]);
    let message = refusal(&CAMERA.replace("vfov_degrees = 40\n", ""), 1);
    assert!(message.contains("missing key `vfov_degrees`"), "{message}");
    let message = refusal("", 1);
    assert!(message.contains("missing key `camera`"), "{message}");
}

/// Case 31: up along the view is no error.
#[test]
fn up_may_lie_along_the_view() {
    parse(&format!("{CAMERA}vup = [0, 0, 1]\n"), "up").expect("valid");
}

#[test]
fn bad_settings_are_refused() {
    for (line, expected) in [
        ("width = 0", "width is 0, but must be within 1 and 16384"),
        ("height = 100000", "height is 100000, but must be within 1 and 16384"),
        ("width = -5", "width is -5"),
        ("width = 99999999999", "width is 99999999999"),
        ("width = 40.5", "expected a whole number"),
        ("samples_per_pixel = 0", "samples_per_pixel is 0, but must be within 1 and 4294967296"),
        ("samples_per_pixel = -1", "samples_per_pixel is -1"),
        ("max_depth = 0", "max_depth is 0, but must be within 1 and 10000"),
        ("max_depth = 10001", "max_depth is 10001"),
        ("seed = -1", "seed is -1, but must be within 0 and 4294967295"),
        ("sampler = \"random\"", "`sobol`"),
        ("samples = 3", "unknown key `samples`"),
        ("estimate_error = 1", "expected a boolean"),
    ] {
        let message = refusal(&format!("{CAMERA}[render]\n{line}\n"), 6);
        assert!(message.contains(expected), "{expected:?} is not in {message:?}");
    }
    for (table, line, expected) in [
        ("sky", "top = [0, 0, 101]", "sky.top is [0, 0, 101], but each component must be within 0 and 100"),
        ("sky", "bottom = [nan, 0, 0]", "sky.bottom.x is NaN"),
        ("sky", "middle = [0, 0, 0]", "unknown key `middle`"),
        ("rules", "surface = \"smooth\"", "`exact`"),
        ("rules", "gravity = true", "unknown key `gravity`"),
    ] {
        let message = refusal(&format!("{CAMERA}[{table}]\n{line}\n"), 6);
        assert!(message.contains(expected), "{expected:?} is not in {message:?}");
    }
}

#[test]
fn malformed_text_is_refused() {
    let message = refusal(&ONE_SPHERE.replace("look_at = [0, 0, 0]", "look_at = [0, 0, 0"), 4);
    assert!(message.contains("missing comma"), "{message}");
    refusal_with("radius = 1", "radius 1", &[]);
    let message = refusal(&format!("{CAMERA}[lights]\n"), 5);
    assert!(message.contains("unknown key `lights`"), "{message}");
    let message = refusal(&format!("{CAMERA}[camera]\n"), 5);
    assert!(message.contains("duplicate key"), "{message}");
    // Columns count characters.
    let message = refusal("# é\n[camera]\n\"é\" = 1\n", 3);
    assert!(message.starts_with("bad.toml:3:1: unknown key `é`"), "{message}");
}

#[test]
fn lines_are_those_of_the_file_whatever_their_ends() {
    let message = refusal(&ONE_SPHERE.replace("radius = 1", "radius = 0").replace('\n', "\r\n"), 10);
    assert!(message.contains("spheres[0].radius is 0"), "{message}");
}

#[test]
fn unreadable_files_are_told_from_bad_ones() {
    let folder = tempfile::tempdir().expect("a folder");
    let missing = folder.path().join("missing.toml");
    let error = load(&missing).expect_err("missing");
    assert!(matches!(error, FileError::Input(InputError::Unreadable { .. })));
    let message = error.to_string();
    assert!(message.contains("missing.toml") && message.contains("check its name"), "{message}");
    let message = load(folder.path()).expect_err("a directory").to_string();
    assert!(message.contains("is a directory, but a file is needed; name a file in it"), "{message}");
    let huge = folder.path().join("huge.toml");
    std::fs::File::create(&huge).and_then(|file| file.set_len(1 << 40)).expect("a sparse file");
    let message = load(&huge).expect_err("too long").to_string();
    assert!(message.contains("has 1099.5 GB, but a scene file of more than 1.1 GB is not read"), "{message}");
    #[cfg(unix)]
    {
        let message = load(Path::new("/dev/zero")).expect_err("endless").to_string();
        assert!(
            message.contains("/dev/zero is a device, but a file is needed; save what it gives"),
            "{message}"
        );
    }

    let binary = folder.path().join("binary.toml");
    std::fs::write(&binary, b"[camera]\nlook_from = [0,\xff\xfe").expect("written");
    let message = load(&binary).expect_err("no text").to_string();
    assert!(message.contains("binary.toml:2: this is not UTF-8 text"), "{message}");

    let bad = folder.path().join("bad.toml");
    std::fs::write(&bad, ONE_SPHERE.replace("radius = 1", "radius = 0")).expect("written");
    let message = load(&bad).expect_err("no radius").to_string();
    assert!(message.contains("bad.toml:10:1: spheres[0].radius is 0"), "{message}");

    let good = folder.path().join("my scene.v2.toml");
    std::fs::write(&good, ONE_SPHERE).expect("written");
    assert_eq!(load(&good).expect("valid").name, "my scene.v2");
}

#[test]
fn the_example_scenes_are_valid() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes");
    let mut count = 0;
    let files =
        |folder| std::fs::read_dir(folder).expect("the folder").map(|entry| entry.expect("an entry").path());
    for path in files(scenes.clone()).filter(|path| path.is_file()).chain(files(scenes.join("stress"))) {
        let recipe = load(&path).unwrap_or_else(|error| panic!("{error}"));
        assert!(!recipe.scene.spheres.is_empty(), "{}", path.display());
        assert_eq!(recipe.rules, Rules::default(), "{}", path.display());
        assert_round_trip(&recipe);
        count += 1;
    }
    assert!(count >= 10);
}

/// The text of a large scene stays readable: a line for a sphere.
#[test]
fn large_scenes_are_written_compactly() {
    let book = Recipe::builtin("book").expect("a scene");
    let text = to_toml(&book);
    let lines = text.lines().count();
    assert!(lines < book.scene.spheres.len() + book.scene.materials.len() + 40, "{lines}");
    assert!(text.lines().all(|line| line.len() < 110));
    assert!(text.contains("center = [0.0, -1000.0, 0.0], radius = 1000.0, material = \"ground\""));
}

#[test]
fn a_hundred_thousand_spheres_are_read_back() {
    assert_round_trip(&Recipe::builtin("field:100000").expect("a field"));
}

#[test]
fn a_picture_names_a_large_field_and_restores_it() {
    let field = Recipe::builtin("field:20000").expect("a field");
    let text = to_picture_toml(&field);
    assert!(text.len() < 1000 && text.starts_with("scene = \"field:20000\""), "{text}");
    assert_eq!(parse(&text, "field:20000").expect("valid"), field);
    // One that was changed is listed.
    let mut changed = field.clone();
    std::sync::Arc::make_mut(&mut changed.scene).spheres[3].radius = 0.25;
    assert_eq!(parse(&to_picture_toml(&changed), "field:20000").expect("valid"), changed);
    assert!(to_picture_toml(&changed).len() > 1_000_000);

    let message = |text: &str| parse(text, "x").expect_err("refused").to_string();
    let mark = text.lines().nth(1).expect("a mark");
    let other = message(&text.replace(mark, "scene_mark = \"0123456789abcdef\""));
    assert!(
        other.starts_with("x:2:1: ") && other.contains("field:20000") && other.contains("scene_mark"),
        "{other}"
    );
    let named = CAMERA.replace("[camera]", "scene = \"three-spheres\"\n[camera]");
    assert_eq!(
        parse(&named, "x").expect("valid").scene,
        Recipe::builtin("three-spheres").expect("one").scene
    );
    let unknown = message(&named.replace("three-spheres", "three-sphere"));
    assert!(unknown.starts_with("x:1:1: ") && unknown.contains("did you mean three-spheres"), "{unknown}");
    let both = message(&format!("{named}\n[sky]\ntop = [1, 1, 1]\n"));
    assert!(both.contains("sky cannot be combined with scene"), "{both}");
}
