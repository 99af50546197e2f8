//! Checks of a page. html-validate is from npm: `npm ci --prefix companion/tests` installs it.

use super::skip;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// The values of an attribute in a page, except in scripts and styles.
pub fn values<'a>(page: &'a str, attribute: &str) -> Vec<&'a str> {
    let begin = format!(" {attribute}=\"");
    let outside = |part: &'a str| match part.split_once('>') {
        Some((_, rest)) => rest.split_once("</").map_or("", |(_, rest)| rest),
        None => part,
    };
    let mut pieces = page.split("<script");
    let first = pieces.next();
    let parts = first.into_iter().chain(pieces.map(outside));
    parts.flat_map(|part| part.split(&begin).skip(1).filter_map(|rest| rest.split('"').next())).collect()
}

/// Asserts that a page in `directory` is valid, that ids are unique and links lead somewhere, that pictures are there
/// and described, and that nothing is loaded from elsewhere. Returns the page.
pub fn assert_whole(directory: &Path) -> String {
    let path = directory.join("index.html");
    let page = std::fs::read_to_string(&path).unwrap();
    let ids: BTreeSet<&str> = values(&page, "id").into_iter().collect();
    assert_eq!(values(&page, "id").len(), ids.len(), "an id occurs twice");
    for target in values(&page, "href") {
        let is_kept = match target.strip_prefix('#') {
            Some(id) => ids.contains(id),
            None => {
                let is_web = target.starts_with("https://") && !target.contains([' ', '<']);
                is_web || target == "data:," || directory.join(target).is_file()
            }
        };
        assert!(is_kept, "{target} leads nowhere");
    }
    for name in ["aria-labelledby", "aria-describedby", "for"] {
        for id in values(&page, name).into_iter().flat_map(str::split_whitespace) {
            assert!(ids.contains(id), "{name}={id}");
        }
    }
    let (sources, alts) = (values(&page, "src"), values(&page, "alt"));
    assert!(sources.iter().all(|source| directory.join(source).is_file()), "{sources:?}");
    assert!(alts.len() == sources.len() && alts.iter().all(|alt| alt.len() > 20), "{alts:?}");
    for part in ["src=\"http", "url(http", "url(//", "@import", "<link rel=\"stylesheet\"", "<iframe"] {
        assert!(!page.contains(part), "{part}");
    }
    assert_valid(&path);
    page
}

/// Asserts that the HTML file is valid. Without html-validate it says so, or fails where `WEEKENDER_REQUIRE_BROWSER=1`.
fn assert_valid(page: &Path) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let program = folder.join("node_modules/html-validate/bin/html-validate.mjs");
    if !program.is_file() {
        return skip("BROWSER", "the page's HTML was not checked: run npm ci --prefix companion/tests");
    }
    let output = Command::new("node")
        .arg(&program)
        .args(["--formatter", "text", "--config"])
        .arg(folder.join("html-validate.json"))
        .arg(page)
        .output();
    match output {
        Err(error) => {
            skip("BROWSER", &format!("the page's HTML was not checked: cannot start node: {error}"))
        }
        Ok(output) => {
            let said = [output.stdout, output.stderr].concat();
            let said = String::from_utf8_lossy(&said);
            assert!(output.status.success(), "{}", said.chars().take(4000).collect::<String>());
        }
    }
}
