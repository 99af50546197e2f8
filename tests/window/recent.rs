//! The files that were opened last, and the picture on the clipboard.

use crate::harness::{SMALL, control, copied, has_samples, open, send, until};
use crate::questions::Ask as _;
use egui_kittest::kittest::Queryable;
use std::path::Path;
use std::time::Duration;
use weekender::app::{Command, Source};

#[test]
fn files_are_opened_again_from_the_menu() {
    let mut harness = open(SMALL);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes");
    let paths = ["metals.toml", "matte.toml"].map(|name| folder.join(name));
    paths.iter().for_each(|path| harness.state_mut().remembered_mut().note_recent(path));
    harness.run_steps(2);
    for name in ["File", "Open recent", "metals.toml"] {
        control(&harness, name).click();
        harness.run_steps(4);
    }
    let source = Source::File(paths[0].clone());
    until(&mut harness, "the scene", |window| window.shown_document().origin.source == source);
    assert_eq!(harness.state_mut().remembered_mut().recent, paths, "it is the newest now");
}

#[test]
fn the_picture_is_copied_without_exposure() {
    let mut harness = open(&format!("{SMALL} --samples 16"));
    until(&mut harness, "the end", has_samples(16));
    let mut bytes = Vec::new();
    for _ in 0..2 {
        send(&mut harness, Command::Copy);
        let image = copied(&mut harness, Duration::from_secs(60)).expect("nothing was copied");
        assert_eq!(image.size, [32, 18]);
        bytes.push(image.pixels);
        send(&mut harness, Command::Brighter);
    }
    assert!(bytes[0] == bytes[1]);
    assert!(harness.query_all_by_label("Picture").next().is_some());
}
