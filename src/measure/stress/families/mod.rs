//! The registry of all cases, by family.

pub mod build;
mod cavities;
mod copies;
mod files;
mod glass;
mod lengths;

use super::case::{Case, Family};
use std::sync::OnceLock;

/// A family and the function that lists its cases.
type Entry = (&'static Family, fn() -> Vec<Case>);

/// In the table's order.
const ENTRIES: [Entry; 15] = [
    (&copies::COPIES, copies::copies),
    (&copies::SHIFTS, copies::shifts),
    (&glass::SHELLS, glass::shells),
    (&glass::COATS, glass::coats),
    (&cavities::EYE, cavities::eye_near_a_surface),
    (&cavities::CAVITIES, cavities::cavities),
    (&lengths::FAR, lengths::far),
    (&lengths::MOVED, lengths::moved_scenes),
    (&lengths::SCALED, lengths::scaled_scenes),
    (&glass::INDICES, glass::indices),
    (&glass::TRAPPED, glass::trapped),
    (&glass::DEPTHS, glass::depths),
    (&lengths::LENSES, lengths::lenses),
    (&copies::ODD, copies::odd_ones),
    (&files::FILES, files::files),
];

pub fn families() -> impl Iterator<Item = &'static Family> {
    ENTRIES.iter().map(|(family, _)| *family)
}

/// The cases shown in the window. The families without a lesson are not built: their largest scenes have a hundred
/// thousand spheres.
pub fn shown_cases() -> &'static [Case] {
    static SHOWN: OnceLock<Vec<Case>> = OnceLock::new();
    SHOWN.get_or_init(|| {
        let shown = ENTRIES.iter().rev().filter(|(family, _)| family.lesson.is_some());
        shown.flat_map(|(_, list)| list()).filter(|case| case.watch.is_some()).collect()
    })
}

/// All cases in the table's order, built once: the largest scenes have a hundred thousand spheres.
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
            for (form, recipe) in case.forms() {
                if let Err(error) = recipe.job() {
                    panic!("{} {form}: {error}", case.id);
                }
            }
            if let Expected::Same(other) = &case.expected {
                other.job().unwrap();
            }
        }
    }

    #[test]
    fn ids_are_unique_with_family_prefix() {
        let ids: HashSet<&str> = cases().iter().map(|case| case.id.as_str()).collect();
        assert_eq!(ids.len(), cases().len());
        for case in cases() {
            assert_eq!(case.id.split('/').next(), Some(case.family.id), "{}", case.id);
            assert!(case.stiff.len() > 10 && case.why.len() > 10, "{}", case.id);
        }
    }
}
