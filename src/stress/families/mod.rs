//! The registry of all cases, by family.

pub mod build;
mod cavities;
mod copies;
mod eye;
mod far;
mod files;
mod glass;
mod lengths;
mod many;
mod shells;

use super::case::{Case, Family};
use std::sync::OnceLock;

/// A family and the function that lists its cases.
type Entry = (&'static Family, fn() -> Vec<Case>);

/// All families, in the order of the table.
const ENTRIES: [Entry; 15] = [
    (&copies::COPIES, copies::copies),
    (&copies::SHIFTS, copies::shifts),
    (&shells::SHELLS, shells::shells),
    (&shells::COATS, shells::coats),
    (&eye::EYE, eye::eye_near_a_surface),
    (&cavities::CAVITIES, cavities::cavities),
    (&far::FAR, far::far),
    (&lengths::MOVED, lengths::moved_scenes),
    (&lengths::SCALED, lengths::scaled_scenes),
    (&glass::INDICES, glass::indices),
    (&glass::TRAPPED, glass::trapped),
    (&glass::DEPTHS, glass::depths),
    (&lengths::LENSES, lengths::lenses),
    (&many::ODD, many::odd_ones),
    (&files::FILES, files::files),
];

/// All families, in the order of the table.
pub fn families() -> impl Iterator<Item = &'static Family> {
    ENTRIES.iter().map(|(family, _)| *family)
}

/// The cases that the window shows. They are listed separately, so that it need not build the largest scenes.
pub fn shown_cases() -> &'static [Case] {
    static SHOWN: OnceLock<Vec<Case>> = OnceLock::new();
    SHOWN.get_or_init(|| {
        let lists: [fn() -> Vec<Case>; 5] = [
            files::files,
            lengths::scaled_scenes,
            lengths::moved_scenes,
            lengths::lenses,
            cavities::cavities,
        ];
        lists.into_iter().flat_map(|list| list()).filter(|case| case.watch.is_some()).collect()
    })
}

/// All cases, in the order of the table. They are built once: the largest scenes have a hundred thousand spheres.
pub fn cases() -> &'static [Case] {
    static CASES: OnceLock<Vec<Case>> = OnceLock::new();
    CASES.get_or_init(|| ENTRIES.iter().flat_map(|(_, list)| list()).collect())
}

#[cfg(test)]
mod tests {
    use super::super::case::Expected;
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_case_is_a_valid_picture_in_each_form() {
        for case in cases() {
            for form in case.forms() {
                let recipe = case.recipe_in(*form);
                if let Err(error) = recipe.job() {
                    panic!("{} {}: {error}", case.id, form.name());
                }
            }
            for other in case.tame.iter().chain(match &case.expected {
                Expected::Same { other, .. } => Some(&**other),
                _ => None,
            }) {
                other.job().unwrap();
            }
        }
    }

    #[test]
    fn ids_are_unique_and_say_the_family() {
        let ids: HashSet<&str> = cases().iter().map(|case| case.id.as_str()).collect();
        assert_eq!(ids.len(), cases().len());
        for case in cases() {
            assert_eq!(case.id.split('/').next(), Some(case.family.id), "{}", case.id);
            assert!(case.stiff.len() > 10 && case.expected.why().len() > 10, "{}", case.id);
        }
    }

    #[test]
    fn every_family_has_cases_and_some_are_shown() {
        for family in families() {
            assert!(cases().iter().any(|case| case.family == family), "{}", family.id);
        }
        let all = cases().iter().filter(|case| case.watch.is_some()).count();
        assert!(all >= 10 && all == shown_cases().len(), "{all}");
    }

    #[test]
    fn the_same_picture_has_the_same_size_and_samples() {
        for case in cases() {
            if let Expected::Same { other, .. } = &case.expected {
                assert_eq!(case.recipe.settings, other.settings, "{}", case.id);
                assert_eq!(case.recipe.samples_per_pixel, other.samples_per_pixel, "{}", case.id);
            }
        }
    }

    /// Otherwise their times could not be compared.
    #[test]
    fn a_tame_twin_has_as_many_paths_of_the_same_length() {
        let mut twins: Vec<(&str, &str)> = Vec::new();
        for case in cases() {
            let Some(tame) = &case.tame else { continue };
            assert_eq!(tame.settings, case.recipe.settings, "{}", case.id);
            assert_eq!(tame.samples_per_pixel, case.recipe.samples_per_pixel, "{}", case.id);
            assert_ne!((&tame.scene, tame.camera), (&case.recipe.scene, case.recipe.camera), "{}", case.id);
            let twin = (case.family.id, tame.name.as_str());
            if twins.last() != Some(&twin) {
                twins.push(twin);
            }
        }
        assert_eq!(
            twins,
            [
                ("copies", "as many apart"),
                ("shifts", "one-ball"),
                ("coats", "a coat of .1"),
                ("moved", "tame"),
                ("scaled", "tame"),
                ("lens", "tame"),
                ("odd", "field:4000"),
            ]
        );
        // A scene of as many spheres takes as long to prepare.
        let crowded = cases().iter().filter(|case| ["copies", "odd"].contains(&case.family.id));
        for (case, tame) in crowded.filter_map(|case| Some((case, case.tame.as_ref()?))) {
            let [count, of_tame] = [&case.recipe, tame].map(|recipe| recipe.scene.spheres.len());
            assert!(of_tame <= count && count <= of_tame + 100, "{}: {count} and {of_tame}", case.id);
        }
    }
}
