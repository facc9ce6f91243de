//! The engine for JavaScript: a plant is opened from bytes, and its levels are handed out as the bytes that the
//! program writes.
//!
//! ```js
//! const tree = new Tree("oak.glb", bytes, "[]");
//! const level = tree.level('{"amount": "share", "value": 0.25}', () => {});
//! const glb = level.glb(); // what `secateur simplify oak.glb --triangles 0.25` writes
//! ```
//!
//! Settings and figures travel as JSON: [`settings`] says which keys there are. All calls work until they are done;
//! a page makes them in a Worker, which it ends to break one off.

mod chosen;
mod lasso;
mod levels;
mod picture;
pub mod settings;
mod tree;
mod zip;

use std::cell::RefCell;

use secateur::plant::{GrowOptions, Species};
use wasm_bindgen::prelude::wasm_bindgen;

pub use chosen::JsChosen;
pub use levels::{JsLevel, JsLevels};
pub use picture::JsPicture;
pub use tree::JsTree;

thread_local! {
    static LAST_PANIC: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Remembers what went wrong where the engine itself fails, for [`last_panic`].
#[wasm_bindgen(start)]
pub fn start() {
    std::panic::set_hook(Box::new(|info| {
        LAST_PANIC.with(|last| *last.borrow_mut() = info.to_string());
    }));
}

/// What the engine said when it failed last; empty where it has not. Nothing may be asked of it after that.
#[wasm_bindgen(js_name = lastPanic)]
pub fn last_panic() -> String {
    LAST_PANIC.with(|last| last.borrow().clone())
}

/// The version of the program whose bytes these are.
#[wasm_bindgen]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}

/// The species that can be grown, by their names.
#[wasm_bindgen]
pub fn species() -> Vec<String> {
    let names = Species::ALL.iter().map(|species| species.name());
    names.map(str::to_owned).collect()
}

/// Grows a plant: the bytes of `secateur grow SPECIES --leaves N --seed S`.
///
/// # Errors
/// A sentence where there is no such species, or it can't have as many leaves.
#[wasm_bindgen]
pub fn grow(species: &str, leaves: u32, seed: u32) -> Result<Vec<u8>, String> {
    let species: Species = species.parse().map_err(|error| format!("{error}"))?;
    let options = GrowOptions {
        leaves,
        seed: u64::from(seed),
    };
    let plant = secateur::plant::grow(species, &options).map_err(|error| error.to_string())?;
    Ok(secateur::plant_into_glb(plant))
}
