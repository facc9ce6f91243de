//! Pieces, or whole parts, that a person chose together.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use secateur::chain::LevelReport;
use secateur::glam::DVec3;
use secateur::{AlphaMode, Finish, LeafId, Material, ScenePieces, Surface};
use secateur_pages::preview::{Facts, Level, Packed};
use serde_json::{Value, json};
use wasm_bindgen::prelude::wasm_bindgen;

use crate::lasso::Key;
use crate::picture::JsPicture;
use crate::tree::pack;

/// Pieces or parts that are chosen together.
#[wasm_bindgen(js_name = Chosen)]
#[derive(Debug)]
pub struct JsChosen {
    items: Value,
    triangles: u32,
    packed: Packed,
}

#[wasm_bindgen(js_class = Chosen)]
impl JsChosen {
    /// By the places of primitives, the numbers of their pieces that are chosen, rising; null where all of a part is.
    pub fn items(&self) -> String {
        self.items.to_string()
    }

    /// How many triangles they have, drawn twice counted twice.
    pub fn triangles(&self) -> u32 {
        self.triangles
    }

    /// What is drawn of them.
    pub fn picture(&self) -> JsPicture {
        JsPicture(self.packed.clone())
    }
}

impl JsChosen {
    /// None where nothing is chosen, or nothing of it is there.
    pub(crate) fn of(
        title: &str,
        pieces: &ScenePieces,
        keys: &BTreeSet<Key<'_>>,
    ) -> Result<Option<Self>, String> {
        let foliage = pieces.foliage();
        let leaves = (0..foliage.leaves().len()).map(LeafId::from_index);
        let chosen = leaves.filter(|leaf| {
            let (place, number) = pieces.source(*leaf);
            keys.contains(&(place, Some(number))) || keys.contains(&(place, None))
        });
        let triangles = chosen.flat_map(|leaf| foliage.triangles_of(leaf));
        let triangles: Vec<[DVec3; 3]> = triangles.map(|triangle| triangle.corners).collect();
        if triangles.is_empty() {
            return Ok(None);
        }
        let mut items: BTreeMap<&str, Option<Vec<u32>>> = BTreeMap::new();
        for (place, number) in keys {
            let numbers = items
                .entry(place)
                .or_insert_with(|| number.map(|_| Vec::new()));
            if let (Some(numbers), Some(number)) = (numbers, number) {
                numbers.push(*number);
            }
        }
        Ok(Some(Self {
            items: json!(items),
            triangles: triangles.len() as u32,
            packed: over_the_plant(title, &triangles)?,
        }))
    }
}

/// What is drawn of triangles in world space that are shown over the plant.
pub(crate) fn over_the_plant(title: &str, triangles: &[[DVec3; 3]]) -> Result<Packed, String> {
    let mut surface = Surface::empty(Arc::new(Material {
        name: String::new(),
        base_color: [1.0; 4],
        texture: None,
        alpha_mode: AlphaMode::Opaque,
        double_sided: true,
        finish: Finish::default(),
    }));
    surface.positions = triangles.concat();
    let count = triangles.len() as u32;
    surface.triangles = (0..count).map(|t| [0, 1, 2].map(|k| 3 * t + k)).collect();
    let level = Level {
        surfaces: &[(surface, false)],
        ends: None,
        facts: Facts {
            name: "chosen".to_owned(),
            report: LevelReport::default(),
        },
    };
    pack(title, &[level])
}
