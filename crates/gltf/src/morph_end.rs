//! A level at the end of the way to the next one.

use serde_json::Value;

use crate::document::Document;
use crate::write::chain::MORPH;

impl Document {
    /// The document with each primitive's [`MORPH`] for its positions, where it has that: what is drawn where the next
    /// level takes over. Vertices and triangles keep their order.
    #[must_use]
    pub fn at_end_of_morph(&self) -> Self {
        let mut end = self.clone();
        let meshes = end.root.get_mut("meshes").and_then(Value::as_array_mut);
        let primitives = meshes.into_iter().flatten();
        let primitives = primitives.filter_map(|mesh| mesh.get_mut("primitives")?.as_array_mut());
        for primitive in primitives.flatten() {
            let Some(attributes) = primitive["attributes"].as_object_mut() else {
                continue;
            };
            if let Some(accessor) = attributes.shift_remove(MORPH) {
                attributes.insert("POSITION".to_owned(), accessor);
            }
        }
        end.undecoded = None;
        end
    }
}
