//! What is made of a plant: one level, or a chain.

use std::cell::RefCell;
use std::rc::Rc;

use secateur::chain::{ChainError, ChainFiles, Layout, LevelReport, LevelsOptions};
use secateur::{Detail, Document, Level, Levels, Observer, Plant};
use secateur_scene::preview::{Facts, Level as Shown, Pictures};
use serde_json::{Value, json};
use wasm_bindgen::prelude::wasm_bindgen;

use crate::picture::JsPicture;
use crate::tree::pack;
use crate::warnings::sentence;
use crate::zip::Zip;

/// One level of a plant.
#[wasm_bindgen(js_name = Level)]
pub struct JsLevel {
    glb: Vec<u8>,
    facts: Facts,
    warnings: Vec<String>,
    plant: Rc<Plant>,
}

impl JsLevel {
    pub(crate) fn of(plant: &Rc<Plant>, level: &Level<'_>) -> Result<Self, String> {
        let glb = level.to_bytes().map_err(|error| error.to_string())?;
        let left = level.simplified.lod.foliage(plant.leaves());
        let leaf_triangles = left.triangles().len() as u64;
        let report = LevelReport {
            leaves: left.leaves().len() as u64,
            triangles: leaf_triangles + level.wood_triangles,
            foliage_triangles: leaf_triangles,
            wood_triangles: level.wood_triangles,
            difference: level.difference.unwrap_or_default(),
            ..LevelReport::default()
        };
        Ok(Self {
            glb,
            facts: Facts {
                name: "level".to_owned(),
                report,
            },
            warnings: level.warnings.iter().map(sentence).collect(),
            plant: Rc::clone(plant),
        })
    }
}

#[wasm_bindgen(js_class = Level)]
impl JsLevel {
    /// The bytes that `secateur simplify` writes.
    pub fn glb(&self) -> Vec<u8> {
        self.glb.clone()
    }

    /// Its figures and warnings, as JSON.
    pub fn report(&self) -> String {
        json!({ "level": self.facts, "warnings": self.warnings }).to_string()
    }

    /// What is drawn of the plant and the level.
    ///
    /// # Errors
    /// A sentence where there is too much of it to draw.
    pub fn picture(&self) -> Result<JsPicture, String> {
        let drawn = |document: &Document| {
            let drawn = document.drawn(Detail::Full, &[]);
            let drawn = drawn.map_err(|error| error.to_string())?.into_iter();
            Ok::<_, String>(drawn.map(|d| (d.surface, d.is_foliage)).collect::<Vec<_>>())
        };
        let original = self.plant.tree().document();
        let name = original.name();
        let document = Document::from_bytes(name, self.glb.clone(), None);
        let after = drawn(&document.map_err(|error| error.to_string())?)?;
        let before = drawn(original)?;
        let of_plant = self.plant.whole().map(LevelReport::of_plant);
        let levels = [
            Shown {
                surfaces: &before,
                facts: Facts {
                    name: "original".to_owned(),
                    report: of_plant.unwrap_or_default(),
                },
            },
            Shown {
                surfaces: &after,
                facts: self.facts.clone(),
            },
        ];
        pack(name, &levels).map(JsPicture)
    }
}

/// Levels beside the plant that they are of.
pub(crate) struct OwnedLevels {
    /// Of the plant below, and dropped before it.
    levels: Levels<'static>,
    _plant: Rc<Plant>,
}

impl OwnedLevels {
    pub(crate) fn make(
        plant: &Rc<Plant>,
        options: &LevelsOptions,
        observer: &mut Observer<'_>,
    ) -> Result<Self, ChainError> {
        let plant = Rc::clone(plant);
        // SAFETY: the plant lies on the heap behind an `Rc` that is held as long as the levels, and nothing changes
        // it: `Rc` hands out shared references alone.
        let lasting: &'static Plant = unsafe { &*Rc::as_ptr(&plant) };
        Ok(Self {
            levels: lasting.levels_watched(options, observer)?,
            _plant: plant,
        })
    }
}

