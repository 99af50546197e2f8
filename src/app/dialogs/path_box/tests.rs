//! Tests of the box for a file's name.

use super::*;
use crate::app::tests::{dressed, part};
use crate::output::OutputFormat;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};

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
fn the_home_directory_is_a_tilde() {
    let home = Some(Path::new("/of/me"));
    for (text, path) in [
        ("~", "/of/me"),
        ("~/a.png", "/of/me/a.png"),
        ("~//a", "/of/me/a"),
        ("~you/a", "~you/a"),
        ("a/~", "a/~"),
        ("/a", "/a"),
    ] {
        assert_eq!(in_home(text, home), Path::new(path), "{text}");
        assert_eq!(in_home(text, None), Path::new(text));
    }
    if let Some(home) = home_directory() {
        let png = Purpose::Save(OutputFormat::Png);
        assert_eq!(typed(png, "~/no such a"), Some(home.join("no such a.png")));
    }
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

#[test]
fn what_would_happen_is_told_first() {
    let directory = tempfile::tempdir().unwrap();
    let png = Purpose::Save(OutputFormat::Png);
    let tone = |purpose, name: &str| {
        let path = directory.path().join(name);
        PathBox::of(purpose, &path).note(Some(&path)).1
    };
    assert_eq!(tone(png, "a.png"), Tone::Plain);
    std::fs::write(directory.path().join("a.png"), "").unwrap();
    std::fs::create_dir(directory.path().join("b.png")).unwrap();
    assert_eq!(tone(png, "a.png"), Tone::Replaces);
    assert_eq!(tone(png, "b.png"), Tone::Refused);
    assert_eq!(tone(png, "no/a.png"), Tone::Refused);
    assert_eq!(tone(Purpose::Open, "a.png"), Tone::Plain);
    assert_eq!(tone(Purpose::Open, "c.png"), Tone::Refused);
}

#[test]
fn a_name_from_the_systems_dialog_gets_its_ending_and_replaces_nothing_unasked() {
    let directory = tempfile::tempdir().unwrap();
    let png = Purpose::Save(OutputFormat::Png);
    let [bare, named] = ["a", "a.png"].map(|name| directory.path().join(name));
    let taken = |path: &Path| PathBox::chosen(png, path.to_owned()).map_err(|asks| asks.text);
    assert_eq!(taken(&bare), Ok(named.clone()));
    std::fs::write(&named, "").unwrap();
    assert_eq!(taken(&bare), Err(named.display().to_string()));
    assert_eq!(taken(&named), Ok(named), "the dialog has asked");
}

#[test]
fn the_systems_dialog_begins_where_the_box_is() {
    let directory = tempfile::tempdir().unwrap();
    assert_eq!(place_of(&directory.path().join("a.png")), (Some(directory.path().into()), "a.png".into()));
    assert_eq!(place_of(directory.path()), (Some(directory.path().into()), String::new()));
    assert_eq!(place_of(Path::new("a.png")), (std::env::current_dir().ok(), "a.png".into()));
    assert_eq!(place_of(&directory.path().join("no/a.png")), (None, "a.png".into()));
}

#[test]
fn the_name_of_a_scene_becomes_a_files() {
    let path_box = PathBox::new(Purpose::Save(OutputFormat::P6), "field:1000", Some(Path::new("out")));
    assert_eq!(PathBuf::from(&path_box.text), Path::new("out").join("field-1000.ppm"));
}

#[test]
fn the_name_is_selected_without_its_folder_and_ending() {
    for (text, ends) in
        [("out/a.b.png", [4, 7]), ("käse.png", [0, 4]), ("out.d/a", [6, 7]), ("out.d/", [6, 6])]
    {
        let path_box = PathBox::of(Purpose::Open, Path::new(text));
        let mut selected = None;
        let _ = egui::Context::default().run_ui(egui::RawInput::default(), |ui| {
            let id = egui::Id::unique("name");
            path_box.select_stem(ui, id, egui::text_edit::TextEditState::default());
            let state = egui::text_edit::TextEditState::load(ui.ctx(), id).unwrap();
            selected = state.cursor.char_range();
        });
        let [from, to] = ends.map(|end: usize| egui::text::CCursor::new(end));
        assert_eq!(selected, Some(egui::text::CCursorRange::two(from, to)), "{text}");
    }
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

#[test]
fn a_box_begins_in_its_folder_and_one_for_opening_has_no_name() {
    for (purpose, name) in [
        (Purpose::Open, ""),
        (Purpose::ReferenceFilm, ""),
        (Purpose::SaveFlight, "field-1000.toml"),
        (Purpose::SavePlot, "field-1000.csv"),
    ] {
        let text = |directory: Option<&Path>| PathBox::new(purpose, "field:1000", directory).text;
        assert_eq!(text(None), name);
        assert_eq!(text(Some(Path::new("out"))), Path::new("out").join(name).display().to_string());
    }
}

#[test]
fn a_new_file_is_told_with_its_folder_unless_that_was_typed() {
    let directory = tempfile::tempdir().unwrap();
    let note = |path: &Path| {
        let path_box = PathBox::of(Purpose::Save(OutputFormat::Png), path);
        path_box.note(path_box.path().as_deref())
    };
    assert_eq!(note(&directory.path().join("a.png")), ("A new file".to_owned(), Tone::Plain));
    let name = "there is no such picture.png";
    let here = std::env::current_dir().unwrap().join(name);
    assert_eq!(note(Path::new(name)), (here.display().to_string(), Tone::Plain));
    if let Some(home) = home_directory().filter(|home| home.is_dir()) {
        let told = home.join(name).display().to_string();
        assert_eq!(note(&Path::new("~").join(name)), (told, Tone::Plain));
    }
}

#[test]
fn the_system_is_asked_for_one_dialog_at_a_time() {
    let mut dialog = asked(Purpose::Open, Path::new("a.png"));
    let is_disabled =
        |dialog: &Harness<'_, Asked>| dialog.get_by_label("Browse…").accesskit_node().is_disabled();
    assert!(!is_disabled(&dialog));
    let browsing = Arc::new(());
    dialog.state_mut().path_box.browsing = Arc::downgrade(&browsing);
    dialog.run_steps(2);
    assert!(is_disabled(&dialog), "it is open");
    drop(browsing);
    dialog.run_steps(2);
    assert!(!is_disabled(&dialog), "it was closed");
}
