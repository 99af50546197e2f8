//! The file of the remembered settings, which all windows share.
//!
//! A window writes soon what was changed in it. What another window or another version of the program has written stays.

use super::answers::Answers;
use super::model::remembered::Remembered;
use crate::system::files::{free_name, lock_path, write_text};
use eframe::egui::Context;
use serde_json::{Map, Value};
use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// How long changes wait for others, so that not every letter of a name is written.
const WRITES_APART: Duration = Duration::from_secs(1);

/// How long a window waits for another one that is writing, which takes some milliseconds.
const LONGEST_TURN: Duration = Duration::from_secs(1);

/// The fields of the settings, by name.
type Fields = Map<String, Value>;

/// The settings' file, and what this window has done to it.
pub struct SettingsFile {
    path: PathBuf,
    /// The settings as this window read or wrote them last; `None` if there was no file.
    known: Option<Remembered>,
    /// The settings that were given to be written last, or `known`.
    tried: Option<Remembered>,
    outcomes: Answers<Result<(), String>>,
    is_writing: bool,
    has_failed: bool,
    next: Instant,
}

/// What was read when a window opened.
pub struct Read {
    /// The file.
    pub file: SettingsFile,
    /// Its settings; `None` if there is no file yet.
    pub settings: Option<Remembered>,
    /// What the user must be told.
    pub message: Option<String>,
}

impl SettingsFile {
    /// Reads the settings. What cannot be understood has its usual value. A file without any settings is kept under
    /// another name, and a message says so.
    pub fn read(path: &Path) -> Read {
        let (settings, message) = match read_fields(path) {
            Ok(Stored::Nothing) => (None, None),
            Ok(Stored::Fields(fields)) => (Some(understood(fields).mended()), None),
            Ok(Stored::Damaged(reason)) => (None, Some(set_aside(path, &reason))),
            Err(reason) => {
                (Some(Remembered::default()), Some(format!("The usual settings are used: {reason}")))
            }
        };
        let file = SettingsFile {
            path: path.to_owned(),
            known: settings.clone(),
            tried: settings.clone(),
            outcomes: Answers::default(),
            is_writing: false,
            has_failed: false,
            next: Instant::now(),
        };
        Read { file, settings, message }
    }

    /// Has the settings written if they have changed. Returns why they could not be written, once.
    pub fn keep(&mut self, context: &Context, mine: &Remembered) -> Option<String> {
        let outcome = self.outcomes.take();
        let reason = outcome.and_then(|outcome| self.settle(outcome).err());
        let reason = reason.filter(|_| !std::mem::replace(&mut self.has_failed, true));
        if self.is_writing || self.tried.as_ref() == Some(mine) {
            return reason;
        }
        let wait = self.next.saturating_duration_since(Instant::now());
        if !wait.is_zero() {
            context.request_repaint_after(wait);
            return reason;
        }
        self.next = Instant::now() + WRITES_APART;
        self.tried = Some(mine.clone());
        let (path, known, mine) = (self.path.clone(), self.known.clone(), mine.clone());
        self.outcomes.ask("settings", context, move || write(&path, known.as_ref(), &mine), Err);
        self.is_writing = true;
        reason
    }

    /// Writes the settings if they have changed since they were written.
    ///
    /// # Errors
    /// Why they could not be written.
    pub fn finish(&mut self, mine: &Remembered) -> Result<(), String> {
        if self.is_writing
            && let Some(outcome) = self.outcomes.wait()
        {
            // What was not written is written now.
            let _ = self.settle(outcome);
        }
        if self.known.as_ref() == Some(mine) {
            return Ok(());
        }
        write(&self.path, self.known.as_ref(), mine)?;
        self.known = Some(mine.clone());
        Ok(())
    }

    fn settle(&mut self, outcome: Result<(), String>) -> Result<(), String> {
        self.is_writing = false;
        if outcome.is_ok() {
            self.known.clone_from(&self.tried);
        }
        outcome
    }
}

/// What there is at the place of the settings.
enum Stored {
    Nothing,
    Fields(Fields),
    /// Not settings, for this reason.
    Damaged(String),
}

