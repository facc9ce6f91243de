//! Reasons for and against taking a primitive for foliage.

use serde::Serialize;

use super::Document;
use super::cutouts::{cutoff, is_kept};
use super::error::Fault;
use super::material::MaterialLook;
use super::name_evidence::{self, NameSays, TellingWord};
use super::picture::{Decoded, Pictures};
use super::shape_evidence::{self, MANY, Pieces};
use super::survey::Group;

/// A primitive with this many points or more is foliage.
pub(crate) const FOLIAGE_POINTS: f64 = 2.0;

/// A primitive with this many points or fewer is wood; between the two it can't
/// be told.
pub(crate) const WOOD_POINTS: f64 = 0.0;

/// A reason for (positive points) or against (negative) foliage.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Reason {
    /// How much it counts: names 2 to 4, pieces up to 4 (lumps 8), cut-outs 3, colour 1.
    /// From 2 in sum a primitive is foliage, up to 0 it is wood.
    pub points: f64,
    /// What was found, as a phrase for people.
    pub text: String,
}

impl Reason {
    fn new(points: f64, text: String) -> Self {
        Self { points, text }
    }

    /// A reason that decides by itself, without points.
    pub(crate) fn of_role(text: &str) -> Self {
        Self::new(0.0, text.to_owned())
    }
}

/// Reasons are shown strongest first.
pub(crate) fn strongest_first(reasons: &mut [Reason]) {
    reasons.sort_by(|a, b| b.points.abs().total_cmp(&a.points.abs()));
}

/// What was found about a group.
#[derive(Clone, Debug, Default)]
pub(crate) struct Evidence {
    pub(crate) reasons: Vec<Reason>,
    /// Whether its texture cuts out a good part of its texels.
    pub(crate) is_cut_out: bool,
    /// Whether its pieces look like leaves and wood in one.
    pub(crate) is_mixed: bool,
}

/// What is found about every group.
pub(crate) fn gather(
    document: &Document,
    groups: &[Group],
    pictures: &mut Pictures<'_>,
) -> Result<Vec<Evidence>, Fault> {
    let names = [
        ("material", 4.0, each(groups, |g| vec![g.look.name.clone()])),
        (
            "mesh",
            3.0,
            each(groups, |g| {
                vec![document.label("meshes", g.mesh).name.to_owned()]
            }),
        ),
        ("node", 2.0, each(groups, |g| node_names(document, g))),
        ("image", 2.0, each(groups, |g| image_names(document, g))),
    ];
    let mut of_textures = Vec::with_capacity(groups.len());
    for group in groups {
        let tint = tint(document, group)?;
        of_textures.push(texture_reasons(&group.look, tint, pictures)?);
    }
    let mut all = vec![Vec::new(); groups.len()];
    let mut counted = vec![Vec::new(); groups.len()];
    for (what, points, names) in &names {
        // Exporters copy no names of images.
        if *what == "image" {
            counted.iter_mut().for_each(Vec::clear);
        }
        let mut words = telling_words(names);
        for ((found, of_texture), group) in words.iter_mut().zip(&of_textures).zip(groups) {
            let tells = |(word, _): &(TellingWord, String)| {
                let has_leaves_on_it = of_texture.is_cut_out && word.is_of_branches();
                let pieces = group.geometry.pieces().len() * group.placements;
                let may_be_lawn = word.is_of_grass() && pieces < MANY;
                !has_leaves_on_it && !may_be_lawn
            };
            *found = found.take().filter(tells);
        }
        add_names(&mut all, &mut counted, (what, *points), &words);
    }
    let found = all.into_iter().zip(of_textures).zip(groups);
    let found = found.map(|((mut reasons, of_texture), group)| {
        reasons.extend(of_texture.reasons);
        Evidence {
            is_mixed: add_pieces(&mut reasons, group, of_texture.is_cut_out),
            reasons,
            is_cut_out: of_texture.is_cut_out,
        }
    });
    Ok(found.collect())
}

fn each(groups: &[Group], names: impl Fn(&Group) -> Vec<String>) -> Vec<Vec<String>> {
    groups.iter().map(names).collect()
}

fn node_names(document: &Document, group: &Group) -> Vec<String> {
    const ENOUGH: usize = 8;
    let label = |&node: &usize| document.label("nodes", node).name.to_owned();
    group.nodes.iter().take(ENOUGH).map(label).collect()
}

fn image_names(document: &Document, group: &Group) -> Vec<String> {
    let Some(image) = group.look.texture.and_then(|t| t.image) else {
        return Vec::new();
    };
    let json = &document.root["images"][image];
    let uri = json.get("uri").and_then(|u| u.as_str());
    let file = uri.filter(|uri| !uri.starts_with("data:"));
    let name = document.label("images", image).name;
    [Some(name), file]
        .into_iter()
        .flatten()
        .map(str::to_owned)
        .collect()
}

/// For each group the first name that says something, and the word by which it does.
type TellingNames = Vec<Option<(TellingWord, String)>>;

fn telling_words(names: &[Vec<String>]) -> TellingNames {
    let read = |name: &String| Some((name_evidence::read(name)?, name.clone()));
    names
        .iter()
        .map(|list| list.iter().find_map(read))
        .collect()
}

