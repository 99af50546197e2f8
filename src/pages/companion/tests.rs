//! Made-up texts as HTML, and errors in them.

use super::back_matter::{Area, Reference, Term};
use super::chapter::Chapter;
use super::library::{Entry, Fault, Library};
use super::site::Site;
use super::uses::Uses;
use super::{directive, page, prose};
use crate::stages::Stage;

/// The page's site with two terms, two references and two chapters without text: 06-normals and 01-languages.
fn site() -> Site {
    let mut site = Site::read(&Library::Embedded).unwrap();
    site.chapters.retain(|chapter| ["normals", "languages"].contains(&chapter.id.as_str()));
    site.chapters.iter_mut().for_each(|chapter| chapter.body.clear());
    let term = |key: &str, line, area| {
        let value = Term { term: key.to_uppercase(), text: format!("A *{key}*."), area };
        Entry { key: key.to_owned(), line, value }
    };
    site.terms = vec![term("lane", 1, Area::Parallelism), term("ray", 5, Area::Rendering)];
    let reference = |key: &str, line| {
        let (title, authors, note) = (format!("On {key}"), format!("{key} and others"), "Good.".to_owned());
        let value = Reference { title, authors, year: 1984, url: format!("https://{key}.org"), note };
        Entry { key: key.to_owned(), line, value }
    };
    site.references = vec![reference("first", 1), reference("second", 5)];
    site
}

/// The HTML of a text in the chapter on normals.
fn converted(site: &Site, text: &str, uses: &mut Uses) -> Result<String, Fault> {
    let normals = site.chapters.iter().find(|chapter| chapter.id == "normals").unwrap();
    let chapter = Chapter { body: text.to_owned(), lines_before: 4, ..normals.clone() };
    prose::chapter(site, &chapter, directive::html, uses).map(|html| html.into_string())
}

/// The HTML of a single text.
fn alone(site: &Site, text: &str) -> String {
    converted(site, text, &mut Uses::default()).unwrap()
}

#[test]
fn links_lead_to_what_they_name() {
    let site = site();
    for (target, html) in [
        ("#there", "<a href=\"#there\">x</a>"),
        ("https://a.org/b", "<a href=\"https://a.org/b\">x</a>"),
        (
            "page:normals",
            "<a href=\"#normals\" title=\"Chapter 6: Surface Normals and Multiple Objects\">x</a>",
        ),
        (
            "page:normals#6.1",
            "<a href=\"#normals-61-shading-with-surface-normals\" title=\"Section 6.1 Shading with Surface Normals\">x</a>",
        ),
        ("glossary:lane", "<a id=\"use-lane\" class=\"term\" href=\"#term-lane\">x</a>"),
        (
            "live:metal-fuzzy?fuzz=1",
            "<a class=\"try\" href=\"#figure-fuzz\" data-stage=\"metal-fuzzy\" data-set=\"fuzz=1\">x</a>",
        ),
        ("source:src/lib.rs", "x <span class=\"cite\">[<code class=\"path\">src/lib.rs</code>]</span>"),
    ] {
        assert_eq!(alone(&site, &format!("[x]({target})")), format!("<p>{html}</p>\n"));
    }
    let [first, second] = [("first", 1), ("second", 2)]
        .map(|(key, n)| format!("<a href=\"#ref-{key}\" title=\"{key} and others: On {key}\">{n}</a>"));
    let both = format!("<p><span class=\"cite\">[{first}, {second}]</span></p>\n");
    assert_eq!(alone(&site, "[@second; @first]"), both);
}

#[test]
fn links_are_recorded_with_lines() {
    let (site, mut uses) = (site(), Uses::default());
    let text = "[a](#there)\n\n[b](page:languages#two) [c](glossary:ray)\n\n[d](glossary:ray)";
    let html = converted(&site, text, &mut uses).unwrap();
    let targets: Vec<_> = uses.targets.iter().map(|(anchor, _, line)| (anchor.as_str(), *line)).collect();
    assert_eq!(targets, [("there", 5), ("languages-two", 7)]);
    assert_eq!(uses.terms["ray"], "Normals");
    assert_eq!(html.matches("id=\"use-ray\"").count(), 1, "{html}");
    let fault = converted(&site, "a\n\n[e](page:nowhere)", &mut uses).unwrap_err();
    assert_eq!(fault.to_string(), "docs/companion/06-normals.md:7: the page has no chapter \"nowhere\"");
}

