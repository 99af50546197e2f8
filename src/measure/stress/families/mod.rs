//! The registry of all cases, by family.

pub mod build;
mod cavities;
mod copies;
mod files;
mod glass;
mod lengths;

use super::case::{Case, Family};
use std::sync::OnceLock;

/// All families in the table's order.
pub static FAMILIES: [Family; 15] = [
    // Two surfaces at the same place tie at every hit. A ray that leaves one of them also starts on the other and must
    // not hit it.
    Family { id: "copies", title: "Many spheres at the same place", lesson: None, cases: copies::copies },
    // No threshold separates coinciding surfaces from distinct ones: every shift must give the picture of one ball, to
    // within the shift.
    Family { id: "shifts", title: "A copy, moved imperceptibly", lesson: None, cases: copies::shifts },
    // Concentric shells are the worst case for a hierarchy: every box contains all smaller ones, so the tree can become
    // as deep as there are shells.
    Family { id: "shells", title: "Spheres inside spheres", lesson: None, cases: glass::shells },
    // The coat's thickness is the difference of two radii. The thinner the coat and the farther from the origin, the
    // fewer of its digits remain.
    Family { id: "coats", title: "A coat of glass over matte", lesson: None, cases: glass::coats },
    // Only the camera's rays start where no ray has arrived. Exactly on a surface, they must leave it like any other
    // rays.
    Family { id: "eye", title: "The eye on a surface", lesson: None, cases: cavities::eye_near_a_surface },
    Family {
        id: "cavity",
        title: "The eye in a closed ball",
        lesson: Some(
            "No light gets in, so a single leaking path shows as a bright speck. Where the ball touches the ground, \
             the surfaces are closer to each other than rounding can tell.",
        ),
        cases: cavities::cavities,
    },
    // The hit point is the eye plus a vector of up to millions of radii, and the normal is what remains of its digits.
    // The book's quadratic subtracts two squares that agree in all their digits.
    Family { id: "far", title: "A ball that is tiny for its distance", lesson: None, cases: lengths::far },
    Family {
        id: "moved",
        title: "The whole scene far from the origin",
        lesson: Some(
            "A picture does not depend on where the origin is. In f32, a scene at 1e7 has no digits left for \
             lengths below 1, unless its coordinates are measured from near the eye.",
        ),
        cases: lengths::moved_scenes,
    },
    Family {
        id: "scaled",
        title: "The whole scene larger or smaller",
        lesson: Some("A picture does not depend on the unit of length; a threshold that is a length does."),
        cases: lengths::scaled_scenes,
    },
    // Near 1, the bend is a difference of almost equal angles. At 1e4, light leaves through a cone of a hundredth of a
    // degree, whose sine cannot be computed from 1 - cos^2.
    Family {
        id: "index",
        title: "Refraction indices from 1.000001 to a million",
        lesson: None,
        cases: glass::indices,
    },
    // In a ball, the angle of incidence never changes. Rounding must not let it drift across the critical angle, even in
    // ten thousand reflections.
    Family {
        id: "trapped",
        title: "Light that runs along the wall of a glass ball",
        lesson: None,
        cases: glass::trapped,
    },
    // A bounce must be right ten thousand times in a row, and a kernel that a driver cuts short must be noticed.
    Family { id: "depth", title: "Long paths and many samples", lesson: None, cases: glass::depths },
    Family {
        id: "lens",
        title: "Extreme angles, lenses and focus",
        lesson: Some(
            "The narrowest view turns a pixel into a hundred-thousandth of a degree; the widest lens sends rays \
             almost parallel to its own plane.",
        ),
        cases: lengths::lenses,
    },
    // One unusual thing in a large field.
    // If one sphere needs more precision, only that sphere should pay for it. Anchoring all spheres would turn the
    // hierarchy into a list.
    Family {
        id: "odd",
        title: "One odd thing among four thousand balls",
        lesson: None,
        cases: copies::odd_ones,
    },
    Family {
        id: "file",
        title: "Scenes to look at",
        lesson: Some("Whole pictures in which several of these difficulties meet."),
        cases: files::files,
    },
];

/// The cases shown in the window. The families without a lesson are not built: their largest scenes have a hundred
/// thousand spheres.
pub fn shown_cases() -> &'static [Case] {
    static SHOWN: OnceLock<Vec<Case>> = OnceLock::new();
    SHOWN.get_or_init(|| {
        let shown = FAMILIES.iter().rev().filter(|family| family.lesson.is_some());
        shown.flat_map(|family| (family.cases)(family)).filter(|case| case.watch.is_some()).collect()
    })
}

/// All cases in the table's order, built once: the largest scenes have a hundred thousand spheres.
pub fn cases() -> &'static [Case] {
    static CASES: OnceLock<Vec<Case>> = OnceLock::new();
    CASES.get_or_init(|| FAMILIES.iter().flat_map(|family| (family.cases)(family)).collect())
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
