//! Made-up texts as HTML, and errors in them.

use crate::back_matter::{Reference, Term};
use crate::chapter::Chapter;
use crate::library::{Entry, Fault, Library};
use crate::site::Site;
use crate::uses::Uses;
use crate::{directive, page, prose};

/// The page's site with two terms, two references and two chapters without text: 00-start and 06-normals.
fn site() -> Site {
    let mut site = Site::read(&Library::of_checkout()).unwrap();
    site.chapters.retain(|chapter| ["normals", "start"].contains(&chapter.id.as_str()));
    site.chapters.iter_mut().for_each(|chapter| chapter.body.clear());
    let term = |key: &str, line, area: &str| {
        let value = Term { term: key.to_uppercase(), text: format!("A *{key}*."), area: area.to_owned() };
        Entry { key: key.to_owned(), line, value }
    };
    site.terms = vec![term("lane", 1, "parallelism"), term("ray", 5, "rendering")];
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
        ("page:normals", "<a href=\"#normals\">x</a>"),
        ("page:normals#6.1", "<a href=\"#normals-61-shading-with-surface-normals\">x</a>"),
        ("glossary:lane", "<a id=\"use-lane\" class=\"term\" href=\"#term-lane\">x</a>"),
        (
            "live:metal-fuzzy?fuzz=1",
            "<a class=\"try\" href=\"#figure-fuzz\" data-stage=\"metal-fuzzy\" data-set=\"fuzz=1\" data-still=\"figures/more/metal-fuzzy-try-",
        ),
        ("source:src/lib.rs", "x <span class=\"cite\">[<code class=\"path\">src/lib.rs</code>]</span>"),
    ] {
        // The still's name ends with a fingerprint.
        let found = alone(&site, &format!("[x]({target})"));
        assert!(
            found == format!("<p>{html}</p>\n") || (target.starts_with("live:") && found.contains(html)),
            "{found}"
        );
    }
    let [first, second] = [("first", 1), ("second", 2)]
        .map(|(key, n)| format!("<a href=\"#ref-{key}\" title=\"{key} and others: On {key}\">{n}</a>"));
    let both = format!("<p><span class=\"cite\">[{first}, {second}]</span></p>\n");
    assert_eq!(alone(&site, "[@second; @first]"), both);
}

#[test]
fn links_to_terms_are_recorded() {
    let (site, mut uses) = (site(), Uses::default());
    let html = converted(&site, "[c](glossary:ray)\n\n[d](glossary:ray)", &mut uses).unwrap();
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
        ("$$x$$", "<p><span class=\"formula\""),
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
    let site = Site::read(&Library::of_checkout()).unwrap();
    let code = alone(
        &site,
        "{{code without: a reason\nshaders/lanes.wgsl: fn dot3\nsrc/render_cpu/lanes/vector.rs: pub fn dot\n}}",
    );
    assert!(code.contains("<p class=\"without\">Not shown in C: a reason.</p>"), "{code}");
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
    let aimed = alone(&site, "{{figure glass-rules aim -1 0 -1 50}}");
    assert_eq!(aimed.matches("<div class=\"aimed\"><img").count(), 3, "{aimed}");
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
    let code = alone(&site, "{{code without: none\nshaders/sphere.wgsl: fn chord_end\n}}");
    assert!(code.contains("<span class=\"q4\">h</span>") && !code.contains("q4\">hit"), "{code}");
}

