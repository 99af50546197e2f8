//! Flags and values that are refused.

use super::common::{refused, temp};
use crate::common::program::{outcome, weekender};

#[test]
fn bad_values_are_refused_with_value_and_limit() {
    refused(&[], &["--batch"]);
    let foreign = if cfg!(target_arch = "x86_64") { "neon" } else { "avx2" };
    let cases: [(&[&str], &[&str]); 20] = [
        (&["--vfov", "20,5"], &["20,5", "write a point: 20.5"]),
        (&["--size", "0x10"], &["0x10", "16384"]),
        (&["--samples", "0"], &["0", "4294967296"]),
        (&["--samples", "1e3"], &["1e3", "4294967296"]),
        (&["--depth", "10001"], &["10001", "10000"]),
        (&["--vfov", "180"], &["180", "179"]),
        (&["--look-from", "1,2"], &["1,2", "three numbers"]),
        (&["--look-from", "1e200,0,0"], &["look_from.x is 1e200,", "1e18"]),
        (&["--noise-target", "1e-9"], &["1e-9", "above 3e-8"]),
        (&["--sample-range", "0..8", "--samples", "9"], &["--sample-range", "--samples"]),
        (&["--checkpoint", "x.exr", "--every", "5 weeks"], &["5 weeks", "30d", "--every"]),
        (&["--scene", "three-spheeres"], &["three-spheeres", "three-spheres"]),
        (&["--stage", "glass-schlik"], &["glass-schlik", "glass-schlick"]),
        (&["--device", "tpu"], &["tpu", "cpu"]),
        (&["--adapter", "no-such-adapter"], &["adapter"]),
        (&["--device", "cpu", "--adapter", "any"], &["--adapter", "--device cpu"]),
        (&["--isa", "mmx"], &["mmx", "avx2"]),
        (&["--isa", foreign], &[foreign, "portable"]),
        (&["--isa", "portable", "--simd", "16"], &["16 lanes", "portable"]),
        (&["--no-such-flag"], &["--no-such-flag"]),
    ];
    for (arguments, parts) in cases {
        refused(&[&["--batch"], arguments].concat(), parts);
    }
}

#[test]
fn files_of_another_kind_are_refused_with_a_remedy() {
    let directory = temp();
    let camera = "[camera]\nlook_from = [0.0, 0.0, 3.0]\nlook_at = [0.0, 0.0, 0.0]\nvfov_degrees = 40.0\n";
    let table = |row: &str| format!("spheres = '''\nx,y,z,radius,red,green,blue\n{row}\n'''\n{camera}");
    let wrong = |arguments: &[&str], parts: &[&str]| {
        crate::common::program::refused(directory.path(), arguments, parts)
    };
    for (scene, parts) in [
        ("{\"camera\": {}}", &["s.toml:1:1: ", "is TOML", "--save-scene"]),
        (&format!("{camera}vup = {{ x = 1.0 }}\n"), &["s.toml:5:", "table", "a list"]),
        (&format!("spheres = \"\"\n{camera}"), &["s.toml:1: ", "cannot read", "name"]),
        (&table("0,0,0,1,1,1,\"1"), &["s.toml:3: ", "quote", "close it"]),
        (&table(&"0,".repeat(99)), &["s.toml:3: ", "7 values", "has 100"]),
    ] {
        std::fs::write(directory.path().join("s.toml"), scene).unwrap();
        wrong(&["--batch", "--scene", "s.toml", "--out", "a.png"], parts);
    }
    std::fs::write(directory.path().join("e.exr"), "").unwrap();
    wrong(&["info", "e.exr"], &["e.exr is empty"]);
}

