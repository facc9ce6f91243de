//! The page from its parts.

use std::io::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use glam::Vec3Swizzles as _;
use secateur_model::{AlphaMode, Material};
use serde::Serialize;

use super::continuous::{self, PackedOrder};
use super::geometry::{self, Packed as PackedSurface};
use super::textures::{Entry, Pictures, Textures};
use super::{Facts, Preview, PreviewError};

/// What stands between marks is put in once, from left to right, so that nothing
/// that is put in is ever taken for a mark.
const TEMPLATE: &str = include_str!("page/page.html");

/// In the order in which they build on each other.
const SCRIPTS: [&str; 8] = [
    include_str!("page/matrices.js"),
    include_str!("page/unpack.js"),
    include_str!("page/continuous.js"),
    include_str!("page/wind.js"),
    include_str!("page/renderer.js"),
    include_str!("page/orbit.js"),
    include_str!("page/levels.js"),
    include_str!("page/page.js"),
];

/// All that the script is told.
#[derive(Serialize)]
struct Scene<'a> {
    title: &'a str,
    screen: [f64; 2],
    /// Corners of the box about the original.
    low: [f64; 3],
    high: [f64; 3],
    /// How far the original reaches from the box's upright axis.
    reach: f64,
    textures: Vec<Entry>,
    materials: Vec<Look>,
    levels: Vec<PackedLevel<'a>>,
    continuous: Option<PackedOrder>,
}

#[derive(Serialize)]
struct PackedLevel<'a> {
    facts: &'a Facts,
    surfaces: Vec<PackedSurface>,
}

#[derive(Debug, PartialEq, Serialize)]
pub(crate) struct Look {
    color: [f32; 4],
    texture: Option<usize>,
    alpha: &'static str,
    cutoff: f32,
    is_double_sided: bool,
    roughness: f32,
    is_unlit: bool,
    normal_map: Option<usize>,
    normal_scale: f32,
}

/// What a page draws, for `page/renderer.js`.
#[derive(Clone, Debug)]
pub struct Packed {
    /// What there is to draw and where it lies in the bytes, as JSON.
    pub scene: String,
    /// The vertices and triangles of all parts, at the places in bytes that `scene` gives.
    pub geometry: Vec<u8>,
    /// Textures, one after another.
    pub pictures: Vec<u8>,
}

/// The page, as HTML.
///
/// # Errors
/// As [`packed`].
pub fn page(preview: &Preview<'_>) -> Result<String, PreviewError> {
    let packed = packed(preview, Pictures::Png)?;
    Ok(filled(TEMPLATE, |mark| match mark {
        "title" => escaped(preview.title),
        "style" => include_str!("page/page.css").to_owned(),
        "vertex shader" => vertex_shader(),
        "fragment shader" => include_str!("page/tree.frag").to_owned(),
        // Within a script element only this sign could end it.
        "scene" => packed.scene.replace('<', "\\u003c"),
        "geometry" => STANDARD.encode(deflated(&packed.geometry)),
        "pictures" => STANDARD.encode(&packed.pictures),
        "script" => SCRIPTS.concat(),
        _ => unreachable!("the template has no other mark than these: {mark}"),
    }))
}

/// What a page draws.
///
/// Attributes of a surface that are not one per position are left out.
///
/// # Errors
/// [`PreviewError`] if there is no triangle at all in the original, or a texture
/// cannot be packed.
pub fn packed(preview: &Preview<'_>, pictures: Pictures) -> Result<Packed, PreviewError> {
    let original = preview.levels.first().ok_or(PreviewError::NothingToShow)?;
    if original
        .surfaces
        .iter()
        .all(|(s, _)| s.triangles.is_empty())
    {
        return Err(PreviewError::NothingToShow);
    }
    let mut textures = Textures::of(pictures);
    let mut materials = Vec::new();
    let mut bytes = Vec::new();
    let mut levels = Vec::new();
    for level in preview.levels {
        let mut surfaces = Vec::new();
        for (k, (surface, is_foliage)) in level.surfaces.iter().enumerate() {
            let material = material(&surface.material, &mut materials, &mut textures)?;
            let ends = level.ends.and_then(|ends| ends.get(k)).map(Vec::as_slice);
            let place = (*is_foliage, material);
            surfaces.push(geometry::pack(surface, ends, place, &mut bytes));
        }
        levels.push(PackedLevel {
            facts: &level.facts,
            surfaces,
        });
    }
    let continuous = match &preview.continuous {
        Some(shown) => continuous::pack(shown, &mut materials, &mut textures, &mut bytes)?,
        None => None,
    };
    let drawn = || original.surfaces.iter().flat_map(|(s, _)| &s.positions);
    let (low, high) = geometry::bounds(drawn());
    let middle = (low + high) / 2.0;
    let reach = drawn().map(|p| (*p - middle).xz().length());
    let scene = Scene {
        title: preview.title,
        screen: [
            preview.screen.height_px,
            preview.screen.field_of_view_degrees,
        ],
        low: low.to_array(),
        high: high.to_array(),
        reach: reach.fold(0.0, f64::max),
        textures: textures.entries(),
        materials,
        levels,
        continuous,
    };
    let scene = serde_json::to_string(&scene).expect("numbers and texts make JSON");
    Ok(Packed {
        scene,
        geometry: bytes,
        pictures: textures.bytes,
    })
}

