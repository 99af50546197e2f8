//! The companion: the page beside the program, and the address of a stage in it.

use crate::stages::Stage;
use std::env;
use std::path::{Path, PathBuf};

/// Where the page is, from the directory of the program: in an archive, an installation, a bundle of macOS, a checkout.
const PLACES: [&str; 4] =
    ["companion", "../share/weekender/companion", "../Resources/companion", "../companion"];

/// The page beside this program.
pub fn page() -> Option<PathBuf> {
    page_beside(env::current_exe().ok()?.parent()?)
}

fn page_beside(directory: &Path) -> Option<PathBuf> {
    PLACES.iter().map(|place| directory.join(place).join("index.html")).find(|page| page.is_file())
}

/// The URL of the companion with this absolute path, at the first figure that shows the stage.
pub fn url(page: &Path, stage: Option<&Stage>) -> String {
    let anchor = stage.map_or_else(String::new, |stage| format!("#stage-{}", stage.id));
    // Characters that end or change a path in a URL.
    let path = page.display().to_string().replace('%', "%25").replace('#', "%23").replace('?', "%3F");
    format!("file:///{}{anchor}", path.replace(' ', "%20").replace('\\', "/").trim_start_matches('/'))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn the_companion_opens_at_the_stage() {
        let page = Path::new("/my books/50%/companion/index.html");
        let begin = "file:///my%20books/50%25/companion/index.html";
        assert_eq!(url(page, None), begin);
        assert_eq!(url(page, Stage::find("sky").ok()), format!("{begin}#stage-sky"));
    }

    #[test]
    fn the_page_is_found_beside_the_program() {
        let root = tempfile::tempdir().unwrap();
        let program = root.path().join("bin");
        fs::create_dir(&program).unwrap();
        assert_eq!(page_beside(&program), None);
        for place in ["../companion", "../share/weekender/companion", "companion"] {
            let folder = program.join(place);
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join("index.html"), "").unwrap();
            assert_eq!(page_beside(&program), Some(folder.join("index.html")));
        }
    }
}
