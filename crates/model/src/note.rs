//! Sentences about plants and levels that speak of options.

use std::borrow::Borrow;
use std::fmt;
use std::ops::{Deref, Range};

/// An option that a [`Note`] speaks of. Prints as the library's fields are called.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NamedOption {
    /// Which parts are foliage.
    Foliage,
    /// Whether the alpha of vertex colours counts.
    KeepVertexAlpha,
    /// The largest difference that a level may have, with its value where that matters.
    MaxDifference(Option<f64>),
    /// Which impostors there are.
    Impostor,
    /// How many bytes textures of impostors may take on a GPU.
    ImpostorTextures,
    /// How high the plant really is, in metres.
    PlantHeight,
    /// Whether what stands apart is one plant.
    AsOne,
}

impl fmt::Display for NamedOption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Foliage => "foliage",
            Self::KeepVertexAlpha => "vertex_alpha: keep",
            Self::MaxDifference(Some(value)) => return write!(f, "max_difference: {value}"),
            Self::MaxDifference(None) => "max_difference",
            Self::Impostor => "impostor",
            Self::ImpostorTextures => "impostor_texture_bytes",
            Self::PlantHeight => "plant_height_m",
            Self::AsOne => "as_one",
        })
    }
}

/// A sentence about a plant or its levels. Its text has the library's names of options; a program that calls them
/// otherwise asks for the sentence [in its own words](Note::calling).
#[derive(Clone, Debug, PartialEq)]
pub struct Note {
    text: String,
    options: Vec<(Range<usize>, NamedOption)>,
}

impl Note {
    /// The note with an option after its text, as `name`.
    #[must_use]
    pub fn naming(mut self, option: NamedOption) -> Self {
        let begin = self.text.len() + 1;
        self.text += &format!("`{option}`");
        self.options.push((begin..self.text.len() - 1, option));
        self
    }

    /// The note with more text at its end.
    #[must_use]
    pub fn then(mut self, text: &str) -> Self {
        self.text += text;
        self
    }

    /// The note by other names of options.
    #[must_use]
    pub fn calling(&self, name: impl Fn(NamedOption) -> String) -> Self {
        let mut text = String::new();
        let mut options = Vec::new();
        let mut read = 0;
        for (place, option) in &self.options {
            text += &self.text[read..place.start];
            let begin = text.len();
            text += &name(*option);
            options.push((begin..text.len(), *option));
            read = place.end;
        }
        text += &self.text[read..];
        Self { text, options }
    }
}

impl From<String> for Note {
    fn from(text: String) -> Self {
        Self {
            text,
            options: Vec::new(),
        }
    }
}

impl From<&str> for Note {
    fn from(text: &str) -> Self {
        Self::from(text.to_owned())
    }
}

impl Deref for Note {
    type Target = str;

    fn deref(&self) -> &str {
        &self.text
    }
}

impl Borrow<str> for Note {
    fn borrow(&self) -> &str {
        self
    }
}

impl PartialEq<&str> for Note {
    fn eq(&self, text: &&str) -> bool {
        self.text == *text
    }
}

impl PartialEq<String> for Note {
    fn eq(&self, text: &String) -> bool {
        self.text == *text
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_called_what_the_caller_calls_them() {
        let note = Note::from("above ")
            .naming(NamedOption::MaxDifference(Some(0.28)))
            .then(", as ")
            .naming(NamedOption::Impostor)
            .then(" asks");
        assert_eq!(note, "above `max_difference: 0.28`, as `impostor` asks");
        let shouted = |option: NamedOption| option.to_string().to_uppercase() + "!";
        let shouted = note.calling(shouted);
        assert_eq!(
            shouted,
            "above `MAX_DIFFERENCE: 0.28!`, as `IMPOSTOR!` asks"
        );
        assert_eq!(shouted.calling(|option| option.to_string()), note);
    }
}