/// The number of a material among those of the page.
pub(super) fn material(
    material: &Material,
    materials: &mut Vec<Look>,
    textures: &mut Textures,
) -> Result<usize, PreviewError> {
    let look = look(material, textures)?;
    let known = materials.iter().position(|other| *other == look);
    Ok(known.unwrap_or_else(|| {
        materials.push(look);
        materials.len() - 1
    }))
}

pub(crate) fn look(material: &Material, textures: &mut Textures) -> Result<Look, PreviewError> {
    let finish = &material.finish;
    let texture = material.texture.as_ref();
    let normals = finish.normal_map.as_ref();
    let (alpha, cutoff) = match material.alpha_mode {
        AlphaMode::Opaque => ("opaque", 0.0),
        AlphaMode::Mask(cutoff) => ("mask", cutoff),
        AlphaMode::Blend => ("blend", 0.0),
    };
    Ok(Look {
        color: material.base_color,
        texture: texture.map(|t| textures.number(t, true)).transpose()?,
        alpha,
        cutoff,
        is_double_sided: material.double_sided,
        roughness: finish.roughness,
        is_unlit: finish.is_unlit,
        normal_map: normals
            .map(|n| textures.number(&n.texture, false))
            .transpose()?,
        normal_scale: normals.map_or(1.0, |n| n.scale),
    })
}

/// A template whose marks are taken for their parts.
pub(crate) fn filled(template: &str, part: impl Fn(&str) -> String) -> String {
    let mut html = String::new();
    for (k, piece) in template.split("%%").enumerate() {
        match k % 2 {
            0 => html.push_str(piece),
            _ => html.push_str(&part(piece)),
        }
    }
    html
}

/// The vertex shader, which sways and morphs by the functions that are handed out for that.
pub(crate) fn vertex_shader() -> String {
    filled(include_str!("page/tree.vert"), |mark| match mark {
        "morph" => secateur_shaders::MORPH_GLSL.to_owned(),
        "wind" => secateur_shaders::WIND_GLSL.to_owned(),
        _ => unreachable!("the shader has no other mark than these: {mark}"),
    })
}

/// In zlib's format, which browsers call `deflate`.
fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder
        .write_all(bytes)
        .and_then(|()| encoder.finish())
        .expect("a vector takes all that is written")
}

pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DVec3;
    use secateur_model::{Finish, Surface};

    use super::super::Level;
    use super::*;
    use secateur_levels::chain::LevelReport;
    use secateur_runtime::Screen;

    fn triangle() -> (Surface, bool) {
        let surface = Surface {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            normals: Vec::new(),
            uvs: Vec::new(),
            colors: Vec::new(),
            holds: Vec::new(),
            triangles: vec![[0, 1, 2]],
            material: Arc::new(Material {
                name: String::new(),
                base_color: [1.0; 4],
                texture: None,
                alpha_mode: AlphaMode::Mask(0.25),
                double_sided: true,
                finish: Finish::default(),
            }),
        };
        (surface, true)
    }

    fn facts(name: &str) -> Facts {
        let report = LevelReport {
            leaves: 1,
            triangles: 1,
            foliage_triangles: 1,
            ..LevelReport::default()
        };
        Facts {
            name: name.into(),
            report,
        }
    }

    fn page_of(title: &str, levels: &[Level<'_>]) -> Result<String, PreviewError> {
        page(&Preview {
            title,
            screen: Screen::default(),
            levels,
            continuous: None,
        })
    }

    #[test]
    fn names_cannot_break_out_of_the_page() {
        let surfaces = [triangle()];
        let levels = [Level {
            surfaces: &surfaces,
            ends: None,
            facts: facts("</script><b>%%script%%"),
        }];
        let html = page_of("<oak> & %%scene%%", &levels).unwrap();
        assert!(html.contains("<title>&lt;oak&gt; &amp; %%scene%%"));
        assert!(!html.contains("</script><b>"));
        assert!(html.contains("\\u003c/script>\\u003cb>") || html.contains("\\u003cb>"));
        assert!(html.trim_end().ends_with("</html>"));
    }

    #[test]
    fn the_page_names_no_address() {
        let surfaces = [triangle()];
        let levels = [0, 1].map(|k| Level {
            surfaces: &surfaces,
            ends: None,
            facts: facts(&format!("LOD{k}")),
        });
        let html = page_of("oak", &levels).unwrap();
        assert!(!html.contains("http:") && !html.contains("https:"));
        assert!(html.contains("default-src 'none'"));
        // One material, though two levels use it.
        assert_eq!(html.matches("\"cutoff\":0.25").count(), 1);
    }

    #[test]
    fn nothing_to_show_is_said() {
        let mut surfaces = [triangle()];
        surfaces[0].0.triangles.clear();
        let levels = [Level {
            surfaces: &surfaces,
            ends: None,
            facts: facts("LOD0"),
        }];
        assert_eq!(page_of("oak", &levels), Err(PreviewError::NothingToShow));
        let error = page_of("oak", &[]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "a preview needs a tree with at least one triangle"
        );
    }
}
