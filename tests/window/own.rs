//! One's own world: a new scene.

use crate::harness::{control, has_samples, open, save, send, until};
use crate::questions::Ask as _;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::NodeT;
use weekender::app::Command;
use weekender::job::recipe::file;

#[test]
fn a_new_scene_has_a_ball_on_the_ground_and_undo_returns() {
    let mut harness = open("--stage metal --size 32x18 --device cpu");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::N);
    harness.run_steps(3);
    let document = harness.state().shown_document();
    assert!(document.stage().is_none() && !document.has_own_size);
    assert_eq!(document.scene().spheres.len(), 2);
    let ball = document.pick(&document.camera, [0.5, 0.5]).unwrap().sphere;
    let ground = document.pick(&document.camera, [0.5, 0.99]).unwrap().sphere;
    assert_eq!((ball, ground), (1, 0));
    until(&mut harness, "its picture", has_samples(1));
    send(&mut harness, Command::Undo);
    assert_eq!(harness.state().shown_document().stage().unwrap().id, "metal");
}

/// Then it is saved in that file again, and what is traced goes on.
#[test]
fn a_scene_that_was_saved_is_its_file() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mine.toml");
    let mut harness = open("--stage metal --device cpu");
    send(&mut harness, Command::NewScene);
    send(&mut harness, Command::AddSphere);
    until(&mut harness, "its picture", has_samples(1));
    save(&mut harness, Command::Save, &path);
    let run = harness.state().status().run;
    let document = harness.state().shown_document();
    assert_eq!((document.heading(), document.is_changed()), ("mine.toml".to_owned(), false));
    let spheres = document.scene().spheres.len();
    harness.run_steps(3);
    assert_eq!(harness.state().status().run, run, "it goes on");

    send(&mut harness, Command::AddSphere);
    assert!(harness.state().shown_document().is_changed());
    send(&mut harness, Command::Save);
    assert_eq!(control(&harness, "Name").accesskit_node().value().unwrap(), "mine");
    harness.key_press(Key::Enter);
    until(&mut harness, "the file", |window| !window.shown_document().is_changed());
    assert_eq!(file::load(&path).unwrap().scene.spheres.len(), spheres + 1);
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 1);
    send(&mut harness, Command::Undo);
    let document = harness.state().shown_document();
    assert_eq!((document.heading(), document.is_changed()), ("mine.toml".to_owned(), true));
    assert_eq!(document.scene().spheres.len(), spheres);
}
