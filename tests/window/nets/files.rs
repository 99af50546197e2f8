//! What the window remembers of each file that comes in or goes out.

use super::{finished, open};
use crate::common::{name_file, save, until};
use std::path::Path;
use weekender::app::{Command, Window};
use weekender::output::OutputFormat;

/// The directory for the next dialog, and the file opened or saved last.
fn remembered(window: &mut Window) -> (Option<&Path>, Option<&Path>) {
    let remembered = window.remembered_mut();
    (remembered.directory.as_deref(), remembered.recent.first().map(|path| path.as_path()))
}

#[test]
#[ignore = "for an idle machine: it waits until the window is at rest"]
fn files_and_their_directories_are_remembered() {
    let directory = tempfile::tempdir().unwrap();
    let at = |folder: &str, name: &str| {
        let folder = directory.path().join(folder);
        std::fs::create_dir_all(&folder).unwrap();
        folder.join(name)
    };
    let mut harness = finished("defocus");
    let film = at("films", "a.exr");
    for (command, path) in [
        (Command::Save(OutputFormat::Exr), film.clone()),
        (Command::Save(OutputFormat::Png), at("pictures", "a.png")),
        (Command::Save(OutputFormat::P6), at("plain", "a.ppm")),
        (Command::SaveScene, at("scenes", "a.toml")),
    ] {
        save(&mut harness, command, &path);
        assert_eq!(remembered(harness.state_mut()), (path.parent(), Some(path.as_path())), "{command:?}");
    }
    // A film to compare with is none that is worked on.
    let last = at("scenes", "a.toml");
    name_file(&mut harness, Command::LoadReference, &film);
    until(&mut harness, "a reference", |window| {
        window.messages().iter().any(|text| text.contains("difference"))
    });
    assert_eq!(remembered(harness.state_mut()), (film.parent(), Some(last.as_path())), "a reference");
    for path in [at("pictures", "a.png"), film.clone(), last] {
        name_file(&mut harness, Command::Open, &path);
        let told = format!("Opened {}", path.display());
        until(&mut harness, &told, |window| window.messages().contains(&told));
        assert_eq!(remembered(harness.state_mut()), (path.parent(), Some(path.as_path())), "{told}");
    }
    drop(harness);
    let mut harness = open(&format!("--resume {} --isa portable --threads 1", film.display()));
    let told = format!("Continuing {}", film.display());
    until(&mut harness, &told, |window| window.messages().contains(&told));
    assert_eq!(remembered(harness.state_mut()).1, Some(film.as_path()), "{told}");
}