/// Adds what names say. A word that all groups share, such as that of a mesh
/// which holds the whole tree, tells nothing apart. One that a group has said before,
/// as exporters copy names from materials to meshes and nodes, says nothing new.
fn add_names(
    all: &mut [Vec<Reason>],
    counted: &mut [Vec<&'static str>],
    (what, points): (&str, f64),
    found: &TellingNames,
) {
    let says = |k: usize| found[k].as_ref().map(|(word, _)| word.says);
    let all_alike = found.len() > 1 && (1..found.len()).all(|k| says(k) == says(0));
    if all_alike {
        return;
    }
    for ((reasons, counted), found) in all.iter_mut().zip(counted).zip(found) {
        let Some((telling, name)) = found else {
            continue;
        };
        if counted.contains(&telling.word) {
            continue;
        }
        counted.push(telling.word);
        let (points, of) = match telling.says {
            NameSays::Leaf => (points, "leaves"),
            NameSays::Wood => (-points, "wood"),
        };
        reasons.push(Reason::new(
            points,
            format!("{what} name `{name}` speaks of {of}"),
        ));
    }
}

/// The mean of the vertex colours, where they are all the colour that there is: beside a texture they may be wind.
fn tint(document: &Document, group: &Group) -> Result<[f64; 3], Fault> {
    if group.look.texture.is_some() {
        return Ok([1.0; 3]);
    }
    let colors = document.colors(group.mesh, group.primitive)?;
    let mean = |k: usize| {
        let sum: f64 = colors.iter().map(|color| f64::from(color[k])).sum();
        sum / colors.len() as f64
    };
    Ok(match colors.is_empty() {
        true => [1.0; 3],
        false => [0, 1, 2].map(mean),
    })
}

/// Cut-out texels and green or brown colour, of vertices too. Only textures whose alpha matters
/// are looked at.
fn texture_reasons(
    look: &MaterialLook,
    tint: [f64; 3],
    pictures: &mut Pictures<'_>,
) -> Result<Evidence, Fault> {
    const LEAST_SHARE: f64 = 0.02;
    let mut reasons = Vec::new();
    let mut is_cut_out = false;
    let mut color = [0, 1, 2].map(|k| tint[k] * f64::from(look.base_color[k]));
    let image = look.texture.and_then(|t| t.image);
    if let (Some(cutoff), Some(image)) = (cutoff(look), image)
        && let Decoded::Picture(picture) = pictures.get(image)?
    {
        let mut kept = 0u64;
        let mut sums = [0u64; 3];
        for alpha in 0..=255 {
            if is_kept(alpha, look.base_color[3], cutoff) {
                kept += picture.tally.texels(alpha);
                for (sum, color) in sums.iter_mut().zip(picture.tally.color(alpha)) {
                    *sum += color;
                }
            }
        }
        let image = &picture.image;
        let texels = u64::from(image.width()) * u64::from(image.height());
        let cut = 1.0 - kept as f64 / texels as f64;
        if cut > LEAST_SHARE && kept > 0 {
            is_cut_out = true;
            let percent = (100.0 * cut).round();
            reasons.push(Reason::new(
                3.0,
                format!("its texture cuts out {percent} % of its texels"),
            ));
        }
        for (channel, sum) in color.iter_mut().zip(sums) {
            // The mean of sRGB values as if they were linear: enough for a hue.
            *channel *= sum as f64 / kept.max(1) as f64 / 255.0;
        }
    }
    add_color(&mut reasons, color);
    Ok(Evidence {
        reasons,
        is_cut_out,
        is_mixed: false,
    })
}

fn add_color(reasons: &mut Vec<Reason>, [red, green, blue]: [f64; 3]) {
    const CLEARLY: f64 = 1.1;
    if green > CLEARLY * red && green > CLEARLY * blue {
        reasons.push(Reason::new(1.0, "its colour is green".to_owned()));
    } else if red > CLEARLY * green && green > CLEARLY * blue {
        reasons.push(Reason::new(-1.0, "its colour is brown".to_owned()));
    }
}

/// Adds what the pieces say; returns whether they look like leaves and wood in one.
fn add_pieces(reasons: &mut Vec<Reason>, group: &Group, is_cut_out: bool) -> bool {
    const MOST: f64 = 0.8;
    const FEW: f64 = 0.3;
    const ALIKE: f64 = 0.5;
    let geometry = &group.geometry;
    if geometry.triangles.is_empty() {
        return false;
    }
    let pieces =
        shape_evidence::sum_up(&geometry.positions, &geometry.triangles, geometry.pieces());
    let is_mixed = pieces.are_leaves_and_wood(group.placements);
    if pieces.are_lumps(group.placements) && !is_cut_out {
        let text = match pieces.count {
            1 => "its only piece is round and of many triangles".to_owned(),
            count => format!("its {count} pieces are round and of many triangles each"),
        };
        reasons.push(Reason::new(-8.0, text));
        return is_mixed;
    }
    let Pieces {
        count,
        leaf_like,
        leaf_like_share,
        alike_share,
        ..
    } = pieces;
    let pieces = if count == 1 {
        "its only piece is"
    } else {
        "of its pieces"
    };
    let many = leaf_like * group.placements >= MANY;
    if many && leaf_like_share >= MOST {
        let points = if alike_share >= ALIKE { 4.0 } else { 2.0 };
        let text = if count == 1 {
            format!(
                "{pieces} small and flat, and drawn {} times",
                group.placements
            )
        } else {
            format!("{leaf_like} of its {count} pieces are small and flat")
        };
        reasons.push(Reason::new(points, text));
    } else if leaf_like_share < FEW {
        let percent = (100.0 * leaf_like_share).round();
        let text = format!("only {percent} % of its triangles are in small flat pieces");
        reasons.push(Reason::new(-3.0, text));
    }
    is_mixed
}
