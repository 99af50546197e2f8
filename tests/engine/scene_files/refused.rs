//! Errors name the file, the line, the key, the value and its limit.

use super::common::{CAMERA, ONE_SPHERE};
use std::path::Path;
use weekender::job::recipe::file::{load, parse};

/// The message for `text`, which must begin with the file's name and `line` and have all of `parts`.
fn refuse(text: &str, line: usize, parts: &[&str]) {
    let message = match parse(text, "bad.toml") {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(error) => error.to_string(),
    };
    assert!(message.starts_with(&format!("bad.toml:{line}:")), "line {line} expected: {message}\n{text}");
    assert_eq!(message.lines().count(), 1, "{message}");
    for part in parts {
        assert!(message.contains(part), "{part:?} is not in {message:?}");
    }
}

const RADIUS: &str = "radius = 1";
const CENTER: &str = "center = [0, 0, 0]";
const KIND: &str = "kind = \"lambertian\"";
const ALBEDO: &str = "albedo = [0.5, 0.5, 0.5]";
const MATERIAL: &str = "material = \"ball\"";
const VFOV: &str = "vfov_degrees = 40";

/// In the file of one sphere, a piece is replaced by another.
#[test]
fn bad_spheres_materials_and_cameras_are_refused() {
    for (old, new, line, parts) in [
        (RADIUS, "radius = 0", 8, &["spheres[0].radius is 0", "between 1e-18 and 1e18"][..]),
        (RADIUS, "radius = nan", 8, &["spheres[0].radius is NaN", "finite"]),
        (RADIUS, "radius = 1e300", 8, &["spheres[0].radius is 1e300, but", "1e18", "give the sphere"]),
        (RADIUS, "radious = 1", 10, &["unknown key `radious`", "`radius`"]),
        (RADIUS, "radius = 1e400", 10, &["overflow"]),
        (RADIUS, "radius = 1\nradius = 2", 11, &["duplicate key"]),
        (RADIUS, "radius = 1,5", 10, &["write a point"]),
        (CENTER, "center = [0, nan, 0]", 8, &["spheres[0].center.y is NaN"]),
        (CENTER, "center = [0, 0]", 9, &["three numbers", "found 2", "spheres.center"]),
        (CENTER, "center = [0, 0, -1, 5]", 9, &["three numbers", "found 4", "spheres.center"]),
        (CENTER, "center = [1,5, 0,5, -1]", 9, &["three numbers", "found 5", "spheres.center"]),
        (CENTER, "", 8, &["missing key `center`"]),
        (ALBEDO, "albedo = [0.5, 1.5, 0.5]", 5, &["ball.albedo is [0.5, 1.5, 0.5]", "between 0 and 1"]),
        (ALBEDO, "albedo = [0.5, 0.5]", 5, &["invalid length 2", "materials.ball"]),
        (ALBEDO, "", 5, &["missing key `albedo`", "materials.ball"]),
        (ALBEDO, "albedo = [0, 0, 0]\nfuzz = 0.1", 5, &["unknown key `fuzz`", "materials.ball"]),
        (KIND, "kind = \"metal\"\nfuzz = -0.1", 5, &["materials.ball.fuzz is -0.1", "0 or more"]),
        (KIND, "kind = \"matte\"", 6, &["unknown value `matte`", "`metal`", "materials.ball"]),
        (MATERIAL, "material = \"bell\"", 8, &["\"bell\"", "add [materials.bell]"]),
        (MATERIAL, "material = 3", 8, &["spheres[0].material is 3", "a material's name or a table"]),
        (
            MATERIAL,
            "material = { kind = \"metal\", albedo = [1, 2, 1] }",
            8,
            &["[0].material.albedo is [1.0, 2"],
        ),
        (
            MATERIAL,
            "material = { kind = \"dielectric\", refraction_index = 0 }",
            8,
            &["refraction_index is 0"],
        ),
        (VFOV, "vfov_degrees = 180", 1, &["vfov_degrees is 180.0, but must be between 0.01 and 179"]),
        (VFOV, "", 1, &["missing key `vfov_degrees`"]),
        (VFOV, "vfov_degrees = 40\nvup = [0, 0, 1]", 1, &["vup is [0.0, 0.0, 1.0], which is parallel"]),
        (VFOV, "vfov_degrees = 40\nroll = 3", 5, &["unknown key `roll`"]),
    ] {
        assert!(ONE_SPHERE.contains(old), "{old}");
        refuse(&ONE_SPHERE.replace(old, new), line, parts);
    }
    // Columns count characters, and lines may end as on Windows.
    let line = "\"é\" = { kind = \"metal\", albedo = [0.5, 0.5, 0.5], fuzz = -1 }";
    refuse(&format!("{CAMERA}[materials]\n{line}\n"), 6, &["bad.toml:6:1: materials.é.fuzz is -1"]);
    refuse(&ONE_SPHERE.replace(RADIUS, "radius = 0").replace('\n', "\r\n"), 8, &["spheres[0].radius is 0"]);
}

