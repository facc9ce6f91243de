//! Tiny meshes: the fast engine against drawing everything anew.

use glam::{DVec2, DVec3};
use secateur_model::{LeafTriangle, Lod};
use secateur_raster::measure::vmi::Vmi;
use secateur_raster::occluders::Occluded;
use secateur_raster::{AreaTable, CpuRasteriser, Scene, ViewSet, cpu};

use super::super::levels::{Level, joints, levels};
use super::super::parts::Parts;
use super::super::tests::{tube, wood};
use super::mesh::Effect;
use super::seen::{Cost, triangles_as_leaves};
use super::*;

const RESOLUTION: u32 = 48;

/// The cost by its definition: all triangles are drawn before and after.
struct Literal<'a> {
    views: &'a ViewSet,
    occluders: &'a Foliage,
    table: &'a LgTable,
    /// Triangles as they are, each a leaf, and which are left.
    corners: Vec<LeafTriangle>,
    left: Vec<bool>,
}

impl Literal<'_> {
    fn vmi(&self, mesh: &Mesh<'_>, corners: &[LeafTriangle], left: &[bool]) -> Vmi {
        let mut leaves = Foliage::default();
        for (number, triangle) in corners.iter().enumerate() {
            let like = mesh.wood().leaf(mesh.piece_of(number as u32));
            leaves.push_leaf_like(&[*triangle], like).unwrap();
        }
        let mut lod = Lod::original(left.len());
        for (number, _) in left.iter().enumerate().filter(|(_, is_left)| !**is_left) {
            lod.remove(LeafId::from_index(number));
        }
        let scene = Scene {
            foliage: &leaves,
            lod: &lod,
            views: self.views,
            resolution: RESOLUTION,
        };
        let occluded = Occluded {
            rasteriser: &CpuRasteriser,
            occluders: self.occluders,
        };
        let rows = self.views.views().iter().map(|view| {
            let image = occluded.leaf_ids(&scene, view).unwrap();
            cpu::histogram(&image, left.len())
        });
        let rows: Vec<Vec<u32>> = rows.collect();
        Vmi::of(&AreaTable::from_rows(left.len(), rows.concat()), self.table)
    }

    fn after(&self, mesh: &Mesh<'_>, effect: &Effect) -> (Vec<LeafTriangle>, Vec<bool>) {
        let (mut corners, mut left) = (self.corners.clone(), self.left.clone());
        for &triangle in &effect.removed {
            left[triangle as usize] = false;
        }
        for &(triangle, after) in &effect.changed {
            corners[triangle as usize] = mesh.triangle(after);
        }
        (corners, left)
    }
}

impl Cost for Literal<'_> {
    fn of(&mut self, mesh: &Mesh<'_>, effect: &Effect) -> i64 {
        let (corners, left) = self.after(mesh, effect);
        let before = self.vmi(mesh, &self.corners, &self.left);
        let after = self.vmi(mesh, &corners, &left);
        let pairs = before.scaled().iter().zip(after.scaled());
        pairs.map(|(a, b)| (a - b).abs()).sum()
    }

    fn commit(&mut self, mesh: &Mesh<'_>, effect: &Effect) {
        (self.corners, self.left) = self.after(mesh, effect);
    }
}

fn views(wood: &Foliage) -> ViewSet {
    ViewSet::octahedron(wood.bounding_sphere().unwrap())
}

fn levels_of(wood: &Foliage, resolution: u32) -> Vec<Vec<Level>> {
    let views = &views(wood);
    let judges = Judges { views, resolution };
    let left = collapsed(wood, judges, &CpuRasteriser).unwrap();
    let parts = Parts::of(wood);
    levels(&parts, left, &joints(&parts), judges)
}

/// All collapses in turn, by the fast engine and by the literal one.
fn both(wood: &Foliage, occluders: &Foliage) -> [Vec<Candidate>; 2] {
    let (views, table) = (views(wood), LgTable::new());
    let occluded = Occluded {
        rasteriser: &CpuRasteriser,
        occluders,
    };
    let mut mesh = Mesh::new(wood);
    let mut fast = Seen::new(&mesh, &views, RESOLUTION, &occluded, &table).unwrap();
    let mut made = [Vec::new(), Vec::new()];
    let firsts = firsts(&mesh, &fast);
    collapse_all(&mut mesh, &mut fast, firsts, |_, c, _| made[0].push(c));

    let mut mesh = Mesh::new(wood);
    let leaves = triangles_as_leaves(&mesh);
    let mut literal = Literal {
        views: &views,
        occluders,
        table: &table,
        corners: leaves.triangles().to_vec(),
        left: vec![true; leaves.leaves().len()],
    };
    let places = 0..mesh.place_count();
    let firsts = places.map(|place| cheapest(&mesh, place, &mut literal));
    let firsts = firsts.collect();
    collapse_all(&mut mesh, &mut literal, firsts, |_, c, _| made[1].push(c));
    made
}

fn crossed_tubes() -> Foliage {
    let mut wood = Foliage::default();
    for piece in [
        tube(DVec3::ZERO, 3.0 * DVec3::Y, 0.4, 2),
        tube(
            DVec3::new(-1.0, 1.5, 0.6),
            DVec3::new(1.0, 1.2, -0.5),
            0.2,
            1,
        ),
    ] {
        wood.push_leaf(&piece, None).unwrap();
    }
    wood
}

#[test]
fn collapses_are_those_of_drawing_everything_anew_to_the_last_bit() {
    let [fast, literal] = both(&crossed_tubes(), &Foliage::default());
    assert!(fast.len() > 10, "{} collapses", fast.len());
    assert!(fast.iter().any(|made| made.cost > 0));
    assert_eq!(fast, literal);
}

