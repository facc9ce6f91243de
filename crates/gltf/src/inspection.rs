//! What is in a file, for people and for programs.

use std::fmt;

use secateur_model::Note;
use serde::{Serialize, Serializer};

use super::evidence::Reason;

/// What is in a file, and what was taken for foliage and why.
///
/// Prints as a readable text; as JSON through serde.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Inspection {
    /// The file, as it was named when it was opened.
    pub file: String,
    /// The tool that wrote it (`asset.generator`).
    pub generator: Option<String>,
    /// The extensions it uses.
    pub extensions: Vec<String>,
    /// Every primitive that is drawn, in traversal order.
    pub primitives: Vec<PrimitiveReport>,
    /// The foliage, where there is one.
    pub foliage: Option<FoliageReport>,
    /// Triangles of everything else, every placement counted.
    pub wood_triangles: u64,
    /// The lowest and the highest corner of the plant, in world units.
    pub extents: Option<[[f64; 3]; 2]>,
    /// What is not the plant, one sentence each.
    pub notes: Vec<String>,
    /// What was passed over, one sentence each.
    #[serde(serialize_with = "as_texts")]
    #[cfg_attr(feature = "cli", schemars(with = "Vec<String>"))]
    pub warnings: Vec<Note>,
    /// Selectors that would name leaves, where none were found.
    pub candidates: Vec<String>,
    /// Why there is no foliage, in one sentence.
    pub problem: Option<String>,
}

/// Notes as their texts.
fn as_texts<S: Serializer>(notes: &[Note], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(notes.iter().map(|note| &**note))
}

/// What a primitive was taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum TakenFor {
    /// Leaves, wherever it is drawn.
    Foliage,
    /// Leaves where some nodes draw it, wood elsewhere.
    FoliageInPart,
    /// All triangles are kept as they are: trunk, branches, pots and the like.
    Wood,
    /// Not the plant: ground, and helpers such as collision shapes. It stays as it is.
    NotPlant,
    /// Nothing: points, lines, or no vertices at all.
    Nothing,
}

/// A primitive and the reasons of the choice.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct PrimitiveReport {
    /// Its place in the JSON, such as `meshes[0].primitives[1]`.
    pub place: String,
    /// Its material's name, `#` and number where it has none, `#none` without
    /// material.
    pub material: String,
    /// `OPAQUE`, `MASK` or `BLEND`.
    pub alpha_mode: &'static str,
    /// The mesh's name or number.
    pub mesh: String,
    /// Names or numbers of the first nodes that draw it.
    pub nodes: Vec<String>,
    /// How often it is drawn, instances counted.
    pub placements: u64,
    /// Triangles of one placement.
    pub triangles: u64,
    /// Its connected pieces, once: leaves, if it is foliage.
    pub pieces: u64,
    /// What it was taken for.
    pub taken_for: TakenFor,
    /// Whether a selector decided.
    pub chosen_by_user: bool,
    /// The sum of the reasons' points: from 2 foliage, up to 0 wood.
    pub points: f64,
    /// What speaks for and against foliage, the strongest reason first.
    pub reasons: Vec<Reason>,
}

/// The foliage in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct FoliageReport {
    /// Leaves, every instance counted.
    pub leaves: u64,
    /// Triangles of all leaves, every instance counted.
    pub triangles: u64,
    /// Triangles of a leaf.
    pub triangles_per_leaf: Spread,
    /// One side of a leaf in squared world units, cut-outs not subtracted.
    pub leaf_area: Spread,
    /// For each alpha mask the share of its texels that is leaf, 0 to 1.
    pub mask_coverage: Vec<f64>,
}

/// The least, the middle and the greatest of some numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Spread {
    /// The least of the values.
    pub min: f64,
    /// The middle one, the upper of two.
    pub median: f64,
    /// The greatest of the values.
    pub max: f64,
}

impl Spread {
    /// The spread of some numbers, or `None` of no numbers.
    pub(crate) fn of(mut values: Vec<f64>) -> Option<Self> {
        let last = values.len().checked_sub(1)?;
        let middle = values.len() / 2;
        let (_, &mut median, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
        let (_, &mut min, _) = values.select_nth_unstable_by(0, f64::total_cmp);
        let (_, &mut max, _) = values.select_nth_unstable_by(last, f64::total_cmp);
        Some(Self { min, median, max })
    }
}

impl fmt::Display for Spread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { min, median, max } = self;
        write!(f, "{} / {} / {}", Short(*min), Short(*median), Short(*max))
    }
}

