use super::*;
use glam::{DQuat, DVec3, EulerRot, Vec2};
use secateur_gltf::{Document, plant_to_glb};
use secateur_model::{Filters, Finish, Material, Plant, Texture, Wrap};
use std::sync::Arc;

/// A crown whose texture shows what `is_there`.
fn crown(is_there: impl Fn(u32, u32) -> bool) -> Tree {
    crown_of(1.0, |x, y| 255 * u8::from(is_there(x, y)))
}

/// Cards of this side in a ball of radius 10, whose texture of 256 x 256 texels has this alpha.
fn crown_of(side: f64, alpha: impl Fn(u32, u32) -> u8) -> Tree {
    let texel = |k: u32| [60, 140, 40, alpha(k % 256, k / 256)];
    let texture = Texture {
        width: 256,
        height: 256,
        rgba: (0..256 * 256).flat_map(texel).collect(),
        wrap: [Wrap::Repeat; 2],
        filters: Filters::default(),
    };
    let material = |name: &str, texture: Option<Texture>| {
        Arc::new(Material {
            name: name.to_owned(),
            base_color: [1.0; 4],
            alpha_mode: match texture {
                Some(_) => AlphaMode::Mask(0.5),
                None => AlphaMode::Opaque,
            },
            texture: texture.map(Arc::new),
            double_sided: true,
            finish: Finish::default(),
        })
    };
    let surface = |material| Surface::empty(material);
    let mut leaves = surface(material("leaves", Some(texture)));
    for k in 0..CARDS {
        let part = (f64::from(k) + 0.5) / f64::from(CARDS);
        let [a, b] = [2.4, 1.7].map(|angle| angle * f64::from(k));
        let turn = DQuat::from_euler(EulerRot::YXZ, a, b, 0.0);
        let centre = DVec3::Y * 12.0 + turn * DVec3::X * 9.0 * part.cbrt();
        let first = leaves.positions.len() as u32;
        for [u, v] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
            let corner = turn * DVec3::new(u - 0.5, 0.5 - v, 0.0) * side;
            leaves.positions.push(centre + corner);
            leaves.uvs.push(Vec2::new(u as f32, v as f32));
        }
        let quad = [[0, 1, 2], [0, 2, 3]];
        let quad = quad.map(|corners| corners.map(|corner| first + corner));
        leaves.triangles.extend(quad);
    }
    let mut wood = surface(material("bark", None));
    wood.positions = [[-0.1, 0.0], [0.1, 0.0], [0.0, 12.0]]
        .map(|[x, y]| DVec3::new(x, y, 0.0))
        .into();
    wood.triangles = vec![[0, 1, 2]];
    let plant = Plant {
        name: "crown".to_owned(),
        wood,
        leaves,
        triangles_per_leaf: vec![2; CARDS as usize],
        skeleton: None,
        holds: None,
    };
    let document = Document::from_bytes("crown.glb", plant_to_glb(&plant), None).unwrap();
    document.into_tree(&[]).unwrap()
}

const CARDS: u32 = 400;

/// All leaves but the first.
fn level(tree: &Tree) -> Lod {
    let count = tree.foliage().leaves().len();
    let mut order = secateur_model::RemovalOrder::new(count as u32);
    order.push_step(secateur_model::Step {
        removed: &[secateur_model::LeafId::from_index(0)],
        grown: &[],
        made: &[],
        survivors_area_scale: 1.0,
    });
    Lod::after(&order, 1)
}

fn chosen(tree: &Tree, lod: &Lod) -> Option<ChosenCutoffs> {
    choose_cutoffs(tree, lod, MaterialChange::Cutoffs).unwrap()
}

