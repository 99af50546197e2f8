//! The shaders' text: valid to naga (and tint, where it is installed), and laid out as the host has it.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod gpu_common;

use gpu_common::say_loudly;
use naga::back::pipeline_constants::process_overrides;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use std::collections::HashMap;
use std::mem::offset_of;
use weekender::render_gpu::Overrides;
use weekender::render_gpu::layout::*;
use weekender::render_gpu::shader_source::{EntryPoint, source};

fn parsed(entry_point: EntryPoint) -> naga::Module {
    let text = source(entry_point);
    match naga::front::wgsl::parse_str(&text) {
        Ok(module) => module,
        Err(error) => panic!("{}", error.emit_to_string_with_path(&text, entry_point.name())),
    }
}

/// The general kernel with a list and with each hierarchy: name and value of every override.
fn variants() -> [Vec<(String, f64)>; 3] {
    let general = Overrides::default();
    let variants = [
        general,
        Overrides { hierarchy: true, ..general },
        Overrides { hierarchy: true, cwbvh: true, ..general },
    ];
    variants.map(|v| v.constants().into_iter().map(|(name, c)| (name.to_owned(), c.value())).collect())
}

#[test]
fn every_shader_is_valid() {
    for entry_point in EntryPoint::ALL {
        let module = parsed(entry_point);
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::default());
        let info = match validator.validate(&module) {
            Ok(info) => info,
            Err(error) => {
                panic!("{}", error.emit_to_string_with_path(&source(entry_point), entry_point.name()))
            }
        };
        let entry = Some((naga::ShaderStage::Compute, entry_point.name()));
        for values in variants() {
            let values = values.into_iter().collect();
            // What it returns is validated again.
            process_overrides(&module, &info, entry, &values).unwrap();
        }
    }
}

/// The compiler of another browser. It is no package of any system that is known of, so that it is looked for and its
/// absence is told; with `WEEKENDER_REQUIRE_TINT=1` it is a failure.
#[test]
fn every_shader_is_valid_to_tint() {
    if let Err(error) = std::process::Command::new("tint").arg("--version").output() {
        let is_required = std::env::var("WEEKENDER_REQUIRE_TINT").as_deref() == Ok("1");
        assert!(!is_required, "tint cannot be run: {error}");
        say_loudly("tint is not installed: no shader was shown to it");
        return;
    }
    // What is no shader is refused, so that the others are read at all.
    assert!(!told_by_tint("fn broken( {", &[]).status.success());
    for entry_point in EntryPoint::ALL {
        for values in variants() {
            let values: Vec<String> = values.iter().map(|(name, value)| format!("{name}={value}")).collect();
            let output = told_by_tint(&source(entry_point), &values);
            let told = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{}: {told}", entry_point.name());
        }
    }
}

/// What tint says of a shader with values of overrides.
fn told_by_tint(text: &str, overrides: &[String]) -> std::process::Output {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("shader.wgsl");
    std::fs::write(&file, text).unwrap();
    let mut tint = std::process::Command::new("tint");
    tint.args(["--format", "wgsl", "--overrides", &overrides.join(",")]).arg(&file).output().unwrap()
}

fn offsets(module: &naga::Module, name: &str) -> (HashMap<String, u32>, u32) {
    for (_, ty) in module.types.iter() {
        if let naga::TypeInner::Struct { members, span } = &ty.inner
            && ty.name.as_deref() == Some(name)
        {
            let offset = |m: &naga::StructMember| (m.name.clone().unwrap_or_default(), m.offset);
            return (members.iter().map(offset).collect(), *span);
        }
    }
    panic!("no struct {name} in the shaders");
}

macro_rules! same_layout {
    ($module:expr, $rust:ident, $wgsl:literal, $($field:ident),+) => {
        let (members, span) = offsets(&$module, $wgsl);
        assert_eq!(span as usize, size_of::<$rust>(), "size of {}", $wgsl);
        let mut count = 0;
        $(
            count += 1;
            let offset = members.get(stringify!($field)).copied();
            assert_eq!(offset, Some(offset_of!($rust, $field) as u32), "{}.{}", $wgsl, stringify!($field));
        )+
        assert_eq!(members.len(), count, "{} has members that are not compared", $wgsl);
    };
}

#[test]
fn layouts_agree() {
    let module = parsed(EntryPoint::PathTrace);
    same_layout!(module, GpuCamera, "Camera", eye, tau, u, focus_tau, v, scale_x, w, scale_y, offset, size);
    same_layout!(module, GpuAnchoredSphere, "AnchoredSphere", anchor, curvature, inward, flags);
    same_layout!(
        module,
        GpuJob,
        "Job",
        camera,
        sky_middle,
        extent,
        sky_slope,
        max_depth,
        seed,
        opaque_count,
        two_root_count,
        anchored_count,
        width,
        height,
        tile_width,
        node_count,
        few_spheres,
        few_anchored
    );
    same_layout!(
        module,
        GpuDispatch,
        "Dispatch",
        first_tile,
        tile_count,
        block_count,
        turn_limit,
        first_row,
        row_count,
        sample_count,
        transfer,
        resumes,
        first_aside
    );
    same_layout!(module, GpuBlock, "Block", half, counter, step, count);
    same_layout!(
        module,
        GpuRow,
        "Row",
        reference,
        curvature,
        albedo,
        weight,
        radius,
        index,
        inverse_index,
        normal_share,
        inward,
        is_anchored
    );
    same_layout!(module, GpuNode, "Node", low, first, high, count);
    same_layout!(module, GpuCwbvhNode, "CwbvhNode", low, units, first_child, first_sphere, marks, x, y, z);
    same_layout!(module, GpuPixelSum, "PixelSum", red, green, blue);
    let (members, span) = offsets(&module, "Counters");
    assert_eq!((span as usize, members.len()), (size_of::<GpuCounters>(), 8));
    let own = [
        ("rays", offset_of!(GpuCounters, rays)),
        ("rays_high", offset_of!(GpuCounters, rays_high)),
        ("rejected", offset_of!(GpuCounters, rejected)),
        ("rejected_high", offset_of!(GpuCounters, rejected_high)),
        ("finished", offset_of!(GpuCounters, dispatch.finished)),
        ("finished_high", offset_of!(GpuCounters, dispatch.finished_high)),
        ("unfinished", offset_of!(GpuCounters, dispatch.unfinished)),
        ("stuck", offset_of!(GpuCounters, dispatch.stuck)),
    ];
    for (name, offset) in own {
        assert_eq!(members.get(name).copied(), Some(offset as u32), "Counters.{name}");
    }
}
