//! Errors name the file, the line, the key, the value and its limit.

use super::common::{CAMERA, ONE_SPHERE};
use std::path::Path;
use weekender::job::recipe::file::{load, parse};

/// The message for `text`, which must begin with the file's name and `line`.
fn refusal(text: &str, line: usize) -> String {
    let message = match parse(text, "bad.toml") {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(error) => error.to_string(),
    };
    assert!(message.starts_with(&format!("bad.toml:{line}:")), "line {line} expected: {message}\n{text}");
    assert_eq!(message.lines().count(), 1, "{message}");
    message
}

/// Refuses the file of one sphere with `old` replaced by `new`, at `line` with a message that has all of `parts`.
fn refuse_with(old: &str, new: &str, line: usize, parts: &[&str]) {
    assert!(ONE_SPHERE.contains(old), "{old}");
    let message = refusal(&ONE_SPHERE.replace(old, new), line);
    for part in parts {
        assert!(message.contains(part), "{part:?} is not in {message:?}");
    }
}

#[test]
fn bad_spheres_are_refused() {
    for (radius, parts) in [
        ("0", &["spheres[0].radius is 0", "within 1e-18 and 1e18"][..]),
        ("nan", &["spheres[0].radius is NaN", "finite"]),
        ("inf", &["spheres[0].radius is inf", "finite"]),
        ("1e300", &["spheres[0].radius is 1e300, but", "1e18", "give the sphere"]),
    ] {
        refuse_with("radius = 1", &format!("radius = {radius}"), 8, parts);
    }
    let center = "center = [0, 0, 0]";
    refuse_with(center, "center = [0, nan, 0]", 8, &["spheres[0].center.y is NaN"]);
    for (old, new, line, parts) in [
        ("radius = 1", "radious = 1", 10, &["unknown key `radious`", "`radius`"][..]),
        ("radius = 1", "radius = 1e400", 10, &["overflow"]),
        ("radius = 1", "radius = 1\nradius = 2", 11, &["duplicate key"]),
        (center, "center = [0, 0]", 9, &["three numbers", "found 2", "spheres.center"]),
        (center, "", 8, &["missing key `center`"]),
    ] {
        refuse_with(old, new, line, parts);
    }
}

#[test]
fn bad_materials_are_refused() {
    let (kind, albedo) = ("kind = \"lambertian\"", "albedo = [0.5, 0.5, 0.5]");
    for (old, new, parts) in [
        (
            albedo,
            "albedo = [0.5, 1.5, 0.5]",
            &["materials.ball.albedo is [0.5, 1.5, 0.5]", "within 0 and 1"][..],
        ),
        (albedo, "albedo = [0.5, 0.5]", &["invalid length 2", "materials.ball"]),
        (albedo, "", &["missing key `albedo`", "materials.ball"]),
        (albedo, "albedo = [0, 0, 0]\nfuzz = 0.1", &["unknown key `fuzz`", "materials.ball"]),
        (kind, "kind = \"metal\"\nfuzz = -0.1", &["materials.ball.fuzz is -0.1", "0 or more"]),
    ] {
        refuse_with(old, new, 5, parts);
    }
    refuse_with(kind, "kind = \"matte\"", 6, &["unknown value `matte`", "`metal`", "materials.ball"]);
    let glass = "kind = \"dielectric\"\nrefraction_index = 0\n";
    let message = refusal(&ONE_SPHERE.replace(&format!("{kind}\n{albedo}\n"), glass), 5);
    assert!(message.contains("materials.ball.refraction_index is 0"), "{message}");

    let material = "material = \"ball\"";
    let table = |keys: &str| format!("material = {{ {keys} }}");
    for (new, parts) in [
        ("material = \"bell\"".to_owned(), &["\"bell\"", "add [materials.bell]"][..]),
        ("material = 3".to_owned(), &["spheres[0].material is 3", "a material's name or a table"]),
        (table("kind = \"metal\", albedo = [1, 2, 1]"), &["spheres[0].material.albedo is [1.0, 2.0, 1.0]"]),
    ] {
        refuse_with(material, &new, 8, parts);
    }
}

#[test]
fn bad_cameras_are_refused() {
    let vfov = "vfov_degrees = 40";
    refuse_with(vfov, "vfov_degrees = 180", 1, &["vfov_degrees is 180.0, but must be within 0.01 and 179"]);
    refuse_with(vfov, "", 1, &["missing key `vfov_degrees`"]);
    refuse_with(
        vfov,
        "vfov_degrees = 40\nvup = [0, 0, 1]",
        1,
        &["vup is [0.0, 0.0, 1.0], which is parallel"],
    );
    refuse_with(vfov, "vfov_degrees = 40\nroll = 3", 5, &["unknown key `roll`"]);
}