#[test]
fn headings_code_and_formulas_render() {
    let site = site();
    for (text, html) in [
        (
            "## A Title's `code`",
            "<h3 id=\"normals-a-titles-code\">A Title’s <code>code</code><a class=\"anchor\"",
        ),
        (
            "## 6.1 Shading with Surface Normals",
            "</span> Shading with Surface Normals <a class=\"book\" href=\"https://",
        ),
        ("```rust\nfn a() {}\n```", "<span class=\"hl-k\">fn</span>"),
        ("```\nplain <b>\n```", "<code>plain &lt;b&gt;\n</code>"),
        ("$$x$$", "<p class=\"wide\"><span class=\"formula\""),
        ("So $$x$$", "<p>So <span class=\"formula\""),
        ("$x$, y", "</math>,</span> y"),
        ("$\\frac{1}{2}$", "<mfrac><mn>1</mn><mn>2</mn></mfrac>"),
        ("| a |\n|---|\n| 1 |", "aria-label=\"Table\">\n<table>"),
    ] {
        let found = alone(&site, text);
        assert!(found.contains(html), "{text}: {found}");
    }
    assert!(!alone(&site, "$x$-y").contains("class=\"nb\""));
}

#[test]
fn directives_render() {
    let site = Site::read(&Library::Embedded).unwrap();
    let code =
        alone(&site, "{{code\nshaders/lanes.wgsl: fn dot3\nsrc/render_cpu/lanes/vector.rs: pub fn dot\n}}");
    assert!(code.contains("<figure class=\"code shown\" data-language=\"wgsl\">"), "{code}");
    assert!(code.contains("<figure class=\"code\" data-language=\"rs\">"), "{code}");
    assert!(code.contains("shaders/lanes.wgsl</code> <span class=\"lines\">lines "), "{code}");
    let figure = alone(&site, "{{ figure antialiasing }}");
    assert!(
        figure.contains("id=\"figure-antialiasing\"") && figure.contains("src=\"figures/aliased.png\""),
        "{figure}"
    );
    let cropped = alone(&site, "{{figure antialiasing crop 1 2 3 4\nA *caption*.\n}}");
    assert!(
        cropped.contains("aspect-ratio: 3 / 4\"") && cropped.contains("A <em>caption</em>."),
        "{cropped}"
    );
    let diagram = alone(&site, "{{diagram lanes}}");
    assert!(diagram.contains("aria-label=\"Diagram\"><svg") && diagram.contains("<figcaption>"), "{diagram}");
}

#[test]
fn values_come_from_measurements() {
    let site = site();
    let rows = "speed/scenes/three-spheres/rows/C89, cc -O2, 1 thread";
    let text = format!("{{{{value 3 {rows}/ratio_to_baseline}}}} {{{{value 2 12345 over 1}}}}");
    assert_eq!(alone(&site, &text), "<p>1.00 12,000</p>\n");
    let fault = converted(&site, "a\n\n{{value 2 speed/nothing}}", &mut Uses::default()).unwrap_err();
    assert_eq!((fault.line, fault.message.contains("speed/nothing")), (7, true), "{fault}");
}

#[test]
fn symbols_have_colours_in_formulas_and_code() {
    let mut site = site();
    let normals = site.chapters.iter_mut().find(|chapter| chapter.id == "normals").unwrap();
    normals.facts.colours = [("h".to_owned(), 4)].into();
    assert!(alone(&site, "$h$").contains("<mi class=\"q4\">h</mi>"));
    let code = alone(&site, "{{code\nshaders/sphere.wgsl: fn chord_end\n}}");
    assert!(code.contains("<span class=\"q4\">h</span>") && !code.contains("q4\">hit"), "{code}");
}

#[test]
fn back_matter_lists_terms_and_works() {
    let (site, mut uses) = (site(), Uses::default());
    let text = "[x](glossary:ray)\n\n{{glossary}}\n\n{{references}}";
    let html = converted(&site, text, &mut uses).unwrap();
    for part in [
        "<dt id=\"term-ray\">RAY</dt><dd><span id=\"def-ray\">A <em>ray</em>.</span> <a class=\"back\" href=\"#use-ray\"",
        "<li id=\"ref-second\">second and others. <cite><a href=\"https://second.org\">On second</a></cite>, 1984. Good.</li>",
    ] {
        assert!(html.contains(part), "{part}: {html}");
    }
    let mut faulty = self::site();
    faulty.terms[1].value.text = "[x](page:nowhere)".to_owned();
    let fault = converted(&faulty, text, &mut Uses::default()).unwrap_err();
    assert_eq!(fault.to_string(), "docs/companion/glossary.toml:5: the page has no chapter \"nowhere\"");
}

#[test]
fn page_figures_follow_book_order() {
    let mut site = site();
    site.terms.clear();
    let [languages, normals] = site.chapters.as_mut_slice() else { panic!("two chapters") };
    languages.body = "{{figure red-sphere}}\n\n{{glossary}}\n\n{{references}}".to_owned();
    normals.body = "{{figure sky}}\n\n[x](#normals)".to_owned();
    let built = page::render(&site).unwrap();
    let ids: Vec<&str> = built.stages.iter().map(|stage| stage.id).collect();
    assert_eq!(ids, ["sky", "red-sphere", Stage::ALL[Stage::ALL.len() - 1].id]);

    site.chapters[1].body = "[x](#gone)".to_owned();
    let fault = page::render(&site).unwrap_err().to_string();
    assert!(fault.ends_with("nothing on the page has the anchor #gone"), "{fault}");
}
