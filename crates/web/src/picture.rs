//! What the page draws.

use secateur_pages::preview::Packed;
use wasm_bindgen::prelude::wasm_bindgen;

/// What is drawn of a plant and its levels, for the page's renderer.
#[wasm_bindgen(js_name = Picture)]
#[derive(Debug)]
pub struct JsPicture(pub(crate) Packed);

#[wasm_bindgen(js_class = Picture)]
impl JsPicture {
    /// What there is to draw and where it lies in the bytes, as JSON.
    pub fn scene(&self) -> String {
        self.0.scene.clone()
    }

    /// The vertices and triangles of all parts, at the places in bytes that the scene gives.
    pub fn geometry(&self) -> Vec<u8> {
        self.0.geometry.clone()
    }

    /// Textures, texel by texel.
    pub fn textures(&self) -> Vec<u8> {
        self.0.pictures.clone()
    }
}
