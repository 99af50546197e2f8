//! What is around made-up chapters.

use super::*;
use crate::companion::directive::{GLOSSARY_MARK, REFERENCES_MARK};

#[test]
fn the_glossary_and_the_references_are_on_the_page_once() {
    let site = Site::made_up();
    let told = |marks: &str| {
        let (mut uses, mut faults) = (Uses::default(), Vec::new());
        back_matter::fill(marks, &site, &mut uses, &mut faults);
        faults.into_iter().map(|fault| fault.to_string()).collect::<Vec<_>>()
    };
    let twice = [GLOSSARY_MARK, GLOSSARY_MARK].concat();
    assert_eq!(
        told(&twice),
        [
            "docs/companion/glossary.toml: {{glossary}} must be in one chapter once, but it is there 2 times",
            "docs/companion/references.toml: {{references}} must be in one chapter once, but it is there 0 times",
        ]
    );
    assert_eq!(told(&[GLOSSARY_MARK, REFERENCES_MARK].concat()), Vec::<String>::new());
}

#[test]
fn stages_are_those_of_the_figures_and_the_cover_in_the_order_of_the_book() {
    let mut site = Site::made_up();
    site.terms.clear();
    site.chapters[0].body = "{{figure red-sphere}}\n\n{{glossary}}\n\n{{references}}".to_owned();
    site.chapters[1].body = "{{figure sky}}\n\n[x](#normals)".to_owned();
    let page = render(&site, Vec::new()).unwrap();
    let ids: Vec<&str> = page.stages.iter().map(|stage| stage.id).collect();
    assert_eq!((ids.first(), ids.last()), (Some(&"sky"), Some(&cover_stage().id)));
    assert!(ids.contains(&"red-sphere") && page.stages.is_sorted_by(|a, b| a.index() < b.index()), "{ids:?}");
    let place = |part: &str| page.html.find(part).unwrap();
    assert!(place("id=\"figure-red-sphere\"") < place("id=\"figure-sky\""));
    assert!(place("id=\"figure-sky\"") < place("id=\"live-data\""));

    site.chapters[0].book = Some("99".to_owned());
    let earlier = vec![Fault::new("z.md", 1, "is wrong")];
    let Faults(faults) = render(&site, earlier).unwrap_err();
    assert_eq!(
        faults,
        [Fault::new("normals.md", 1, "the book has no chapter \"99\""), Fault::new("z.md", 1, "is wrong")]
    );
}
