//! The script's own arithmetic, run by node: the camera, the bytes that sliders change, and the blocks of samples.

use super::live_page::{SCRIPT, job_of};
use crate::live::live_data;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec3;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::process::{Command, Stdio};
use weekender::job::render::{RenderJob, Viewport};
use weekender::kernel::sampling::{SampleBlock, pcg4d};
use weekender::kernel::{CameraTable, words_of};
use weekender::render_gpu::Exported;
use weekender::render_gpu::shader_source::{EntryPoint, source};
use weekender::scene::{Camera, Material, Scene};
use weekender::stages::Stage;

/// Random numbers that are the same in each run.
struct Draws(u32);

impl Draws {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 += 1;
        low + (high - low) * f64::from(pcg4d([self.0, 0, 0, 7])[0]) / f64::from(u32::MAX)
    }

    fn point(&mut self, size: f64) -> DVec3 {
        DVec3::new(self.within(-size, size), self.within(-size, size), self.within(-size, size))
    }

    fn whole(&mut self, most: u32) -> u32 {
        self.within(1.0, f64::from(most) + 1.0) as u32
    }
}

fn camera_json(camera: &Camera) -> Value {
    json!({
        "from": camera.look_from, "at": camera.look_at, "up": camera.vup, "vfov": camera.vfov_degrees,
        "defocus": camera.defocus_angle_degrees, "focus": camera.focus_distance,
    })
}

pub fn camera_of(json: &Value) -> Camera {
    let vector = |key: &str| serde_json::from_value(json[key].clone()).unwrap();
    Camera {
        look_from: vector("from"),
        look_at: vector("at"),
        vup: vector("up"),
        vfov_degrees: json["vfov"].as_f64().unwrap(),
        defocus_angle_degrees: json["defocus"].as_f64().unwrap(),
        focus_distance: json["focus"].as_f64(),
    }
}

/// Runs the script in node; `None` if there is none.
fn told_by_node(input: &Value) -> Option<Value> {
    let directory = tempfile::tempdir().unwrap();
    let script = directory.path().join("live.mjs");
    std::fs::write(&script, SCRIPT).unwrap();
    let program = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/bytes.mjs");
    let mut node = Command::new("node");
    node.arg(program).arg(&script).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = match node.spawn() {
        Ok(child) => child,
        Err(error) => {
            super::skip("BROWSER", &format!("node cannot be run: {error}"));
            return None;
        }
    };
    serde_json::to_writer(child.stdin.take().unwrap(), input).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    Some(serde_json::from_slice(&output.stdout).unwrap())
}

pub fn data_of(stages: &[Stage]) -> Value {
    serde_json::from_str(&live_data(stages).unwrap()).unwrap()
}

#[test]
fn cameras_are_those_of_the_program() {
    let mut draws = Draws(0);
    let cameras: Vec<(Camera, [u32; 2], DVec3)> = (0..3000)
        .map(|i| {
            let look_from = draws.point(20.0);
            let look_at = look_from + draws.point([1e-3, 1.0, 30.0][i % 3]);
            let almost_ahead = 3.0 * (look_at - look_from) + draws.point(1e-6);
            let vup = if i % 50 == 0 { almost_ahead } else { draws.point(2.0) };
            let camera = Camera {
                look_from,
                look_at,
                vup,
                vfov_degrees: draws.within(1.0, 170.0),
                defocus_angle_degrees: if i % 2 == 0 { 0.0 } else { draws.within(0.0, 90.0) },
                focus_distance: (i % 3 == 0).then(|| draws.within(0.1, 100.0)),
            };
            let origin = if i % 4 == 0 { draws.point(8.0) } else { DVec3::ZERO };
            (camera, [draws.whole(2000), draws.whole(2000)], origin)
        })
        .collect();
    let tables = cameras.iter().map(
        |(camera, size, origin)| json!({ "camera": camera_json(camera), "size": size, "origin": origin }),
    );
    let tables: Vec<Value> = tables.collect();
    let input = json!({ "data": data_of(&[]), "tables": tables });
    let Some(told) = told_by_node(&input) else { return };
    for (index, (camera, size, origin)) in cameras.iter().enumerate() {
        let table = CameraTable::<f32>::new(camera, &Viewport::WHOLE, *size, *origin);
        let expected = STANDARD.encode(bytemuck::cast_slice::<u32, u8>(&words_of(&[table])));
        assert_eq!(told["tables"][index], expected, "{camera:?} {size:?} from {origin}");
    }
}

