//! An opened file: what it holds, what of it are leaves, and what is made of it.

use std::ops::ControlFlow;

use js_sys::Function;
use secateur::chain::Screen;
use secateur::{
    Detail, Document, Inspection, Memory, Opening, Plant, Progress, Selector, TakenFor,
};
use secateur_pages::preview::{Facts, Level, Pictures, Preview, packed};
use serde_json::json;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

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
}

#[wasm_bindgen(js_class = Tree)]
impl JsTree {
    /// Opens a GLB, or a .glTF that holds all its data; `leaves` names its leaves as a JSON list of selectors such as
    /// `["material:leaf"]`, which is empty where the evidence is to decide.
    ///
    /// # Errors
    /// A sentence where the file can't be read. That no leaves are found is no error: [`problem`](Self::problem).
    #[wasm_bindgen(constructor)]
    pub fn new(name: &str, bytes: Vec<u8>, leaves: &str) -> Result<JsTree, String> {
        let named: Vec<String> =
            serde_json::from_str(leaves).map_err(|e| format!("the selectors are wrong: {e}"))?;
        let parsed = named.iter().map(|text| text.parse());
        let selectors: Result<Vec<Selector>, _> = parsed.collect();
        let selectors = selectors.map_err(|error| format!("{error}"))?;
        let opened = Document::from_bytes_within(name, bytes.clone(), None, MEMORY);
        let document = opened.map_err(|error| for_a_tab(&error.to_string()))?;
        let inspection = document.inspect(&selectors);
        let opening = Opening {
            foliage: selectors.clone(),
            memory: MEMORY,
            ..Opening::default()
        };
        let plant = Plant::from_bytes(name, bytes, &opening);
        Ok(Self {
            document,
            selectors,
            inspection,
            plant: plant.map_err(|error| for_a_tab(&error.to_string())),
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
            facts: facts("original"),
        }];
        if !others.is_empty() {
            levels.push(Level {
                surfaces: &others,
                facts: facts("not the plant"),
            });
        }
        let mut made = pack(self.document.name(), &levels)?;
        made.scene.pop();
        made.scene += &format!(r#","parts":{}}}"#, json!(parts));
        Ok(JsPicture(made))
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

/// What is drawn of levels.
fn pack(title: &str, levels: &[Level<'_>]) -> Result<secateur_pages::preview::Packed, String> {
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
