//! A removal order within its tree's file: a text in the root's `extras`.
//!
//! ```text
//! "extras": {"secateur_order": {"version": 1, "base64": "..."}}
//! ```
//!
//! What the text says is no matter of this crate; it is of the leaves as they are in this file, so
//! a level of fewer leaves is written without it.

use serde_json::{Value, json};

use crate::Tree;

/// The name within the root's extras.
pub(crate) const ORDER_EXTRAS_NAME: &str = "secateur_order";
const VERSION: u64 = 1;

impl Tree {
    /// The removal order that the file has, in base64; nothing where it has none, or one of another
    /// version.
    pub fn order_base64(&self) -> Option<&str> {
        let order = self.document.root.get("extras")?.get(ORDER_EXTRAS_NAME)?;
        let is_known = order.get("version").and_then(Value::as_u64) == Some(VERSION);
        order.get("base64")?.as_str().filter(|_| is_known)
    }

    /// Gives the file a removal order, in base64, to be written with all its leaves. Whether it
    /// could: extras may be a text or a number, and stay so.
    #[must_use]
    pub fn set_order_base64(&mut self, base64: &str) -> bool {
        let Some(root) = self.document.root.as_object_mut() else {
            return false;
        };
        let extras = root.entry("extras").or_insert_with(|| json!({}));
        let Some(extras) = extras.as_object_mut() else {
            return false;
        };
        let order = json!({ "version": VERSION, "base64": base64 });
        extras.insert(ORDER_EXTRAS_NAME.to_owned(), order);
        true
    }
}

#[cfg(test)]
mod tests {
    use secateur_model::{LeafId, Lod};
    use serde_json::Value;

    use crate::{Document, Tree};

    fn tree(extras: &str) -> Tree {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/corpus/gltf_loader");
        let text = std::fs::read_to_string(format!("{folder}/data_uri.gltf")).unwrap();
        let with = format!(
            "{{\"extras\":{extras},{}",
            text.trim_start().strip_prefix('{').unwrap()
        );
        let document = Document::from_bytes("tree.gltf", with.into_bytes(), None).unwrap();
        document
            .into_tree(&["material:*".parse().unwrap()])
            .unwrap()
    }

    #[test]
    fn an_order_stays_with_all_leaves_and_goes_with_the_first() {
        let mut tree = tree(r#"{"other": 1}"#);
        assert_eq!(tree.order_base64(), None);
        assert!(tree.set_order_base64("AAAA"));
        let count = tree.foliage().leaves().len();
        let original = Lod::original(count);
        let read = |lod: &Lod| {
            let bytes = tree.lod_to_bytes(lod).unwrap();
            Document::from_bytes("again.glb", bytes, None).unwrap()
        };
        let order = |document: &Document| document.json()["extras"]["secateur_order"].clone();
        assert_eq!(order(&read(&original))["base64"], "AAAA");
        let mut fewer = original.clone();
        fewer.remove(LeafId::from_index(0));
        let without = read(&fewer);
        assert_eq!(order(&without), Value::Null);
        assert_eq!(without.json()["extras"]["other"], 1);
    }

    #[test]
    fn extras_that_are_no_object_stay() {
        let mut tree = tree("7");
        assert!(!tree.set_order_base64("AAAA"));
        assert_eq!(tree.document().json()["extras"], 7);
    }

    #[test]
    fn another_version_is_no_order() {
        let of = |text: &str| tree(text).order_base64().map(str::to_owned);
        let version = |n| format!(r#"{{"secateur_order": {{"version": {n}, "base64": "AA"}}}}"#);
        assert_eq!(of(&version(1)).as_deref(), Some("AA"));
        assert_eq!(of(&version(2)), None);
        assert_eq!(of(r#"{"secateur_order": 3}"#), None);
    }
}