/// Cases for each stage. The first has the stage's own settings.
const CASES: usize = 60;

/// A stage with a reader's settings: the script's input, and the job that it should become.
struct Case {
    stage: Stage,
    settings: Value,
    size: [u32; 2],
    moves: Vec<[f64; 3]>,
    scene: Scene,
    depth: u32,
}

/// The scene with a slider's material number, and the slider's value.
pub fn with_slider(scene: &mut Scene, slider: &Value, value: f64) {
    let label = slider["label"].as_str().unwrap();
    let first_index = scene.materials.iter().find_map(|named| match named.material {
        Material::Dielectric { refraction_index } => Some(refraction_index),
        _ => None,
    });
    for named in &mut scene.materials {
        match &mut named.material {
            Material::Metal { fuzz, .. } if label == format!("Fuzz ({})", named.name) => *fuzz = value,
            Material::Dielectric { refraction_index } if slider["key"] == "index" => {
                let is_bubble = Some(*refraction_index) != first_index;
                *refraction_index = if is_bubble { 1.0 / value } else { value };
            }
            _ => {}
        }
    }
}

fn case(stage: &Stage, sliders: &[Value], draws: &mut Draws, count: usize) -> Case {
    let mut scene = (stage.setup.scene)();
    let mut camera = camera_json(&stage.setup.camera);
    let mut material = BTreeMap::new();
    let mut depth = stage.setup.max_depth;
    for (index, slider) in sliders.iter().enumerate().filter(|_| count > 0) {
        let end = |key: &str| slider[key].as_f64().unwrap();
        let value =
            [end("min"), end("max"), draws.within(end("min"), end("max"))][draws.whole(3) as usize - 1];
        match slider["key"].as_str().unwrap() {
            "fuzz" | "index" => {
                material.insert(index.to_string(), value);
                with_slider(&mut scene, slider, value);
            }
            "bounces" => depth = value as u32 + 1,
            "samples" => {}
            // A wide lens is not served everywhere, and most cases should be.
            "defocus" => camera["defocus"] = json!(value * 0.2),
            key => camera[key] = json!(value),
        }
    }
    let moves =
        (0..count).map(|_| [draws.within(-2.0, 2.0), draws.within(-1.0, 1.0), draws.within(0.5, 1.5)]);
    Case {
        stage: *stage,
        settings: json!({ "camera": camera, "depth": depth, "material": material }),
        size: [stage.setup.width, stage.setup.height].map(|pixels| pixels.div_ceil([1, 2, 8][count % 3])),
        moves: moves.collect(),
        scene,
        depth,
    }
}

/// The script moves the camera and changes materials in buffers that were prepared for another camera. They must be
/// those that the program prepares.
#[test]
fn buffers_are_those_of_the_program() {
    let mut draws = Draws(1 << 20);
    let data = data_of(Stage::ALL);
    let mut cases = Vec::new();
    for stage in Stage::ALL.iter().filter(|stage| stage.setup.width > 100) {
        let sliders = data["stages"][stage.id]["sliders"].as_array().unwrap();
        cases.extend((0..CASES).map(|count| case(stage, sliders, &mut draws, count)));
    }
    let told = cases.iter().map(|Case { stage, settings, size, moves, .. }| {
        json!({ "stage": stage.id, "settings": settings, "size": size, "moves": moves })
    });
    let told: Vec<Value> = told.collect();
    let input = json!({ "data": data, "cases": told });
    let Some(told) = told_by_node(&input) else { return };
    let mut served = 0;
    for (index, Case { stage, size: [width, height], scene, depth, .. }) in cases.into_iter().enumerate() {
        let told = &told["cases"][index];
        let camera = camera_of(&told["camera"]);
        if told["isServed"] == false {
            assert!(index % CASES != 0, "{}: its own camera is served", stage.id);
            continue;
        }
        served += 1;
        let mut settings = *job_of(&stage).settings();
        (settings.width, settings.height, settings.max_depth) = (width, height, depth);
        let job = RenderJob::new(scene, camera, settings, stage.setup.rules).unwrap();
        let expected = Exported::new(&job);
        let about = format!("{} case {}: {camera:?}", stage.id, index % CASES);
        for (name, value) in expected.features.overrides() {
            // The number of rays that fit a dispatch decides it.
            if name != "SUSPENDS" {
                assert_eq!(told["overrides"][&name], value, "{name}, {about}");
            }
        }
        for (number, bytes) in expected.buffers.iter().enumerate() {
            let written = STANDARD.decode(told["buffers"][number].as_str().unwrap()).unwrap();
            let differs = written.iter().zip(bytes).position(|(a, b)| a != b);
            assert_eq!((differs, written.len()), (None, bytes.len()), "buffer {number}, {about}");
        }
    }
    assert!(served > 10 * CASES, "only {served} cases are served");
}

