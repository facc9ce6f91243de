//! Roles: which parts of a file are leaves, which are other surface of the plant, and which are not the plant.
//!
//! Not the plant are helpers, known by their names, and ground, known by its shape. It stays in files as it is
//! and is neither drawn, counted nor changed.

use std::collections::{BTreeMap, HashMap};
use std::fmt;

use glam::DVec3;
use serde_json::Value;

use super::choice;
use super::cutouts::{cutoff, is_kept};
use super::error::Fault;
use super::helper_names::{self, Helper};
use super::parts::Part;
use super::picture::{Decoded, Pictures};
use super::survey::{Group, Survey};
use super::{Document, GltfError, Selector};
use secateur_model::Budget;

/// What a part is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// Its triangles are leaves.
    Leaf,
    /// Other surface of the plant: wood, a pot, fruit.
    Wood,
    /// The part stays as it is.
    NotPlant(NotPlant),
}

/// Why a part is not the plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum NotPlant {
    /// What the plant stands on.
    Ground,
    /// A shape that things bump into.
    Collision,
    /// Where things may walk.
    Navigation,
    /// What hides other things.
    Occlusion,
    /// What its engine is asked not to import.
    NotImported,
    /// What a selector of [`Document::with_not_plant`] names.
    Named,
}

impl fmt::Display for NotPlant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ground => "ground",
            Self::Collision => "collision",
            Self::Navigation => "navigation",
            Self::Occlusion => "occlusion",
            Self::NotImported => "not imported",
            Self::Named => "named so",
        })
    }
}

impl NotPlant {
    /// The reason, as a phrase for people.
    pub(crate) fn reason(self) -> &'static str {
        match self {
            Self::Ground => "it is flat, and the plant stands on it (ground)",
            Self::Collision => "its node is a collision shape by name",
            Self::Navigation => "its node is a navigation mesh by name",
            Self::Occlusion => "its node is an occluder by name",
            Self::NotImported => "its node is not to be imported by name",
            Self::Named => "it was named as not the plant",
        }
    }
}

/// The parts of a file by what they are.
pub(crate) struct SortedParts {
    /// The parts of the plant; none is a leaf yet.
    pub(crate) plant: Vec<Part>,
    /// The survey of these.
    pub(crate) survey: Survey,
    /// The parts that are not the plant.
    pub(crate) others: Vec<Part>,
    /// What is left to read more with.
    pub(crate) budget: Budget,
}

impl Document {
    /// What these selectors name is not the plant: it stays as it is, and is neither drawn, counted nor changed,
    /// whatever else names it. Pieces that are named become a primitive of their own.
    ///
    /// # Errors
    /// [`GltfError`] if pieces are named that are not there, or their primitive can't be read.
    pub fn with_not_plant(mut self, selectors: &[Selector]) -> Result<Self, GltfError> {
        let parted = self.part_pieces(selectors);
        parted.map_err(|fault| self.error(fault))?;
        self.not_plant = selectors.to_vec();
        Ok(self)
    }

    /// The parts with their roles, but for leaves. A selector that matches nothing else makes a part the plant's.
    pub(crate) fn sorted_parts(&self, selectors: &[Selector]) -> Result<SortedParts, Fault> {
        let mut parts = self.parts()?;
        let mut budget = self.budget;
        let survey = self.survey(&parts, &mut budget)?;
        self.find_helpers(&mut parts, &survey)?;
        self.find_ground(&mut parts, &survey, budget)?;
        let selectors = match selectors {
            [] => &self.selectors,
            given => given,
        };
        for part in &mut parts {
            if self.is_marked(part.mesh, part.primitive) {
                part.role = Role::NotPlant(NotPlant::Named);
            }
        }
        self.keep_named(&mut parts, &survey, selectors);
        self.leave_out_named(&mut parts, &survey)?;
        let is_plant = |part: &Part| part.role == Role::Wood;
        let shows_something = |(part, group): (&Part, &usize)| {
            is_plant(part) && !survey.groups[*group].geometry.triangles.is_empty()
        };
        if parts.iter().all(is_plant) {
            return Ok(SortedParts {
                plant: parts,
                survey,
                others: Vec::new(),
                budget,
            });
        }
        // Where nothing else is there, that is the plant.
        let is_left = parts.iter().zip(&survey.group_of_part).any(shows_something);
        if !is_left && self.not_plant.is_empty() {
            parts.iter_mut().for_each(|part| part.role = Role::Wood);
        }
        drop(survey);
        let (plant, others): (Vec<Part>, Vec<Part>) = parts.into_iter().partition(is_plant);
        let mut budget = self.budget;
        Ok(SortedParts {
            survey: self.survey(&plant, &mut budget)?,
            plant,
            others,
            budget,
        })
    }

