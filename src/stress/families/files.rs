//! Scene files that are worth looking at.

use super::build::sized;
use crate::recipe::file;
use crate::stress::case::{Case, Expected, Family};

/// Scenes in files.
pub const FILES: Family = Family {
    id: "file",
    title: "Scenes to look at",
    lesson: "Whole pictures in which several of these difficulties meet.",
};

struct Entry {
    name: &'static str,
    text: &'static str,
    stiff: &'static str,
    unit: f64,
    expected: Expected,
    tolerance: f64,
    title: &'static str,
    look_for: &'static str,
}

const F64: Expected = Expected::Reference { why: "f64 has digits to spare at these scales" };

const ENTRIES: [Entry; 6] = [
    Entry {
        name: "soap-bubbles",
        title: "Soap bubbles",
        text: include_str!("../../../assets/scenes/stress/soap-bubbles.toml"),
        stiff: "skins a ten-thousandth of the radius thick, each of two surfaces",
        unit: 1.0,
        expected: F64,
        tolerance: 5e-6,
        look_for: "Each bubble shows only a pale rim. The book's arithmetic passes through skins thinner than \
                its threshold and turns them into balls of glass.",
    },
    Entry {
        name: "dust",
        title: "Dust on a table",
        text: include_str!("../../../assets/scenes/stress/dust.toml"),
        stiff: "grains with a radius of a ten-thousandth, whose shadows are shorter than the book's threshold",
        unit: 1e-3,
        expected: F64,
        tolerance: 5e-6,
        look_for: "Each grain has its own shadow. With the book's arithmetic, the grains float in even light.",
    },
    Entry {
        name: "contact",
        title: "Balls in contact",
        text: include_str!("../../../assets/scenes/stress/contact.toml"),
        stiff: "balls that touch the ground and each other at a point",
        unit: 1.0,
        expected: F64,
        tolerance: 5e-6,
        look_for: "The points where the balls touch are dark. Zoom in: they stay dark and smooth.",
    },
    Entry {
        name: "planet-coast",
        title: "Pebbles at a planet's pole",
        text: include_str!("../../../assets/scenes/stress/planet-coast.toml"),
        stiff: "a planet in metres, with the eye two metres above its ground and 6,371 km from its origin",
        unit: 1.0,
        expected: F64,
        tolerance: 5e-6,
        look_for: "The horizon is straight and the pebbles are round. In the book's f32, the ground is a staircase of half a metre.",
    },
    Entry {
        name: "nested",
        title: "Coats of varnish",
        text: include_str!("../../../assets/scenes/stress/nested.toml"),
        stiff: "coats within coats: eight surfaces within two thousandths of the radius",
        unit: 1.0,
        expected: F64,
        tolerance: 5e-6,
        look_for: "A red ball under four coats of varnish that mirror the sky. The book's arithmetic misses most of \
                   the coats.",
    },
    Entry {
        name: "closed-room",
        title: "A closed room of a millimetre",
        text: include_str!("../../../assets/scenes/stress/closed-room.toml"),
        stiff: "a closed white room that stands on the ground, with a ball in it",
        unit: 1.0,
        expected: Expected::Every { value: [0.0; 3], why: "the room is closed: no path leaves it" },
        tolerance: 0.0,
        look_for: "Nothing: the room is black. A bright speck would be a path that slipped through the wall. The book's \
                arithmetic lets light in all around.",
    },
];

/// The scenes of the files, as small pictures.
pub fn files() -> Vec<Case> {
    let case = |entry: &Entry| {
        let recipe = file::parse(entry.text, entry.name).ok()?;
        let small = sized(recipe, [24, 16], 32);
        Some(
            Case::new(&FILES, entry.name, entry.stiff, small)
                .of_unit(entry.unit)
                .expect(entry.expected.clone(), entry.tolerance)
                .watched(entry.title, entry.look_for),
        )
    };
    ENTRIES.iter().filter_map(case).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_read() {
        for entry in &ENTRIES {
            if let Err(error) = file::parse(entry.text, entry.name) {
                panic!("{error}");
            }
        }
        assert_eq!(files().len(), ENTRIES.len());
    }
}
