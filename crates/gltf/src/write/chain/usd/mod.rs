//! Levels as USD: a layer of text (.usda) with `LODRootAPI`, and textures beside it.
//!
//! What is written is what the levels' own .glb files show: each is read again, and its triangles become
//! meshes about the plant's pivot. Skins and animations stay at rest.

mod look;
mod text;

use std::fmt::Write as _;

use glam::DVec3;
use serde_json::Value;

use super::{ChainFile, ChainFiles, Level};
use crate::Document;
use crate::error::GltfError;
use crate::surfaces::{Detail, DrawnSurface};
use crate::tree::Tree;
use look::Looks;
use secateur_model::Surface;
use text::{facts, identifier, quoted, tuple, tuples, unique, values};

/// Width over height of the screen that sizes are reckoned for: they are shares of its area.
const ASPECT: f64 = 16.0 / 9.0;

/// How much farther off than a switch the next level is alone.
const FADE: f64 = 1.1;

/// Makes USD of levels that are in a file each.
pub(super) fn rewrite(
    tree: &Tree,
    name: &str,
    levels: &[Level],
    chain: &mut ChainFiles,
) -> Result<(), GltfError> {
    let root = identifier(name);
    let mut looks = Looks::new(format!("/{root}/Materials"), name);
    let mut meshes = String::new();
    let mut pivot = None;
    let mut extent = None;
    let mut prims = Vec::new();
    for (number, (level, file)) in levels
        .iter()
        .zip(std::mem::take(&mut chain.files))
        .enumerate()
    {
        let before = meshes.len() as u64 + looks.texture_bytes();
        let Document {
            name,
            base_dir,
            memory,
            ..
        } = &tree.document;
        let document = Document::from_bytes_within(name, file.bytes, base_dir.as_deref(), *memory)?;
        let pivot = *pivot.get_or_insert_with(|| place_of(&document, &level.name));
        let surfaces = document.drawn_scene(Detail::Full)?;
        let prim = unique(&level.name, &mut prims);
        let bounds = push_level(
            &mut meshes,
            &mut looks,
            (level, &prim),
            &document,
            (&surfaces, pivot),
        );
        extent.get_or_insert(bounds);
        chain.costs[number].bytes = meshes.len() as u64 + looks.texture_bytes() - before;
        let is_at_rest = ["animations", "skins"]
            .iter()
            .any(|list| document.root.get(list).is_some());
        if is_at_rest {
            chain.notes.push(
                "the layout usd has the plant at rest, without skins and animations".to_owned(),
            );
        }
    }
    let layer = Layer {
        root: &root,
        name,
        pivot: pivot.unwrap_or_default(),
        extent: extent.unwrap_or([[0.0; 3]; 2]),
        prims: &prims,
    };
    let bytes = layer.text(levels, &meshes, &looks.text).into_bytes();
    chain.files.push(ChainFile {
        name: format!("{name}.usda"),
        bytes,
        is_as_it_came: false,
    });
    chain.files.extend(looks.into_files());
    Ok(())
}

/// Where the node of a level stands, if that is all that its transform does.
fn place_of(document: &Document, level: &str) -> DVec3 {
    let nodes = document.root.get("nodes").and_then(Value::as_array);
    let mut nodes = nodes.into_iter().flatten();
    let node = nodes.find(|node| node.get("name").and_then(Value::as_str) == Some(level));
    let place = node.and_then(|node| node.get("translation")?.as_array());
    let number = |k: usize| {
        place
            .and_then(|place| place.get(k)?.as_f64())
            .unwrap_or(0.0)
    };
    DVec3::new(number(0), number(1), number(2))
}