#[test]
fn back_matter_lists_terms_and_works() {
    let (site, mut uses) = (site(), Uses::default());
    let text = "[x](glossary:ray)\n\n{{glossary rendering}}\n\n{{references}}";
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
fn errors_in_texts_name_the_line() {
    let site = Site::read(&Library::of_checkout()).unwrap();
    for (text, message) in [
        ("{{figure spehre}}", "there is no figure \"spehre\""),
        ("{{figure sky aim 1 2 3}}", "give four numbers"),
        ("{{code\nsrc/lib.rs: mod nothing\n}}", "no line begins with \"mod nothing\""),
        ("{{code\nsrc/nothing.rs: fn a\n}}", "src/nothing.rs"),
        ("{{mistakes sky\nno-such\n}}", "can have no mistake \"no-such\""),
        ("{{value 2 speed/no-such}}", "speed/no-such is not a number"),
        ("[x](live:no-such?fuzz=1)", "no figure shows the stage \"no-such\""),
        ("{{figure sky\n[x](page:no-such)\n}}", "no chapter \"no-such\""),
        ("{{table no-such}}", "no measurement \"no-such\""),
        ("{{diagram no-such}}", "diagrams/no-such.svg"),
        ("{{code\nshaders/sphere.wgsl: fn chord\n}}", "what is missing (C, Rust)"),
        (
            "{{code without: none\nreference/rt_weekend.c: static double dot\nshaders/lanes.wgsl: fn dot3\nsrc/render_cpu/lanes/vector.rs: pub fn dot\n}}",
            "only then",
        ),
        ("[x](live:diffuse?fuzz=1)", "no slider \"fuzz\""),
        ("{{picture sky}}", "is not a directive"),
        ("Text {{figure sky}}", "stands alone in its paragraph"),
        ("[x](glossary:no-such)", "no term \"no-such\""),
        ("## 6.99 Title", "the book has no section 6.99"),
        ("[x](06-normals.md)", "is not a link of the page"),
        ("[x](source:src/nothing.rs)", "no file \"src/nothing.rs\""),
        ("[@no-such]", "no entry \"no-such\""),
        ("## 6.1 Another Title", "is called \"Shading with Surface Normals\""),
        ("### Title", "have two #"),
        ("$\\nosuch$", "is not understood"),
        ("$\\xi$", "ξ has no meaning"),
        ("```cobol\nx\n```", "\"cobol\" has no colours"),
        ("<b>x</b>", "HTML and pictures are not allowed"),
    ] {
        let fault = converted(&site, &format!("a\n\n{text}"), &mut Uses::default()).unwrap_err();
        assert_eq!((fault.line, fault.file.as_str()), (7, "docs/companion/06-normals.md"), "{text}: {fault}");
        assert!(fault.message.contains(message), "{text}: {fault}");
    }
}

/// Names in a text are in the code that is open, or elsewhere.
#[test]
fn texts_and_code_agree() {
    let (wgsl, c) = ("shaders/lanes.wgsl: fn dot3", "reference/rt_weekend.c: static double dot");
    let mut site = site();
    let normals = site.chapters.iter_mut().find(|chapter| chapter.id == "normals").unwrap();
    normals.facts.elsewhere = vec!["other".to_owned()];
    let line_of_fault = |text: &str, [first, second]: [&str; 2]| {
        let text =
            format!("\n`anything`\n\n## A\n\n{text}\n\n{{{{code without: none\n{first}\n{second}\n}}}}\n");
        converted(&site, &text, &mut Uses::default()).err().map(|fault| fault.line)
    };
    for (text, of_wgsl, of_c) in [
        ("a\n`dot3` b", None, Some(11)),
        ("`dot(a, b)`", Some(10), None),
        ("`fma`\n\n`a`", None, Some(10)),
        ("`other` `--flag`", None, None),
    ] {
        assert_eq!(line_of_fault(text, [wgsl, c]), of_wgsl, "{text}");
        assert_eq!(line_of_fault(text, [c, wgsl]), of_c, "{text}");
    }
    site.chapters[1].facts.book = Some("99".to_owned());
    let unknown = page::render(&site, true).unwrap_err().to_string();
    assert!(unknown.ends_with("06-normals.md:1: the book has no chapter \"99\""), "{unknown}");
}

/// The number after the last occurrence of a word.
fn number_after(text: &str, word: &str) -> f64 {
    let mut numbers = text.rsplit_once(word).unwrap().1.split(|c: char| !c.is_ascii_digit() && c != '.');
    numbers.find_map(|number| number.trim_end_matches('.').parse().ok()).unwrap()
}

/// What the captions of random drawings say is what their stills show.
#[test]
fn readings_of_random_drawings_agree_with_captions() {
    let holds = |reading: &str, [a, b]: [&str; 2], is_below: bool| {
        let [left, right] = [a, b].map(|word| number_after(reading, word));
        if is_below { left < right } else { (left - right).abs() <= 2.0 }
    };
    let library = Library::of_checkout();
    let still = |name: &str| library.read(&format!("docs/companion/diagrams/{name}.svg")).unwrap();
    for (name, words, is_below) in [
        ("points", ["Sobol", "random"], true),
        ("directions", ["mean", "hemisphere"], false),
        ("cosine", ["share", "counted"], false),
        ("error", ["Sobol", "random"], true),
    ] {
        let still = still(name);
        let reading = still.split("<desc").nth(1).unwrap().split("</desc>").next().unwrap();
        assert!(still.contains("data-random") && holds(reading, words, is_below), "{name}: {reading}");
    }
    assert!(!holds("random 0.2, Sobol 0.3", ["Sobol", "random"], true));
    let all = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/companion/diagrams")).unwrap();
    let is_random = |path: &std::path::Path| std::fs::read_to_string(path).unwrap().contains("data-random");
    assert_eq!(all.filter(|entry| is_random(&entry.as_ref().unwrap().path())).count(), 4);
}

/// A text without its directives' code.
fn words(text: &str) -> usize {
    text.split_whitespace().count()
}

#[test]
fn chapters_have_all_their_parts() {
    let chapters = Site::read(&Library::of_checkout()).unwrap().chapters;
    let total: usize = chapters.iter().map(|chapter| words(&chapter.body)).sum();
    assert!(total <= 21_000, "{total} words");
    // Before the first picture that the tracer makes.
    let texts: Vec<&str> = chapters.iter().map(|chapter| chapter.body.as_str()).collect();
    let before = words(texts.join("\n\n").split("{{figure ").next().unwrap());
    assert!(before <= 600, "{before} words");
    let parts: [&[&str]; 5] = [
        &["{{figure ", "{{diagram "],
        &["**Predict"],
        &["surprise"],
        &["## What a mistake looks like\n"],
        &["**Next:**"],
    ];
    let lacks =
        |text: &str| parts.iter().find(|part| !part.iter().any(|words| text.contains(words))).copied();
    for chapter in chapters.iter().filter(|chapter| (2..=14).contains(&chapter.number)) {
        assert_eq!(lacks(&chapter.body), None, "{}", chapter.id);
    }
    assert_eq!(lacks("{{figure sky}} **Predict** surprised **Next:**"), Some(parts[3]));
}