/// A number to four digits.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if self.0 == 0.0 || (self.0.fract() == 0.0 && size < 1e9) {
            write!(f, "{}", self.0)
        } else if (1e-3..1e6).contains(&size) {
            let digits = (3 - size.log10().floor() as i32).max(0) as usize;
            write!(f, "{:.digits$}", self.0)
        } else {
            write!(f, "{:.3e}", self.0)
        }
    }
}

impl fmt::Display for TakenFor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Foliage => "foliage",
            Self::FoliageInPart => "foliage in part",
            Self::Wood => "wood",
            Self::NotPlant => "no plant",
            Self::Nothing => "nothing",
        })
    }
}

impl fmt::Display for Inspection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.file)?;
        if let Some(generator) = &self.generator {
            writeln!(f, "  made with    {generator}")?;
        }
        if !self.extensions.is_empty() {
            writeln!(f, "  extensions   {}", self.extensions.join(", "))?;
        }
        if let Some([low, high]) = self.extents {
            let size: [f64; 3] = std::array::from_fn(|k| high[k] - low[k]);
            let [x, y, z] = size.map(Short);
            writeln!(f, "  size         {x} x {y} x {z}")?;
        }
        if let Some(foliage) = &self.foliage {
            writeln!(f, "{foliage}")?;
        }
        if !self.primitives.is_empty() {
            writeln!(f, "  wood         {} triangles", self.wood_triangles)?;
        }
        for primitive in &self.primitives {
            writeln!(f, "\n{primitive}")?;
        }
        if !self.warnings.is_empty() || !self.notes.is_empty() {
            writeln!(f)?;
        }
        for note in &self.notes {
            writeln!(f, "note: {note}")?;
        }
        for warning in &self.warnings {
            writeln!(f, "warning: {warning}")?;
        }
        match &self.problem {
            Some(problem) => writeln!(f, "\nproblem: {problem}"),
            None => Ok(()),
        }
    }
}

impl fmt::Display for FoliageReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "  leaves       {} of {} triangles in all",
            self.leaves, self.triangles
        )?;
        writeln!(
            f,
            "  a leaf       {} triangles (min / median / max)",
            self.triangles_per_leaf
        )?;
        write!(f, "  its area     {}", self.leaf_area)?;
        if !self.mask_coverage.is_empty() {
            let shares = self.mask_coverage.iter();
            let percents: Vec<String> = shares.map(|s| format!("{:.0} %", 100.0 * s)).collect();
            write!(f, "\n  alpha masks  {} leaf", percents.join(", "))?;
        }
        Ok(())
    }
}

impl fmt::Display for PrimitiveReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "  {}", self.place)?;
        write!(
            f,
            "    material {} ({}), mesh {}, node {}",
            self.material,
            self.alpha_mode,
            self.mesh,
            self.nodes.join(", "),
        )?;
        if self.placements > 1 {
            write!(f, ", drawn {} times", self.placements)?;
        }
        writeln!(f)?;
        writeln!(
            f,
            "    {} triangles in {} pieces",
            self.triangles, self.pieces
        )?;
        if self.taken_for == TakenFor::NotPlant {
            let reasons = self.reasons.iter().map(|reason| reason.text.as_str());
            let reasons: Vec<&str> = reasons.collect();
            return write!(
                f,
                "    taken for {}: {}",
                self.taken_for,
                reasons.join("; ")
            );
        }
        let by = if self.chosen_by_user {
            "as selected".to_owned()
        } else {
            format!("{:+} points", self.points)
        };
        write!(f, "    taken for {}: {by}", self.taken_for)?;
        for reason in &self.reasons {
            write!(f, "\n      {:+}  {}", reason.points, reason.text)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_an_even_number_is_the_upper_one() {
        let spread = Spread::of(vec![4.0, 1.0, 3.0, 2.0]).unwrap();
        assert_eq!(
            spread,
            Spread {
                min: 1.0,
                median: 3.0,
                max: 4.0
            }
        );
        assert_eq!(Spread::of(Vec::new()), None);
    }

    #[test]
    fn numbers_print_to_four_digits() {
        let shown = |x: f64| Short(x).to_string();
        assert_eq!(shown(2.0), "2");
        assert_eq!(shown(0.012345), "0.01235");
        assert_eq!(shown(123.456), "123.5");
        assert_eq!(shown(1.5e-7), "1.500e-7");
    }
}
