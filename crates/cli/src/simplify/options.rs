//! What `secateur simplify` is asked to do, as options of the library.

use std::path::Path;

use secateur::{
    Error, LevelOptions, MeshoptBorders, MeshoptOptions, Method, Options, VdsOptions, Views,
    read_cameras,
};

use super::super::args::{self, MaxCoverage};
use super::super::failure::Failure;
use super::super::names::MethodName;

/// What a run is asked to do.
pub(crate) fn options(args: &args::Simplify) -> Result<Options, Failure> {
    let options = Options::with_preset(args.preset, args.target.target());
    Ok(Options {
        effort: args.effort,
        method: method(args),
        engine: args.engine,
        views: match &args.views {
            Some(name) => views(name)?,
            None => options.views.clone(),
        },
        field_of_view: args.field_of_view.unwrap_or(options.field_of_view),
        resolution: args.resolution.unwrap_or(options.resolution),
        alpha: args.alpha.unwrap_or(options.alpha),
        sides: args.sides.unwrap_or(options.sides),
        leaf_triangles: args.leaf_triangles.unwrap_or(options.leaf_triangles),
        needles: args.needles.unwrap_or(options.needles),
        fit: args.fit,
        audit: args.audit || (options.audit && !args.no_audit),
        ..options
    })
}

fn method(args: &args::Simplify) -> Method {
    match args.method {
        MethodName::Vds => Method::Vds(vds(args)),
        MethodName::VdsReference => Method::VdsReference(vds(args)),
        MethodName::Fsa => Method::Fsa(args.fsa),
        MethodName::Stochastic => Method::Stochastic(args.stochastic),
        MethodName::Meshopt => Method::Meshopt(MeshoptOptions {
            mode: args.meshopt_mode,
            borders: match (args.preserve_area, args.dilate_borders) {
                (true, _) => MeshoptBorders::PreserveArea,
                (false, true) => MeshoptBorders::Dilate,
                (false, false) => MeshoptBorders::Stay,
            },
        }),
        MethodName::Chain => Method::Chain(args.chain),
        MethodName::Merge => Method::Merge(args.merge),
    }
}

fn vds(args: &args::Simplify) -> VdsOptions {
    let preset = args.preset.vds();
    VdsOptions {
        reference: args.reference.unwrap_or(preset.reference),
        resize: args.resize.unwrap_or(preset.resize),
        neighbours: args.neighbours as usize,
        max_coverage: match args.max_coverage {
            Some(MaxCoverage(limit)) => limit,
            None => preset.max_coverage,
        },
        ties: args.ties,
    }
}

/// A set of views by its name, or cameras from a file.
fn views(name: &str) -> Result<Views, Error> {
    if let Some(views) = Views::by_name(name) {
        return Ok(views);
    }
    let path = Path::new(name);
    read_cameras(path).map(Views::Cameras).map_err(|mut error| {
        // A name that was mistyped is no file either.
        if !path.exists() {
            error.reason += "; `--views` takes auto, dodecahedron, turning, icosahedron, 32, 60, 92, 8, \
                             6, vnc or a JSON file";
        }
        Error::Cameras(error)
    })
}

/// A level with the material changes that are asked for.
pub(crate) fn level_options(args: &args::Simplify, simplify: Options) -> LevelOptions {
    LevelOptions {
        simplify,
        cutoffs: args.cutoffs.unwrap_or_default(),
        colors: args.colors.unwrap_or_default(),
        level_of: args.level_of.clone(),
        judged: true,
    }
}