#[test]
fn blocks_hold_each_sample_once() {
    let wishes = [(1_u32, 128_u32), (2, 128), (3, 1), (200, 128), (500, 7), (4096, 128), (1000, 1000)];
    let input = json!({ "data": data_of(&[]), "blocks": wishes });
    let Some(told) = told_by_node(&input) else { return };
    let settings = *job_of(&Stage::ALL[0]).settings();
    for (index, (wanted, most)) in wishes.into_iter().enumerate() {
        let blocks = told["blocks"][index].as_array().unwrap();
        let mut first = 0;
        for block in blocks {
            let number = |key: &str| block[key].as_u64().unwrap() as u32;
            let count = number("count");
            assert!(count <= most && count.is_power_of_two() && first % count == 0, "{first} {block}");
            let (counter, step) = SampleBlock { half: 0, first, count }.counter(&settings);
            assert_eq!((number("half"), number("counter"), number("step")), (0, counter, step), "{first}");
            first += count;
        }
        assert_eq!(first, wanted);
    }
}

#[test]
fn dispatches_reach_their_time_and_recover() {
    let mut times = vec![[0.1, 1e5]; 20];
    times.push([0.0, 1e3]);
    let Some(told) = told_by_node(&json!({ "data": data_of(&[]), "times": times })) else { return };
    let paths = |index: usize| told["learnt"][index].as_f64().unwrap();
    assert!(paths(0) <= 4.0 * 4096.0, "a careful start");
    assert!((1.9e6..2.1e6).contains(&paths(19)), "20 ms: {}", paths(19));
    assert_eq!(paths(20), paths(19) / 2.0, "a dispatch that takes a hundred times as long");
}

#[test]
fn orbits_keep_the_distance_and_never_turn_over() {
    let mut draws = Draws(1 << 21);
    let camera = Camera { look_from: DVec3::new(0.0, 0.0, 4.0), look_at: DVec3::ZERO, ..Camera::BOOK };
    let mut turns = vec![(camera, FRAC_PI_2, 0.0), (camera, 0.0, 0.3)];
    for _ in 0..200 {
        let tilted = Camera { vup: DVec3::Y + draws.point(0.5), ..camera };
        turns.push((tilted, draws.within(-9.0, 9.0), draws.within(-9.0, 9.0)));
    }
    let told: Vec<_> =
        turns.iter().map(|(camera, right, up)| json!([camera_json(camera), right, up])).collect();
    let Some(told) = told_by_node(&json!({ "data": data_of(&[]), "turns": told })) else { return };
    let eye = |index: usize| -> DVec3 { serde_json::from_value(told["turned"][index].clone()).unwrap() };
    // The scene turns right and its front goes down, as in the window.
    assert!(eye(0).distance(DVec3::new(-4.0, 0.0, 0.0)) < 1e-9, "{}", eye(0));
    assert!(eye(1).y > 0.0, "{}", eye(1));
    for (index, (camera, ..)) in turns.iter().enumerate() {
        assert!((eye(index).length() - 4.0).abs() < 1e-9, "{}", eye(index));
        let from_pole = eye(index).angle_between(camera.vup).to_degrees();
        assert!((0.999..179.001).contains(&from_pole), "{from_pole} degrees from the pole");
    }
}

/// HTML ends a script at `</script` and reads `<!--` as a comment. The rest of the page should not wait for the data.
#[test]
fn a_page_can_hold_data_and_script() {
    let data = live_data(Stage::ALL).unwrap();
    for text in [data.as_str(), SCRIPT] {
        assert!(!text.contains("</") && !text.contains("<!--"));
    }
    let json: Value = serde_json::from_str(&data).unwrap();
    let programs = &json["programs"];
    for entry_point in [EntryPoint::PathTrace, EntryPoint::Resolve] {
        let text = [&programs["shared"], &programs[entry_point.name()]].map(|part| part.as_str().unwrap());
        assert_eq!(text.concat(), source(entry_point));
    }
    for (id, stage) in json["stages"].as_object().unwrap() {
        let size = stage.to_string().len();
        let limit = if id == "book" { 80_000 } else { 4_000 };
        assert!(size < limit, "{id} takes {size} bytes");
    }
}
