//! Spheres in a table: CSV in a file beside the scene file, or in a string of it.

use super::common::{CAMERA, assert_round_trip};
use glam::DVec3;
use std::fs;
use std::sync::Arc;
use weekender::job::recipe::Recipe;
use weekender::job::recipe::file::{inputs, load, parse, to_toml};
use weekender::scene::{Material, Scene};

const MATERIALS: &str = "\
[materials]
ball = { kind = \"lambertian\", albedo = [0.5, 0.5, 0.5] }
\"ice blue\" = { kind = \"dielectric\", refraction_index = 1.3 }
";

const TABLE: &str = "x,y,z,radius,material\n0,-1000.5,0,1e3,ball\n-1,0.25,2,0.5,\"ice blue\"\n";

fn with_spheres(value: &str) -> String {
    format!("spheres = {value}\n{CAMERA}{MATERIALS}")
}

#[test]
fn a_table_is_the_same_scene_as_a_list() {
    let listed = with_spheres(
        "[{ center = [0, -1000.5, 0], radius = 1e3, material = \"ball\" }, { center = [-1, 0.25, 2], radius = 0.5, \
         material = \"ice blue\" }]",
    );
    let listed = parse(&listed, "a").expect("valid");
    let folder = tempfile::tempdir().expect("a folder");
    let scene = folder.path().join("a.toml");
    let read = |value: &str, table: &str| {
        fs::write(&scene, with_spheres(value)).expect("written");
        fs::write(folder.path().join("t.csv"), table).expect("written");
        load(&scene).unwrap_or_else(|error| panic!("{error}"))
    };
    assert_eq!(
        read("'''\nx,y,z,radius,material\n0,-1000.5,0,1e3,ball\n-1,0.25,2,0.5,\"ice blue\"'''", ""),
        listed
    );
    let quoted = TABLE.replace("-1,0.25", "\"-1\", \"0.25\"");
    let (mac, spaced) = (TABLE.replace('\n', "\r"), TABLE.replace(",", " , ").replace('\n', "\n  \n"));
    assert_eq!(
        [read("\"t.csv\"", &quoted), read("\"t.csv\"", &mac), read("\"t.csv\"", &spaced)],
        [(); 3].map(|()| listed.clone())
    );
    let reordered = "material, radius, z, y, x\nball, 1000, 0, -1000.5, 0\n\n\"ice blue\",.5,2,.25,-1";
    for table in [TABLE, &TABLE.replace('\n', "\r\n"), &format!("\u{feff}{TABLE}"), reordered] {
        assert_eq!(read("\"t.csv\"", table), listed, "{table:?}");
    }
    assert_eq!(read("\"./t.csv\"", TABLE), listed);
    assert_eq!(inputs(&scene), [scene.clone(), folder.path().join("t.csv")]);
    fs::write(&scene, to_toml(&listed)).expect("written");
    assert_eq!(inputs(&scene), std::slice::from_ref(&scene));
}

#[test]
fn equal_colours_share_a_material() {
    let table =
        "'''\nx,y,z,radius,red,green,blue\n0,0,0,1,0.5,0.25,1\n3,0,0,1,0,0,0\n6,0,0,1,0.5,0.25,1\n'''";
    let recipe = parse(&with_spheres(table), "a").expect("valid");
    let Scene { materials, spheres, .. } = &*recipe.scene;
    assert_eq!((materials.len(), spheres[0].material, spheres[2].material), (4, 2, 2));
    assert_eq!(materials[2].material, Material::Lambertian { albedo: DVec3::new(0.5, 0.25, 1.0) });
    assert_round_trip(&recipe);
}

#[test]
fn large_scenes_are_written_as_a_table() {
    let mut recipe = Recipe::builtin("field:10000").expect("a field");
    let scene = Arc::make_mut(&mut recipe.scene);
    scene.spheres[7].center.x = -0.0;
    scene.spheres[8].radius = 1e-18;
    for name in ["", "é", "a.b c", " a ", "a,b", "\"", "'''", "\\", "two\nlines"] {
        name.clone_into(&mut Arc::make_mut(&mut recipe.scene).materials[3].name);
        assert_round_trip(&recipe);
        let is_table = to_toml(&recipe).len() < 60 * 10_000;
        assert_eq!(is_table, ["", "é", "a.b c"].contains(&name), "{name:?}");
    }
}

#[test]
fn a_wrong_table_is_refused_with_its_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = folder.path().join("a.toml");
    fs::write(&scene, with_spheres("\"t.csv\"")).expect("written");
    let path = folder.path().join("t.csv");
    for (old, new, line, parts) in [
        ("2,0.5", "2,0", 3, &["spheres[1].radius is 0", "between 1e-18 and 1e18", "give the sphere"][..]),
        ("0.25", "nan", 3, &["spheres[1].center.y is NaN"]),
        ("0.25", "0,25", 3, &["have 5 values", "has 6", "write a point"]),
        ("0.25", "zero", 3, &["spheres[1].y is \"zero\"", "a number such as"]),
        ("1e3,ball", "1e3", 2, &["has 4"]),
        ("ball", "bell", 2, &["spheres[0].material is \"bell\"", "add [materials.bell]"]),
        ("radius", "size", 1, &["x,y,z,size,material", "unknown column \"size\"", "x,y,z,radius"]),
        ("x,y,z,radius,material", "x;y;z;radius;material", 1, &["separated by semicolons"]),
        ("x,y,z,radius,material", "x\ty\tz\tradius\tmaterial", 1, &["separated by tabs"]),
        ("x,y,z,radius,material", ",x,y,z,radius,material", 1, &["no name", "index"]),
        ("0.25", "\"0,25\"", 3, &["spheres[1].y is \"0,25\"", "a number such as"]),
        ("material", "x", 1, &["x,y,z,radius,x", "each once"]),
        ("x,y,z,radius,material\n", "", 1, &["0,-1000.5,0,1e3,ball", "must name its columns"]),
    ] {
        assert!(TABLE.contains(old), "{old}");
        let table = TABLE.replacen(old, new, 1);
        fs::write(&path, &table).expect("written");
        let in_file = load(&scene).expect_err("refused").to_string();
        let there = path.display();
        assert!(in_file.starts_with(&format!("{there}:{line}: ")), "{line}: {in_file}");
        // The table's first line is the second of this file.
        let in_text =
            parse(&with_spheres(&format!("'''\n{table}'''")), "a.toml").expect_err("refused").to_string();
        assert!(in_text.starts_with(&format!("a.toml:{}: ", line + 1)), "{line}: {in_text}");
        for message in [in_file, in_text] {
            assert!(parts.iter().all(|part| message.contains(part)), "{parts:?}: {message}");
        }
    }
    fs::write(&path, "x,y,z,radius,red,green,blue\n0,0,0,1,255,0,0\n").expect("written");
    let message = load(&scene).expect_err("refused").to_string();
    assert!(message.contains("t.csv:2: ") && message.contains("[255.0, 0.0, 0.0]"), "{message}");
    fs::write(&path, b"x,y,z\xff").expect("written");
    assert!(load(&scene).expect_err("refused").to_string().contains("t.csv: it is not UTF-8"));
    for (bytes, kind) in [
        (&b"\x1f\x8b\x08\x00"[..], "gzip"),
        (b"\xff\xfex\0,\0", "UTF-16"),
        (b"\x89PNG\r\n\x1a\n", "a PNG"),
        (b"PK\x03\x04\xff", "workbook"),
    ] {
        fs::write(&path, bytes).expect("written");
        let message = load(&scene).expect_err("refused").to_string();
        assert!(message.contains(kind) && !message.contains("permissions"), "{message}");
    }
    fs::remove_file(&path).expect("removed");
    assert!(load(&scene).expect_err("refused").to_string().contains("cannot read"));
    // A recipe in a picture cannot make the program read a file.
    let message = parse(&with_spheres("\"/etc/passwd\""), "a.png").expect_err("refused").to_string();
    assert!(message.contains("a.png:1: ") && message.contains("/etc/passwd"), "{message}");
    assert!(parse(&with_spheres("7"), "a").expect_err("refused").to_string().contains("a list of spheres"));
}
