//! Files shipped with the program: manual pages, completions, desktop entry, icons, and the library's examples.
#[allow(dead_code, reason = "its main function is not called")]
#[path = "../../examples/own_scene.rs"]
mod own_scene;
#[allow(dead_code, reason = "its main function is not called")]
#[path = "../../examples/render_a_film.rs"]
mod render_a_film;
#[path = "../../examples/package/texts.rs"]
mod texts;

use crate::common::skip::report_untested;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;
use weekender::film::checkpoint;
use weekender::job::recipe::{Recipe, file};

const PACKAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/package");

fn names(directory: &Path) -> BTreeSet<String> {
    fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

/// Runs a checker, if it is installed.
fn check(program: &str, arguments: &[&str]) {
    match Command::new(program).args(arguments).output() {
        Ok(output) => {
            let said = String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned();
            assert!(output.status.success(), "{program} {arguments:?}: {said}");
        }
        Err(error) => {
            report_untested(&format!("{program} cannot be run ({error}): not checked: {arguments:?}"))
        }
    }
}

#[test]
fn manual_pages_and_completions_are_complete() {
    let directory = tempfile::tempdir().unwrap();
    texts::write(directory.path()).unwrap();
    let command = weekender::cli::command();
    let [man, completions] = ["man", "completions"].map(|folder| directory.path().join(folder));

    let pages = names(&man);
    assert!(pages.contains("weekender.1"), "{pages:?}");
    for subcommand in command.get_subcommands().filter(|subcommand| !subcommand.is_hide_set()) {
        let page = format!("weekender-{}.1", subcommand.get_name());
        assert!(pages.contains(&page), "{page} is not in {pages:?}");
    }
    let page = fs::read_to_string(man.join("weekender.1")).unwrap();
    assert!(page.contains("noise\\-target") && page.contains("Exit codes"), "{page}");
    assert!(!page.contains("autosave\\-every"), "a hidden flag is documented");
    for page in &pages {
        check("mandoc", &["-T", "lint", "-W", "error", man.join(page).to_str().unwrap()]);
    }

    for file in ["_weekender", "_weekender.ps1", "weekender.bash", "weekender.elv", "weekender.fish"] {
        let text = fs::read_to_string(completions.join(file)).unwrap();
        assert!(text.contains("noise-target"), "{file}");
    }
    check("bash", &["-n", completions.join("weekender.bash").to_str().unwrap()]);

    for file in ["_weekender", "weekender.bash", "weekender.fish"] {
        let text = fs::read_to_string(completions.join(file)).unwrap();
        assert!(!text.contains("autosave-every"), "{file} offers a hidden flag");
        assert!(text.contains("glass-schlick") && text.contains("avx512"), "{file}");
    }
    let offered = |words: &str, current: &str| {
        let script = format!(
            "source {}; COMP_WORDS=({words} {current}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); \
             _weekender weekender '{current}' \"${{COMP_WORDS[COMP_CWORD-1]}}\"; echo \"${{COMPREPLY[@]}}\"",
            completions.join("weekender.bash").display()
        );
        let output =
            Command::new("bash").args(["-c", &script]).current_dir(directory.path()).output().ok()?;
        Some(String::from_utf8_lossy(&output.stdout).into_owned())
    };
    for (words, current, part) in [
        ("weekender --stage", "glass-s", "glass-schlick"),
        ("weekender --batch --scene", "three", "three-spheres"),
        ("weekender --batch --scene", "man", "man"),
        ("weekender --isa", "avx", "avx512"),
        ("weekender check --stage", "met", "metal"),
    ] {
        match offered(words, current) {
            Some(offered) => assert!(offered.contains(part), "{words} {current}: {offered:?}"),
            None => eprintln!("bash was not run: completions were not tried"),
        }
    }
}

#[test]
fn desktop_files_are_valid() {
    check("desktop-file-validate", &[&format!("{PACKAGE}/weekender.desktop")]);
    // A reverse domain name needs a domain, which the project does not have yet.
    let lenient = "--override=cid-desktopapp-is-not-rdns=info";
    check("appstreamcli", &["validate", "--no-net", lenient, &format!("{PACKAGE}/weekender.metainfo.xml")]);
    let manifest = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml")).unwrap();
    for side in [16, 32, 48, 64, 128, 256, 512] {
        let path = format!("{PACKAGE}/icons/{side}.png");
        assert_eq!(image::image_dimensions(&path).unwrap(), (side, side), "{path}");
        assert!(
            manifest.contains(&format!("icons/{side}.png\", \"usr/share/icons/hicolor/{side}x{side}/")),
            "{path}"
        );
    }
    let recipe = file::load(Path::new(&format!("{PACKAGE}/icon.toml"))).unwrap();
    recipe.job().unwrap();
}

#[test]
fn the_example_renders_a_film_that_can_be_continued() {
    let directory = tempfile::tempdir().unwrap();
    let mut recipe = Recipe::find("three-spheres").unwrap();
    (recipe.settings.width, recipe.settings.height, recipe.samples_per_pixel) = (64, 36, 32);
    let (film, error) = render_a_film::render(&recipe, directory.path()).unwrap();
    assert!(film.sample_count() == 32 && error.rmse > 1e-4 && error.rmse < 0.1, "{error:?}");
    assert!(checkpoint::load(&directory.path().join("three-spheres.exr")).unwrap().film == film);
    let picture = image::open(directory.path().join("three-spheres.png")).unwrap();
    assert_eq!((picture.width(), picture.height()), (64, 36));
}

#[test]
fn example_scene_survives_its_file() {
    let directory = tempfile::tempdir().unwrap();
    let mut recipe = own_scene::spiral();
    (recipe.settings.width, recipe.settings.height, recipe.samples_per_pixel) = (48, 27, 4);
    own_scene::render(&recipe, directory.path()).unwrap();
    let read = file::load(&directory.path().join("spiral.toml")).unwrap();
    assert_eq!((&read.scene, read.camera, read.settings), (&recipe.scene, recipe.camera, recipe.settings));
    assert!(image::open(directory.path().join("spiral.png")).is_ok());
}

#[test]
fn the_package_has_what_its_readme_links_to() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let [readme, manifest] =
        ["README.md", "Cargo.toml"].map(|name| fs::read_to_string(root.join(name)).unwrap());
    let links = readme.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next());
    let links: BTreeSet<&str> = links.filter(|link| !link.is_empty() && !link.contains("://")).collect();
    assert!(links.len() > 10, "{links:?}");
    for link in links {
        let folder = Path::new(link).parent().unwrap().to_str().unwrap();
        let slash = if folder.is_empty() { "" } else { "/" };
        let place = format!("\", \"usr/share/doc/weekender/{folder}{slash}\"");
        let ending =
            Path::new(link).extension().map_or("*".to_owned(), |ending| format!("*.{}", ending.display()));
        let whole = format!("usr/share/doc/weekender/{link}/\"");
        let sources = [link.to_owned(), format!("{folder}/{ending}"), format!("{folder}/*")];
        let is_packed = sources.iter().any(|source| manifest.contains(&format!("[\"{source}{place}")));
        assert!(is_packed || manifest.contains(&whole), "{link} is not in the package");
    }
}
