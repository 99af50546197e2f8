//! Live figures in Chromium, on its software adapter.

use super::live_bytes::{camera_of, data_of, with_slider};
use super::live_page::{self, small};
use super::{driver, obstacle, program, skip};
use serde_json::{Value, json};
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use weekender::film::{Film, PixelSum, to_byte};
use weekender::job::recipe::{Recipe, file::to_toml};
use weekender::job::saved::open;
use weekender::stages::Stage;

/// Makes Chromium's software adapter an ordinary Vulkan adapter.
const SWIFTSHADER: &str = "/usr/lib/chromium/vk_swiftshader_icd.json";

/// All stages: the first five, which the driver uses, in larger pictures of more samples.
fn stages() -> Vec<Stage> {
    const USED: [&str; 5] = ["aliased", "antialiased", "hollow-glass", "view-close", "defocus"];
    let rest = Stage::ALL.iter().map(|stage| stage.id).filter(|id| !USED.contains(id));
    let used = USED.iter().map(|id| small(id, [160, 90], 16));
    used.chain(rest.map(|id| small(id, [64, 36], 2))).collect()
}

/// The recipe of a stage with a reader's settings.
pub fn recipe_of(stage: &Stage, told: &Value) -> Recipe {
    let mut recipe = stage.recipe();
    let mut scene = (*recipe.scene).clone();
    let data = data_of(&[*stage]);
    for (index, value) in told["material"].as_object().unwrap() {
        let slider = &data["stages"][stage.id]["sliders"][index.parse::<usize>().unwrap()];
        with_slider(&mut scene, slider, value.as_f64().unwrap());
    }
    recipe.scene = Arc::new(scene);
    recipe.camera = camera_of(&told["camera"]);
    recipe.settings.max_depth = told["depth"].as_u64().unwrap() as u32;
    recipe.samples_per_pixel = told["samples"].as_u64().unwrap();
    recipe
}

/// The film that the program renders on Chromium's adapter.
fn program_film(directory: &Path, name: &str, recipe: &Recipe) -> Film {
    let file = |ending: &str| directory.join(format!("program-{name}.{ending}"));
    std::fs::write(file("toml"), to_toml(recipe)).unwrap();
    let _ = std::fs::remove_file(file("exr"));
    let mut program = Command::new(program());
    program.env("VK_ICD_FILENAMES", SWIFTSHADER).args([
        "--batch",
        "--device",
        "gpu",
        "--adapter",
        "SwiftShader",
    ]);
    for (flag, ending) in [("--scene", "toml"), ("--checkpoint", "exr"), ("--out", "png")] {
        program.arg(flag).arg(file(ending));
    }
    // The page's film is one half.
    let output = program.arg("--samples").arg((2 * recipe.samples_per_pixel).to_string()).output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
    assert!(!told.contains("continues"), "the program left the adapter: {told}");
    open(&file("exr")).unwrap().film().unwrap().film
}

fn browser_film(file: &Path) -> Vec<PixelSum> {
    let bytes = std::fs::read(file).unwrap();
    let words = bytes.as_chunks::<8>().0.iter().map(|word| u64::from_le_bytes(*word));
    words.collect::<Vec<_>>().as_chunks::<3>().0.iter().map(|sums| PixelSum(*sums)).collect()
}

#[test]
fn a_browser_renders_the_films_of_the_program() {
    if let Some(reason) = obstacle() {
        return skip("BROWSER", &reason);
    }
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path().join("live figures");
    std::fs::create_dir(&directory).unwrap();
    let stages = stages();
    live_page::write(
        &directory,
        &[
            ("One sample and many.", &stages[0..2]),
            ("A shell of glass.", &stages[2..3]),
            ("Without and with a lens.", &stages[3..5]),
            ("All other stages.", &stages[5..]),
        ],
    );
    let output = driver("live").arg(&directory).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let seen: Value = serde_json::from_slice(&output.stdout).unwrap();

    assert_eq!(seen["console"], json!([]));
    for key in ["drag", "slider", "wheel", "key", "reset", "bothTurn", "narrow-dark", "middle-light"] {
        assert_eq!(seen[key], true, "{key}");
    }
    for key in ["jumps", "wheelWithoutFocus", "outOfView"] {
        assert_eq!(seen[key], false, "{key}");
    }
    for panel in seen["lost"].as_array().unwrap() {
        assert!(panel[0].as_str().unwrap().contains("The graphics device was lost. Press Run"), "{panel}");
        assert_eq!((&panel[1], &panel[2]), (&json!("false"), &json!(false)), "a still again: {panel}");
    }
    assert!(seen["afterLoss"].as_str().unwrap().contains("16 of 16 samples"), "{}", seen["afterLoss"]);
    assert_eq!(
        seen["without"],
        "In a browser with WebGPU, the pictures of this page can be turned and changed."
    );
    compare_films(&directory, &stages, seen["films"].as_object().unwrap());
}

/// The picture on the screen is the film's, as the program resolves it. Where a value is close to a step, rounding decides.
fn check_picture(name: &str, stage: &Stage, film: &[PixelSum], told: &Value) {
    let (width, height) = (stage.setup.width as usize, stage.setup.height as usize);
    let samples = told["settings"]["samples"].as_f64().unwrap();
    let rgba: Vec<u8> = serde_json::from_value(told["rgba"].clone()).unwrap();
    assert_eq!(rgba.len(), 4 * film.len(), "{name}");
    let mut apart = 0;
    for (pixel, (shown, sum)) in rgba.as_chunks::<4>().0.iter().zip(film).enumerate() {
        let byte = |x: f64| to_byte(x / samples, stage.setup.rules.transfer, pixel / width, height);
        let [red, green, blue] = sum.radiance().map(byte);
        let expected = [red, green, blue, 255];
        let by = [0, 1, 2, 3].map(|i| usize::from(expected[i].abs_diff(shown[i])));
        assert!(by.iter().all(|by| *by <= 1), "{name}, pixel {pixel}: {shown:?}, not {expected:?}");
        apart += by.iter().sum::<usize>();
    }
    assert!(apart <= film.len() / 20, "{name}: {apart} bytes are a step apart");
}

/// The films of the browser and of the program are equal to the bit: on one adapter, under two compilers.
fn compare_films(directory: &Path, stages: &[Stage], films: &serde_json::Map<String, Value>) {
    assert_eq!(films.len(), Stage::ALL.len() + 2);
    if !Path::new(SWIFTSHADER).exists() {
        return skip("BROWSER", &format!("the films were not compared: there is no {SWIFTSHADER}"));
    }
    let mut rendered = Vec::new();
    for (name, told) in films {
        let stage = stages.iter().find(|stage| told["id"] == stage.id).unwrap();
        let browser = browser_film(&directory.join(told["file"].as_str().unwrap()));
        let program = program_film(directory, name, &recipe_of(stage, &told["settings"]));
        let sums = &program.halves()[0];
        let differing = browser.iter().zip(sums).filter(|(a, b)| a != b).count();
        assert_eq!((differing, browser.len()), (0, sums.len()), "{name}: pixels that differ");
        check_picture(name, stage, &browser, told);
        rendered.push((name.clone(), browser));
    }
    let film_of = |name: &str| &rendered.iter().find(|film| film.0 == name).unwrap().1;
    assert_eq!(film_of("suspended"), film_of("hollow-glass"), "suspending paths changes nothing");
    assert_ne!(film_of("changed"), film_of("hollow-glass"));
}
