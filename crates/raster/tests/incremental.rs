//! An A-buffer and VMI that are kept up to date, against drawing and computing anew.

use glam::DVec3;
use proptest::prelude::*;
use secateur_model::{Foliage, LeafId, LeafTriangle, Lod};
use secateur_raster::abuffer::{ABuffer, Event, Events, Undo};
use secateur_raster::cpu::{self, LeafFragments};
use secateur_raster::measure::incremental::IncrementalVmi;
use secateur_raster::measure::lg::LgTable;
use secateur_raster::measure::vmi::Vmi;
use secateur_raster::{AreaTable, Fragment, Scene, ViewFragments, ViewSet};

const RESOLUTION: u32 = 24;

fn any_foliage() -> impl Strategy<Value = Foliage> {
    let point = || [-1.0..1.0f64, -1.0..1.0, -1.0..1.0].prop_map(DVec3::from_array);
    let leaf = (point(), [point(), point(), point()], 0.1..1.5f64);
    proptest::collection::vec(leaf, 2..40).prop_map(|leaves| {
        let mut foliage = Foliage::default();
        for (at, corners, size) in leaves {
            let triangle = LeafTriangle::plain(corners.map(|p| at + p * size));
            foliage.push_leaf(&[triangle], None).unwrap();
        }
        foliage
    })
}

#[derive(Clone, Debug)]
enum Edit {
    Remove,
    Resize(f64),
    /// Changes some leaves, and takes the changes back.
    Try(Vec<(prop::sample::Index, f64)>),
}

fn any_edit() -> impl Strategy<Value = Edit> {
    let tried = (any::<prop::sample::Index>(), 0.1..9.0f64);
    prop_oneof![
        Just(Edit::Remove),
        (0.1..9.0f64).prop_map(Edit::Resize),
        prop::collection::vec(tried, 1..5).prop_map(Edit::Try),
    ]
}

/// Everything that is kept up to date about a foliage in some views.
struct Kept<'a> {
    foliage: &'a Foliage,
    views: &'a ViewSet,
    a_buffer: ABuffer,
    vmi: IncrementalVmi<'a>,
    leaf_fragments: LeafFragments,
    events: Events,
}

fn scene<'a>(foliage: &'a Foliage, lod: &'a Lod, views: &'a ViewSet) -> Scene<'a> {
    Scene {
        foliage,
        lod,
        views,
        resolution: RESOLUTION,
    }
}

impl<'a> Kept<'a> {
    /// With areas of all leaves, or of those that are seen.
    fn new(foliage: &'a Foliage, views: &'a ViewSet, table: &'a LgTable, is_of_all: bool) -> Self {
        let leaf_count = foliage.leaves().len();
        let lod = Lod::original(leaf_count);
        let (fragments, areas) = cpu::fragments_and_areas(&scene(foliage, &lod, views));
        Self {
            foliage,
            views,
            a_buffer: ABuffer::new(fragments.into_views(), leaf_count),
            vmi: match is_of_all {
                true => IncrementalVmi::new(&areas, table),
                false => IncrementalVmi::of_seen(&areas, table),
            },
            leaf_fragments: LeafFragments::new(RESOLUTION),
            events: Events::default(),
        }
    }

    /// A leaf goes, or changes its size, for a while if there is an undo.
    fn edit(&mut self, leaf: LeafId, scale: Option<f64>, undo: Option<&mut Undo>) {
        let events = &mut self.events;
        events.begin_round();
        let changed = |pixel, before, after| events.push(pixel / RESOLUTION.pow(2), before, after);
        let Some(scale) = scale else {
            return self.a_buffer.remove(leaf.get(), changed);
        };
        let views = self.views.views();
        let fragments = self.leaf_fragments.of(self.foliage, leaf, scale, views);
        match undo {
            None => self.a_buffer.replace(leaf.get(), fragments, changed),
            Some(undo) => self.a_buffer.try_out(leaf.get(), fragments, undo, changed),
        }
    }

    fn settle(&mut self) {
        self.events
            .all()
            .iter()
            .for_each(|event| self.vmi.record(event));
        self.vmi.settle();
        self.events.clear();
    }

