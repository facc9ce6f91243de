//! Options that contradict the preset they stand beside.

use secateur::{
    Alpha, ColorChoice, CutoffChoice, FieldOfView, Fitting, LeafTriangles, Needles, Reference,
    Resolution, Ties, Views,
};

use super::super::args::{MaxCoverage, Simplify};
use super::super::names::{MethodName, text};

/// Why a paper's preset can't be what it says, a sentence; nothing where all agrees. Other presets
/// are where options begin, and may be changed.
pub(crate) fn contradiction(args: &Simplify) -> Option<String> {
    let preset = args.preset;
    if !preset.is_paper() {
        return None;
    }
    let resize = args.resize;
    let is_vds = matches!(args.method, MethodName::Vds | MethodName::VdsReference);
    // The paper itself compares these three.
    let is_papers = args.views.as_ref().is_none_or(|name| {
        matches!(
            Views::by_name(name),
            Some(Views::Dodecahedron | Views::Icosahedron | Views::Variable)
        )
    });
    let others = [
        ("--method", !is_vds),
        ("--views", !is_papers),
        (
            "--field-of-view",
            args.field_of_view
                .is_some_and(|field| field != FieldOfView::Degrees(60.0)),
        ),
        (
            "--resolution",
            args.resolution
                .is_some_and(|r| r != Resolution::Pixels(256)),
        ),
        ("--alpha", args.alpha == Some(Alpha::Mask)),
        ("--reference", args.reference == Some(Reference::Previous)),
        (
            "--resize",
            resize.is_some_and(|resize| resize != preset.vds().resize),
        ),
        ("--neighbours", args.neighbours != 1),
        (
            "--max-coverage",
            matches!(args.max_coverage, Some(MaxCoverage(Some(_)))),
        ),
        ("--ties", args.ties == Ties::Spread),
        (
            "--leaf-triangles",
            args.leaf_triangles
                .is_some_and(|t| t != LeafTriangles::Keep),
        ),
        ("--needles", args.needles == Some(Needles::Widen)),
        (
            "--cutoffs",
            args.cutoffs.is_some_and(|name| name != CutoffChoice::Keep),
        ),
        ("--colors", args.colors == Some(ColorChoice::Dilate)),
        ("--fit", !matches!(args.fit, Fitting::Auto | Fitting::None)),
    ];
    let (option, _) = others.into_iter().find(|(_, is_other)| *is_other)?;
    let name = text(args.preset);
    Some(format!(
        "`{option}` contradicts `--preset {name}`, which is the paper's in all that it chooses: \
         leave one of them out"
    ))
}