/// Adds a level; its lowest and highest corner.
fn push_level(
    text: &mut String,
    looks: &mut Looks,
    (level, prim): (&Level, &str),
    document: &Document,
    (surfaces, pivot): (&[DrawnSurface], DVec3),
) -> [[f32; 3]; 2] {
    let _ = write!(
        text,
        "        def Xform \"{prim}\" (\n            customData = {{\n                dictionary secateur = {{\n{}                \
         }}\n            }}\n            displayName = {}\n        )\n        {{\n",
        facts(&level.facts, "                    "),
        quoted(&level.name)
    );
    let mut names = Vec::new();
    let mut bounds = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    for drawn in surfaces {
        let kind = match drawn.surface.material.name.is_empty() {
            true => "mesh",
            false => &drawn.surface.material.name,
        };
        let name = unique(kind, &mut names);
        let material = looks.path_of(document, drawn);
        let own = push_mesh(text, &name, &drawn.surface, pivot, &material);
        for k in 0..3 {
            bounds[0][k] = bounds[0][k].min(own[0][k]);
            bounds[1][k] = bounds[1][k].max(own[1][k]);
        }
    }
    text.push_str("        }\n");
    match surfaces.is_empty() {
        true => [[0.0; 3]; 2],
        false => bounds,
    }
}

fn push_mesh(
    text: &mut String,
    name: &str,
    surface: &Surface,
    pivot: DVec3,
    material: &str,
) -> [[f32; 3]; 2] {
    let local = |position: &DVec3| (*position - pivot).as_vec3();
    let low = surface.positions.iter().map(local).reduce(|a, b| a.min(b));
    let high = surface.positions.iter().map(local).reduce(|a, b| a.max(b));
    let bounds = [low, high].map(|corner| corner.unwrap_or_default().to_array());
    let mut lines = vec![
        format!(
            "float3[] extent = [{}, {}]",
            tuple(bounds[0]),
            tuple(bounds[1])
        ),
        format!(
            "int[] faceVertexCounts = {}",
            values(surface.triangles.iter().map(|_| 3))
        ),
        format!(
            "int[] faceVertexIndices = {}",
            values(surface.triangles.iter().flatten())
        ),
        format!("rel material:binding = <{material}>"),
        format!(
            "point3f[] points = {}",
            tuples(surface.positions.iter().map(|p| local(p).to_array()))
        ),
        "uniform token subdivisionScheme = \"none\"".to_owned(),
    ];
    let mut per_vertex = |declared: &str, list: String| {
        lines.push(format!("{declared} = {list} (\n                    interpolation = \"vertex\"\n                )"));
    };
    if !surface.normals.is_empty() {
        per_vertex(
            "normal3f[] normals",
            tuples(surface.normals.iter().map(|n| n.to_array())),
        );
    }
    if !surface.uvs.is_empty() {
        let st = surface.uvs.iter().map(|uv| [uv.x, 1.0 - uv.y]);
        per_vertex("texCoord2f[] primvars:st", tuples(st));
    }
    if !surface.colors.is_empty() {
        // Where there is no texture, they are the colour: its factor is in them.
        let factor = match surface.material.texture {
            Some(_) => [1.0; 4],
            None => surface.material.base_color,
        };
        let colors = surface
            .colors
            .iter()
            .map(|c| [c.x * factor[0], c.y * factor[1], c.z * factor[2]]);
        per_vertex("color3f[] primvars:displayColor", tuples(colors));
        if surface.colors.iter().any(|c| c.w != 1.0) {
            per_vertex(
                "float[] primvars:displayOpacity",
                values(surface.colors.iter().map(|c| c.w)),
            );
        }
    }
    if surface.material.double_sided {
        lines.push("uniform bool doubleSided = 1".to_owned());
    }
    let _ = write!(
        text,
        "            def Mesh \"{name}\" (\n                prepend apiSchemas = [\"MaterialBindingAPI\"]\n            )\n            {{\n"
    );
    for line in lines {
        let _ = writeln!(text, "                {line}");
    }
    text.push_str("            }\n");
    bounds
}