/// Stripes that get wider from one side to the other, up to a half: all mips are below that.
#[test]
fn a_crown_that_fades_gets_a_lower_cutoff() {
    let tree = crown(|x, _| x % 16 < x / 32);
    let found = chosen(&tree, &level(&tree)).unwrap();
    let own: Vec<(usize, f64)> = found.cutoffs.of_materials().collect();
    let [(1, cutoff)] = own[..] else {
        panic!("of the leaves alone: {own:?}");
    };
    assert!((0.1..0.45).contains(&cutoff), "{cutoff}");
    assert!((found.times - cutoff / 0.5).abs() < 1e-3);
    let far = found.coverage[2].1;
    assert!(far[0] < 0.5 && (0.7..1.2).contains(&far[1]), "{far:?}");
    // From a level that is the tree nothing is gone.
    let original = Lod::original(CARDS as usize);
    assert_eq!(chosen(&tree, &original), None);
}

/// Nearly half of each square of 8 x 8 texels is there: all coarse mip maps have that mean, and each
/// cutoff shows cards whole or not at all.
#[test]
fn what_no_cutoff_helps_is_read_without_mip_maps() {
    let tree = crown(|x, y| x % 8 < 6 && y % 8 < 5);
    let by = |change| choose_cutoffs(&tree, &level(&tree), change).unwrap();
    let off = |found: &ChosenCutoffs| {
        let off = |(_, [_, after]): &(u32, [f64; 2])| (after - 1.0).abs();
        found.coverage.iter().map(off).fold(0.0, f64::max)
    };
    let found = by(MaterialChange::CutoffsOrMips).unwrap();
    let without: Vec<usize> = found.cutoffs.materials_without_mips().collect();
    assert_eq!(without, [1], "the leaves alone");
    assert!(off(&found) < 0.05, "{found:?}");
    // The level that is written shows that much.
    let bytes = tree.lod_to_bytes_with(&level(&tree), &found.cutoffs);
    let document = Document::from_bytes("level.glb", bytes.unwrap(), None).unwrap();
    let drawn = document.drawn_as_one(Detail::Color).unwrap();
    let texture = |one: &DrawnSurface| one.surface.material.texture.clone();
    let textures: Vec<_> = drawn.iter().filter_map(texture).collect();
    assert_eq!(textures.len(), 1);
    assert_eq!(textures[0].filters.mips, Mips::None);
    // With mip maps some size stays far off, whatever the cutoff.
    let kept = by(MaterialChange::Cutoffs);
    assert!(kept.is_none_or(|kept| {
        kept.cutoffs.materials_without_mips().count() == 0 && off(&kept) > FAR_OFF
    }));

    // Two thirds are there: clients close the holes of the original too, and so show no specks of it.
    let tree = crown(|x, y| x % 8 < 6 && y % 8 < 7);
    let found = choose_cutoffs(&tree, &level(&tree), MaterialChange::CutoffsOrMips).unwrap();
    let without = found.unwrap().cutoffs;
    assert_eq!(without.materials_without_mips().count(), 1);
}

/// Wide stripes: close by clients show no more of them than there is, with fewer specks than without mip maps.
#[test]
fn mip_maps_stay_where_there_would_be_more_specks_than_of_the_original() {
    let tree = crown(|x, _| x % 128 < 70);
    let found = choose_cutoffs(&tree, &level(&tree), MaterialChange::CutoffsOrMips).unwrap();
    let without = |found: ChosenCutoffs| found.cutoffs.materials_without_mips().count();
    assert_eq!(found.map_or(0, without), 0);
}

/// Squares, of which clients show a third from afar, and larger ones, of which they show a quarter too much:
/// that outweighs some more specks close by.
#[test]
fn a_crown_that_vanishes_or_closes_may_show_more_specks_than_the_original() {
    for (side, shown) in [(64, 0.0..0.4), (96, 1.2..1.3)] {
        let tree = crown(|x, y| x % 128 < side && y % 128 < side);
        let found = choose_cutoffs(&tree, &level(&tree), MaterialChange::CutoffsOrMips);
        let found = found.unwrap().unwrap();
        assert_eq!(found.cutoffs.materials_without_mips().count(), 1);
        let [before, after] = found.coverage[2].1;
        assert!(shown.contains(&before), "{before}");
        assert!((after - 1.0).abs() < 0.05, "{after}");
    }
}

