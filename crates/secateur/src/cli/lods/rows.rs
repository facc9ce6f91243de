//! What is said of each level, in files and in records.

use secateur_gltf::chain::{Layout, WrittenChain};
use secateur_scene::chain::{Chain, ChainLevel, Shape};
use serde_json::{Value, json};

use super::super::record;
use super::job::Job;

pub(super) fn layout_name(layout: Layout) -> &'static str {
    match layout {
        Layout::Siblings => "siblings",
        Layout::Msft => "msft",
        _ => "files",
    }
}

/// The record of each level, finest first.
pub(crate) fn rows(job: &Job<'_>, made: &Chain, written: &WrittenChain) -> Vec<Value> {
    let levels = made.levels.iter().enumerate();
    let row = |(k, level): (usize, &ChainLevel)| {
        let place = |k: usize| match job.layout {
            Layout::Files => json!({ "file": written.files[k].display().to_string() }),
            _ => json!({ "node": format!("{}_LOD{k}", job.name) }),
        };
        let mut figures = json!({
            "kind": level.kind(),
            "shadow": place(level.shadow),
            "pop": level.pop,
            "leaves": level.leaves,
            "triangles": level.triangles(),
            "foliage_triangles": level.foliage_triangles,
            "wood_triangles": level.wood_triangles,
            "distance": level.distance,
            "pixels_high": Some(level.pixels_high).filter(|px| px.is_finite()),
            "screen_coverage": level.screen_coverage,
            "difference": level.difference.difference,
            "block_coverage": level.difference.block_coverage,
            "flip_mean": level.flip_mean,
            "silhouette_iou": level.silhouette_iou,
            "vmi_error_percent": level.vmi_error_percent,
            "order_sha256": level.order_sha256,
            "view_count": level.view_count,
            "textures": match level.keeps_textures {
                true => "keep",
                false => "fit",
            },
            "colors": match (&level.shape, level.textures.is_empty()) {
                (Shape::Impostor(_), _) => Value::Null,
                (_, true) => json!("keep"),
                (_, false) => json!("dilate"),
            },
            "texture_bytes": level.texture_bytes,
            "coverage_ratio": level.as_drawn.map(|seen| seen.begin.coverage_over_truth),
            "coverage_as_drawn": level.as_drawn.map(|seen| seen.begin.coverage_over_truth),
            "coverage_as_drawn_at_end": level.as_drawn.map(|seen| seen.end.coverage_over_truth),
            "specks_as_drawn": level.as_drawn.map(|seen| seen.begin.specks_per_view),
            "more_specks_as_drawn": level.as_drawn.map(|seen| seen.more_specks_per_view),
        });
        if let Shape::Impostor(made) = &level.shape {
            let against = json!({
                "mesh_triangles": made.mesh_triangles,
                "mesh_difference": made.mesh_difference,
                "same_cost_triangles": made.same_cost.map(|(triangles, _)| triangles),
                "same_cost_difference": made.same_cost.map(|(_, difference)| difference),
            });
            figures["impostor"] = record::joined(made.impostor.facts(), against);
        }
        record::joined(place(k), figures)
    };
    levels.map(row).collect()
}
