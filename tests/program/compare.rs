//! `weekender compare`: equal pictures, different pictures, and pictures that cannot be compared.

use crate::common::program::{outcome, succeeds, weekender};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Exit code, standard output and messages.
fn compare(arguments: &[&str], directory: &Path) -> (i32, String, String) {
    let output = weekender(directory, &[&["compare"], arguments].concat()).output().unwrap();
    let (code, text, errors) = outcome(&output);
    (code.unwrap(), text, errors)
}

fn render(directory: &Path, out: &str, flags: &[&str]) {
    let usual = ["--batch", "--device", "cpu", "--progress", "off", "--out", out];
    let size: &[&str] = if flags.contains(&"--size") { &[] } else { &["--size", "160x90"] };
    succeeds(directory, &[&usual[..], size, flags].concat());
}

fn json(arguments: &[&str], directory: &Path) -> (i32, serde_json::Value) {
    let (code, text, errors) = compare(&[arguments, &["--json", "-"]].concat(), directory);
    (code, serde_json::from_str(&text).unwrap_or_else(|_| panic!("{text}{errors}")))
}

#[test]
fn noise_is_equal_but_larger_sphere_differs() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    render(at, "a.exr", &["--samples", "64"]);
    render(at, "b.exr", &["--samples", "64", "--seed", "1"]);
    render(at, "c.exr", &["--samples", "64", "--seed", "2", "--sampler", "independent"]);
    let (code, found) = json(&["a.exr", "b.exr"], at);
    let times = found["times_noise"].as_f64().unwrap();
    assert_eq!(code, 0, "{found}");
    assert!((times - 1.0).abs() < 0.1, "{times}");
    assert_eq!(json(&["a.exr", "c.exr"], at).0, 0);
    let (code, text, _) = compare(&["a.exr", "a.exr"], at);
    assert!(code == 0 && text.contains("equal to the bit"), "{text}");

    // A ball with a radius larger by a hundredth.
    succeeds(at, &["--save-scene", "scene.toml", "--size", "160x90"]);
    let scene = fs::read_to_string(at.join("scene.toml")).unwrap();
    let larger = scene.replacen("radius = 0.5", "radius = 0.505", 1);
    assert_ne!(scene, larger, "{scene}");
    fs::write(at.join("larger.toml"), larger).unwrap();
    render(at, "larger.exr", &["--scene", "larger.toml", "--samples", "64", "--seed", "3"]);
    let (code, text, _) = compare(&["a.exr", "larger.exr"], at);
    assert_eq!(code, 1, "{text}");
}

#[test]
fn pictures_compare_with_films() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    render(at, "film.exr", &["--samples", "256"]);
    for (name, flags) in [("a.png", ["--seed", "5"]), ("a.ppm", ["--seed", "6"])] {
        render(at, name, &[&["--samples", "64"], &flags[..]].concat());
        let (code, text, errors) = compare(&["film.exr", name], at);
        assert_eq!(code, 0, "{text}{errors}");
    }
    let plain = image::open(at.join("a.png")).unwrap().to_rgb8();
    plain.save(at.join("plain.png")).unwrap();
    assert_eq!(compare(&["plain.png", "film.exr"], at).0, 0);
    assert_eq!(compare(&["plain.png", "film.exr", "--encoding", "linear"], at).0, 1);
}

#[test]
fn picture_is_decoded_by_its_recipe() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    // Linear integers, entirely or only in the upper half: the recipe overrides --encoding.
    for stage in ["diffuse", "gamut"] {
        render(at, "film.exr", &["--stage", stage, "--samples", "64"]);
        render(at, "picture.png", &["--stage", stage, "--samples", "64"]);
        for encoding in ["linear", "gamma2", "srgb"] {
            let (code, found) = json(&["film.exr", "picture.png", "--encoding", encoding], at);
            assert_eq!(code, 0, "{stage}, {encoding}: {found}");
            assert!(found["rms"].as_f64().unwrap() < 0.01, "{stage}, {encoding}: {found}");
        }
    }
}

#[test]
fn clipped_picture_verdicts() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    for (name, dark) in [("white.png", 0), ("half.png", 32)] {
        let picture =
            image::RgbImage::from_fn(64, 16, |x, _| image::Rgb([if x < dark { 0 } else { 255 }; 3]));
        picture.save(at.join(name)).unwrap();
    }
    for sides in [["white.png", "half.png"], ["half.png", "white.png"]] {
        assert_eq!(compare(&sides, at).0, 1);
    }
    assert_eq!(compare(&["white.png", "white.png"], at).0, 0);
    // White in another format may stand for other values.
    let deep = image::ImageBuffer::from_pixel(64, 16, image::Rgb([u16::MAX; 3]));
    deep.save(at.join("deep.png")).unwrap();
    let (code, found) = json(&["white.png", "deep.png"], at);
    assert_eq!((code, &found["is_equal"]), (2, &serde_json::json!(false)));
    assert!(found["unclear"].is_string(), "{found}");
}

#[test]
fn incomparable_pictures_exit_with_2() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    render(at, "a.exr", &["--samples", "2"]);
    render(at, "small.exr", &["--samples", "2", "--size", "80x45"]);
    fs::write(at.join("text.png"), "no picture").unwrap();
    let cases: [(&[&str], &[&str]); 5] = [
        (&["a.exr"], &["SECOND"]),
        (&["a.exr", "a.exr", "--json", "nowhere/a.json"], &["a.json", "create its directory"]),
        (&["a.exr", "nowhere.exr"], &["nowhere.exr"]),
        (&["a.exr", "text.png"], &["text.png", "not a PNG, PPM, PFM or EXR"]),
        (&["a.exr", "small.exr"], &["160x90", "80x45", "the same size"]),
    ];
    for (arguments, parts) in cases {
        crate::common::program::refused(at, &[&["compare"], arguments].concat(), parts);
    }
}