/// Large squares, of which clients show a twenty-fifth too much from afar: no cutoff helps, and without mip maps there are
/// hardly more specks.
#[test]
fn a_crown_that_is_off_by_more_than_three_per_cent_is_read_without_mip_maps() {
    let tree = crown(|x, y| x % 256 < 190 && y % 256 < 190);
    let found = choose_cutoffs(&tree, &level(&tree), MaterialChange::CutoffsOrMips);
    let found = found.unwrap().unwrap();
    assert_eq!(found.cutoffs.materials_without_mips().count(), 1);
    let [before, after] = found.coverage[2].1;
    assert!((1.03..1.06).contains(&before), "{before}");
    assert!((after - 1.0).abs() < 0.02, "{after}");
}

#[test]
fn cutoffs_for_mip_maps_stay_where_they_are_good_without_them() {
    assert!(do_no_harm(0.07, 0.2) && do_no_harm(0.01, 0.04));
    assert!(!do_no_harm(0.09, 0.2), "far off");
    assert!(!do_no_harm(0.07, 0.05), "mip maps would do better");
}

#[test]
fn more_specks_are_borne_with_where_the_level_is_not_tolerable() {
    let tree = crown(|x, y| x % 64 < 28 && y % 64 < 28);
    let original = tree.document().drawn_as_one(Detail::Color).unwrap();
    let surfaces: Vec<&Surface> = original.iter().map(|drawn| &drawn.surface).collect();
    let views = ViewSet::cube(tree.foliage().bounding_sphere().unwrap());
    let truth = Outlines::of_truth(&surfaces, &views, 128);
    let most =
        |is_tolerable| DrawnOriginal::new(&surfaces, &views, is_tolerable).most_specks(&truth, 128);
    // The plant has faded, so that what clients show of it says nothing.
    let specks = truth.specks_per_view();
    assert!(specks > 10.0, "{specks}");
    assert_eq!(most(true), 1.25 * specks + 2.0);
    assert_eq!(most(false), 1.5 * specks + 4.0);
}

/// Large blots: a lower cutoff helps fine mip maps, and not the coarsest.
#[test]
fn cutoffs_stay_where_mip_maps_are_left_out() {
    let tree = crown(|x, y| x % 64 < 28 && y % 64 < 28);
    let by = |change| choose_cutoffs(&tree, &level(&tree), change).unwrap();
    let with = by(MaterialChange::Cutoffs).unwrap();
    let without = by(MaterialChange::CutoffsOrMips).unwrap();
    assert_eq!(without.cutoffs.materials_without_mips().count(), 1);
    assert_eq!(with.cutoffs.materials_without_mips().count(), 0);
    let cutoffs = |found: &ChosenCutoffs| found.cutoffs.of_materials().collect::<Vec<_>>();
    assert!(cutoffs(&with).len() == 1 && with.times != 1.0, "{with:?}");
    assert_eq!(cutoffs(&without), cutoffs(&with));
    assert_eq!(without.times, with.times);
}

