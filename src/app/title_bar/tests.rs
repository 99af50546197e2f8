//! Tests of the bar at the top.

use super::*;
use crate::app::tests::{dressed, facts_of};
use crate::progressive::{EndReason, Phase, Status, Stop};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use std::sync::Arc;

struct Bar {
    facts: Facts,
    thumbnails: Thumbnails,
    commands: Vec<Command>,
}

/// With these widths, everything but the stage takes 497 points; without words on until when, 366; with a menu of
/// devices, 226.
#[test]
fn the_stage_gives_way_first_then_the_words_and_then_the_devices() {
    let widths = Widths { menus: 1e6, steps: 40.0, go_on: 120.0, devices: 200.0, device: 60.0, save: 40.0 };
    for (room, least, expected) in [
        (900.0, LEAST_STAGE, Some((284.0, true, true))),
        (781.0, LEAST_STAGE, Some((284.0, true, true))),
        (780.5, LEAST_STAGE, Some((283.0, true, true))),
        (717.0, LEAST_STAGE, Some((220.0, true, true))),
        (716.5, LEAST_STAGE, Some((284.0, false, true))),
        (516.0, LEAST_STAGE, Some((150.0, false, true))),
        (515.5, LEAST_STAGE, Some((284.0, false, false))),
        (376.0, LEAST_STAGE, Some((150.0, false, false))),
        (375.5, LEAST_STAGE, None),
        (375.5, 0.0, Some((9.0, false, true))),
        (366.0, 0.0, Some((0.0, false, true))),
        (365.5, 0.0, Some((139.0, false, false))),
        (226.0, 0.0, Some((0.0, false, false))),
        (225.5, 0.0, None),
        (747.0, 250.0, Some((250.0, true, true))),
        (746.5, 250.0, Some((284.0, false, true))),
    ] {
        let expected = expected.map(|(stage, says_until_when, has_all_devices)| Fit {
            stage,
            says_until_when,
            has_all_devices,
        });
        assert_eq!(widths.fit(room, least), expected, "{room} points");
    }
}
