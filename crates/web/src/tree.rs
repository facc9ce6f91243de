//! An opened file: what it holds, what of it are leaves, and what is made of it.

use std::cell::OnceCell;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;

use js_sys::Function;
use secateur::chain::Screen;
use secateur::glam::DVec2;
use secateur::{
    Detail, Document, Inspection, LeafId, Memory, Opening, Piece, Plant, Progress, ScenePieces,
    Selector, TakenFor,
};
use secateur_pages::preview::{Facts, Level, Packed, Pictures, Preview, packed};
use serde_json::json;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

use crate::chosen::{JsChosen, over_the_plant};
use crate::lasso::{Camera, Key, held};
use crate::levels::{JsLevel, JsLevels};
use crate::picture::JsPicture;
use crate::settings::{ChainSettings, LevelSettings};

/// What a plant and its levels may take of a tab, in bytes: pages have 4 GiB at most, and share them.
const MEMORY: Memory = Memory::Bytes(3 << 29);

/// What helps where a file is too large for that.
const TOO_LARGE: &str = "the program `secateur` opens it";

/// An opened file.
#[wasm_bindgen(js_name = Tree)]
pub struct JsTree {
    document: Document,
    selectors: Vec<Selector>,
    inspection: Inspection,
    plant: Result<Plant, String>,
    /// What the scene draws, piece by piece, once it was asked for.
    pieces: OnceCell<ScenePieces>,
}

#[wasm_bindgen(js_class = Tree)]
impl JsTree {
    /// Opens a GLB, or a .glTF that holds all its data; `leaves` names its leaves as a JSON list of selectors such as
    /// `["material:leaf"]`, which is empty where the evidence is to decide; `not_plant` likewise what is not the plant. With
    /// `wind` the plant and its levels get what they hang on, as by `--wind`.
    ///
    /// # Errors
    /// A sentence where the file can't be read. That no leaves are found is no error: [`problem`](Self::problem).
    #[wasm_bindgen(constructor)]
    pub fn new(
        name: &str,
        bytes: Vec<u8>,
        leaves: &str,
        not_plant: Option<String>,
        wind: Option<bool>,
    ) -> Result<JsTree, String> {
        let selectors = selectors_of(leaves)?;
        let not_plant = selectors_of(not_plant.as_deref().unwrap_or("[]"))?;
        let opened = Document::from_bytes_within(name, bytes.clone(), None, MEMORY);
        let document = opened.map_err(|error| for_a_tab(&error.to_string()))?;
        let document = document.with_not_plant(&not_plant);
        let document = document.map_err(|error| for_a_tab(&error.to_string()))?;
        let inspection = document.inspect(&selectors);
        let opening = Opening {
            foliage: selectors.clone(),
            not_plant,
            memory: MEMORY,
            wind: wind.unwrap_or(false),
            ..Opening::default()
        };
        let plant = Plant::from_bytes(name, bytes, &opening);
        Ok(Self {
            document,
            selectors,
            inspection,
            plant: plant.map_err(|error| for_a_tab(&error.to_string())),
            pieces: OnceCell::new(),
        })
    }

    /// What is in the file and what was taken for leaves, as the JSON of `secateur inspect`.
    pub fn inspection(&self) -> String {
        json!(self.inspection).to_string()
    }

    /// Why no levels can be made of it, in a sentence.
    pub fn problem(&self) -> Option<String> {
        self.plant.as_ref().err().cloned()
    }

