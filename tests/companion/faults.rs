//! Errors in the texts end the command and name file and line.

use super::companion;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

pub fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let (source, target) = (entry.as_ref().unwrap().path(), to.join(entry.unwrap().file_name()));
        if source.is_dir() {
            copy(&source, &target);
        } else {
            fs::copy(&source, &target).unwrap();
        }
    }
}

/// A checkout with the page's files.
fn texts() -> TempDir {
    let directory = TempDir::new().unwrap();
    for folder in ["assets", "docs/companion", "examples", "src", "shaders", "reference"] {
        copy(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &directory.path().join(folder));
    }
    directory
}

const CHAPTER: &str = "docs/companion/05-sphere.md";

/// Builds the page after changing one file, and returns the messages.
fn refused(texts: &TempDir, file: &str, change: &dyn Fn(&str) -> String) -> String {
    let path = texts.path().join(file);
    let original = fs::read_to_string(&path).unwrap();
    fs::write(&path, change(&original)).unwrap();
    let (code, _, message) = companion(texts.path(), &["--source", "."]);
    fs::write(&path, original).unwrap();
    assert_eq!(code, Some(2), "{file}: {message}");
    assert!(!texts.path().join("out").exists(), "{file}: something was written");
    message
}

#[test]
fn chapter_errors_name_line() {
    let texts = texts();
    let lines = fs::read_to_string(texts.path().join(CHAPTER)).unwrap().lines().count();
    let line = lines + 2;
    for (added, message) in [
        ("{{figure spehre}}", "there is no figure \"spehre\""),
        ("{{figure red-sphere}}", "on the page already"),
        ("{{code\nsrc/lib.rs: mod nothing\n}}", "no line begins with \"mod nothing\""),
        ("{{code\nsrc/nothing.rs: fn a\n}}", "src/nothing.rs"),
        ("Here `no_such` is.\n\n{{code\nshaders/sphere.wgsl: fn chord\n}}", "`no_such` is not in the code"),
        ("{{mistakes sky\nno-such\n}}", "can have no mistake \"no-such\""),
        ("{{value 2 speed/no-such}}", "speed/no-such is not a number"),
        ("[x](live:no-such?fuzz=1)", "no figure shows the stage \"no-such\""),
        ("{{figure sky\n[x](page:no-such)\n}}", "no chapter \"no-such\""),
        ("{{table no-such}}", "no measurement \"no-such\""),
        ("{{diagram no-such}}", "diagrams/no-such.svg"),
        ("{{picture sky}}", "is not a directive"),
        ("Text {{figure sky}}", "stands alone in its paragraph"),
        ("[x](glossary:no-such)", "no term \"no-such\""),
        ("## 6.99 Title", "the book has no section 6.99"),
        ("[x](page:no-such)", "no chapter \"no-such\""),
        ("[x](page:normals#no-such)", "#normals-no-such"),
        ("[x](06-normals.md)", "is not a link of the page"),
        ("[@no-such]", "no entry \"no-such\""),
        ("## 6.1 Another Title", "is called \"Shading with Surface Normals\""),
        ("### Title", "have two #"),
        ("## Where the digits go", "another heading has the anchor #sphere-where-the-digits-go"),
        ("$\\nosuch$", "is not understood"),
        ("```cobol\nx\n```", "\"cobol\" has no colours"),
        ("<b>x</b>", "HTML and pictures are not allowed"),
    ] {
        let stderr = refused(&texts, CHAPTER, &|text| format!("{text}\n{added}\n"));
        assert!(
            stderr.contains(&format!("{CHAPTER}:{line}: ")) && stderr.contains(message),
            "{added}: {stderr}"
        );
    }
}

#[test]
fn other_errors_name_file() {
    let texts = texts();
    let path = "docs/companion/glossary.toml";
    let added = "[extra]\nterm = \"x\"\narea = \"rendering\"\ntext = \"x\"";
    let stderr = refused(&texts, path, &|text| format!("{text}\n{added}\n"));
    assert!(stderr.contains(path) && stderr.contains("no chapter links the term \"extra\""), "{stderr}");
    let stderr = refused(&texts, CHAPTER, &|text| text.replacen("book = \"5\"", "book = \"99\"", 1));
    assert!(stderr.contains(&format!("{CHAPTER}:1: the book has no chapter \"99\"")), "{stderr}");
    let stderr = refused(&texts, CHAPTER, &|text| text.replacen("title", "titel", 1));
    assert!(stderr.contains(&format!("{CHAPTER}:2: ")) && stderr.contains("titel"), "{stderr}");
}
