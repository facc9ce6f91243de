//! Reading properties of glTF's JSON: every type and range checked.

use serde_json::{Value, json};

use super::error::{Problem, shortened};

/// A property that is not what it should be.
pub(crate) fn bad(property: &'static str, expected: &'static str, found: &Value) -> Problem {
    Problem::BadProperty {
        property,
        expected,
        found: shortened(&found.to_string()),
    }
}

/// A whole number that is not negative, below 2^53; `None` where it is absent.
pub(crate) fn whole(object: &Value, name: &'static str) -> Result<Option<u64>, Problem> {
    const LARGEST: f64 = 9_007_199_254_740_992.0;
    let Some(value) = object.get(name) else {
        return Ok(None);
    };
    let from_float = |x: f64| ((0.0..LARGEST).contains(&x) && x.fract() == 0.0).then_some(x as u64);
    match value
        .as_u64()
        .or_else(|| value.as_f64().and_then(from_float))
    {
        Some(n) if (n as f64) < LARGEST => Ok(Some(n)),
        _ => Err(bad(name, "a whole number from 0 to 2^53", value)),
    }
}

/// Puts an entry at the end of a list, which may be new; its number.
pub(crate) fn push(root: &mut Value, list: &str, entry: Value) -> usize {
    if !root[list].is_array() {
        root[list] = json!([]);
    }
    let entries = root[list].as_array_mut();
    let entries = entries.unwrap_or_else(|| unreachable!("it is a list"));
    entries.push(entry);
    entries.len() - 1
}

/// Takes a property out, if it is there.
pub(crate) fn remove(object: &mut Value, name: &str) {
    if let Some(fields) = object.as_object_mut() {
        fields.shift_remove(name);
    }
}

/// [`whole`], for a list index or a length in memory.
pub(crate) fn index(object: &Value, name: &'static str) -> Result<Option<usize>, Problem> {
    let Some(n) = whole(object, name)? else {
        return Ok(None);
    };
    usize::try_from(n)
        .map(Some)
        .map_err(|_| bad(name, "a number this machine can address", &object[name]))
}

/// [`index`] that must be there.
pub(crate) fn required_index(object: &Value, name: &'static str) -> Result<usize, Problem> {
    index(object, name)?.ok_or(Problem::Missing(name))
}

/// A string; `None` where it is absent.
pub(crate) fn text<'a>(object: &'a Value, name: &'static str) -> Result<Option<&'a str>, Problem> {
    match object.get(name) {
        None => Ok(None),
        Some(Value::String(text)) => Ok(Some(text)),
        Some(other) => Err(bad(name, "a string", other)),
    }
}

/// A truth value; false where it is absent.
pub(crate) fn flag(object: &Value, name: &'static str) -> Result<bool, Problem> {
    match object.get(name) {
        None => Ok(false),
        Some(Value::Bool(value)) => Ok(*value),
        Some(other) => Err(bad(name, "true or false", other)),
    }
}

/// A number; `None` where it is absent.
pub(crate) fn number(object: &Value, name: &'static str) -> Result<Option<f64>, Problem> {
    match object.get(name) {
        None => Ok(None),
        Some(value) => match value.as_f64() {
            Some(x) if x.is_finite() => Ok(Some(x)),
            _ => Err(bad(name, "a number", value)),
        },
    }
}

/// `N` numbers; `None` where they are absent.
pub(crate) fn numbers<const N: usize>(
    object: &Value,
    name: &'static str,
) -> Result<Option<[f64; N]>, Problem> {
    let Some(value) = object.get(name) else {
        return Ok(None);
    };
    let finite = |v: &Value| v.as_f64().filter(|x| x.is_finite());
    let all: Option<Vec<f64>> = value
        .as_array()
        .filter(|list| list.len() == N)
        .and_then(|list| list.iter().map(finite).collect());
    match all.and_then(|list| list.try_into().ok()) {
        Some(array) => Ok(Some(array)),
        None => Err(bad(name, expected_numbers(N), value)),
    }
}

fn expected_numbers(count: usize) -> &'static str {
    match count {
        2 => "a list of 2 numbers",
        3 => "a list of 3 numbers",
        4 => "a list of 4 numbers",
        16 => "a list of 16 numbers",
        _ => "a list of numbers of the right length",
    }
}

/// A list; empty where it is absent.
pub(crate) fn list<'a>(object: &'a Value, name: &'static str) -> Result<&'a [Value], Problem> {
    match object.get(name) {
        None => Ok(&[]),
        Some(Value::Array(list)) => Ok(list),
        Some(other) => Err(bad(name, "a list", other)),
    }
}

/// An entry of a list.
pub(crate) fn entry<'a>(
    object: &'a Value,
    name: &'static str,
    index: usize,
) -> Result<&'a Value, Problem> {
    let list = list(object, name)?;
    list.get(index).ok_or(Problem::NoSuch {
        list: name,
        index,
        count: list.len(),
    })
}

/// An entry of a list of indices.
pub(crate) fn list_index(name: &'static str, value: &Value) -> Result<usize, Problem> {
    value
        .as_u64()
        .and_then(|n| usize::try_from(n).ok())
        .ok_or_else(|| bad(name, "a list of indices", value))
}

/// An extension object of a glTF object.
pub(crate) fn extension<'a>(object: &'a Value, name: &str) -> Option<&'a Value> {
    object.get("extensions")?.get(name)
}

/// `accessors[3]`, with the entry's name where it has one.
pub(crate) fn place(root: &Value, list: &str, index: usize) -> String {
    let name = root
        .get(list)
        .and_then(|l| l.get(index))
        .and_then(|entry| entry.get("name"))
        .and_then(Value::as_str)
        .filter(|name| !name.is_empty());
    match name {
        Some(name) => format!("{list}[{index}] \"{}\"", shortened(name)),
        None => format!("{list}[{index}]"),
    }
}