    /// The parts of a scene that may be anything, and their survey: all but helpers.
    pub(crate) fn scene_parts(&self) -> Result<(Vec<Part>, Survey, Budget), Fault> {
        let mut parts = self.parts()?;
        let mut budget = self.budget;
        let survey = self.survey(&parts, &mut budget)?;
        self.find_helpers(&mut parts, &survey)?;
        if parts.iter().all(|part| part.role == Role::Wood) {
            return Ok((parts, survey, budget));
        }
        parts.retain(|part| part.role == Role::Wood);
        let mut budget = self.budget;
        let survey = self.survey(&parts, &mut budget)?;
        Ok((parts, survey, budget))
    }

    /// Gives helpers, and all below their nodes, their role.
    fn find_helpers(&self, parts: &mut [Part], survey: &Survey) -> Result<(), Fault> {
        let mut helpers: HashMap<usize, Helper<'_>> = HashMap::new();
        let placed = self.placed_nodes()?;
        for node in &placed {
            let above = node.parent.and_then(|parent| helpers.get(&parent).copied());
            let helper = above.or_else(|| helper_names::read(self.label("nodes", node.index).name));
            helpers.extend(helper.map(|helper| (node.index, helper)));
        }
        if helpers.is_empty() {
            return Ok(());
        }
        let others = placed
            .iter()
            .filter(|node| !helpers.contains_key(&node.index));
        let names: Vec<&str> = others
            .map(|node| self.label("nodes", node.index).name)
            .collect();
        let helps_another = |stem: &str| names.iter().any(|name| name.starts_with(stem));
        for (part, &group) in parts.iter_mut().zip(&survey.group_of_part) {
            let Some(helper) = helpers.get(&part.node) else {
                continue;
            };
            // `Trunk-col`, textured, without another `Trunk`, is a trunk that things bump into.
            let has_texture = survey.groups[group].look.texture.is_some();
            let is_drawn = helper
                .drawn_as
                .is_some_and(|stem| has_texture && !helps_another(stem));
            if !is_drawn {
                part.role = Role::NotPlant(helper.kind);
            }
        }
        Ok(())
    }

    /// Gives ground its role: flat pieces under a hundredth of the height of what is drawn thick, and more than
    /// half as wide and as deep, on which something else stands. Cut-out cards are none.
    fn find_ground(
        &self,
        parts: &mut [Part],
        survey: &Survey,
        budget: Budget,
    ) -> Result<(), Fault> {
        let extents: Vec<Extent> = parts
            .iter()
            .zip(&survey.group_of_part)
            .map(|(part, &group)| match part.role {
                Role::NotPlant(_) => Extent::NOTHING,
                Role::Leaf | Role::Wood => Extent::of(part, &survey.groups[group]),
            })
            .collect();
        let all = Extent::around(extents.iter());
        let mut pictures = Pictures::new(self, budget);
        let mut is_ground = vec![false; parts.len()];
        for (number, (part, &group)) in parts.iter().zip(&survey.group_of_part).enumerate() {
            let group = &survey.groups[group];
            is_ground[number] = extents[number].lies_flat_under(&all)
                && has_wide_piece(part, group, &all)
                && !is_cut_out(group, &mut pictures)?;
        }
        let which = |wanted: bool| {
            let chosen = extents.iter().zip(&is_ground);
            Extent::around(
                chosen
                    .filter(|(_, is)| **is == wanted)
                    .map(|(extent, _)| extent),
            )
        };
        let rest = which(false);
        for (number, part) in parts.iter_mut().enumerate() {
            if is_ground[number] && rest.stands_on(&extents[number], &all) {
                part.role = Role::NotPlant(NotPlant::Ground);
            }
        }
        Ok(())
    }

