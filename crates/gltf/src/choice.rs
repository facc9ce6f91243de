//! Choosing the foliage: what the user names, or what the evidence says.

use std::collections::HashMap;
use std::sync::Arc;

use super::Document;
use super::error::Problem;
use super::evidence::{Evidence, FOLIAGE_POINTS, WOOD_POINTS};
use super::parts::Part;
use super::roles::Role;
use super::selector::Selector;
use super::survey::{Group, Survey};

/// What a group's evidence says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    Foliage,
    /// Cut out, and nothing else is clearly foliage.
    FoliageForWantOfOther,
    Unclear,
    Wood,
    /// Points, lines or nothing.
    NoTriangles,
}

/// What each group's evidence says.
///
/// A cut-out texture that leaves the rest open decides where nothing else is clearly foliage. A primitive of leaves
/// and wood in one is foliage with pieces of wood.
pub(crate) fn judge(groups: &[Group], evidence: &[Evidence]) -> Vec<Verdict> {
    let verdict = |(group, evidence): (&Group, &Evidence)| {
        let points: f64 = evidence.reasons.iter().map(|r| r.points).sum();
        if group.geometry.triangles.is_empty() {
            Verdict::NoTriangles
        } else if points >= FOLIAGE_POINTS || (evidence.is_cut_out && evidence.is_mixed) {
            Verdict::Foliage
        } else if points > WOOD_POINTS {
            Verdict::Unclear
        } else {
            Verdict::Wood
        }
    };
    let mut verdicts: Vec<Verdict> = groups.iter().zip(evidence).map(verdict).collect();
    if !verdicts.contains(&Verdict::Foliage) {
        for (verdict, evidence) in verdicts.iter_mut().zip(evidence) {
            if *verdict == Verdict::Unclear && evidence.is_cut_out {
                *verdict = Verdict::FoliageForWantOfOther;
            }
        }
    }
    verdicts
}

impl Verdict {
    fn is_foliage(self) -> bool {
        match self {
            Self::Foliage | Self::FoliageForWantOfOther => true,
            Self::Unclear | Self::Wood | Self::NoTriangles => false,
        }
    }
}

/// Marks the parts that are foliage: those that a selector names, or, without
/// selectors, those that are known to be or whose evidence is clear; there may be none.
pub(crate) fn choose(
    document: &Document,
    survey: &Survey,
    verdicts: &[Verdict],
    selectors: &[Selector],
    parts: &mut [Part],
) -> Result<(), Problem> {
    if document.deciding(selectors).is_empty() {
        for (part, &group) in parts.iter_mut().zip(&survey.group_of_part) {
            let labels = document.labels(&survey.groups[group], part.node);
            let known = document.known_roles.as_ref();
            let known = known.and_then(|known| known.role(labels));
            let of_evidence = match verdicts[group].is_foliage() {
                true => Role::Leaf,
                false => Role::Wood,
            };
            part.role = known.unwrap_or(of_evidence);
        }
        return Ok(());
    }
    let mut has_match = vec![false; selectors.len()];
    let wood_pieces = unnamed_pieces(document, survey, selectors, &mut has_match);
    for (part, &group) in parts.iter_mut().zip(&survey.group_of_part) {
        let labels = document.labels(&survey.groups[group], part.node);
        for (selector, has_match) in selectors.iter().zip(&mut has_match) {
            if selector.matches(labels) {
                part.role = Role::Leaf;
                *has_match = true;
            }
        }
        // All that is named may be not the plant.
        let of_group = wood_pieces[group].as_ref();
        let with_leaves = of_group.filter(|is_wood| is_wood.contains(&false));
        if let (Role::Wood, Some(is_wood)) = (part.role, with_leaves) {
            part.role = Role::Leaf;
            part.wood_pieces = is_wood.contains(&true).then(|| Arc::clone(is_wood));
        }
    }
    match has_match.iter().position(|has_match| !has_match) {
        Some(unmatched) => Err(matches_nothing(document, survey, &selectors[unmatched])),
        None => Ok(()),
    }
}

/// By group, where a selector names pieces of it: whether each piece is none of them.
fn unnamed_pieces(
    document: &Document,
    survey: &Survey,
    selectors: &[Selector],
    has_match: &mut [bool],
) -> Vec<Option<Arc<[bool]>>> {
    let of_group = |group: &Group| {
        let mut is_wood: Option<Vec<bool>> = None;
        for (selector, has_match) in selectors.iter().zip(&mut *has_match) {
            let &Selector::Pieces {
                mesh,
                primitive,
                first,
                last,
            } = selector
            else {
                continue;
            };
            if mesh as usize != group.mesh {
                continue;
            }
            let count = || group.geometry.pieces().len();
            let (source, of) = match document.halves.get(&[group.mesh, group.primitive]) {
                Some(half) => (half.source, half.of),
                None if primitive as usize == group.primitive => (group.primitive, count()),
                None => continue,
            };
            if primitive as usize == source && (last as usize) < of {
                *has_match = true;
                let number = |k| document.piece_number(group.mesh, group.primitive, k);
                let is_wood = is_wood.get_or_insert_with(|| vec![true; count()]);
                let named = is_wood.iter_mut().enumerate();
                named
                    .filter(|(k, _)| (first..=last).contains(&number(*k)))
                    .for_each(|(_, is_wood)| *is_wood = false);
            }
        }
        is_wood.map(Arc::from)
    };
    survey.groups.iter().map(of_group).collect()
}