    fn assert_is_drawn_anew(&self, lod: &Lod) {
        let scene = scene(self.foliage, lod, self.views);
        let fragments = cpu::fragments(&scene);
        let lists = fragments.views().iter().flat_map(|view| view.pixels());
        let fronts = lists.map(|list| [0, 1].map(|k| list.get(k).map_or(0, |f| f.leaf())));
        assert!(self.a_buffer.fronts().eq(fronts));
        let areas = cpu::areas(&scene);
        assert_eq!(self.vmi.area_table(), areas);
        let table = self.vmi.table();
        assert_eq!(self.vmi.deviations(), Vmi::of(&areas, table).scaled());
        for leaf in 0..=areas.leaf_count() as u32 {
            let of_leaf = self.vmi.leaf(leaf);
            let area = |row: &[u32]| row[leaf as usize];
            assert!(areas.rows().map(area).eq(of_leaf.areas.iter().copied()));
            assert_eq!(areas.rows().map(area).sum::<u32>(), of_leaf.total);
            assert_eq!(table.lg(of_leaf.total), of_leaf.lg_total);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn what_is_kept_up_to_date_is_what_is_drawn_anew(
        foliage in any_foliage(),
        edits in prop::collection::vec((any::<prop::sample::Index>(), any_edit()), 1..25),
        is_of_all: bool,
    ) {
        let views = ViewSet::octahedron(foliage.bounding_sphere().unwrap());
        let table = LgTable::new();
        let mut kept = Kept::new(&foliage, &views, &table, is_of_all);
        let mut lod = Lod::original(foliage.leaves().len());
        kept.assert_is_drawn_anew(&lod);
        for (index, edit) in edits {
            let left: Vec<LeafId> = lod.leaves().map(|(leaf, _)| leaf).collect();
            if left.is_empty() {
                break;
            }
            let leaf = *index.get(&left);
            match edit {
                Edit::Remove => {
                    kept.edit(leaf, None, None);
                    kept.settle();
                    lod.remove(leaf);
                }
                Edit::Resize(scale) => {
                    kept.edit(leaf, Some(scale), None);
                    kept.settle();
                    lod.resize(leaf, scale);
                }
                Edit::Try(sizes) => {
                    let (mut tried, mut undo) = (lod.clone(), Undo::default());
                    for (index, scale) in sizes {
                        let leaf = *index.get(&left);
                        kept.edit(leaf, Some(scale), Some(&mut undo));
                        tried.resize(leaf, scale);
                    }
                    kept.settle();
                    kept.assert_is_drawn_anew(&tried);
                    kept.a_buffer.undo(&mut undo, |_, _, _| ());
                    kept.vmi.undo();
                }
            }
            kept.vmi.forget_step();
            kept.assert_is_drawn_anew(&lod);
        }
    }

    #[test]
    fn a_step_tells_what_it_changed(
        foliage in any_foliage(),
        scale in 0.1..9.0f64,
        is_of_all: bool,
    ) {
        let views = ViewSet::octahedron(foliage.bounding_sphere().unwrap());
        let table = LgTable::new();
        let mut kept = Kept::new(&foliage, &views, &table, is_of_all);
        let (before, original) = (kept.vmi.clone(), Vmi::of(&kept.vmi.area_table(), &table));
        kept.vmi.measure_from(&original);
        kept.edit(LeafId::from_index(0), Some(scale), None);
        kept.settle();
        let mut deviations = vec![0; views.len()];
        for changed in kept.vmi.changed_areas() {
            prop_assert_eq!(changed.before.areas, before.areas(changed.leaf));
            prop_assert_eq!(changed.after.areas, kept.vmi.areas(changed.leaf));
            let known = kept.vmi.changed_from(changed.leaf).unwrap();
            prop_assert_eq!(known.total, before.leaf(changed.leaf).total);
            for (deviation, change) in deviations.iter_mut().zip(changed.own_term) {
                *deviation += change;
            }
        }
        prop_assert_eq!(kept.vmi.deviations(), &deviations);
        let unchanged = (0..=foliage.leaves().len() as u32)
            .filter(|leaf| kept.vmi.changed_from(*leaf).is_none());
        for leaf in unchanged {
            prop_assert_eq!(before.areas(leaf), kept.vmi.areas(leaf));
        }
    }
}

#[test]
fn a_pixel_is_worth_the_logarithm_of_its_share() {
    let areas = AreaTable::from_rows(2, vec![8, 8, 0, 13, 0, 3]);
    let table = LgTable::new();
    let vmi = IncrementalVmi::new(&areas, &table);
    // lg 8/8 = 0, lg 8/21 = 3 - lg 21, and none where there is no area.
    assert_eq!(vmi.pixel_value(1, 0), 0);
    assert_eq!(vmi.pixel_value(1, 1), 0);
    assert_eq!(vmi.pixel_value(0, 0), table.lg(8) - table.lg(21));
    assert_eq!([vmi.pixel_value(2, 0), vmi.pixel_value(2, 1)], [0, 0]);
}

#[test]
#[should_panic(expected = "the step before is settled")]
fn steps_do_not_run_into_each_other() {
    let areas = AreaTable::from_rows(1, vec![3, 1]);
    let table = LgTable::new();
    let mut vmi = IncrementalVmi::new(&areas, &table);
    for _ in 0..2 {
        vmi.record(&Event {
            view: 0,
            pixels: 1,
            before: [0, 0],
            after: [1, 0],
        });
        vmi.settle();
    }
}

#[test]
#[should_panic(expected = "leaf 1 was removed")]
fn what_was_removed_does_not_come_back() {
    let view = ViewFragments::from_lists(vec![0, 1], vec![Fragment::new(5, 1)]);
    let mut a_buffer = ABuffer::new(vec![view], 1);
    a_buffer.remove(1, |_, _, _| ());
    a_buffer.replace(1, &[(0, 5)], |_, _, _| ());
}