#[test]
fn what_stands_before_the_wood_hides_it_from_both() {
    let mut wall = Foliage::default();
    let corners = [[-2.0, -1.0], [0.1, -1.0], [0.1, 4.0]].map(|[x, y]| DVec3::new(x, y, 0.9));
    wall.push_leaf(&[LeafTriangle::plain(corners)], None)
        .unwrap();
    let bare = both(&crossed_tubes(), &Foliage::default());
    let [fast, literal] = both(&crossed_tubes(), &wall);
    assert_eq!(fast, literal);
    assert_ne!(fast, bare[0]);
}

#[test]
fn what_stays_is_made_of_corners_that_were_there_and_gets_ever_less() {
    let wood = wood();
    let levels = levels_of(&wood, 128);
    for (index, levels) in levels.iter().enumerate() {
        let of_piece = wood.triangles_of(LeafId::from_index(index)).len();
        assert!(!levels.is_empty(), "piece {index}");
        let mut before = (of_piece, 0.0);
        // The coarsest that stands stays whatever it loses.
        let standing = levels.iter().rposition(|level| level.stands);
        for (number, level) in levels.iter().enumerate() {
            if Some(number) != standing {
                assert!(level.triangles.len() < before.0 && level.loss >= before.1);
                before = (level.triangles.len(), level.loss);
            }
            let corners = level.triangles.as_flattened();
            assert!(
                corners
                    .iter()
                    .all(|corner| (*corner as usize) < 3 * of_piece)
            );
        }
        assert!(2 * levels[0].triangles.len() <= of_piece);
    }
}

/// A sheet of four quads in a row whose texture has a seam in the middle.
fn sheet_with_a_seam() -> Foliage {
    let at = |x: f64, y: f64, left: bool| {
        // The right half has its texture elsewhere.
        let u = if left { x } else { x + 10.0 };
        (DVec3::new(x, y, 0.0), DVec2::new(u, y))
    };
    let mut triangles = Vec::new();
    for column in 0..4 {
        for row in 0..3 {
            let (x, y) = (f64::from(column), f64::from(row));
            let left = column < 2;
            let [a, b, c, d] = [
                at(x, y, left),
                at(x + 1.0, y, left),
                at(x + 1.0, y + 1.0, left),
                at(x, y + 1.0, left),
            ];
            for t in [[a, b, c], [a, c, d]] {
                triangles.push(LeafTriangle {
                    corners: t.map(|corner| corner.0),
                    uvs: t.map(|corner| corner.1),
                });
            }
        }
    }
    let mut wood = Foliage::default();
    wood.push_leaf(&triangles, None).unwrap();
    wood
}

#[test]
fn seams_and_borders_stay_where_they_are_and_textures_do_not_swim() {
    let wood = sheet_with_a_seam();
    let levels = levels_of(&wood, 64);
    let all = wood.triangles();
    let coarsest = levels[0].last().unwrap();
    // Two halves of two triangles are the least that keeps outline and seam.
    assert_eq!(coarsest.triangles.len(), 4);
    let mut area = 0.0;
    for triangle in &coarsest.triangles {
        let corner = |c: u32| (all[c as usize / 3], c as usize % 3);
        let [a, b, c] = triangle.map(|c| corner(c).0.corners[corner(c).1]);
        area += 0.5 * (b - a).cross(c - a).length();
        let shifts = triangle.map(|c| {
            let (t, k) = corner(c);
            t.uvs[k].x - t.corners[k].x
        });
        assert!(shifts == [0.0; 3] || shifts == [10.0; 3], "{shifts:?}");
    }
    assert!((area - 12.0).abs() < 1e-12, "{area}");
}

#[test]
fn no_wood_has_no_levels() {
    let views = &views(&crossed_tubes());
    let resolution = 16;
    let judges = Judges { views, resolution };
    let left = collapsed(&Foliage::default(), judges, &CpuRasteriser).unwrap();
    assert!(left.is_empty());
}

/// Costs by number of the triangles that go; from the first collapse on, those of odd numbers
/// cost a thousand times as much.
struct Rising {
    has_risen: bool,
}

impl Cost for Rising {
    fn of(&mut self, _: &Mesh<'_>, effect: &Effect) -> i64 {
        let number = i64::from(*effect.removed.iter().max().unwrap());
        let is_odd = number % 2 == 1;
        if self.has_risen && is_odd {
            1000 * number
        } else {
            number
        }
    }

    fn commit(&mut self, _: &Mesh<'_>, _: &Effect) {
        self.has_risen = true;
    }
}

/// What got dearer since it was queued goes back behind what is cheaper.
#[test]
fn a_collapse_that_got_dearer_waits_its_turn() {
    let wood = crossed_tubes();
    let mut mesh = Mesh::new(&wood);
    let mut rising = Rising { has_risen: false };
    let places = 0..mesh.place_count();
    let firsts = places.map(|place| cheapest(&mesh, place, &mut rising));
    let firsts: Vec<_> = firsts.collect();
    let is_even = |first: &&Option<Candidate>| first.is_some_and(|first| first.cost % 2 == 0);
    let even = firsts.iter().filter(is_even).count();
    let mut made = Vec::new();
    collapse_all(&mut mesh, &mut rising, firsts, |_, c, _| made.push(c.cost));
    let cheap = made.iter().position(|cost| *cost >= 1000).unwrap();
    assert!(cheap >= even, "{even} were cheap: {made:?}");
}
