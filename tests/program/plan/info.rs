//! `weekender info`.

use super::common::{PICTURE, ends, film, json, plan, render_part, succeeds, whole};
use tempfile::TempDir;

#[test]
fn files_say_what_they_are() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    plan(at, "p", &["--stage", "metal", "--samples", "8", "--parts", "2"]);
    render_part(at, "p", 1);
    let pictures = ["--samples", "4", "--progress", "off", "--out", "a.png", "--checkpoint", "a b.exr"];
    succeeds(at, &[&["--batch"], &PICTURE[..], &pictures].concat());
    succeeds(at, &["--scene", "book", "--save-scene", "s.toml"]);
    let json = |file: &str| json(at, &["info", file, "--json"]);
    let keys = ["kind", "scene", "stage", "samples_per_pixel", "sample_ranges", "film_version", "parts"];
    let of = |file: &str| {
        let json = json(file);
        keys.map(|key| json[key].to_string()).join(" ")
    };
    assert_eq!(of("p"), "\"plan\" \"metal\" \"metal\" 8 \"0..8\" null 2");
    assert_eq!(of("p/plan.json"), of("p"));
    assert_eq!([&json("p")["halves"], &json("p/part-1.exr")["halves"]], [2, 2]);
    assert_eq!(of("p/part-1.exr"), "\"film\" \"metal\" \"metal\" 4 \"4..8\" 4 null");
    assert_eq!(of("a b.exr"), "\"film\" \"three-spheres\" null 4 \"0..4\" 4 null");
    assert_eq!(of("a.png"), "\"picture\" \"three-spheres\" null 4 null null null");
    std::fs::copy(at.join("a.png"), at.join("without an ending")).unwrap();
    assert_eq!(of("without an ending"), of("a.png"));
    assert!(of("s.toml").starts_with("\"scene\" \"s\" null "), "{}", of("s.toml"));
    assert!(json("a b.exr")["rmse_estimate"].as_f64().unwrap() > 0.0);

    // The command is the one that made the file, and makes the same one again.
    let message = succeeds(at, &["info", "a b.exr"]);
    let command = message.lines().find_map(|line| line.strip_prefix("command  ")).unwrap();
    let words = shlex::split(command).unwrap();
    assert_eq!(words[0], "weekender");
    assert_eq!(json("a.png")["command"], command);
    let before = whole(at, "0..4", &[]);
    std::fs::remove_file(at.join("a b.exr")).unwrap();
    succeeds(at, &words.iter().skip(1).map(String::as_str).collect::<Vec<_>>());
    assert!(film(&at.join("a b.exr")) == before);
    let part = json("p/part-1.exr")["command"].as_str().unwrap().to_owned();
    assert_eq!(part, "weekender render-part p --part 1 --device cpu");
    for words in ["three-spheres, 32x18", "4 per pixel, samples 0..4", "RMSE"] {
        assert!(message.contains(words), "{words}: {message}");
    }
    std::fs::write(at.join("x.exr"), "x").unwrap();
    let (_, refused) = ends(at, 2, &["info", "x.exr"]);
    assert!(refused.contains("x.exr"), "{refused}");
}
