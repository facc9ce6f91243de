//! A stand as one glTF scene, and what it costs.

use std::collections::HashMap;

use secateur_gltf::{Document, StandPart, StandWriter};
use secateur_levels::chain::{CostWeights, LevelParts, texture_bytes};
use serde::Serialize;
use serde_json::json;

use super::{KindLevels, Stand};
use crate::Error;

/// What a stand costs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct StandFigures {
    /// Plants that are there.
    pub plants: u64,
    /// Triangles of all plants together.
    pub triangles: u64,
    /// Primitives that are drawn, those of each plant counted.
    pub draws: u64,
    /// Bytes of the file.
    pub bytes: u64,
    /// Bytes of textures, vertices and indices on the GPU; what plants share counts once.
    pub gpu_bytes: u64,
    /// All of these as one figure, by the weights of costs.
    pub cost: f64,
}

/// The stand with these levels, by place; what has none is left out.
pub(super) fn written(
    stand: &Stand,
    kinds: &[KindLevels],
    levels: &[Option<usize>],
    weights: CostWeights,
) -> Result<(StandFigures, Vec<u8>), Error> {
    let mut writer = StandWriter::default();
    let mut parts: HashMap<(usize, usize), StandPart> = HashMap::new();
    let (mut plants, mut triangles, mut draws) = (0, 0, 0);
    for (place, level) in stand.places.iter().zip(levels) {
        let Some(level) = *level else {
            continue;
        };
        let shown = &kinds[place.kind].levels[level];
        let part = match parts.get(&(place.kind, level)) {
            Some(part) => part,
            None => {
                let part = writer.part(&shown.document)?;
                parts.entry((place.kind, level)).or_insert(part)
            }
        };
        let extras = json!({ "plant": stand.kinds[place.kind].name, "level": level });
        writer.place(&place.name, part, place.world_from_own, extras);
        plants += 1;
        triangles += shown.parts.triangles;
        draws += shown.parts.draws;
    }
    let name = "stand.glb";
    let glb = writer.to_glb(name)?;
    let gpu_bytes = gpu_bytes(&Document::from_bytes(name, glb.clone(), None)?);
    let bytes = glb.len() as u64;
    let cost = weights.cost(LevelParts {
        triangles,
        draws,
        bytes,
        gpu_bytes,
    });
    let figures = StandFigures {
        plants,
        triangles,
        draws,
        bytes,
        gpu_bytes,
        cost,
    };
    Ok((figures, glb))
}

fn gpu_bytes(document: &Document) -> u64 {
    let materials = document.json()["materials"].as_array().map_or(0, Vec::len);
    let materials: Vec<Option<usize>> = (0..materials).map(Some).collect();
    document.cost().geometry_bytes + texture_bytes(document, &materials, &[])
}