fn read_fields(path: &Path) -> Result<Stored, String> {
    let bytes = match fs::read(path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Stored::Nothing),
        Err(error) => return Err(format!("cannot read {}: {error}", path.display())),
    };
    Ok(match serde_json::from_slice(&bytes) {
        Ok(fields) => Stored::Fields(fields),
        Err(error) => Stored::Damaged(error.to_string()),
    })
}

/// The settings of these fields. A field that cannot be understood, perhaps of a newer version, has its usual value.
fn understood(fields: Fields) -> Remembered {
    let settings_of = |fields: Fields| serde_json::from_value::<Remembered>(Value::Object(fields));
    let is_understood = |(name, value): &(String, Value)| {
        settings_of(Fields::from_iter([(name.clone(), value.clone())])).is_ok()
    };
    settings_of(fields.into_iter().filter(is_understood).collect()).unwrap_or_default()
}

/// Renames a file that holds no settings, and says so.
fn set_aside(path: &Path, reason: &str) -> String {
    let name = |number: u32| path.with_extension(format!("damaged-{number}"));
    let outcome = match free_name(name).map(|other| (fs::rename(path, &other), other)) {
        Some((Ok(()), other)) => format!("it is kept as {}", other.display()),
        Some((Err(error), _)) => format!("it cannot be renamed: {error}"),
        None => "there is no free name for it".to_owned(),
    };
    format!("The settings start anew: {} is damaged ({reason}); {outcome}", path.display())
}

/// Writes the changes from `known` to `mine`.
fn write(path: &Path, known: Option<&Remembered>, mine: &Remembered) -> Result<(), String> {
    if let Some(directory) = path.parent() {
        fs::create_dir_all(directory)
            .map_err(|error| format!("cannot make the directory {}: {error}", directory.display()))?;
    }
    let _turn = take_turn(&path.with_extension("lock"));
    let theirs = match read_fields(path)? {
        Stored::Nothing => Fields::new(),
        Stored::Fields(fields) => fields,
        Stored::Damaged(reason) => {
            let words = set_aside(path, &reason);
            log::warn!("{words}");
            Fields::new()
        }
    };
    let known = known.map(fields_of).transpose()?.unwrap_or_default();
    let all = Value::Object(merged(&known, fields_of(mine)?, theirs));
    write_text(path, &format!("{all:#}\n")).map_err(|error| error.to_string())
}

/// Windows that write at the same time take turns. Where files cannot be locked, or another window has stopped during its
/// turn, the later one wins.
fn take_turn(path: &Path) -> Option<File> {
    lock_path(path, LONGEST_TURN).ok()
}

fn fields_of(settings: &Remembered) -> Result<Fields, String> {
    match serde_json::to_value(settings) {
        Ok(Value::Object(fields)) => Ok(fields),
        Ok(other) => Err(format!("the settings are {other}")),
        Err(error) => Err(error.to_string()),
    }
}

/// Makes the changes from `known` to `mine` to `theirs`.
fn merged(known: &Fields, mine: Fields, mut theirs: Fields) -> Fields {
    for (name, mine) in mine {
        let known = known.get(&name);
        if known == Some(&mine) && theirs.contains_key(&name) {
            continue;
        }
        let known = known.and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
        let value = match (mine, theirs.get(&name)) {
            (Value::Array(mine), Some(Value::Array(theirs))) => {
                Value::Array(merged_list(known, mine, theirs))
            }
            (mine, _) => mine,
        };
        theirs.insert(name, value);
    }
    theirs
}

