//! Resetting a group of controls to the stage's values.

use crate::app::model::document::Document;

/// How a group is compared with the stage and reset to it.
pub(super) struct Reset {
    /// Whether any value of the group differs from the stage's.
    pub is_changed: fn(&Document) -> bool,
    /// Resets the group to the stage's values.
    pub reset: fn(&mut Document),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::checked::CheckedScene;
    use crate::app::model::origin::Origin;
    use crate::app::panels::{camera, lens, output, render, spheres, stop};
    use crate::render::SamplerKind;
    use crate::stages::Stage;
    use std::sync::Arc;

    #[test]
    fn every_value_belongs_to_one_group_which_resets_it() {
        type Change = fn(&mut Document);
        let groups = [
            ("spheres", spheres::RESET),
            ("camera", camera::RESET),
            ("lens", lens::RESET),
            ("render", render::RESET),
            ("stop", stop::RESET),
            ("output", output::RESET),
        ];
        let changes: [(&str, &str, Change); 16] = [
            ("spheres", "a sphere", |document| {
                let mut scene = document.scene().clone();
                scene.spheres.pop();
                document.checked = Arc::new(CheckedScene::new(Arc::new(scene), *document.rules()));
            }),
            ("camera", "look from", |document| document.camera.look_from.x += 1.0),
            ("camera", "look at", |document| document.camera.look_at.y += 1.0),
            ("camera", "up", |document| document.camera.vup.z += 1.0),
            ("camera", "field of view", |document| document.camera.vfov_degrees += 1.0),
            ("lens", "defocus angle", |document| document.camera.defocus_angle_degrees += 1.0),
            ("lens", "focus distance", |document| document.camera.focus_distance = Some(7.0)),
            ("render", "depth", |document| document.settings.max_depth += 1),
            ("render", "sampler", |document| document.settings.sampler = SamplerKind::Independent),
            ("render", "seed", |document| document.settings.seed += 1),
            ("render", "estimate error", |document| document.settings.estimate_error = false),
            ("stop", "samples", |document| document.stop.samples = Some(77)),
            ("stop", "time", |document| document.stop.seconds = Some(7.5)),
            ("stop", "error", |document| document.stop.noise = Some(0.5)),
            ("output", "size", |document| document.give_size([5, 4])),
            ("output", "own size", |document| document.has_own_size = true),
        ];
        let usual = Document::new(Origin::of_stage(Stage::find("defocus").unwrap()));
        for (group, value, change) in changes {
            let mut changed = usual.clone();
            change(&mut changed);
            assert!(changed != usual, "{value}");
            let mut document = changed.clone();
            for (name, Reset { is_changed, reset }) in &groups {
                assert_eq!(is_changed(&changed), *name == group, "{name}: {value}");
                if *name != group {
                    reset(&mut document);
                }
            }
            assert!(document == changed, "the other groups reset {value}");
            for (_, Reset { is_changed, reset }) in groups.iter().filter(|(name, _)| *name == group) {
                reset(&mut document);
                assert!(document == usual && !is_changed(&document), "{value} is not reset");
            }
        }
    }
}
