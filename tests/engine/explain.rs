//! The explanation of recorded paths agrees with what the tracer did.

use weekender::backends::explain::{Event, Lobe, Step, steps};
use weekender::job::recipe::Recipe;
use weekender::job::render::RenderJob;
use weekender::render_cpu::{Isa, PathRecord, PathRecorder};
use weekender::stages::Stage;

fn job(recipe: Recipe) -> RenderJob {
    let mut recipe = recipe;
    (recipe.settings.width, recipe.settings.height) = (24, 14);
    recipe.job().expect("valid")
}

/// Calls `check` for the paths of a few samples of every pixel.
fn for_paths(job: &RenderJob, samples: u64, mut check: impl FnMut(&PathRecord, &[Step])) {
    let recorder = PathRecorder::new(job, Isa::Portable, None);
    for y in 0..14 {
        for x in 0..24 {
            for index in 0..samples {
                let record = recorder.record([x, y], index);
                let steps = steps(job, [x, y], index, &record);
                assert_eq!(steps.len(), record.rays.len());
                check(&record, &steps);
            }
        }
    }
}

#[test]
fn every_direction_follows_from_its_lobe() {
    let mut seen = [0_usize; 5];
    let stages = ["glass-refract", "glass-tir"].map(|id| Stage::find(id).expect("a stage").recipe());
    let scenes = ["three-spheres", "book", "metals"].map(|name| Recipe::find(name).expect("built in"));
    for recipe in scenes.into_iter().chain(stages) {
        let job = job(recipe);
        for_paths(&job, 4, |_, steps| {
            for pair in steps.windows(2) {
                let hit = pair[0].hit.expect("a path that continues has hit");
                assert!(pair[0].direction.dot(hit.normal) <= 1e-9, "the normal faces the ray");
                let next = pair[1].direction;
                match pair[0].event {
                    Event::Scattered(Lobe::Lambertian) => {
                        seen[0] += 1;
                        assert!(next.dot(hit.normal) > -1e-6);
                    }
                    Event::Scattered(Lobe::Metal { mirrored, fuzz }) => {
                        seen[1] += 1;
                        // The head of the random vector is on a ball of radius `fuzz` around the mirrored direction.
                        let sine = mirrored.cross(next).length();
                        assert!(sine <= fuzz + 1e-5, "{sine} {fuzz}");
                    }
                    Event::Scattered(Lobe::Glass { mirrored, refracted, reflectance, coin, refracts }) => {
                        // A stage that only refracts has no right direction where Snell's law has no solution.
                        let expected = if refracts { refracted.unwrap_or(next) } else { mirrored };
                        // Near the critical angle, rounding counts for more.
                        assert!(next.distance(expected) < 1e-4, "{next} {expected}");
                        // Within rounding, the coin decides.
                        if (coin - reflectance).abs() > 1e-5 {
                            assert_eq!(refracts, coin >= reflectance, "{coin} {reflectance}");
                        }
                        seen[if refracts { 2 } else { 3 }] += 1;
                    }
                    event => panic!("a path continued after {event:?}"),
                }
            }
            seen[4] += usize::from(steps.last().is_some_and(|step| matches!(step.event, Event::Absorbed(_))));
        });
    }
    assert!(seen.iter().all(|count| *count > 5), "{seen:?}");
}

#[test]
fn paths_end_for_the_reason_that_is_given() {
    let limited = job(Stage::find("diffuse-limited").expect("a stage").recipe());
    let mut limits = 0;
    for_paths(&limited, 2, |record, steps| {
        let last = steps.last().expect("a ray");
        match last.event {
            Event::Sky => assert!(last.hit.is_none() && record.radiance != [0.0; 3]),
            Event::Limit => {
                limits += 1;
                assert_eq!((steps.len(), record.radiance), (5, [0.0; 3]));
                assert!(last.sentence(&limited).contains("last of 5 rays"), "{}", last.sentence(&limited));
            }
            event => panic!("{event:?}"),
        }
    });
    assert!(limits > 0);
    let normals = job(Stage::find("normals").expect("a stage").recipe());
    for_paths(&normals, 1, |_, steps| {
        assert_eq!(steps.len(), 1);
        assert_eq!(steps[0].event, if steps[0].hit.is_some() { Event::Shown } else { Event::Sky });
    });
}
