//! The page is valid HTML, as html-validate from npm sees it: `npm ci --prefix tests/companion` installs it.

use super::{PAGE, checkout, gpu_common, text};
use std::process::Command;

/// Says that the page was not checked, or fails where `WEEKENDER_REQUIRE_BROWSER=1` is set.
fn skip(reason: &str) {
    let is_required = std::env::var("WEEKENDER_REQUIRE_BROWSER").as_deref() == Ok("1");
    assert!(!is_required, "{reason}");
    gpu_common::say_loudly(reason);
}

#[test]
fn the_page_is_valid_html() {
    let folder = checkout().join("tests/companion");
    let program = folder.join("node_modules/html-validate/bin/html-validate.mjs");
    if !program.is_file() {
        return skip("the page's HTML was not checked: run npm ci --prefix tests/companion");
    }
    let output = Command::new("node")
        .arg(&program)
        .args(["--formatter", "text", "--config"])
        .arg(folder.join("html-validate.json"))
        .arg(PAGE.directory.path().join("index.html"))
        .output();
    match output {
        Err(error) => skip(&format!("the page's HTML was not checked: cannot start node: {error}")),
        Ok(output) => {
            let said = text(&output.stdout) + &text(&output.stderr);
            assert!(output.status.success(), "{}", said.chars().take(4000).collect::<String>());
        }
    }
}
