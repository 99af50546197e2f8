//! The shaders' text: valid for naga (and for tint, if installed), with the host's memory layout.

use crate::common::gpu::skip;
use naga::back::pipeline_constants::process_overrides;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use weekender::job::render::SamplerKind;
use weekender::kernel::{Features, records};
use weekender::render_gpu::shader_source::{EntryPoint, source};
use weekender::stages::{DielectricLaws, Shading, SurfaceRule};

fn parsed(entry_point: EntryPoint) -> naga::Module {
    let text = source(entry_point);
    match naga::front::wgsl::parse_str(&text) {
        Ok(module) => module,
        Err(error) => panic!("{}", error.emit_to_string_with_path(&text, entry_point.name())),
    }
}

/// The overrides of general kernels with a list and with a hierarchy, and of one with every stage rule.
fn variants() -> [Vec<(String, f64)>; 3] {
    let general = Features::default();
    let variants = [
        general,
        Features { hierarchy: true, ..general },
        Features {
            specks: true,
            steep_glass: true,
            sampler: SamplerKind::Independent,
            antialiasing: false,
            surface: SurfaceRule::Book,
            hemisphere: true,
            reflectance_strips: true,
            shading: Shading::Normals,
            dielectric_laws: DielectricLaws::TotalReflection,
            ..general
        },
    ];
    variants.map(|features| features.overrides())
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
            // Validate the result, too.
            process_overrides(&module, &info, entry, &values).unwrap();
        }
    }
}

/// Direct3D gets its kernels in HLSL. `WEEKENDER_HLSL` names a directory for them, where a compiler can be tried on them.
#[cfg(windows)]
#[test]
fn every_kernel_is_translated_for_direct3d() {
    use naga::back::hlsl::{Options, PipelineOptions, Writer};
    for entry_point in EntryPoint::ALL {
        let module = parsed(entry_point);
        let info = Validator::new(ValidationFlags::all(), Capabilities::default()).validate(&module).unwrap();
        let entry = (naga::ShaderStage::Compute, entry_point.name());
        for (index, values) in variants().into_iter().enumerate() {
            let values = values.into_iter().collect();
            let (module, info) = process_overrides(&module, &info, Some(entry), &values).unwrap();
            let chosen = PipelineOptions { entry_point: Some((entry.0, entry.1.to_owned())) };
            let (mut text, options) = (String::new(), Options::default());
            Writer::new(&mut text, &options, &chosen).write(&module, &info, None).unwrap();
            if let Some(directory) = std::env::var_os("WEEKENDER_HLSL") {
                let name = format!("{}-{index}.hlsl", entry_point.name());
                std::fs::write(std::path::Path::new(&directory).join(name), text).unwrap();
            }
        }
    }
}

/// tint is another browser's compiler. No package system that we know of has it, so its absence is only reported unless
/// `WEEKENDER_REQUIRE_TINT=1`.
#[test]
fn tint_accepts_every_shader() {
    if let Err(error) = std::process::Command::new("tint").arg("--version").output() {
        return skip("TINT", &format!("no shader was shown to tint, which cannot be run: {error}"));
    }
    // An invalid shader fails, so tint really checks the others.
    assert!(!run_tint("fn broken( {", &[]).status.success());
    for entry_point in EntryPoint::ALL {
        for values in variants() {
            let values: Vec<String> = values.iter().map(|(name, value)| format!("{name}={value}")).collect();
            let output = run_tint(&source(entry_point), &values);
            let message = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{}: {message}", entry_point.name());
        }
    }
}

/// tint's output for a shader with overrides.
fn run_tint(text: &str, overrides: &[String]) -> std::process::Output {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("shader.wgsl");
    std::fs::write(&file, text).unwrap();
    let mut tint = std::process::Command::new("tint");
    tint.args(["--format", "wgsl", "--overrides", &overrides.join(",")]).arg(&file).output().unwrap()
}

/// The WGSL name of a type.
fn name_of(module: &naga::Module, ty: naga::Handle<naga::Type>) -> String {
    let scalar = |scalar: naga::Scalar| match (scalar.kind, scalar.width) {
        (naga::ScalarKind::Float, 4) => "f32",
        (naga::ScalarKind::Uint, 4) => "u32",
        other => panic!("{other:?} is not for records"),
    };
    match &module.types[ty].inner {
        naga::TypeInner::Scalar(of) => scalar(*of).to_owned(),
        naga::TypeInner::Atomic(of) => format!("atomic<{}>", scalar(*of)),
        naga::TypeInner::Vector { size, scalar: of } => format!("vec{}{}", *size as u8, &scalar(*of)[..1]),
        naga::TypeInner::Array { base, size: naga::ArraySize::Constant(count), .. } => {
            format!("array<{}, {count}>", name_of(module, *base))
        }
        naga::TypeInner::Struct { .. } => module.types[ty].name.clone().unwrap(),
        other => panic!("{other:?} is not for records"),
    }
}

/// Name, type and offset of each member of a struct, and its stride in an array.
fn layout_of(module: &naga::Module, name: &str) -> (Vec<(String, String, usize)>, usize) {
    let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
    let (_, naga::Type { inner: naga::TypeInner::Struct { members, span }, .. }) = found.unwrap() else {
        panic!("{name} is not a struct")
    };
    let members = members
        .iter()
        .map(|member| (member.name.clone().unwrap(), name_of(module, member.ty), member.offset as usize));
    (members.collect(), *span as usize)
}

/// Shaders read the names, types, offsets and sizes that the host writes.
#[test]
fn layouts_agree() {
    let module = parsed(EntryPoint::PathTrace);
    for (name, size, fields) in records::layouts() {
        let (members, span) = layout_of(&module, &name);
        let fields: Vec<_> = fields.into_iter().map(|f| (f.name.to_owned(), f.wgsl, f.offset)).collect();
        assert_eq!(fields, members, "{name}");
        assert_eq!(size, span, "size of {name}");
    }
}
