//! Selectors: naming parts of a file.

use std::fmt;
use std::str::FromStr;

use super::level_names::without_level;

/// Names what is foliage: parts by the name of their material, mesh or node.
///
/// Written `material:NAME`, `mesh:NAME` or `node:NAME`, where `*` in the name
/// stands for any text and `?` for any one character; case matters. Entries can
/// also be named by their number in the file, as in `material:#1`; a primitive
/// without material is `material:#none`. Names of a level count without its number too: `material:leaf` is
/// `leaf_LOD1` as well. A node stands for the mesh it draws
/// itself, not for its children. `all` is everything of the plant.
///
/// `piece:2.0.5-9` are connected pieces: of mesh 2 in the file, of its primitive 0, the pieces 5 to 9, all counted from 0.
/// Pieces are in the order of their lowest triangles. One alone is `piece:2.0.5`.
///
/// ```
/// use secateur_gltf::Selector;
///
/// let selector: Selector = "material:leaf_*".parse().unwrap();
/// assert_eq!(selector.to_string(), "material:leaf_*");
/// assert!("leaves".parse::<Selector>().is_err());
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Selector {
    /// All of the plant.
    All,
    /// By the material's name.
    Material(String),
    /// By the mesh's name.
    Mesh(String),
    /// By the node's name.
    Node(String),
    /// Connected pieces of a primitive.
    Pieces {
        /// The number of the mesh.
        mesh: u32,
        /// The number of the primitive in it.
        primitive: u32,
        /// The first of the pieces.
        first: u32,
        /// The last of them.
        last: u32,
    },
}

/// Why a text is no [`Selector`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is no selector; write material:NAME, mesh:NAME or node:NAME, with * and ? as wildcards, piece:MESH.PRIMITIVE.PIECE by numbers, or `all`"
)]
pub struct SelectorError(String);

impl FromStr for Selector {
    type Err = SelectorError;

    fn from_str(text: &str) -> Result<Self, SelectorError> {
        let error = || SelectorError(text.to_owned());
        if text == "all" {
            return Ok(Self::All);
        }
        let (kind, name) = text.split_once(':').ok_or_else(error)?;
        if name.is_empty() {
            return Err(error());
        }
        match kind {
            "material" => Ok(Self::Material(name.to_owned())),
            "mesh" => Ok(Self::Mesh(name.to_owned())),
            "node" => Ok(Self::Node(name.to_owned())),
            "piece" => pieces_of(name).ok_or_else(error),
            _ => Err(error()),
        }
    }
}

/// Pieces by numbers, such as `2.0.5-9`.
fn pieces_of(numbers: &str) -> Option<Selector> {
    let mut numbers = numbers.splitn(3, '.');
    let mut next = || numbers.next();
    let [mesh, primitive] = [next()?, next()?].map(|number| number.parse().ok());
    let run = next()?;
    let (first, last) = run.split_once('-').unwrap_or((run, run));
    let (first, last) = (first.parse().ok()?, last.parse().ok()?);
    (first <= last).then_some(Selector::Pieces {
        mesh: mesh?,
        primitive: primitive?,
        first,
        last,
    })
}

impl fmt::Display for Selector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::All => f.write_str("all"),
            Self::Material(name) => write!(f, "material:{name}"),
            Self::Mesh(name) => write!(f, "mesh:{name}"),
            Self::Node(name) => write!(f, "node:{name}"),
            Self::Pieces {
                mesh,
                primitive,
                first,
                last,
            } => {
                write!(f, "piece:{mesh}.{primitive}.{first}")?;
                match last == first {
                    true => Ok(()),
                    false => write!(f, "-{last}"),
                }
            }
        }
    }
}

/// What an entry of the file is called: its name, or its number where it has
/// none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Label<'a> {
    pub(crate) name: &'a str,
    /// `None` for glTF's default material.
    pub(crate) index: Option<usize>,
}

