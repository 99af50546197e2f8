//! The page is valid HTML.

use super::PAGE;
use crate::html_common::assert_valid;

#[test]
fn the_page_is_valid_html() {
    assert_valid(&PAGE.directory.path().join("index.html"));
}
