//! Tests of the box for a file's name.

use super::*;
use crate::app::tests::dressed;
use crate::job::output::OutputFormat;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

fn typed(purpose: Purpose, text: &str) -> Option<PathBuf> {
    PathBox::of(purpose, Path::new(text)).path()
}

#[test]
fn endings_are_added_where_one_is_missing() {
    let png = Purpose::Save(OutputFormat::Png);
    assert_eq!(typed(png, "a"), Some("a.png".into()));
    assert_eq!(typed(png, "a.PNG"), Some("a.PNG".into()));
    assert_eq!(typed(png, "v1.2"), Some("v1.2.png".into()));
    assert_eq!(typed(png, "  "), None);
    assert_eq!(typed(Purpose::Open, "a"), Some("a".into()));
}

#[test]
fn a_folder_is_no_name_for_a_file() {
    let directory = tempfile::tempdir().unwrap();
    let png = Purpose::Save(OutputFormat::Png);
    let note = |purpose, text: &str| {
        let path_box = PathBox { begun: String::new(), ..PathBox::of(purpose, Path::new(text)) };
        path_box.note(path_box.path().as_deref())
    };
    let folder = directory.path().display().to_string();
    for purpose in [png, Purpose::SaveScene, Purpose::Open] {
        for end in ["", "/"] {
            let (told, tone) = note(purpose, &format!("{folder}{end}"));
            assert_eq!(
                (told, tone),
                (format!("{folder}{end} is a folder: add a file's name"), Tone::Refused)
            );
        }
    }
    let (told, tone) = note(png, &format!("{folder}/no/"));
    assert!(told.starts_with(&format!("The folder {folder}/no")) && tone == Tone::Refused, "{told}");
    let untouched = PathBox::of(Purpose::Open, directory.path());
    assert_eq!(untouched.note(untouched.path().as_deref()).1, Tone::Unfinished, "it is no fault yet");
}

struct Asked {
    path_box: PathBox,
    browsed: Answers<(Purpose, Chosen)>,
    named: Option<PathBuf>,
    is_closed: bool,
}

fn asked(purpose: Purpose, path: &Path) -> Harness<'static, Asked> {
    let draw = |ui: &mut Ui, asked: &mut Asked| match asked.path_box.ui(ui, &asked.browsed) {
        Outcome::Named(_, path) => asked.named = Some(path),
        Outcome::Close => asked.is_closed = true,
        Outcome::Stay => {}
    };
    let (path_box, browsed) = (PathBox::of(purpose, path), Answers::default());
    dressed([500.0, 240.0]).build_ui_state(draw, Asked { path_box, browsed, named: None, is_closed: false })
}

#[test]
fn a_name_is_taken_by_enter_and_by_the_button() {
    let directory = tempfile::tempdir().unwrap();
    let (png, path) = (Purpose::Save(OutputFormat::Png), directory.path().join("a.png"));
    let mut dialog = asked(png, &path);
    dialog.key_press(Key::Enter);
    dialog.run_steps(3);
    assert_eq!(dialog.state().named.as_ref(), Some(&path));
    let mut dialog = asked(png, &path);
    dialog.get_by_label("File name").type_text("b");
    dialog.run_steps(3);
    dialog.get_by_label("Save").click();
    dialog.run_steps(3);
    assert_eq!(dialog.state().named, Some(directory.path().join("b.png")), "the name was selected");
    std::fs::write(&path, "").unwrap();
    let mut dialog = asked(png, &path);
    dialog.get_by_label("Replace").click();
    dialog.run_steps(3);
    assert_eq!(dialog.state().named.as_ref(), Some(&path));
    let mut dialog = asked(Purpose::Open, directory.path());
    dialog.key_press(Key::Enter);
    dialog.run_steps(3);
    assert_eq!(dialog.state().named, None, "it is a folder");
    assert_eq!(dialog.state().path_box.begun, "", "which is refused now");
    let mut dialog = asked(png, &directory.path().join("no/a.png"));
    dialog.key_press(Key::Enter);
    dialog.run_steps(3);
    assert_eq!(dialog.state().named, None);
    let before = dialog.state().path_box.text.clone();
    dialog.get_by_label("File name").type_text("c");
    dialog.run_steps(3);
    assert_ne!(dialog.state().path_box.text, before, "the box still has the keyboard");
    dialog.get_by_label("Cancel").click();
    dialog.run_steps(3);
    assert!(dialog.state().is_closed);
}
