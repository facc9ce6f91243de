//! Fills an [`Inspection`](crate::Inspection) from a loaded tree.

use glam::DVec3;

use super::error::Fault;
use super::evidence::{Evidence, Reason, strongest_first};
use super::inspection::{FoliageReport, PrimitiveReport, Spread, TakenFor};
use super::parts::Part;
use super::roles::{NotPlant, Role};
use super::survey::{Group, Survey};
use super::{Document, Inspection, Selector};
use secateur_model::{AlphaMode, Foliage};

impl Document {
    /// What can be told without looking at the geometry.
    pub(crate) fn blank_inspection(&self) -> Inspection {
        let text = |value: &serde_json::Value| value.as_str().map(str::to_owned);
        let extensions = self.root.get("extensionsUsed").and_then(|e| e.as_array());
        Inspection {
            file: self.name.clone(),
            generator: self.root["asset"].get("generator").and_then(text),
            extensions: extensions.into_iter().flatten().filter_map(text).collect(),
            ..Inspection::default()
        }
    }
}

/// Reports the primitives and counts the wood.
pub(crate) fn primitives(
    inspection: &mut Inspection,
    document: &Document,
    survey: &Survey,
    parts: &[Part],
    evidence: Vec<Evidence>,
    selectors: &[Selector],
) {
    let mut foliage_placements = vec![0usize; survey.groups.len()];
    let mut wood_pieces = vec![[0u64; 2]; survey.groups.len()];
    for (part, &group) in parts.iter().zip(&survey.group_of_part) {
        foliage_placements[group] += usize::from(part.role == Role::Leaf);
        let pieces = survey.groups[group].geometry.pieces().iter();
        if let Some(is_wood) = &part.wood_pieces {
            let wood = pieces.zip(&**is_wood).filter(|(_, is_wood)| **is_wood);
            let [count, triangles] = &mut wood_pieces[group];
            for (piece, _) in wood {
                *count += 1;
                *triangles += piece.len() as u64;
            }
        }
    }
    let groups = survey.groups.iter().zip(evidence);
    let counted = foliage_placements.into_iter().zip(wood_pieces);
    for ((group, evidence), (as_foliage, [pieces, triangles])) in groups.zip(counted) {
        let mut reasons = evidence.reasons;
        if pieces > 0 {
            let pieces = pieces / as_foliage as u64;
            let text = match selectors.is_empty() {
                true => format!("{pieces} of its pieces are wood: round, large and without holes"),
                false => format!("{pieces} of its pieces were not named"),
            };
            reasons.push(Reason::of_role(&text));
        }
        strongest_first(&mut reasons);
        let wood_placements = (group.placements - as_foliage) as u64;
        inspection.wood_triangles +=
            wood_placements * group.geometry.triangles.len() as u64 + triangles;
        inspection.primitives.push(PrimitiveReport {
            taken_for: match pieces {
                0 => taken_for(group, as_foliage),
                _ => TakenFor::FoliageInPart,
            },
            chosen_by_user: !selectors.is_empty(),
            points: reasons.iter().map(|r| r.points).sum(),
            reasons,
            ..described(document, group)
        });
    }
}

fn taken_for(group: &Group, as_foliage: usize) -> TakenFor {
    if group.geometry.triangles.is_empty() {
        TakenFor::Nothing
    } else if as_foliage == group.placements {
        TakenFor::Foliage
    } else if as_foliage > 0 {
        TakenFor::FoliageInPart
    } else {
        TakenFor::Wood
    }
}

fn described(document: &Document, group: &Group) -> PrimitiveReport {
    const NODES_SHOWN: usize = 3;
    let labels = document.labels(group, group.nodes[0]);
    let label = |&node: &usize| document.label("nodes", node).to_string();
    let mut nodes: Vec<String> = group.nodes.iter().take(NODES_SHOWN).map(label).collect();
    if group.nodes.len() > NODES_SHOWN {
        nodes.push(format!("and {} more", group.nodes.len() - NODES_SHOWN));
    }
    PrimitiveReport {
        place: document.primitive_place(group.mesh, group.primitive),
        material: labels.material.to_string(),
        alpha_mode: match group.look.alpha_mode {
            AlphaMode::Opaque => "OPAQUE",
            AlphaMode::Mask(_) => "MASK",
            AlphaMode::Blend => "BLEND",
        },
        mesh: labels.mesh.to_string(),
        nodes,
        placements: group.placements as u64,
        triangles: group.geometry.triangles.len() as u64,
        pieces: group.geometry.pieces().len() as u64,
        taken_for: TakenFor::Nothing,
        chosen_by_user: false,
        points: 0.0,
        reasons: Vec::new(),
    }
}

/// Reports what is not the plant.
pub(crate) fn others(
    inspection: &mut Inspection,
    document: &Document,
    others: &[Part],
) -> Result<(), Fault> {
    if others.is_empty() {
        return Ok(());
    }
    let mut budget = document.budget;
    let survey = document.survey(others, &mut budget)?;
    for (number, group) in survey.groups.iter().enumerate() {
        let of_group = others.iter().zip(&survey.group_of_part);
        let mut reasons: Vec<Reason> = Vec::new();
        let mut is_named = false;
        for (part, _) in of_group.filter(|(_, of)| **of == number) {
            if let Role::NotPlant(why) = part.role {
                is_named |= why == NotPlant::Named;
                let reason = Reason::of_role(why.reason());
                if !reasons.contains(&reason) {
                    reasons.push(reason);
                }
            }
        }
        inspection.primitives.push(PrimitiveReport {
            taken_for: TakenFor::NotPlant,
            chosen_by_user: is_named,
            reasons,
            ..described(document, group)
        });
    }
    inspection.notes.extend(document.notes_of_others(others));
    Ok(())
}

/// Measures everything of the plant that is drawn.
pub(crate) fn extents(inspection: &mut Inspection, survey: &Survey, parts: &[Part]) {
    let mut low = DVec3::INFINITY;
    let mut high = DVec3::NEG_INFINITY;
    for (part, &group) in parts.iter().zip(&survey.group_of_part) {
        let geometry = &survey.groups[group].geometry;
        for &corner in geometry.triangles.as_flattened() {
            let local = geometry.positions[corner as usize];
            let p = part.world_from_local.transform_point3(local);
            (low, high) = (low.min(p), high.max(p));
        }
    }
    if low.is_finite() && high.is_finite() {
        inspection.extents = Some([low.to_array(), high.to_array()]);
    }
}

/// Counts and measures the leaves of a foliage that was found.
pub(crate) fn foliage(inspection: &mut Inspection, foliage: &Foliage) {
    let leaves = foliage.leaves();
    let ids = (0..leaves.len()).map(secateur_model::LeafId::from_index);
    let sizes = ids
        .map(|id| foliage.triangles_of(id).len() as f64)
        .collect();
    let areas = leaves.iter().map(|leaf| leaf.area()).collect();
    let (Some(triangles_per_leaf), Some(leaf_area)) = (Spread::of(sizes), Spread::of(areas)) else {
        return;
    };
    inspection.foliage = Some(FoliageReport {
        leaves: leaves.len() as u64,
        triangles: foliage.triangles().len() as u64,
        triangles_per_leaf,
        leaf_area,
        mask_coverage: foliage.cutouts().iter().map(|c| c.coverage()).collect(),
    });
}