/// What a layer has beside meshes and materials.
struct Layer<'a> {
    /// Name of the prim that holds all levels.
    root: &'a str,
    name: &'a str,
    pivot: DVec3,
    /// Of the finest level, about the pivot.
    extent: [[f32; 3]; 2],
    /// Prims of the levels.
    prims: &'a [String],
}

impl Layer<'_> {
    fn text(&self, levels: &[Level], meshes: &str, materials: &str) -> String {
        let Self { root, name, .. } = self;
        let [low, high] = self.extent.map(tuple);
        let (thresholds, blends) = self.switches(levels);
        let pivot = self.pivot;
        format!(
            "#usda 1.0\n(\n    defaultPrim = \"{root}\"\n    doc = \"Levels of detail, written by secateur {version}\"\n    \
             metersPerUnit = 1\n    upAxis = \"Y\"\n)\n\n\
             def Xform \"{root}\" (\n    displayName = {title}\n    kind = \"component\"\n    prepend variantSets = \"level\"\n    \
             variants = {{\n        string level = \"auto\"\n    }}\n)\n{{\n    \
             double3 xformOp:translate = ({x}, {y}, {z})\n    uniform token[] xformOpOrder = [\"xformOp:translate\"]\n\n    \
             def Xform \"Levels\" (\n        prepend apiSchemas = [\"LODRootAPI\"]\n    )\n    {{\n        \
             int lod:default:index = 0\n        rel lod:heuristics = </{root}/ScreenSize>\n\n{meshes}    }}\n\n    \
             def LODScreenSizeHeuristic \"ScreenSize\"\n    {{\n        uniform float[] blendThresholds = {blends}\n        \
             float3[] extent = [{low}, {high}]\n        uniform token lod:domain = \"imaging\"\n        \
             uniform token projectionMethod = \"projectedSphere\"\n        uniform float[] thresholds = {thresholds}\n    }}\n\n    \
             def Scope \"Materials\"\n    {{\n{materials}    }}\n\n{variants}}}\n",
            version = env!("CARGO_PKG_VERSION"),
            title = quoted(name),
            x = pivot.x,
            y = pivot.y,
            z = pivot.z,
            variants = self.variants(),
        )
    }

    /// The shares of the screen's area that the sphere about the plant has where a level ends, and where the
    /// next is alone.
    fn switches(&self, levels: &[Level]) -> (String, String) {
        let [low, high] = self.extent;
        let sides: [f64; 3] = std::array::from_fn(|k| f64::from(high[k] - low[k]));
        let largest = sides.into_iter().fold(0.0, f64::max);
        let diagonal = sides.iter().map(|side| side * side).sum::<f64>().sqrt();
        let ratio = if largest > 0.0 {
            diagonal / largest
        } else {
            1.0
        };
        let area = |coverage: f64| {
            let diameter = ratio * coverage;
            std::f64::consts::FRAC_PI_4 * diameter * diameter / ASPECT
        };
        let ends = levels.iter().filter_map(Level::screen_coverage);
        let ends: Vec<f64> = ends.take(levels.len() - 1).collect();
        let at = |fade: f64| values(ends.iter().map(|end| area(end / fade) as f32));
        (at(1.0), at(FADE))
    }

    /// A variant for each level alone, for programs that do not know levels.
    fn variants(&self) -> String {
        let mut text = "    variantSet \"level\" = {\n        \"auto\" {\n        }\n".to_owned();
        for (number, _) in self.prims.iter().enumerate() {
            let _ = write!(
                text,
                "        \"LOD{number}\" {{\n            over \"Levels\"\n            {{\n"
            );
            let others = self.prims.iter().enumerate().filter(|(k, _)| *k != number);
            for (_, other) in others {
                let _ = write!(
                    text,
                    "                over \"{other}\" (\n                    active = false\n                )\n                {{\n                }}\n"
                );
            }
            text.push_str("            }\n        }\n");
        }
        text.push_str("    }\n");
        text
    }
}