/// What the user could name where no leaves were found: what may be some, or else all of the plant; nothing where it
/// has no triangles. Bark is never named.
pub(crate) fn advice(document: &Document, survey: &Survey, verdicts: &[Verdict]) -> Vec<String> {
    let unclear = candidates(document, survey, |k| verdicts[k] == Verdict::Unclear);
    let has_triangles = verdicts.iter().any(|v| *v != Verdict::NoTriangles);
    match unclear.is_empty() && has_triangles {
        true => vec![Selector::All.to_string()],
        false => unclear,
    }
}

/// Errors stay sentences: longer lists end in `...`.
const LONGEST_LIST: usize = 12;

fn shorten(mut list: Vec<String>) -> Vec<String> {
    if list.len() > LONGEST_LIST {
        list.truncate(LONGEST_LIST);
        list.push("...".to_owned());
    }
    list
}

/// Selectors for groups: by material, or by mesh where other groups share the
/// material. Many whose names differ in their last number are one with a wildcard, if it names nothing else.
fn candidates(document: &Document, survey: &Survey, wanted: impl Fn(usize) -> bool) -> Vec<String> {
    let groups = &survey.groups;
    let mut sharing: HashMap<Option<usize>, usize> = HashMap::new();
    for group in groups {
        *sharing.entry(group.look.material).or_default() += 1;
    }
    let selector = |group: &Group| {
        let labels = document.labels(group, group.nodes[0]);
        match sharing[&group.look.material] {
            1 => Selector::Material(labels.material.to_string()),
            _ => Selector::Mesh(labels.mesh.to_string()),
        }
    };
    let (of_wanted, others): (Vec<_>, Vec<_>) =
        groups.iter().enumerate().partition(|(k, _)| wanted(*k));
    let of_wanted = of_wanted.into_iter();
    let of_wanted: Vec<String> = of_wanted
        .map(|(_, group)| selector(group).to_string())
        .collect();
    let names_other = |wildcard: &Selector| {
        let is_named = |(_, group): &(usize, &Group)| {
            let mut nodes = group.nodes.iter();
            nodes.any(|node| wildcard.matches(document.labels(group, *node)))
        };
        others.iter().any(is_named)
    };
    let in_one = |name: &String| {
        let stem = without_number(name);
        let is_many = of_wanted
            .iter()
            .filter(|other| other.starts_with(stem))
            .count()
            >= LEAST_FOR_WILDCARD;
        let wildcard: Selector = format!("{stem}*").parse().ok()?;
        (is_many && !names_other(&wildcard)).then(|| wildcard.to_string())
    };
    let mut found: Vec<String> = Vec::new();
    for name in &of_wanted {
        let text = in_one(name).unwrap_or_else(|| name.clone());
        if !found.contains(&text) {
            found.push(text);
        }
        if found.len() > LONGEST_LIST {
            break;
        }
    }
    shorten(found)
}

/// So many names or more that differ in their last number are one with a wildcard.
const LEAST_FOR_WILDCARD: usize = 3;

/// A selector without the number at the end of its name; all of it where nothing of the name would be left.
fn without_number(selector: &str) -> &str {
    let stem = selector.trim_end_matches(|c: char| c.is_ascii_digit());
    match stem.ends_with([':', '#']) {
        true => selector,
        false => stem,
    }
}

/// Why a selector that matches nothing is refused, with what it could name.
pub(crate) fn matches_nothing(
    document: &Document,
    survey: &Survey,
    selector: &Selector,
) -> Problem {
    Problem::SelectorMatchesNothing {
        selector: selector.to_string(),
        known: known_like(document, survey, selector),
    }
}

/// What a selector of this kind could name.
fn known_like(document: &Document, survey: &Survey, selector: &Selector) -> Vec<String> {
    let mut found = Vec::new();
    for group in &survey.groups {
        for &node in &group.nodes {
            let text = selector.same_kind(document.labels(group, node)).to_string();
            if found.len() <= LONGEST_LIST && !found.contains(&text) {
                found.push(text);
            }
        }
    }
    shorten(found)
}