/// Slanted stripes with a soft rim, which a lower cutoff would widen: what lies between them is raised, and close
/// by nothing changes.
#[test]
fn what_lower_cutoffs_would_widen_is_raised_away_from_leaves() {
    let stripes = |x: u32, y: u32| match (x + y / 3) % 42 {
        0..14 => 255,
        14..16 => 115,
        _ => 0,
    };
    let tree = crown_of(4.0, stripes);
    let found = chosen(&tree, &level(&tree)).unwrap();
    let share = found.raised_share.unwrap();
    assert!((0.05..0.85).contains(&share), "{share}");
    assert_eq!(
        (found.times, found.cutoffs.of_materials().count()),
        (1.0, 0)
    );
    let [near, _, far] = found.coverage[..] else {
        panic!("three sizes");
    };
    let moved = (near.1[1] - near.1[0]).abs();
    assert!(moved < 0.05, "{near:?}");
    assert!(far.1[0] < 0.8 && (far.1[1] - 1.0).abs() < 0.1, "{far:?}");
    let [
        Raised {
            material: 1,
            texture,
        },
    ] = &found.raised[..]
    else {
        panic!("of the leaves alone");
    };
    let mut raised = 0;
    for (k, texel) in (0..).zip(texture.rgba.chunks(4)) {
        let before = stripes(k % 256, k / 256);
        raised += u32::from(texel[3] != before);
        let is_below = before == 0 && f64::from(texel[3]) <= share * 127.5;
        assert!(texel[3] == before || is_below, "{k}: {texel:?}");
    }
    assert!((256 * 256 / 4..256 * 256 / 2).contains(&raised), "{raised}");
    // The level that is written has it, with the cutoff that was there.
    let changes = crate::material_changes(Some(&found), &[]);
    let bytes = tree.lod_to_bytes_with(&level(&tree), &changes).unwrap();
    let document = Document::from_bytes("level.glb", bytes, None).unwrap();
    let drawn = document.drawn_as_one(Detail::Color).unwrap();
    let leaves = drawn
        .iter()
        .find(|one| one.surface.material.texture.is_some());
    let leaves = &leaves.unwrap().surface.material;
    assert_eq!(leaves.texture.as_ref().unwrap().rgba, texture.rgba);
    assert_eq!(leaves.alpha_mode, AlphaMode::Mask(0.5));
    // And clients show as much of it as was said.
    let sphere = tree.foliage().bounding_sphere().unwrap();
    let all = ViewSet::cube(sphere);
    let views = ViewSet::new(SIDES.map(|side| all.views()[side]).into());
    let surfaces: Vec<&Surface> = drawn.iter().map(|one| &one.surface).collect();
    let original = tree.document().drawn_as_one(Detail::Color).unwrap();
    let original: Vec<&Surface> = original.iter().map(|one| &one.surface).collect();
    let mips = MipMaps::of_cut_outs(&surfaces);
    let shown = Strengths::new(&surfaces, |_| false, &views, WIDTH_PX, 1.0, &mips).shown(1.0);
    let truth = Outlines::of_truth(&original, &views, WIDTH_PX);
    let coverage = shown.covered_px() as f64 / truth.covered_px() as f64;
    assert_eq!(coverage, near.1[1]);
}

/// Small blots, of which nothing is left from afar: what would show some of them there would close the crown near by.
#[test]
fn raised_texels_do_not_close_a_crown() {
    let blots = |x: u32, y: u32| match (x % 128).max(y % 128) {
        0..50 => 255,
        50..54 => 115,
        _ => 0,
    };
    let tree = crown_of(1.0, blots);
    let found = chosen(&tree, &level(&tree));
    for (width_px, [before, after]) in found.iter().flat_map(|found| &found.coverage) {
        assert!(*after <= before.max(1.0 + FAR_OFF), "{after} at {width_px}");
    }
}

#[test]
fn the_best_share_is_sought_from_the_middle_on() {
    let at = |best: f64| {
        let tries = std::cell::Cell::new(0);
        let tried = |share: f64| {
            tries.set(tries.get() + 1);
            Some(((share - best).abs(), share))
        };
        let (_, share) = best_share(tried).unwrap();
        (share, tries.get())
    };
    assert_eq!(at(0.5), (0.5, 3));
    assert_eq!(at(0.7), (0.7, 4));
    assert_eq!(at(0.1), (0.1, 6));
    assert_eq!(at(2.0), (0.8, 4));
    // What can't be tried is no better.
    let only_low = |share: f64| (share < 0.45).then_some((share, share));
    assert_eq!(best_share(only_low).map(|(_, share)| share), Some(0.1));
    let only_high = |share: f64| (share > 0.55).then_some((-share, share));
    assert_eq!(best_share(only_high), None);
    assert_eq!(best_share(|_| None::<(f64, ())>), None);
}

/// What is hardly cut out fades nowhere.
#[test]
fn a_crown_that_does_not_fade_stays_as_it_is() {
    let tree = crown(|x, _| x > 0);
    assert_eq!(chosen(&tree, &level(&tree)), None);
}
