//! The page in Chromium: nothing is cut, every diagram moves, and every link of a picture sets it.

use super::live_browser::recipe_of;
use super::{PAGE, driver, obstacle, skip};
use crate::live;
use serde_json::{Value, json};
use std::path::Path;
use std::process::Command;
use weekender::stages::Stage;

#[test]
fn a_reader_can_use_the_page() {
    if let Some(reason) = obstacle() {
        return skip("BROWSER", &reason);
    }
    let output = driver("reader").arg(PAGE.path().join("index.html")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let seen: Value = serde_json::from_slice(&output.stdout).unwrap();
    for key in ["console", "cut", "still", "links"] {
        assert_eq!(seen[key], json!([]), "{key}");
    }
    let links = seen["set"].as_array().unwrap();
    assert!(seen["diagrams"].as_u64() >= Some(28) && links.len() > 20, "{seen}");
    // The state that a link sets is the recipe of the still that a browser without WebGPU shows instead.
    for link in links {
        let stage = Stage::find(link["stage"].as_str().unwrap()).unwrap();
        let mut recipe = stage.recipe();
        live::set(&mut recipe, link["set"].as_str().unwrap()).unwrap();
        assert_eq!(recipe_of(stage, &link["settings"]), recipe, "{link}");
    }
}

/// Each drawing's still is the one that its script draws.
#[test]
fn stills_of_diagrams_are_up_to_date() {
    if let Some(reason) = obstacle() {
        return skip("BROWSER", &reason);
    }
    let texts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/companion");
    let drawn = tempfile::tempdir().unwrap();
    let output = Command::new("node").arg(texts.join("stills.mjs")).arg(drawn.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut count = 0;
    for entry in drawn.path().read_dir().unwrap() {
        let name = entry.unwrap().file_name();
        let [new, kept] =
            [drawn.path(), &texts.join("diagrams")].map(|folder| std::fs::read(folder.join(&name)).unwrap());
        assert!(new == kept, "{name:?} is old: node docs/companion/stills.mjs");
        count += 1;
    }
    assert!(count > 20);
}

/// Numbers and names that scripts repeat are those of the sources.
#[test]
fn scripts_agree_with_sources() {
    let read =
        |path: &str| std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap();
    let (kit, rng) = (read("assets/diagrams/kit.js"), read("../shaders/rng.wgsl").to_lowercase());
    let sobol = kit.split("function sobol").nth(1).unwrap().split("\n}").next().unwrap();
    let numbers: Vec<&str> =
        sobol.split(|c: char| !c.is_alphanumeric()).filter(|word| word.len() == 10).collect();
    assert!(numbers.len() == 7, "{numbers:?}");
    for number in numbers {
        assert!(rng.contains(number), "{number}");
    }
    let (film, adapter) = (read("assets/film.js"), read("../src/render_gpu/adapter.rs"));
    let names = film.split("|| /").nth(1).unwrap().split("/i").next().unwrap();
    let quoted: Vec<String> = names.split('|').map(|name| format!("\"{name}\"")).collect();
    assert!(adapter.contains(&format!("[{}]", quoted.join(", "))), "{names}");
}
