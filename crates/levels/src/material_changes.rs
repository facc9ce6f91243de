//! All that changes in the materials of a level.

use std::collections::HashMap;
use std::sync::Arc;

use secateur_gltf::Cutoffs;
use secateur_model::Texture;

use crate::{ChosenCutoffs, Dilated};

/// Chosen cutoffs with textures whose clear texels have the colours of leaves, or a raised alpha, or both.
pub fn material_changes(chosen: Option<&ChosenCutoffs>, dilated: &[Dilated]) -> Cutoffs {
    let raised = chosen.map_or(&[][..], |chosen| &chosen.raised);
    let colors_of = |material| dilated.iter().find(|one| one.material == material);
    // Materials that share an image share what becomes of it.
    let mut joined: HashMap<[*const Texture; 2], Arc<Texture>> = HashMap::new();
    let mut texels = Vec::new();
    for one in raised {
        let texture = match colors_of(one.material) {
            Some(colors) => joined
                .entry([&colors.texture, &one.texture].map(Arc::as_ptr))
                .or_insert_with(|| Arc::new(with_alpha(&colors.texture, &one.texture)))
                .clone(),
            None => one.texture.clone(),
        };
        texels.push((one.material, texture));
    }
    let is_raised = |material| raised.iter().any(|one| one.material == material);
    let others = dilated.iter().filter(|one| !is_raised(one.material));
    texels.extend(others.map(|one| (one.material, one.texture.clone())));
    let cutoffs = chosen.map(|chosen| chosen.cutoffs.clone());
    let cutoffs = cutoffs.unwrap_or_default();
    cutoffs.with_texels(texels)
}

/// The colours of one texture with the alpha of another of the same size.
fn with_alpha(colors: &Texture, alpha: &Texture) -> Texture {
    let texels = colors.rgba.chunks_exact(4).zip(alpha.rgba.chunks_exact(4));
    Texture {
        rgba: texels.flat_map(|(c, a)| [c[0], c[1], c[2], a[3]]).collect(),
        ..colors.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Raised;
    use secateur_model::{Filters, Wrap};

    fn texture(texel: [u8; 4]) -> Arc<Texture> {
        Arc::new(Texture {
            width: 1,
            height: 1,
            rgba: texel.into(),
            wrap: [Wrap::Repeat; 2],
            filters: Filters::default(),
        })
    }

    #[test]
    fn colours_and_alpha_are_joined() {
        let dilated = |material| Dilated {
            material,
            texture: texture([1, 2, 3, 0]),
            difference: 9.0,
        };
        let raised = |material| Raised {
            material,
            texture: texture([7, 8, 9, 80]),
        };
        let chosen = ChosenCutoffs {
            cutoffs: Cutoffs::new([(1, 0.4)]),
            times: 0.8,
            raised: vec![raised(1), raised(2)],
            raised_share: Some(0.7),
            coverage: Vec::new(),
        };
        let changes = material_changes(Some(&chosen), &[dilated(2), dilated(3)]);
        let expected = Cutoffs::new([(1, 0.4)]).with_texels([
            (1, texture([7, 8, 9, 80])),
            (2, texture([1, 2, 3, 80])),
            (3, texture([1, 2, 3, 0])),
        ]);
        assert_eq!(changes, expected);
        assert!(material_changes(None, &[]).is_empty());
    }
}