impl fmt::Display for Label<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.index {
            _ if !self.name.is_empty() => f.write_str(self.name),
            Some(index) => write!(f, "#{index}"),
            None => f.write_str("#none"),
        }
    }
}

/// The labels a selector looks at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Labels<'a> {
    pub(crate) material: Label<'a>,
    pub(crate) mesh: Label<'a>,
    pub(crate) node: Label<'a>,
}

impl Selector {
    /// Whether it names pieces of parts.
    pub(crate) fn is_of_pieces(&self) -> bool {
        matches!(self, Self::Pieces { .. })
    }

    /// Whether all of a part with these labels is meant.
    pub(crate) fn matches(&self, labels: Labels<'_>) -> bool {
        let (glob, label) = match self {
            Self::All => return true,
            Self::Pieces { .. } => return false,
            Self::Material(glob) => (glob, labels.material),
            Self::Mesh(glob) => (glob, labels.mesh),
            Self::Node(glob) => (glob, labels.node),
        };
        let number = Label { name: "", ..label };
        let name = label.to_string();
        glob_matches(glob, &name)
            || glob_matches(glob, without_level(&name))
            || *glob == number.to_string()
    }

    /// The label of a part that this kind of selector looks at, as a selector.
    pub(crate) fn same_kind(&self, labels: Labels<'_>) -> Self {
        match self {
            Self::All => Self::All,
            Self::Pieces { .. } | Self::Material(_) => Self::Material(labels.material.to_string()),
            Self::Mesh(_) => Self::Mesh(labels.mesh.to_string()),
            Self::Node(_) => Self::Node(labels.node.to_string()),
        }
    }
}

/// Whether a name fits a pattern with `*` and `?`. On a mismatch only the last
/// star takes one character more, so that time is at most pattern x name.
fn glob_matches(glob: &str, name: &str) -> bool {
    let glob: Vec<char> = glob.chars().collect();
    let name: Vec<char> = name.chars().collect();
    let (mut g, mut n) = (0, 0);
    let mut last_star: Option<(usize, usize)> = None;
    while n < name.len() {
        match glob.get(g) {
            Some('*') => {
                last_star = Some((g, n));
                g += 1;
            }
            Some(&c) if c == '?' || c == name[n] => {
                g += 1;
                n += 1;
            }
            _ => match &mut last_star {
                Some((star, taken)) => {
                    *taken += 1;
                    (g, n) = (*star + 1, *taken);
                }
                None => return false,
            },
        }
    }
    glob[g..].iter().all(|&c| c == '*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn globs() {
        for (glob, name, fits) in [
            ("leaf", "leaf", true),
            ("leaf", "Leaf", false),
            ("leaf", "leaf2", false),
            ("leaf*", "leaf", true),
            ("*leaf*", "oak_leaf_2", true),
            ("l?af", "leaf", true),
            ("l?af", "laf", false),
            ("*a*b*c", "aXbXbXc", true),
            ("*a*b*c", "aXcXb", false),
            ("*", "", true),
            ("?", "", false),
            ("blätt?r", "blätter", true),
        ] {
            assert_eq!(glob_matches(glob, name), fits, "{glob} on {name}");
        }
    }

    #[test]
    fn a_selector_needs_a_known_kind_and_a_name() {
        for bad in ["leaves", "material:", "texture:x", ""] {
            assert!(bad.parse::<Selector>().is_err(), "{bad}");
        }
        for bad in ["piece:1.2", "piece:1.2.x", "piece:0.0.9-5", "piece:#1.0.0"] {
            assert!(bad.parse::<Selector>().is_err(), "{bad}");
        }
        for text in ["piece:2.0.5-9", "piece:2.0.5"] {
            assert_eq!(text.parse::<Selector>().unwrap().to_string(), text);
        }
        // Only the first colon parts kind and name.
        let selector: Selector = "mesh:a:b".parse().unwrap();
        assert_eq!(selector, Selector::Mesh("a:b".to_owned()));
    }
}
