//! The `min` and `max` of an accessor.

use serde_json::Value;

use crate::accessor::Component;

/// The least and the largest value of each of `components` components, as the
/// accessor stores them (integers not normalised). `bytes` is packed tightly
/// and holds at least one element.
pub(super) fn bounds(component: Component, components: usize, bytes: &[u8]) -> (Value, Value) {
    let mut least = vec![f64::INFINITY; components];
    let mut largest = vec![f64::NEG_INFINITY; components];
    let elements = bytes.chunks_exact(component.bytes());
    for (place, value) in elements.map(|b| stored_value(component, b)).enumerate() {
        let k = place % components;
        least[k] = least[k].min(value);
        largest[k] = largest[k].max(value);
    }
    let json = |values: Vec<f64>| values.into_iter().map(|v| number(component, v)).collect();
    (json(least), json(largest))
}

/// Every component fits f64 exactly.
fn stored_value(component: Component, b: &[u8]) -> f64 {
    match component {
        Component::I8 => f64::from(b[0] as i8),
        Component::U8 => f64::from(b[0]),
        Component::I16 => f64::from(i16::from_le_bytes([b[0], b[1]])),
        Component::U16 => f64::from(u16::from_le_bytes([b[0], b[1]])),
        Component::U32 => f64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])),
        Component::F32 => f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])),
    }
}

fn number(component: Component, value: f64) -> Value {
    match component {
        Component::F32 => value.into(),
        _ => (value as i64).into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn bounds_are_per_component_and_stored() {
        let floats: Vec<u8> = [1.5f32, -2.0, 0.1, 4.0]
            .iter()
            .flat_map(|x| x.to_le_bytes())
            .collect();
        let (min, max) = bounds(Component::F32, 2, &floats);
        // 0.1 as f32, printed so that reading it as f32 gives the same bits.
        assert_eq!(min, json!([f64::from(0.1f32), -2.0]));
        assert_eq!(max, json!([1.5, 4.0]));
        let (min, max) = bounds(Component::I8, 1, &[0x80, 5, 0xff]);
        assert_eq!((min, max), (json!([-128]), json!([5])));
    }
}