/// The items of `mine` without those that the others have removed, followed by those that the others have added.
fn merged_list(known: &[Value], mine: Vec<Value>, theirs: &[Value]) -> Vec<Value> {
    let added = theirs.iter().filter(|item| !known.contains(item) && !mine.contains(item)).cloned();
    let added: Vec<Value> = added.collect();
    let stays = |item: &Value| theirs.contains(item) || !known.contains(item);
    mine.into_iter().filter(stays).chain(added).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::remembered::{Bookmark, Theme};
    use crate::scene::Camera;

    fn named(names: &[&str]) -> Vec<Bookmark> {
        names.iter().map(|name| Bookmark::new((*name).to_owned(), &Camera::default())).collect()
    }

    fn stored(path: &Path) -> Remembered {
        SettingsFile::read(path).settings.unwrap()
    }

    /// Writes as soon as it may.
    fn keep_now(file: &mut SettingsFile, mine: &Remembered) -> Option<String> {
        let context = Context::default();
        file.next = Instant::now();
        let begun = file.keep(&context, mine);
        if file.is_writing {
            let outcome = file.outcomes.wait().unwrap();
            file.outcomes.answer(&context).give(outcome);
        }
        begun.or_else(|| file.keep(&context, mine))
    }

    #[test]
    fn settings_come_back() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("new/settings.json");
        let Read { mut file, settings, message } = SettingsFile::read(&path);
        assert_eq!((settings, message), (None, None));
        let mut mine = Remembered { theme: Theme::Dark, bookmarks: named(&["a"]), ..Remembered::default() };
        assert_eq!(keep_now(&mut file, &mine), None);
        assert_eq!(stored(&path), mine);
        mine.bookmarks.clear();
        assert_eq!(file.finish(&mine), Ok(()));
        assert_eq!(stored(&path), mine);
    }

    #[test]
    fn what_is_not_understood_stays() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("settings.json");
        fs::write(&path, r#"{"theme": "Purple", "has_plot": true, "of_the_future": [1]}"#).unwrap();
        let Read { mut file, settings, message } = SettingsFile::read(&path);
        let settings = settings.unwrap();
        assert_eq!((settings.theme, settings.has_plot, message), (Theme::System, true, None));
        file.finish(&Remembered { has_code: true, ..settings }).unwrap();
        let kept: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
        let expected =
            serde_json::json!({"theme": "Purple", "has_plot": true, "has_code": true, "of_the_future": [1]});
        for (name, value) in expected.as_object().unwrap() {
            assert_eq!(kept[name], *value, "{name}");
        }
    }

    #[test]
    fn a_damaged_file_is_kept_under_another_name() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        let path = at("settings.json");
        for (number, text) in ["{\"theme\": ", "[1]", ""].iter().enumerate() {
            fs::write(&path, text).unwrap();
            let Read { mut file, settings, message } = SettingsFile::read(&path);
            let other = at(&format!("settings.damaged-{}", number + 1));
            let message = message.unwrap();
            assert!(
                message.starts_with(&format!("The settings start anew: {} is damaged (", path.display()))
            );
            assert!(message.ends_with(&format!("; it is kept as {}", other.display())), "{message}");
            assert_eq!((settings, fs::read_to_string(&other).unwrap().as_str()), (None, *text));
            file.finish(&Remembered::default()).unwrap();
        }
        fs::write(&path, "{").unwrap();
        let mut file = SettingsFile { known: None, ..SettingsFile::read(&at("none.json")).file };
        file.path.clone_from(&path);
        assert_eq!(file.finish(&Remembered::default()), Ok(()));
        assert_eq!(fs::read_to_string(at("settings.damaged-4")).unwrap(), "{");
    }

    #[test]
    fn settings_that_cannot_be_written_are_told_of_once_and_change_nothing() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("settings.json");
        let mut file = SettingsFile::read(&path).file;
        fs::create_dir(&path).unwrap();
        let mut mine = Remembered::default();
        let first = keep_now(&mut file, &mine).unwrap();
        assert!(first.starts_with(&format!("cannot read {}: ", path.display())), "{first}");
        mine.has_plot = true;
        assert_eq!(keep_now(&mut file, &mine), None);
        assert_eq!(file.finish(&mine), Err(first.clone()));
        let Read { settings, message, .. } = SettingsFile::read(&path);
        let told = format!("The usual settings are used: {first}");
        assert_eq!((settings, message), (Some(Remembered::default()), Some(told)));
        fs::remove_dir(&path).unwrap();
        assert_eq!(file.finish(&mine), Ok(()));
        assert_eq!(stored(&path), mine);
    }
}