/// What the user gave may be as long as a file, a message may not.
#[test]
fn messages_are_short_however_long_the_input() {
    let directory = temp();
    let long = "y".repeat(100_000);
    let write = |name: &str, text: &str| std::fs::write(directory.path().join(name), text).unwrap();
    let camera = "[camera]\nlook_from = [0.0, 0.0, 3.0]\nlook_at = [0.0, 0.0, 0.0]\nvfov_degrees = 40.0\n";
    let table = |row: &str| format!("spheres = '''\nx,y,z,radius,red,green,blue\n{row}\n'''\n{camera}");
    write("cell.toml", &table(&format!("0,0,{long},1,0,0,0")));
    write("header.toml", &table("").replace("x,y,z", &format!("x,{long},z")));
    write("key.toml", &format!("{camera}{long} = 3\n"));
    write("kind.toml", &format!("{camera}[materials.a]\nkind = \"{long}\"\n"));
    write("scene.toml", &format!("scene = \"{long}\"\n{camera}"));
    for scene in ["cell.toml", "header.toml", "key.toml", "kind.toml", "scene.toml"] {
        let (code, out, message) = outcome(
            &weekender(directory.path(), &["--batch", "--scene", scene, "--out", "a.png"]).output().unwrap(),
        );
        assert_eq!((code, out.as_str()), (Some(2), ""), "{message:.400}");
        assert!(message.len() < 450 && message.contains('…') && message.contains(scene), "{message:.600}");
    }
    for flags in
        [["--stage", &long], ["--scene", &long], ["--size", &long], ["--isa", &long], ["--out", &long]]
    {
        let (code, _, message) =
            outcome(&weekender(directory.path(), &[&["--batch"], &flags[..]].concat()).output().unwrap());
        assert_eq!(code, Some(2), "{message:.400}");
        assert!(message.len() < 700, "{}: {message:.600}", message.len());
    }
}

#[test]
fn a_flag_of_another_command_is_sent_there() {
    for (arguments, place) in [
        (&["info", "a.exr", "--out", "b.png"][..], "weekender merge"),
        (&["compare", "a.exr", "b.exr", "--denoise"], "weekender --batch"),
        (&["check", "a.png", "--samples", "3"], "weekender --batch"),
        (&["merge", "a.exr", "--watch", "--out", "b.exr"], "weekender check"),
    ] {
        refused(arguments, &["is a flag of", place]);
    }
}

/// A script that died leaves a table of a header only.
#[test]
fn a_scene_without_spheres_is_warned_about() {
    let directory = temp();
    let camera = "[camera]\nlook_from = [0.0, 0.0, 3.0]\nlook_at = [0.0, 0.0, 0.0]\nvfov_degrees = 40.0\n";
    std::fs::write(directory.path().join("t.csv"), "x,y,z,radius,material\n").unwrap();
    for spheres in ["spheres = \"t.csv\"\n", "spheres = []\n", ""] {
        std::fs::write(directory.path().join("s.toml"), format!("{spheres}{camera}")).unwrap();
        for more in [&["--out", "a.png"][..], &["--turntable=2", "--out", "d"]] {
            let flags = ["--batch", "--scene", "s.toml", "--size", "8x8", "--samples", "1"];
            let output = weekender(directory.path(), &[&flags[..], more].concat()).output().unwrap();
            let (code, _, message) = outcome(&output);
            assert_eq!((code, message.matches("no spheres").count()), (Some(0), 1), "{message}");
            assert!(message.contains("[[spheres]]") && message.contains("FILE.csv"), "{message}");
        }
    }
    let stage = ["--batch", "--stage", "sky", "--size", "8x8", "--samples", "1", "--out", "b.png"];
    let (_, _, message) = outcome(&weekender(directory.path(), &stage).output().unwrap());
    assert!(!message.contains("no spheres"), "{message}");
}

/// An empty environment variable counts as not set.
#[test]
fn an_empty_choice_of_backends_is_none() {
    let directory = temp();
    let list = |value: Option<&str>| {
        let mut command = weekender(directory.path(), &["--list"]);
        value.map(|value| command.env("WGPU_BACKEND", value));
        outcome(&command.output().unwrap())
    };
    assert_eq!(list(Some("")), list(None));
    assert!(!list(Some("")).1.contains("WGPU_BACKEND"));
}

#[test]
fn outside_text_cannot_control_a_terminal() {
    let directory = temp();
    let run = |arguments: &[&str]| {
        let (code, out, message) = outcome(&weekender(directory.path(), arguments).output().unwrap());
        let all = out + &message;
        assert!(!all.chars().any(|c| c.is_control() && c != '\n'), "{all:?}");
        (code, all)
    };
    for arguments in [["--scene", "a\x1b[31mb"], ["--out", "a\x1b]0;title\x07.png/"]] {
        let (code, all) = run(&[&["--batch"], &arguments[..]].concat());
        assert!(code == Some(2) && all.starts_with("error"), "{all}");
    }
}
