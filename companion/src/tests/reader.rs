//! The page in Chromium: nothing is cut, every diagram moves, and every link of a picture sets it.

use super::{PAGE, driver, obstacle, skip};
use serde_json::{Value, json};
use std::path::Path;
use std::process::Command;

#[test]
fn a_reader_can_use_the_page() {
    if let Some(reason) = obstacle() {
        return skip("BROWSER", &reason);
    }
    let output = driver("reader").arg(PAGE.path().join("index.html")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let seen: Value = serde_json::from_slice(&output.stdout).unwrap();
    for key in ["console", "cut", "still", "links"] {
        assert_eq!(seen[key], json!([]), "{key}");
    }
    assert!(seen["diagrams"].as_u64() >= Some(28) && seen["linkCount"].as_u64() > Some(20), "{seen}");
}

/// Each drawing's still is the one that its script draws.
#[test]
fn stills_of_diagrams_are_up_to_date() {
    if let Some(reason) = obstacle() {
        return skip("BROWSER", &reason);
    }
    let texts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/companion");
    let drawn = tempfile::tempdir().unwrap();
    let output = Command::new("node").arg(texts.join("stills.mjs")).arg(drawn.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut count = 0;
    for entry in drawn.path().read_dir().unwrap() {
        let name = entry.unwrap().file_name();
        let [new, kept] =
            [drawn.path(), &texts.join("diagrams")].map(|folder| std::fs::read(folder.join(&name)).unwrap());
        assert!(new == kept, "{name:?} is old: node docs/companion/stills.mjs");
        count += 1;
    }
    assert!(count > 20);
}
