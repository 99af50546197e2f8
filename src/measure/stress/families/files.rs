//! Scene files worth looking at.

use super::build::sized;
use crate::job::recipe::file;
use crate::measure::stress::case::{Case, Expected, Family};

/// Name, text, what makes it hard, title, and what to look for.
const SCENES: [[&str; 5]; 6] = [
    [
        "soap-bubbles",
        include_str!("../../../../assets/scenes/stress/soap-bubbles.toml"),
        "skins a ten-thousandth of the radius thick, each of two surfaces",
        "Soap bubbles",
        "Each bubble shows only a pale rim. The book's arithmetic passes through skins thinner than \
                its threshold and turns them into balls of glass.",
    ],
    [
        "dust",
        include_str!("../../../../assets/scenes/stress/dust.toml"),
        "grains with a radius of a ten-thousandth, whose shadows are shorter than the book's threshold",
        "Dust on a table",
        "Each grain has its own shadow. With the book's arithmetic, the grains float in even light.",
    ],
    [
        "contact",
        include_str!("../../../../assets/scenes/stress/contact.toml"),
        "balls that touch the ground and each other at a point",
        "Balls in contact",
        "The points where the balls touch are dark. Zoom in: they stay dark and smooth.",
    ],
    [
        "planet-coast",
        include_str!("../../../../assets/scenes/stress/planet-coast.toml"),
        "a planet in metres, with the eye two metres above its ground and 6,371 km from its origin",
        "Pebbles at a planet's pole",
        "The horizon is straight and the pebbles are round. In the book's f32, the ground is a staircase of half a metre.",
    ],
    [
        "nested",
        include_str!("../../../../assets/scenes/stress/nested.toml"),
        "coats within coats: eight surfaces within two thousandths of the radius",
        "Coats of varnish",
        "A red ball under four coats of varnish that mirror the sky. The book's arithmetic misses most of \
                   the coats.",
    ],
    [
        "closed-room",
        include_str!("../../../../assets/scenes/stress/closed-room.toml"),
        "a closed white room that stands on the ground, with a ball in it",
        "A closed room of a millimetre",
        "Nothing: the room is black. A bright speck would be a path that slipped through the wall. The book's \
                arithmetic lets light in all around.",
    ],
];

/// The files' scenes as small pictures.
pub fn files(family: &'static Family) -> Vec<Case> {
    let case = |[name, text, stiff, title, look_for]: [&'static str; 5]| {
        let recipe = sized(file::parse(text, name).ok()?, [24, 16], 32);
        let case = Case::new(family, name, stiff, recipe).watched(title, look_for);
        let closed = "the room is closed: no path leaves it";
        Some(match name {
            "closed-room" => case.expect(Expected::Every([0.0; 3]), closed, 0.0),
            "dust" => Case { tolerance: 5e-6, ..case.of_unit(1e-3) },
            _ => Case { tolerance: 5e-6, ..case },
        })
    };
    SCENES.into_iter().filter_map(case).collect()
}
