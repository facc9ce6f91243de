//! Every shader on every backend, without a GPU.

use std::mem::offset_of;

use naga::back::{PipelineConstants, hlsl, msl, pipeline_constants, spv, wgsl};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use secateur_model::Wrap;
use secateur_raster::SnappedTriangle;
use secateur_shaders::ALL;

fn parse(name: &str, text: &str) -> naga::Module {
    naga::front::wgsl::parse_str(text)
        .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(text)))
}

fn validate(name: &str, module: &naga::Module) -> ModuleInfo {
    // No capability: neither 64-bit integers nor anything else that some
    // device lacks.
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(module)
        .unwrap_or_else(|e| panic!("{name}: {e:?}"))
}

fn shader(name: &str) -> naga::Module {
    let found = ALL.iter().find(|(file, _)| *file == name);
    let (_, text) = found.unwrap_or_else(|| panic!("{name} exists"));
    parse(name, text)
}

#[test]
fn shaders_are_valid_and_translate_to_every_backend() {
    for &(name, text) in ALL {
        let module = parse(name, text);
        let info = validate(name, &module);
        wgsl::write_string(&module, &info, wgsl::WriterFlags::empty())
            .unwrap_or_else(|e| panic!("{name} to WGSL: {e}"));
        // Any value that makes a workgroup.
        let mut constants = PipelineConstants::default();
        for (_, constant) in module.overrides.iter() {
            constants.insert(constant.name.clone().expect("a name"), 64.0);
        }
        let (module, info) =
            pipeline_constants::process_overrides(&module, &info, None, &constants)
                .unwrap_or_else(|e| panic!("{name}: {e}"));
        spv::write_vec(&module, &info, &spv::Options::default(), None)
            .unwrap_or_else(|e| panic!("{name} to SPIR-V: {e}"));
        let metal = msl::Options {
            lang_version: (2, 4),
            ..Default::default()
        };
        msl::write_string(&module, &info, &metal, &msl::PipelineOptions::default())
            .unwrap_or_else(|e| panic!("{name} to MSL: {e}"));
        let mut text = String::new();
        hlsl::Writer::new(
            &mut text,
            &hlsl::Options::default(),
            &hlsl::PipelineOptions::default(),
        )
        .write(&module, &info, None)
        .unwrap_or_else(|e| panic!("{name} to HLSL: {e}"));
        assert!(!text.is_empty());
    }
}

#[test]
fn shaders_compute_with_integers_only() {
    // These move vertices on their way to the screen: nothing is compared with their last sums bit
    // for bit, and their twins in `secateur-runtime` say how far they may differ.
    let moves = ["morph.wgsl", "wind.wgsl"];
    let exact = ALL.iter().filter(|(name, _)| !moves.contains(name));
    for &(name, text) in exact {
        let has_float = parse(name, text)
            .types
            .iter()
            .any(|(_, ty)| ty.inner.scalar_kind() == Some(naga::ScalarKind::Float));
        assert!(!has_float, "{name} uses floats, which drivers may fuse");
    }
}

/// Names and offsets of a struct's members, and its size.
fn layout(module: &naga::Module, name: &str) -> (Vec<(String, usize)>, usize) {
    let is_it = |ty: &&naga::Type| ty.name.as_deref() == Some(name);
    let ty = module.types.iter().map(|(_, ty)| ty).find(is_it);
    let naga::TypeInner::Struct { members, span } = &ty.expect("the struct").inner else {
        panic!("{name} is a struct");
    };
    let member = |m: &naga::StructMember| (m.name.clone().unwrap(), m.offset as usize);
    (members.iter().map(member).collect(), *span as usize)
}

#[test]
fn triangles_lie_as_rust_writes_them() {
    let module = shader("rasterise.wgsl");
    let (members, size) = layout(&module, "Triangle");
    let expected = [
        ("leaf", offset_of!(SnappedTriangle, leaf)),
        ("cutout", offset_of!(SnappedTriangle, cutout)),
        ("first_pixel", offset_of!(SnappedTriangle, first_pixel)),
        ("size", offset_of!(SnappedTriangle, size)),
        ("edges", offset_of!(SnappedTriangle, edges)),
        ("depth", offset_of!(SnappedTriangle, depth)),
        ("u", offset_of!(SnappedTriangle, u)),
        ("v", offset_of!(SnappedTriangle, v)),
    ]
    .map(|(name, offset)| (name.to_owned(), offset));
    assert_eq!(members, expected);
    assert_eq!(size, size_of::<SnappedTriangle>());
    // Two words of header come before a piece's triangles.
    let (piece, _) = layout(&module, "Piece");
    assert_eq!(piece[2], ("triangles".to_owned(), 8));
}

/// A constant of a shader.
fn constant(module: &naga::Module, name: &str) -> i64 {
    let constants = &mut module.constants.iter().map(|(_, c)| c);
    let constant = constants.find(|c| c.name.as_deref() == Some(name));
    let init = constant.unwrap_or_else(|| panic!("{name} exists")).init;
    match module.global_expressions[init] {
        naga::Expression::Literal(naga::Literal::I32(value)) => value.into(),
        naga::Expression::Literal(naga::Literal::U32(value)) => value.into(),
        ref other => panic!("{name} is {other:?}"),
    }
}

#[test]
fn copied_constants_agree() {
    let rasterise = shader("rasterise.wgsl");
    assert_eq!(constant(&rasterise, "REPEAT"), Wrap::Repeat as i64);
    assert_eq!(
        constant(&rasterise, "CLAMP_TO_EDGE"),
        Wrap::ClampToEdge as i64
    );
    let dropped = |file| constant(&shader(file), "DROPPED");
    assert_eq!(dropped("fragments_sort.wgsl"), i64::from(u32::MAX));
    assert_eq!(dropped("fragments_sort_long.wgsl"), i64::from(u32::MAX));
    // All stages that read a window read the same one.
    let window = layout(&rasterise, "Window");
    assert_eq!(window.1, 16);
    for file in [
        "fragments_scan.wgsl",
        "fragments_sort.wgsl",
        "leaf_ids.wgsl",
    ] {
        assert_eq!(layout(&shader(file), "Window"), window, "{file}");
    }
}
