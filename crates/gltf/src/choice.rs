//! Choosing the foliage: what the user names, or what the evidence says.

use std::collections::HashMap;

use super::Document;
use super::error::Problem;
use super::evidence::{FOLIAGE_POINTS, Reason, WOOD_POINTS};
use super::parts::Part;
use super::roles::Role;
use super::selector::Selector;
use super::survey::{Group, Survey};

/// What a group's evidence says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    Foliage,
    Unclear,
    Wood,
    /// Points, lines or nothing.
    NoTriangles,
}

/// What each group's evidence says.
pub(crate) fn judge(groups: &[Group], reasons: &[Vec<Reason>]) -> Vec<Verdict> {
    let verdict = |(group, reasons): (&Group, &Vec<Reason>)| {
        let points: f64 = reasons.iter().map(|r| r.points).sum();
        if group.geometry.triangles.is_empty() {
            Verdict::NoTriangles
        } else if points >= FOLIAGE_POINTS {
            Verdict::Foliage
        } else if points > WOOD_POINTS {
            Verdict::Unclear
        } else {
            Verdict::Wood
        }
    };
    groups.iter().zip(reasons).map(verdict).collect()
}

/// Marks the parts that are foliage: those that a selector names, or, without
/// selectors, those whose evidence is clear.
pub(crate) fn choose(
    document: &Document,
    survey: &Survey,
    verdicts: &[Verdict],
    selectors: &[Selector],
    parts: &mut [Part],
) -> Result<(), Problem> {
    if selectors.is_empty() {
        for (part, &group) in parts.iter_mut().zip(&survey.group_of_part) {
            if verdicts[group] == Verdict::Foliage {
                part.role = Role::Leaf;
            }
        }
        return check_found(document, survey, verdicts);
    }
    let mut has_match = vec![false; selectors.len()];
    for (part, &group) in parts.iter_mut().zip(&survey.group_of_part) {
        let labels = document.labels(&survey.groups[group], part.node);
        for (selector, has_match) in selectors.iter().zip(&mut has_match) {
            if selector.matches(labels) {
                part.role = Role::Leaf;
                *has_match = true;
            }
        }
    }
    match has_match.iter().position(|has_match| !has_match) {
        Some(unmatched) => Err(Problem::SelectorMatchesNothing {
            selector: selectors[unmatched].to_string(),
            known: known_like(document, survey, &selectors[unmatched]),
        }),
        None => Ok(()),
    }
}

fn check_found(document: &Document, survey: &Survey, verdicts: &[Verdict]) -> Result<(), Problem> {
    if verdicts.contains(&Verdict::Foliage) {
        return Ok(());
    }
    let unclear = candidates(document, survey, |k| verdicts[k] == Verdict::Unclear);
    if !unclear.is_empty() {
        return Err(Problem::AmbiguousFoliage {
            candidates: unclear,
        });
    }
    Err(Problem::NoFoliage {
        candidates: candidates(document, survey, |k| verdicts[k] == Verdict::Wood),
    })
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
/// material.
fn candidates(document: &Document, survey: &Survey, wanted: impl Fn(usize) -> bool) -> Vec<String> {
    let groups = &survey.groups;
    let mut sharing: HashMap<Option<usize>, usize> = HashMap::new();
    for group in groups {
        *sharing.entry(group.look.material).or_default() += 1;
    }
    let mut found = Vec::new();
    for (_, group) in groups.iter().enumerate().filter(|(k, _)| wanted(*k)) {
        let labels = document.labels(group, group.nodes[0]);
        let selector = if sharing[&group.look.material] == 1 {
            Selector::Material(labels.material.to_string())
        } else {
            Selector::Mesh(labels.mesh.to_string())
        };
        let text = selector.to_string();
        if !found.contains(&text) {
            found.push(text);
        }
        if found.len() > LONGEST_LIST {
            break;
        }
    }
    shorten(found)
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
