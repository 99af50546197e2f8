//! The command line as pictures and reports record it.

use crate::shell;
use clap::{ArgMatches, Command, ValueHint};
use std::ffi::{OsStr, OsString};
use std::path::Path;

/// The words of the command line, quoted for a shell, with file names instead of paths: a picture is passed on, and the
/// directories of its author are nobody's business.
pub(super) fn without_directories(arguments: &[OsString], matches: &ArgMatches) -> String {
    let mut paths = Vec::new();
    find_paths(&super::command(), matches, &mut paths);
    let words = arguments.iter().skip(1).map(|word| shortened(&word.to_string_lossy(), &paths));
    shell::line(std::iter::once("weekender".to_owned()).chain(words))
}

/// Adds the values of flags that take a path, also those of the subcommand.
fn find_paths(command: &Command, matches: &ArgMatches, paths: &mut Vec<String>) {
    use ValueHint::{AnyPath, DirPath, ExecutablePath, FilePath};
    let takes_path = |hint| matches!(hint, AnyPath | DirPath | ExecutablePath | FilePath);
    for argument in command.get_arguments().filter(|argument| takes_path(argument.get_value_hint())) {
        let values = matches.try_get_raw(argument.get_id().as_str()).ok().flatten().into_iter().flatten();
        paths.extend(values.map(|value| value.to_string_lossy().into_owned()));
    }
    if let Some((name, matches)) = matches.subcommand()
        && let Some(command) = command.find_subcommand(name)
    {
        find_paths(command, matches, paths);
    }
}

/// Adds the values of all flags but `except`, also those of the subcommand.
pub(super) fn find_values(matches: &ArgMatches, except: &str, values: &mut Vec<OsString>) {
    for id in matches.ids().filter(|id| id.as_str() != except) {
        let found = matches.try_get_raw(id.as_str()).ok().flatten().into_iter().flatten();
        values.extend(found.map(OsStr::to_owned));
    }
    if let Some((_, matches)) = matches.subcommand() {
        find_values(matches, except, values);
    }
}

/// A word `PATH` or `--flag=PATH` with only the file's name.
fn shortened(word: &str, paths: &[String]) -> String {
    let is_path = |value: &str| paths.iter().any(|path| path == value);
    let name = |path: &str| Path::new(path).file_name().and_then(OsStr::to_str).unwrap_or(path).to_owned();
    match word.split_once('=') {
        _ if is_path(word) => name(word),
        Some((flag, value)) if is_path(value) => format!("{flag}={}", name(value)),
        _ => word.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn typed(words: &[&str]) -> String {
        let arguments: Vec<OsString> = words.iter().map(OsString::from).collect();
        let matches = super::super::command().try_get_matches_from(&arguments).expect("a command");
        without_directories(&arguments, &matches)
    }

    #[test]
    fn paths_lose_their_directories_and_nothing_else_changes() {
        let found = typed(&[
            "/opt/bin/weekender",
            "--batch",
            "--scene",
            "/home/ann/secret/my scene.toml",
            "--out=../ann/a.png",
            "--checkpoint",
            "films/",
            "--json",
            "-",
            "--fps=30000/1001",
            "--adapter",
            "a/b",
            "--log=/var/log/run.log",
        ]);
        assert_eq!(
            found,
            "weekender --batch --scene 'my scene.toml' --out=a.png --checkpoint films --json - --fps=30000/1001 \
             --adapter a/b --log=run.log"
        );
        let part = typed(&["weekender", "render-part", "/home/ann/plan", "--part", "3"]);
        assert_eq!(part, "weekender render-part plan --part 3");
        let root = typed(&["weekender", "--batch", "--frames=0..2", "--out", ".."]);
        assert!(root.ends_with("--out .."), "{root}");
    }
}