    /// Takes parts for the plant's that a selector names and that matches nothing else.
    fn keep_named(&self, parts: &mut [Part], survey: &Survey, selectors: &[Selector]) {
        for selector in selectors {
            let matches = |part: &Part, group: usize| {
                selector.matches(self.labels(&survey.groups[group], part.node))
            };
            let named: Vec<usize> = (0..parts.len())
                .filter(|&k| matches(&parts[k], survey.group_of_part[k]))
                .collect();
            let is_other = |&k: &usize| matches!(parts[k].role, Role::NotPlant(_));
            if named.iter().all(is_other) {
                named.into_iter().for_each(|k| parts[k].role = Role::Wood);
            }
        }
    }

    /// Gives what was named as not the plant its role. Levels of a plant may lack it.
    fn leave_out_named(&self, parts: &mut [Part], survey: &Survey) -> Result<(), Fault> {
        for part in &mut *parts {
            let half = self.halves.get(&[part.mesh, part.primitive]);
            if half.is_some_and(|half| !half.is_plant) {
                part.role = Role::NotPlant(NotPlant::Named);
            }
        }
        let of_parts = self.not_plant.iter().filter(|named| !named.is_of_pieces());
        for selector in of_parts {
            let mut is_there = self.known_roles.is_some();
            for (part, &group) in parts.iter_mut().zip(&survey.group_of_part) {
                if selector.matches(self.labels(&survey.groups[group], part.node)) {
                    part.role = Role::NotPlant(NotPlant::Named);
                    is_there = true;
                }
            }
            if !is_there {
                return Err(choice::matches_nothing(self, survey, selector).into());
            }
        }
        Ok(())
    }

    /// What is not the plant, in sentences: nodes with the reason, and pieces that were named.
    pub(crate) fn notes_of_others(&self, others: &[Part]) -> Vec<String> {
        let halves = self.halves.values().filter(|half| !half.is_plant);
        let of_pieces = match halves.map(|half| half.pieces.len()).sum() {
            0 => None,
            1 => Some("1 piece is no plant and stays as it is".to_owned()),
            many => Some(format!("{many} pieces are no plant and stay as they are")),
        };
        let of_nodes = self.note_of_other_nodes(others);
        of_nodes.into_iter().chain(of_pieces).collect()
    }

    fn note_of_other_nodes(&self, others: &[Part]) -> Option<String> {
        const SHOWN: usize = 12;
        let mut of_nodes: BTreeMap<usize, NotPlant> = BTreeMap::new();
        for part in others {
            if self.halves.contains_key(&[part.mesh, part.primitive]) {
                continue;
            }
            if let Role::NotPlant(why) = part.role {
                of_nodes.entry(part.node).or_insert(why);
            }
        }
        let named = of_nodes.iter().take(SHOWN);
        let named = named.map(|(&node, why)| format!("{} ({why})", self.label("nodes", node)));
        let mut named: Vec<String> = named.collect();
        if of_nodes.len() > SHOWN {
            named.push(format!("and {} more", of_nodes.len() - SHOWN));
        }
        let named = named.join(", ");
        match of_nodes.len() {
            0 => None,
            1 => Some(format!("1 node is no plant and stays as it is: {named}")),
            many => Some(format!(
                "{many} nodes are no plant and stay as they are: {named}"
            )),
        }
    }
}

