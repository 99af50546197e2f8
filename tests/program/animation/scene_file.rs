//! Keyframes of scene files.

use super::common::SCENE;
use glam::DVec3;
use weekender::job::recipe::Recipe;
use weekender::job::recipe::file::{parse, to_picture_toml, to_toml};

#[test]
fn keyframe_inherits_omitted_keys_from_the_camera() {
    let recipe = parse(SCENE, "scene").unwrap();
    let [first, second, third] = recipe.keyframes.as_slice() else { panic!("{recipe:?}") };
    assert_eq!((first.frame, first.camera), (0, recipe.camera));
    assert_eq!((second.frame, second.camera.vfov_degrees), (2, 60.0));
    assert_eq!(second.camera.look_from, DVec3::new(3.0, 1.0, 3.0));
    assert_eq!((third.camera.vfov_degrees, third.camera.focus_distance), (40.0, Some(3.0)));
}

#[test]
fn keyframes_are_written_and_read_back_to_the_bit() {
    let mut recipe = parse(SCENE, "scene").unwrap();
    recipe.keyframes[1].camera.look_at = DVec3::new(0.1, 1.0 / 3.0, -1e-18);
    // A keyframe without a focus distance focuses on look_at, whatever the camera does.
    recipe.camera.focus_distance = Some(7.0);
    for text in [to_toml(&recipe), to_picture_toml(&recipe)] {
        assert_eq!(parse(&text, "scene").unwrap(), recipe);
    }
    // So they are where the scene is only named.
    let field = Recipe::find("field:10000").unwrap();
    let text = to_picture_toml(&Recipe { keyframes: recipe.keyframes.clone(), ..field });
    assert!(text.len() < 2000, "{text}");
    assert_eq!(parse(&text, "scene").unwrap().keyframes, recipe.keyframes);
}

#[test]
fn wrong_keyframes_are_refused_with_their_place() {
    for (before, after, parts) in [
        ("frame = 2", "frame = 0", ["scene.toml:9:", "frame is 0, but the keyframe before it has 0"]),
        ("frame = 2", "frame = 100000", ["scene.toml:10:", "100000 is not between"]),
        ("frame = 2\n", "", ["scene.toml:9:1", "missing key `frame`"]),
        ("look_at = [0.0, 0.5, 0.0]", "look_at = [4.0, 2.0, 0.0]", ["scene.toml:14:", "are both"]),
    ] {
        assert!(SCENE.contains(before));
        let message = parse(&SCENE.replacen(before, after, 1), "scene.toml").unwrap_err().to_string();
        assert!(parts.iter().all(|part| message.contains(part)), "{parts:?}: {message}");
    }
}
