//! The address of a stage in the companion, the page that `weekender companion` writes.

use crate::pages::gallery::Figure;
use crate::stages::Stage;
use std::path::Path;

/// The URL of the companion with this absolute path, at the first figure that shows the stage.
pub fn url(page: &Path, stage: Option<&Stage>) -> String {
    let shows = |stage: &Stage| {
        let has_stage = |figure: &&Figure| figure.panels.iter().any(|panel| panel.stage() == stage);
        Figure::all().iter().find(has_stage)
    };
    let anchor = stage.and_then(shows).map_or_else(String::new, |figure| format!("#figure-{}", figure.id));
    format!("{}{anchor}", file_url(page))
}

/// The URL of a file or folder with this absolute path.
pub fn file_url(path: &Path) -> String {
    // Characters that end or change a path in a URL.
    let path = path.display().to_string().replace('%', "%25").replace('#', "%23").replace('?', "%3F");
    format!("file:///{}", path.replace(' ', "%20").replace('\\', "/").trim_start_matches('/'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_companion_opens_at_a_figure_of_the_stage() {
        let page = Path::new("/my books/50%/companion/index.html");
        let begin = "file:///my%20books/50%25/companion/index.html";
        assert_eq!(url(page, None), begin);
        for stage in Stage::ALL {
            let url = url(page, Some(stage));
            let id = url.strip_prefix(begin).unwrap().strip_prefix("#figure-").unwrap();
            let figure = Figure::all().iter().find(|figure| figure.id == id).unwrap();
            assert!(figure.panels.iter().any(|panel| panel.stage().id == stage.id), "{url}: {}", stage.id);
        }
    }
}
