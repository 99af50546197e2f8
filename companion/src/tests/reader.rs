//! The page in Chromium: nothing is cut, every diagram moves, and every link of a picture sets it.

use super::{PAGE, driver, obstacle, skip};
use serde_json::{Value, json};

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
    assert!(seen["diagrams"].as_u64() >= Some(11) && seen["linkCount"].as_u64() > Some(20), "{seen}");
}