/// Whether a single piece of a part is more than half as wide and as deep as all that is drawn: many small
/// flat pieces, such as leaves on water, are no ground.
fn has_wide_piece(part: &Part, group: &Group, all: &Extent) -> bool {
    let geometry = &group.geometry;
    geometry.pieces().iter().any(|piece| {
        let corners = piece.iter().flat_map(|&t| geometry.triangles[t as usize]);
        Extent::of_corners(part, group, corners).is_wide_in(all)
    })
}

/// Whether the alpha of its texture takes anything away.
fn is_cut_out(group: &Group, pictures: &mut Pictures<'_>) -> Result<bool, Fault> {
    let look = &group.look;
    let image = look.texture.and_then(|texture| texture.image);
    let (Some(cutoff), Some(image)) = (cutoff(look), image) else {
        return Ok(false);
    };
    Ok(match pictures.get(image)? {
        Decoded::Picture(picture) => (0..=u8::MAX).any(|alpha| {
            picture.tally.texels(alpha) > 0 && !is_kept(alpha, look.base_color[3], cutoff)
        }),
        Decoded::Unusable(_) => true,
    })
}

/// The lowest and the highest corner of something, in world units.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Extent {
    low: DVec3,
    high: DVec3,
}

impl Extent {
    const NOTHING: Self = Self {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
    };

    fn of(part: &Part, group: &Group) -> Self {
        let corners = group.geometry.triangles.as_flattened().iter().copied();
        Self::of_corners(part, group, corners)
    }

    fn of_corners(part: &Part, group: &Group, corners: impl Iterator<Item = u32>) -> Self {
        let world = |corner: u32| {
            let local = group.geometry.positions[corner as usize];
            part.world_from_local.transform_point3(local)
        };
        corners.map(world).fold(Self::NOTHING, |extent, p| Self {
            low: extent.low.min(p),
            high: extent.high.max(p),
        })
    }

    fn around<'a>(extents: impl Iterator<Item = &'a Self>) -> Self {
        extents.fold(Self::NOTHING, |all, extent| Self {
            low: all.low.min(extent.low),
            high: all.high.max(extent.high),
        })
    }

    fn size(&self) -> DVec3 {
        self.high - self.low
    }

    fn is_wide_in(&self, all: &Self) -> bool {
        let (own, whole) = (self.size(), all.size());
        own.x > 0.5 * whole.x && own.z > 0.5 * whole.z
    }

    fn lies_flat_under(&self, all: &Self) -> bool {
        self.size().y < 0.01 * all.size().y && self.is_wide_in(all)
    }

    /// Whether this is no flat thing itself, is over the ground for the most part, and not beside it.
    fn stands_on(&self, ground: &Self, all: &Self) -> bool {
        let middle = 0.5 * (self.low + self.high);
        let is_within = |k: usize| (ground.low[k]..=ground.high[k]).contains(&middle[k]);
        self.size().y >= 0.01 * all.size().y
            && middle.y > ground.high.y
            && is_within(0)
            && is_within(2)
    }
}

/// The nodes that draw nothing of the plant.
pub(crate) fn nodes_without_plant(plant: &[Part], others: &[Part]) -> Vec<usize> {
    let mut nodes: Vec<usize> = others.iter().map(|part| part.node).collect();
    nodes.dedup();
    nodes.retain(|node| !plant.iter().any(|part| part.node == *node));
    nodes
}

/// The numbers of the primitives that are not the plant, of a node that draws the plant too.
pub(crate) fn primitives_beside_plant(others: &[Part], node: usize) -> Vec<usize> {
    let of_node = others.iter().filter(|part| part.node == node);
    let mut primitives: Vec<usize> = of_node.map(|part| part.primitive).collect();
    primitives.sort_unstable();
    primitives.dedup();
    primitives
}

/// A mesh with these primitives only.
pub(crate) fn mesh_of(mesh: &Value, primitives: &[usize]) -> Value {
    let mut only = mesh.clone();
    if let Some(all) = only.get_mut("primitives").and_then(Value::as_array_mut) {
        let mut number = 0..;
        all.retain(|_| number.next().is_some_and(|n| primitives.contains(&n)));
    }
    only
}
