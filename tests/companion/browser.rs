//! The page in Chromium: nothing is cut, every diagram moves, and every link of a picture sets it.

use super::PAGE;
use serde_json::{Value, json};
use std::path::Path;
use std::process::Command;

/// The reason why the page cannot be used; `None` if it can.
pub fn obstacle() -> Option<String> {
    let lacks = |program: &str| Command::new(program).arg("--version").output().is_err();
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/web/node_modules/playwright-core");
    let is_lacking = lacks("node") || lacks("chromium") || !package.exists();
    let reason = "the page was not used: install node and chromium, and run npm ci --prefix tests/web";
    is_lacking.then(|| reason.to_owned())
}

#[test]
fn a_reader_can_use_the_page() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    if let Some(reason) = obstacle() {
        return crate::common::gpu::skip("BROWSER", &reason);
    }
    let page = PAGE.path().join("out/index.html");
    let output = Command::new("node").arg(folder.join("companion/browser.mjs")).arg(page).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let seen: Value = serde_json::from_slice(&output.stdout).unwrap();
    for key in ["console", "cut", "still", "links"] {
        assert_eq!(seen[key], json!([]), "{key}");
    }
    assert!(seen["diagrams"].as_u64() >= Some(11) && seen["linkCount"].as_u64() > Some(20), "{seen}");
}
