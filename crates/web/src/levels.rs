//! What is made of a plant: one level, or a chain.

use std::cell::RefCell;
use std::rc::Rc;

use secateur::chain::{ChainFiles, Layout};
use secateur::{Level, Levels};
use secateur_pages::preview::Pictures;
use serde_json::{Value, json};
use wasm_bindgen::prelude::wasm_bindgen;

use crate::picture::JsPicture;
use crate::zip::Zip;

/// One level of a plant.
#[wasm_bindgen(js_name = Level)]
pub struct JsLevel(pub(crate) Level);

#[wasm_bindgen(js_class = Level)]
impl JsLevel {
    /// The bytes that `secateur simplify` writes.
    ///
    /// # Errors
    /// A sentence where a part of the file is damaged that was not needed so far.
    pub fn glb(&self) -> Result<Vec<u8>, String> {
        self.0.to_bytes().map_err(|error| error.to_string())
    }

    /// Its figures and warnings, as JSON.
    pub fn report(&self) -> String {
        let warnings: Vec<String> = self.0.warnings.iter().map(ToString::to_string).collect();
        json!({ "level": self.0.report(), "warnings": warnings }).to_string()
    }

    /// What is drawn of the plant and the level.
    ///
    /// # Errors
    /// A sentence where there is too much of it to draw.
    pub fn picture(&self) -> Result<JsPicture, String> {
        let packed = self.0.preview_packed(Pictures::Texels);
        packed.map(JsPicture).map_err(|error| error.to_string())
    }

    /// The page to look at it beside the plant, as HTML.
    ///
    /// # Errors
    /// As [`picture`](Self::picture).
    pub fn preview(&self) -> Result<String, String> {
        self.0.preview_html().map_err(|error| error.to_string())
    }
}

/// A chain of levels of a plant.
#[wasm_bindgen(js_name = Levels)]
pub struct JsLevels {
    levels: Levels,
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
        let packed = self.levels.preview_packed(Pictures::Texels);
        packed.map(JsPicture).map_err(|error| error.to_string())
    }

    /// The page of `secateur lods --preview`, as HTML.
    ///
    /// # Errors
    /// As [`picture`](Self::picture).
    pub fn preview(&self) -> Result<String, String> {
        self.levels
            .preview_html()
            .map_err(|error| error.to_string())
    }

    /// The names of the files in a layout: `files`, `siblings`, `msft` or `usd`.
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
        let name = self.levels.name();
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
    pub(crate) fn of(levels: Levels) -> Self {
        Self {
            levels,
            last: RefCell::default(),
        }
    }

    fn files(&self, layout: &str) -> Result<Rc<ChainFiles>, String> {
        let parsed: Result<Layout, _> = layout.parse();
        let layout = parsed.map_err(|error| error.to_string())?;
        if let Some((known, files)) = &*self.last.borrow()
            && *known == layout
        {
            return Ok(Rc::clone(files));
        }
        let made = self.levels.to_bytes(layout);
        let files = Rc::new(made.map_err(|error| error.to_string())?);
        *self.last.borrow_mut() = Some((layout, Rc::clone(&files)));
        Ok(files)
    }

    fn record(&self) -> Value {
        let levels = &self.levels;
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
            "original": levels.plant().report(),
            "levels": reports,
            "notes": levels.chain.notes.iter().map(|note| &**note).collect::<Vec<_>>(),
        })
    }
}