#[test]
fn bad_settings_are_refused() {
    for (table, key, line, part) in [
        ("render", "width = 0", 6, "0 is not between 1 and 16384 in `render.width`"),
        ("render", "width = 40.5", 6, "expected a whole number in `render.width`"),
        ("render", "max_depth = 99999999999999999999", 6, "expected a whole number in `render.max_depth`"),
        ("render", "samples_per_pixel = 0", 6, "not between 1 and 4294967296 in `render.samples_per_pixel`"),
        ("render", "seed = -1", 6, "-1 is not between 0 and 4294967295"),
        ("render", "sampler = \"random\"", 6, "`sobol`"),
        ("render", "estimate_error = 1", 6, "expected a boolean"),
        ("render", "estimate_error = false", 6, "always estimated; remove this line"),
        ("rules", "gravity = true", 6, "unknown key `gravity`"),
        ("sky", "top = [0, 0, 101]", 5, "[0.0, 0.0, 101.0], but each component must be between 0 and 100"),
        ("sky", "bottom = [nan, 0, 0]", 5, "sky.bottom.x is NaN"),
        ("lights", "", 5, "lights"),
        ("camera", "", 5, "duplicate key"),
    ] {
        refuse(&format!("{CAMERA}[{table}]\n{key}\n"), line, &[part]);
    }
}

/// A key that another table has is sent there.
#[test]
fn right_keys_in_wrong_places_are_told_where_they_belong() {
    let refused = |text: &str| parse(text, "a.toml").expect_err("refused").to_string();
    for (lines, key, place) in [
        ("spheres = \"spheres.csv\"", "spheres", "above the first [table]"),
        ("scene = \"book\"", "scene", "above the first [table]"),
        ("frame = 3", "frame", "in [[keyframes]]"),
        ("[frame]\nlook_from = [0.0, 0.0, 3.0]", "frame", "in [[keyframes]]"),
        ("width = 400", "width", "in [render]"),
        ("[render]\nbottom = [1.0, 1.0, 1.0]", "bottom", "in [sky]"),
        ("[render]\nvfov_degrees = 20", "vfov_degrees", "in [camera]"),
        ("radius = 3.0", "radius", "in [[spheres]]"),
        ("[sky]\nfuzz = 0.1", "fuzz", "in a material"),
        ("[camera.sky]\ntop = [1, 1, 1]", "sky", "in square brackets, as a table of its own"),
    ] {
        let message = refused(&format!("{CAMERA}{lines}\n"));
        let words = [format!("unknown key `{key}` "), format!("; write it {place}")];
        assert!(words.iter().all(|words| message.contains(words)) && message.len() < 200, "{message}");
    }
    let message = refused(&format!("{CAMERA}[spheres]\nfile = \"s.csv\"\n"));
    assert!(message.contains("[[spheres]] for each") && message.contains("FILE.csv"), "{message}");
    let message = refused(&format!("{CAMERA}colour = 3\n"));
    assert!(message.contains("unknown key `colour`, expected"), "{message}");
}

#[test]
fn files_that_cannot_be_read_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let message = |path: &Path| load(path).expect_err("refused").to_string();
    let at = |name: &str| folder.path().join(name);
    assert!(message(&at("missing.toml")).contains("missing.toml"), "{}", message(&at("missing.toml")));
    assert!(message(folder.path()).contains("is a directory"), "{}", message(folder.path()));
    let huge = at("huge.toml");
    std::fs::File::create(&huge).and_then(|file| file.set_len(1 << 40)).expect("a sparse file");
    assert!(message(&huge).contains("1.10 TB"), "{}", message(&huge));

    let wide: Vec<u8> = ONE_SPHERE.encode_utf16().flat_map(u16::to_le_bytes).collect();
    for (bytes, part) in
        [([b"\xff\xfe".to_vec(), wide.clone()].concat(), "it is UTF-16 text"), (wide, "binary.toml")]
    {
        std::fs::write(at("binary.toml"), bytes).expect("written");
        assert!(message(&at("binary.toml")).contains(part), "{part}: {}", message(&at("binary.toml")));
    }
    std::fs::write(at("my scene.v2.toml"), ONE_SPHERE).expect("written");
    assert_eq!(load(&at("my scene.v2.toml")).expect("valid").name, "my scene.v2");
}