#[test]
fn bad_settings_are_refused() {
    for (table, line, expected) in [
        ("render", "width = 0", "0 is not within 1 and 16384 in `render.width`"),
        ("render", "width = -5", "-5 is not within"),
        ("render", "width = 40.5", "expected a whole number in `render.width`"),
        ("render", "max_depth = 99999999999999999999", "expected a whole number in `render.max_depth`"),
        ("render", "samples_per_pixel = 0", "0 is not within 1 and 4294967296 in `render.samples_per_pixel`"),
        ("render", "seed = -1", "-1 is not within 0 and 4294967295"),
        ("render", "sampler = \"random\"", "`sobol`"),
        ("render", "estimate_error = 1", "expected a boolean"),
        ("rules", "gravity = true", "unknown key `gravity`"),
    ] {
        let message = refusal(&format!("{CAMERA}[{table}]\n{line}\n"), 6);
        assert!(message.contains(expected), "{expected:?} is not in {message:?}");
    }
    for (line, expected) in [
        ("top = [0, 0, 101]", "sky.top is [0.0, 0.0, 101.0], but each component must be within 0 and 100"),
        ("bottom = [nan, 0, 0]", "sky.bottom.x is NaN"),
    ] {
        let message = refusal(&format!("{CAMERA}[sky]\n{line}\n"), 5);
        assert!(message.contains(expected), "{expected:?} is not in {message:?}");
    }
}

#[test]
fn malformed_text_is_refused() {
    refusal(&ONE_SPHERE.replace("look_at = [0, 0, 0]", "look_at = [0, 0, 0"), 4);
    refuse_with("radius = 1", "radius 1", 10, &[]);
    for table in ["lights", "camera"] {
        refusal(&format!("{CAMERA}[{table}]\n"), 5);
    }
    let message = refusal(&ONE_SPHERE.replace("radius = 1", "radius = 1,5"), 10);
    assert!(message.contains("write a point"), "{message}");
    // Columns count characters, and lines may end as on Windows.
    let message = refusal("# é\n[camera]\n\"é\" = 1\n", 3);
    assert!(message.starts_with("bad.toml:3:1: unknown key `é`"), "{message}");
    let line = "\"é\" = { kind = \"metal\", albedo = [0.5, 0.5, 0.5], fuzz = -1 }";
    let message = refusal(&format!("{CAMERA}[materials]\n{line}\n"), 6);
    assert!(message.starts_with("bad.toml:6:1: materials.é.fuzz is -1"), "{message}");
    let message = refusal(&ONE_SPHERE.replace("radius = 1", "radius = 0").replace('\n', "\r\n"), 8);
    assert!(message.contains("spheres[0].radius is 0"), "{message}");
}

#[test]
fn files_that_cannot_be_read_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let message = |path: &Path| load(path).expect_err("refused").to_string();
    let missing = folder.path().join("missing.toml");
    assert!(message(&missing).contains("missing.toml"), "{}", message(&missing));
    assert!(message(folder.path()).contains("is a directory"), "{}", message(folder.path()));
    let huge = folder.path().join("huge.toml");
    std::fs::File::create(&huge).and_then(|file| file.set_len(1 << 40)).expect("a sparse file");
    assert!(message(&huge).contains("has 1.10 TB, but a scene file of more than"), "{}", message(&huge));

    let binary = folder.path().join("binary.toml");
    let wide: Vec<u8> = ONE_SPHERE.encode_utf16().flat_map(u16::to_le_bytes).collect();
    for (bytes, part) in [
        (b"[camera]\nlook_from = [0,\xff\xfe".to_vec(), "it is not UTF-8 text"),
        ([b"\xff\xfe".to_vec(), wide.clone()].concat(), "it is not UTF-8 text"),
        (wide, "binary.toml"),
    ] {
        std::fs::write(&binary, bytes).expect("written");
        assert!(message(&binary).contains(part), "{part}: {}", message(&binary));
    }

    let good = folder.path().join("my scene.v2.toml");
    std::fs::write(&good, ONE_SPHERE).expect("written");
    assert_eq!(load(&good).expect("valid").name, "my scene.v2");
}