    /// What is drawn of it: its first level the plant, its second what is not the plant, if anything. `parts` of the
    /// scene says by surface of both which primitive of the inspection it is, and whether it is leaves.
    ///
    /// # Errors
    /// A sentence where there is too much of it to draw, or nothing.
    pub fn picture(&self) -> Result<JsPicture, String> {
        let said = |error: secateur::GltfError| error.to_string();
        let mut plant = self
            .document
            .drawn(Detail::Full, &self.selectors)
            .map_err(said)?;
        let is_other = |place: &str| {
            let mut primitives = self.inspection.primitives.iter();
            primitives.any(|p| p.place == place && p.taken_for == TakenFor::NotPlant)
        };
        plant.retain(|drawn| !is_other(&drawn.place));
        let has_others = (self.inspection.primitives.iter())
            .any(|primitive| primitive.taken_for == TakenFor::NotPlant);
        let mut others = Vec::new();
        if has_others {
            others = self.document.drawn_scene(Detail::Full).map_err(said)?;
            others.retain(|drawn| is_other(&drawn.place));
        }
        let parts: Vec<_> = (plant.iter().chain(&others))
            .map(|drawn| json!({ "place": drawn.place, "isLeaf": drawn.is_foliage }))
            .collect();
        let [plant, others] = [plant, others].map(|all| {
            let surfaces = all.into_iter();
            surfaces
                .map(|drawn| (drawn.surface, drawn.is_foliage))
                .collect::<Vec<_>>()
        });
        let facts = |name: &str| Facts {
            name: name.to_owned(),
            report: self.plant.as_ref().map(Plant::report).unwrap_or_default(),
        };
        let mut levels = vec![Level {
            surfaces: &plant,
            ends: None,
            facts: facts("original"),
        }];
        if !others.is_empty() {
            levels.push(Level {
                surfaces: &others,
                ends: None,
                facts: facts("not the plant"),
            });
        }
        let mut made = pack(self.document.name(), &levels)?;
        made.scene.pop();
        made.scene += &format!(r#","parts":{}}}"#, json!(parts));
        Ok(JsPicture(made))
    }

    /// Of primitives that have leaves and wood, by their places: the first and the last of each run of pieces that are
    /// leaves, as JSON.
    #[wasm_bindgen(js_name = leafPieces)]
    pub fn leaf_pieces(&self) -> String {
        let plant = self.plant.as_ref();
        json!(
            plant
                .map(|plant| plant.tree().leaf_pieces())
                .unwrap_or_default()
        )
        .to_string()
    }

    /// Of primitives whose pieces were named as not the plant, by their places: of which primitive of the file they
    /// are, and their numbers in it as runs, as JSON.
    #[wasm_bindgen(js_name = otherPieces)]
    pub fn other_pieces(&self) -> String {
        let others = self.document.other_pieces().into_iter();
        let others = others.map(|(place, others)| {
            let of = json!({ "source": others.source, "runs": others.runs });
            (place, of)
        });
        json!(others.collect::<BTreeMap<_, _>>()).to_string()
    }

    /// The connected pieces of the primitive at a place of the inspection, most triangles first: each its number in the
    /// file and its triangles, as JSON.
    ///
    /// # Errors
    /// A sentence where the scene can't be read.
    pub fn pieces(&self, place: &str) -> Result<String, String> {
        let all = self.scene_pieces()?;
        let mut pieces: BTreeMap<u32, usize> = BTreeMap::new();
        for leaf in (0..all.foliage().leaves().len()).map(LeafId::from_index) {
            let (of, number) = all.source(leaf);
            if of == place {
                pieces.insert(number, all.foliage().triangles_of(leaf).len());
            }
        }
        let mut pieces: Vec<(u32, usize)> = pieces.into_iter().collect();
        pieces.sort_by_key(|&(number, triangles)| (usize::MAX - triangles, number));
        Ok(json!(pieces).to_string())
    }

    /// What a loop drawn over the picture holds: pieces, or whole parts, of which most visible pixels lie in it; nothing
    /// where there are none. `camera` is ten numbers: eye and target in world space, the tangent of half the field of
    /// view up, width over height, the nearest distance in metres, and the height in pixels. `corners` are x and y by
    /// turns, from -1, -1 at the lower left of the picture to 1, 1 at its upper right.
    ///
    /// # Errors
    /// A sentence where the scene can't be read, or the numbers are no camera.
    pub fn lasso(
        &self,
        camera: &[f64],
        corners: &[f64],
        of_parts: bool,
    ) -> Result<Option<JsChosen>, String> {
        let pieces = self.scene_pieces()?;
        let corners = corners.as_chunks().0.iter();
        let corners: Vec<DVec2> = corners.map(|corner| DVec2::from_array(*corner)).collect();
        let keys = held(pieces, &Camera::of(camera)?, &corners, of_parts)?;
        JsChosen::of(self.document.name(), pieces, &keys)
    }

    /// Some pieces of the primitive at a place, by their numbers.
    ///
    /// # Errors
    /// A sentence where the scene can't be read.
    #[wasm_bindgen(js_name = piecesAt)]
    pub fn pieces_at(&self, place: &str, numbers: &[u32]) -> Result<Option<JsChosen>, String> {
        let pieces = self.scene_pieces()?;
        let keys = numbers.iter().map(|number| (place, Some(*number)));
        let keys: BTreeSet<Key<'_>> = keys.collect();
        JsChosen::of(self.document.name(), pieces, &keys)
    }

    /// The connected piece of the primitive at a place of the inspection that a ray meets first, both as x, y and z in
    /// world space; nothing where it meets none.
    ///
    /// # Errors
    /// A sentence where the primitive can't be read, or the numbers are no ray.
    #[wasm_bindgen(js_name = pieceAt)]
    pub fn piece_at(
        &self,
        place: &str,
        from: &[f64],
        along: &[f64],
    ) -> Result<Option<JsPiece>, String> {
        let Ok(plant) = &self.plant else {
            return Ok(None);
        };
        let vector = |numbers: &[f64]| -> Result<[f64; 3], String> {
            numbers
                .try_into()
                .map_err(|_| format!("{numbers:?} is not x, y and z"))
        };
        let found = plant.tree().piece_at(place, vector(from)?, vector(along)?);
        let piece = found.map_err(|error| error.to_string())?;
        piece
            .map(|piece| JsPiece::of(self.document.name(), piece))
            .transpose()
    }

    /// Makes one level: `settings` as [`LevelSettings`] has them; `progress` is called with a stage and a share of it.
    ///
    /// # Errors
    /// A sentence where the plant can't be simplified as asked.
    pub fn level(&self, settings: &str, progress: &Function) -> Result<JsLevel, String> {
        let options = LevelSettings::parse(settings)?.options();
        let plant = self.plant.as_ref().map_err(Clone::clone)?;
        let level = plant.level_watched(&options, &mut |now| tell(progress, now));
        level
            .map(JsLevel)
            .map_err(|error| for_a_tab(&error.to_string()))
    }

    /// Makes a chain of levels: `settings` as [`ChainSettings`] has them.
    ///
    /// # Errors
    /// As [`level`](Self::level).
    pub fn levels(&self, settings: &str, progress: &Function) -> Result<JsLevels, String> {
        let options = ChainSettings::parse(settings)?.options();
        let plant = self.plant.as_ref().map_err(Clone::clone)?;
        let levels = plant.levels_watched(&options, &mut |now| tell(progress, now));
        levels
            .map(JsLevels::of)
            .map_err(|error| for_a_tab(&error.to_string()))
    }
}

impl JsTree {
    fn scene_pieces(&self) -> Result<&ScenePieces, String> {
        if let Some(pieces) = self.pieces.get() {
            return Ok(pieces);
        }
        let pieces = self.document.scene_pieces();
        let pieces = pieces.map_err(|error| for_a_tab(&error.to_string()))?;
        Ok(self.pieces.get_or_init(|| pieces))
    }
}

/// A connected piece of a primitive.
#[wasm_bindgen(js_name = Piece)]
#[derive(Debug)]
pub struct JsPiece {
    number: u32,
    triangles: u32,
    packed: Packed,
}

#[wasm_bindgen(js_class = Piece)]
impl JsPiece {
    /// Its number in the primitive, as the selector `piece:MESH.PRIMITIVE.NUMBER` has it.
    pub fn number(&self) -> u32 {
        self.number
    }

