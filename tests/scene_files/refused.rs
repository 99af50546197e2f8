//! What is wrong is named with its line.

use super::common::{CAMERA, ONE_SPHERE};
use std::path::Path;
use weekender::files::InputError;
use weekender::recipe::file::{FileError, load, parse};

/// The message for `text`, which must begin with the file's name and `line`.
fn refusal(text: &str, line: usize) -> String {
    let message = match parse(text, "bad.toml") {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(error) => error.to_string(),
    };
    assert!(message.starts_with(&format!("bad.toml:{line}:")), "line {line} expected: {message}\n{text}");
    message
}

/// The error message for the one-sphere file with one line replaced.
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
    refusal_with(
        "radius = 1",
        "radius = 1e300",
        &["spheres[0].radius is 1e300, but", "1e18", "give the sphere"],
    );
    refusal_with("radius = 1", "radius = 1e-300", &["spheres[0].radius is 1e-300, but"]);
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
    for (vup, expected) in
        [("[0, 0, 0]", "vup is [0, 0, 0], which has no direction"), ("[0, 0, -2]", "parallel to the view")]
    {
        let message =
            refusal(&ONE_SPHERE.replace("[materials.ball]", &format!("vup = {vup}\n[materials.ball]")), 5);
        assert!(
            message.contains(expected) && message.contains("use another, such as [0, 1, 0]"),
            "{message}"
        );
    }
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

#[test]
fn bad_settings_are_refused() {
    for (line, expected) in [
        ("width = 0", "width is 0, but must be within 1 and 16384"),
        ("height = 100000", "height is 100000, but must be within 1 and 16384"),
        ("width = -5", "width is -5"),
        ("width = 99999999999", "width is 99999999999"),
        (
            "width = 40.5",
            "width is 40.5, but must be a whole number within 1 and 16384; give pixels, such as 800",
        ),
        ("width = 8e2", "width is 800.0, but must be a whole number within"),
        ("width = \"8\"", "expected a whole number"),
        (
            "max_depth = 99999999999999999999",
            "max_depth is 99999999999999999999, but must be within 1 and 10000",
        ),
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
    assert!(message.contains("duplicate key `camera`; keep one of them"), "{message}");
    let message = refusal(&ONE_SPHERE.replace("radius = 1", "radius = 1\nradius = 2"), 11);
    assert!(message.contains("duplicate key `radius`; keep one of them"), "{message}");
    let message = refusal(&ONE_SPHERE.replace("radius = 1", "\"a b\" = 1\n\"a b\" = 2"), 11);
    assert!(message.contains("duplicate key") && message.contains("a b"), "{message}");
    // Columns count characters.
    let message = refusal("# é\n[camera]\n\"é\" = 1\n", 3);
    assert!(message.starts_with("bad.toml:3:1: unknown key `é`"), "{message}");
    let line = "\"é\" = { kind = \"metal\", albedo = [0.5, 0.5, 0.5], fuzz = -1 }";
    let message = refusal(&format!("{CAMERA}[materials]\n{line}\n"), 6);
    assert!(message.starts_with("bad.toml:6:51: materials.é.fuzz is -1"), "{message}");
}

#[test]
fn numbers_that_no_type_holds_are_refused_as_typed() {
    let limits = ["within 1e-18 and 1e18", "give the sphere a size"];
    for number in ["1e400", "1_0e999", "99999999999999999999999999999999999999999"] {
        refusal_with("radius = 1", &format!("radius = {number}"), &limits);
        refusal_with(
            "radius = 1",
            &format!("radius = {number}"),
            &[&format!("spheres[0].radius is {number}, but")],
        );
    }
    refusal_with("radius = 1", "radius = -1e400", &["spheres[0].radius is -1e400, but", "hollow glass"]);
    // An integer that is too large for a length is a number all the same.
    refusal_with(
        "radius = 1",
        "radius = 99999999999999999999",
        &["spheres[0].radius is 1e20, but", limits[0]],
    );
    refusal_with(
        "center = [0, 0, 0]",
        "center = [0, 1e400, 0]",
        &["spheres[0].center.y is 1e400, but", "-1e18"],
    );
    refusal_with(
        "vfov_degrees = 40",
        "vfov_degrees = 1e400",
        &["vfov_degrees is 1e400, but", "0.01 and 179"],
    );
    refusal_with(
        "albedo = [0.5, 0.5, 0.5]",
        "albedo = [0.5, 1e999, 0.5]",
        &["[0.5, 1e999, 0.5], but each component"],
    );
    let message = refusal(&format!("{CAMERA}[render]\nwidth = 1e400\n"), 6);
    assert!(message.contains("width is 1e400, but must be a whole number within 1 and 16384"), "{message}");
    // Where any number is allowed, or two are too large.
    let message =
        refusal(&ONE_SPHERE.replace("[materials.ball]", "vup = [0, 1e400, 1]\n[materials.ball]"), 5);
    assert!(message.contains("1e400 is too large for a number, whose limit is 1.8e308"), "{message}");
    let message = refusal(&ONE_SPHERE.replace("[0, 0, 3]", "[1e400, 2e400, 3]"), 2);
    assert!(message.contains("1e400 is too large for a number"), "{message}");
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
    assert!(message.ends_with("; save it as UTF-8"), "{message}");
    let picture = folder.path().join("picture.jpg");
    std::fs::write(&picture, b"\xc3\x28").expect("written");
    let message = load(&picture).expect_err("no text").to_string();
    assert!(message.ends_with("save it as UTF-8, or name a .toml file"), "{message}");
    let wide = |bytes: fn(u16) -> [u8; 2], mark: &str| -> Vec<u8> {
        format!("{mark}{ONE_SPHERE}").encode_utf16().flat_map(bytes).collect()
    };
    for bytes in [
        wide(u16::to_le_bytes, "\u{feff}"),
        wide(u16::to_be_bytes, "\u{feff}"),
        wide(u16::to_le_bytes, ""),
        wide(u16::to_be_bytes, ""),
    ] {
        std::fs::write(&binary, bytes).expect("written");
        let message = load(&binary).expect_err("not UTF-8").to_string();
        assert!(message.ends_with("it looks like UTF-16: save it as UTF-8"), "{message}");
    }

    let bad = folder.path().join("bad.toml");
    std::fs::write(&bad, ONE_SPHERE.replace("radius = 1", "radius = 0")).expect("written");
    let message = load(&bad).expect_err("no radius").to_string();
    assert!(message.contains("bad.toml:10:1: spheres[0].radius is 0"), "{message}");

    let good = folder.path().join("my scene.v2.toml");
    std::fs::write(&good, ONE_SPHERE).expect("written");
    assert_eq!(load(&good).expect("valid").name, "my scene.v2");
}
