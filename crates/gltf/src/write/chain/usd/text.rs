//! Names, paths and numbers as text of USD (.usda).

use std::fmt::Write as _;

use serde_json::{Map, Value};

/// A name of a prim: letters, digits and underscores of ASCII, and no digit first.
pub(super) fn identifier(name: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let plain = name.chars().map(|c| if is_plain(c) { c } else { '_' });
    let text: String = plain.collect();
    match text.starts_with(|c: char| c.is_ascii_digit()) || text.is_empty() {
        true => format!("_{text}"),
        false => text,
    }
}

/// A name that is not among `taken` yet, and is from now on.
pub(super) fn unique(name: &str, taken: &mut Vec<String>) -> String {
    let wanted = identifier(name);
    let mut found = wanted.clone();
    let mut count = 1;
    while taken.contains(&found) {
        found = format!("{wanted}_{count}");
        count += 1;
    }
    taken.push(found.clone());
    found
}

/// A text in quotes. Names in files are not to be trusted.
pub(super) fn quoted(text: &str) -> String {
    let plain: String = text.chars().filter(|c| !c.is_control()).collect();
    format!("\"{}\"", plain.replace('\\', "\\\\").replace('"', "\\\""))
}

/// A file beside the layer.
pub(super) fn asset(path: &str) -> String {
    match path.contains('@') {
        true => format!("@@@./{}@@@", path.replace("@@@", "\\@@@")),
        false => format!("@./{path}@"),
    }
}

/// A tuple as USD's text has it, such as `(1, 2, 3)`.
pub(super) fn tuple<const N: usize>(numbers: [f32; N]) -> String {
    let all: Vec<String> = numbers.iter().map(ToString::to_string).collect();
    format!("({})", all.join(", "))
}

/// A list of tuples, each in brackets.
pub(super) fn tuples<const N: usize>(all: impl Iterator<Item = [f32; N]>) -> String {
    list(all, |text, numbers| {
        let mut before = '(';
        for number in numbers {
            let _ = write!(text, "{before}{number}");
            before = ',';
        }
        text.push(')');
    })
}

/// A list of plain values.
pub(super) fn values<T: std::fmt::Display>(all: impl Iterator<Item = T>) -> String {
    list(all, |text, value| {
        let _ = write!(text, "{value}");
    })
}

fn list<T>(all: impl Iterator<Item = T>, mut put: impl FnMut(&mut String, T)) -> String {
    let mut text = "[".to_owned();
    for (number, value) in all.enumerate() {
        if number > 0 {
            text.push_str(", ");
        }
        put(&mut text, value);
    }
    text.push(']');
    text
}

/// Facts of a level as a dictionary for `customData`; what is no number, text or flag is left out.
pub(super) fn facts(facts: &Map<String, Value>, indent: &str) -> String {
    let mut text = String::new();
    for (name, value) in facts {
        let (kind, value) = match value {
            Value::Bool(flag) => ("bool", u8::from(*flag).to_string()),
            Value::Number(number) if number.is_f64() => ("double", number.to_string()),
            Value::Number(number) => ("int64", number.to_string()),
            Value::String(words) => ("string", quoted(words)),
            Value::Null | Value::Array(_) | Value::Object(_) => continue,
        };
        let _ = writeln!(text, "{indent}{kind} {} = {value}", identifier(name));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_strangers_end_no_text_and_no_path() {
        assert_eq!(identifier("7 Ä-b"), "_7___b");
        assert_eq!(identifier(""), "_");
        assert_eq!(quoted("a\"\\\n"), r#""a\"\\""#);
        assert_eq!(asset("a_textures/b.png"), "@./a_textures/b.png@");
        assert_eq!(asset("a@@@b"), r"@@@./a\@@@b@@@");
        let mut taken = Vec::new();
        let names = ["a b", "a-b", "a_b_1"].map(|name| unique(name, &mut taken));
        assert_eq!(names, ["a_b", "a_b_1", "a_b_1_1"]);
    }
}
