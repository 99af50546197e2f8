//! The pictures that figures show: one panel for each stage.

use super::Panel;
use crate::stages::Stage;

/// The stage with this id; an unknown id does not compile.
const fn stage(id: &str) -> &'static Stage {
    let mut index = 0;
    while index < Stage::ALL.len() {
        if is_same(Stage::ALL[index].id.as_bytes(), id.as_bytes()) {
            return &Stage::ALL[index];
        }
        index += 1;
    }
    panic!("no stage has this id")
}

const fn is_same(a: &[u8], b: &[u8]) -> bool {
    let mut index = 0;
    while index < a.len() && index < b.len() && a[index] == b[index] {
        index += 1;
    }
    index == a.len() && index == b.len()
}

pub(super) const PPM_TINY: Panel = Panel {
    stage: stage("ppm-tiny"),
    label: "16 by 9 pixels",
    alt: "A gradient of 16 by 9 large pixels: black at the top left, red at the top right, green at the bottom left, \
          yellow at the bottom right.",
};

pub(super) const PPM_GRADIENT: Panel = Panel {
    stage: stage("ppm-gradient"),
    label: "Full size",
    alt: "A smooth gradient: black at the top left, red at the top right, green at the bottom left, yellow at the \
          bottom right.",
};

pub(super) const SKY: Panel = Panel {
    stage: stage("sky"),
    label: "Sky",
    alt: "A gradient from light blue at the top to white at the bottom.",
};

pub(super) const RED_SPHERE: Panel = Panel {
    stage: stage("red-sphere"),
    label: "Hits in red",
    alt: "A flat red disk in front of the blue and white sky.",
};

pub(super) const NORMALS: Panel = Panel {
    stage: stage("normals"),
    label: "Normals as colours",
    alt: "A ball in the colours of its normals: turquoise at the top, pink on the right, blue in the middle, \
          violet at the bottom.",
};

pub(super) const NORMALS_WORLD: Panel = Panel {
    stage: stage("normals-world"),
    label: "Two spheres",
    alt: "The ball in the colours of its normals, on ground that is light green all over.",
};

pub(super) const ALIASED: Panel = Panel {
    stage: stage("aliased"),
    label: "1 sample per pixel",
    alt: "The ball in the colours of its normals; its outline and the horizon are made of small steps.",
};

pub(super) const ANTIALIASED: Panel = Panel {
    stage: stage("antialiased"),
    label: "64 samples per pixel",
    alt: "The same ball with a smooth outline and a smooth horizon.",
};

pub(super) const DIFFUSE: Panel = Panel {
    stage: stage("diffuse"),
    label: "Uniform over the hemisphere",
    alt: "A dark grey matte ball on grey ground, with a soft, nearly black shadow where they touch.",
};

pub(super) const DIFFUSE_LIMITED: Panel = Panel {
    stage: stage("diffuse-limited"),
    label: "At most four bounces",
    alt: "The dark grey matte ball on grey ground; the shadow beneath it is slightly darker.",
};

pub(super) const SHADOW_ACNE: Panel = Panel {
    stage: stage("shadow-acne"),
    label: "Every distance above 0 counts",
    alt: "The matte ball and the ground, much darker than they should be, with fine vertical lines below the ball.",
};

pub(super) const LAMBERTIAN_LINEAR: Panel = Panel {
    stage: stage("lambertian-linear"),
    label: "Lambertian, linear",
    alt: "A grey matte ball on grey ground with a soft shadow, brighter than with uniform directions but still dark.",
};

pub(super) const LAMBERTIAN_GAMMA: Panel = Panel {
    stage: stage("lambertian-gamma"),
    label: "Lambertian, with gamma",
    alt: "The same ball, ground and shadow in light grey.",
};

pub(super) const GAMUT: Panel = Panel {
    stage: stage("gamut"),
    label: "10, 30, 50, 70 and 90 %",
    alt: "The ball in five vertical strips from dark to light. The upper half is much darker than the lower half, \
          whose strips climb in even steps.",
};

pub(super) const METAL: Panel = Panel {
    stage: stage("metal"),
    label: "Polished",
    alt: "A matte blue ball between a silver and a golden ball, which mirror it, the yellow-green ground and the \
          sky sharply.",
};

pub(super) const METAL_FUZZY: Panel = Panel {
    stage: stage("metal-fuzzy"),
    label: "Fuzz 0.3 and 1",
    alt: "The same three balls; the silver one mirrors softly, and the golden one hardly shows a reflection.",
};

pub(super) const GLASS_REFRACT: Panel = Panel {
    stage: stage("glass-refract"),
    label: "Refraction only",
    alt: "A glass ball on the left that shows the scene upside down up to its very edge: ground above, sky below. \
          A blue ball in the middle and a golden one on the right.",
};

pub(super) const GLASS_TIR: Panel = Panel {
    stage: stage("glass-tir"),
    label: "Total reflection",
    alt: "A bubble of air on the left: its middle can be seen through, and its rim mirrors the sky, the ground and \
          the blue ball.",
};

pub(super) const GLASS_SCHLICK: Panel = Panel {
    stage: stage("glass-schlick"),
    label: "Schlick's reflectance",
    alt: "A glass ball on the left that shows the scene upside down, with a pale reflection of the sky along its rim.",
};

pub(super) const HOLLOW_GLASS: Panel = Panel {
    stage: stage("hollow-glass"),
    label: "Hollow",
    alt: "A thin shell of glass on the left: the scene behind it is upright, and only the rim bends the light.",
};

pub(super) const THREE_SPHERES: Panel = Panel {
    stage: stage("three-spheres"),
    label: "All materials",
    alt: "A hollow glass ball, a matte blue ball and a golden metal ball in a row on yellow-green ground.",
};

pub(super) const FOV_WIDE: Panel = Panel {
    stage: stage("fov-wide"),
    label: "90 degrees",
    alt: "A blue and a red ball side by side that touch in the middle of the picture; both are stretched sideways.",
};

pub(super) const FOV_NARROW: Panel = Panel {
    stage: stage("fov-narrow"),
    label: "30 degrees",
    alt: "The place where the blue and the red ball touch, so close that the balls fill the picture.",
};

pub(super) const VIEW_DISTANT: Panel = Panel {
    stage: stage("view-distant"),
    label: "90 degrees",
    alt: "The three balls from above and from the left, small in the middle of wide yellow-green ground.",
};

pub(super) const VIEW_CLOSE: Panel = Panel {
    stage: stage("view-close"),
    label: "20 degrees",
    alt: "The three balls from the same place, enlarged to fill the picture; all of them are sharp.",
};

pub(super) const DEFOCUS: Panel = Panel {
    stage: stage("defocus"),
    label: "With a lens",
    alt: "The same view; the middle ball is sharp, the near glass ball and the far ground are blurred.",
};

pub(super) const BOOK: Panel = Panel {
    stage: stage("book"),
    label: "485 spheres",
    alt: "Hundreds of small balls of all materials and colours on grey ground around three large ones: glass, matte \
          brown and polished metal.",
};