/// A chain of levels of a plant.
#[wasm_bindgen(js_name = Levels)]
pub struct JsLevels {
    owned: OwnedLevels,
    /// The files of the layout that was asked for last.
    last: RefCell<Option<(Layout, Rc<ChainFiles>)>>,
}

#[wasm_bindgen(js_class = Levels)]
impl JsLevels {
    /// The figures of each level, finest first, with notes and warnings, as JSON.
    pub fn report(&self) -> String {
        self.record().to_string()
    }

    /// What is drawn of the plant and its levels.
    ///
    /// # Errors
    /// A sentence where there is too much of it to draw.
    pub fn picture(&self) -> Result<JsPicture, String> {
        let packed = self.owned.levels.packed(Pictures::Texels);
        packed.map(JsPicture).map_err(|error| error.to_string())
    }

    /// The page of `secateur lods --preview`, as HTML.
    ///
    /// # Errors
    /// As [`picture`](Self::picture).
    pub fn preview(&self) -> Result<String, String> {
        self.owned.levels.page().map_err(|error| error.to_string())
    }

    /// The names of the files in a layout: `files`, `siblings` or `msft`.
    ///
    /// # Errors
    /// A sentence where there is no such layout, or a file would be beyond 4 GiB.
    pub fn names(&self, layout: &str) -> Result<Vec<String>, String> {
        let made = self.files(layout)?;
        Ok(made.files.iter().map(|file| file.name.clone()).collect())
    }

    /// A file of a layout, counted from 0: the bytes that `secateur lods` writes.
    ///
    /// # Errors
    /// As [`names`](Self::names), or where there is no such file.
    pub fn file(&self, layout: &str, number: usize) -> Result<Vec<u8>, String> {
        let made = self.files(layout)?;
        let file = made.files.get(number).map(|file| file.bytes.clone());
        file.ok_or_else(|| format!("there is no file {number} in the layout {layout}"))
    }

    /// All files of a layout with the report as a ZIP; with the preview page, where it is wanted.
    ///
    /// # Errors
    /// As [`names`](Self::names).
    pub fn zip(&self, layout: &str, with_preview: bool) -> Result<Vec<u8>, String> {
        let name = self.owned.levels.name();
        let mut zip = Zip::default();
        let made = self.files(layout)?;
        for file in &made.files {
            zip.add(&file.name, &file.bytes);
        }
        let report = format!("{:#}\n", self.record());
        zip.add(&format!("{name}_report.json"), report.as_bytes());
        if with_preview {
            zip.add(&format!("{name}_preview.html"), self.preview()?.as_bytes());
        }
        Ok(zip.finish())
    }
}

impl JsLevels {
    pub(crate) fn of(owned: OwnedLevels) -> Self {
        Self {
            owned,
            last: RefCell::default(),
        }
    }

    fn files(&self, layout: &str) -> Result<Rc<ChainFiles>, String> {
        let layout = match layout {
            "files" => Layout::Files,
            "siblings" => Layout::Siblings,
            "msft" => Layout::Msft,
            other => return Err(format!("there is no layout {other}")),
        };
        if let Some((known, files)) = &*self.last.borrow()
            && *known == layout
        {
            return Ok(Rc::clone(files));
        }
        let made = self.owned.levels.to_bytes(layout);
        let files = Rc::new(made.map_err(|error| error.to_string())?);
        *self.last.borrow_mut() = Some((layout, Rc::clone(&files)));
        Ok(files)
    }

    fn record(&self) -> Value {
        let levels = &self.owned.levels;
        let reports = levels.chain.levels.iter().enumerate();
        let reports: Vec<Value> = reports
            .map(|(k, level)| {
                let mut report = json!(level.report);
                report["name"] = levels.node(k).into();
                report["shadow"] = levels.node(level.shadow).into();
                report
            })
            .collect();
        json!({
            "name": levels.name(),
            "version": env!("CARGO_PKG_VERSION"),
            "original": LevelReport::of_plant(levels.tree()),
            "levels": reports,
            "notes": levels.chain.notes,
        })
    }
}