    /// How many triangles it has.
    pub fn triangles(&self) -> u32 {
        self.triangles
    }

    /// What is drawn of it where it was met.
    pub fn picture(&self) -> JsPicture {
        JsPicture(self.packed.clone())
    }
}

impl JsPiece {
    fn of(title: &str, piece: Piece) -> Result<Self, String> {
        Ok(Self {
            number: piece.number,
            triangles: piece.triangles.len() as u32,
            packed: over_the_plant(title, &piece.triangles)?,
        })
    }
}

/// Selectors as a JSON list of their texts.
fn selectors_of(json: &str) -> Result<Vec<Selector>, String> {
    let named: Vec<String> =
        serde_json::from_str(json).map_err(|e| format!("the selectors are wrong: {e}"))?;
    let parsed: Result<Vec<Selector>, _> = named.iter().map(|text| text.parse()).collect();
    parsed.map_err(|error| error.to_string())
}

/// What is drawn of levels.
pub(crate) fn pack(title: &str, levels: &[Level<'_>]) -> Result<Packed, String> {
    let preview = Preview {
        title,
        screen: Screen::default(),
        levels,
        continuous: None,
    };
    packed(&preview, Pictures::Texels).map_err(|error| error.to_string())
}

/// A sentence of the library, with what helps a page where there is too little memory.
fn for_a_tab(sentence: &str) -> String {
    match sentence.contains("of memory, and of what is allowed") {
        true => format!("{sentence}; in a page there is no more, and {TOO_LARGE}"),
        false => sentence.to_owned(),
    }
}

/// Tells a page where a run stands.
fn tell(progress: &Function, now: Progress) -> ControlFlow<()> {
    let (stage, share) = match now {
        Progress::Stage(stage) => (stage.name(), None),
        Progress::Step { done, at_most } => ("step", Some(done as f64 / at_most.max(1) as f64)),
        Progress::Level { done, of } => ("level", Some(done as f64 / of.max(1) as f64)),
        Progress::Impostor => ("impostor", None),
        Progress::Finish => ("finish", None),
        // Stages that come to be later are told as what they are part of.
        _ => return ControlFlow::Continue(()),
    };
    let share = share.map_or(JsValue::NULL, JsValue::from_f64);
    // What a page does with it is its own.
    let _ = progress.call2(&JsValue::NULL, &JsValue::from_str(stage), &share);
    ControlFlow::Continue(())
}
