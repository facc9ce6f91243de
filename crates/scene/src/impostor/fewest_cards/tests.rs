//! Searches on a small crown.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use secateur_model::{AlphaMode, BoundingSphere, Finish, Material, Random};
use secateur_raster::ViewSet;
use secateur_simplify::Progress;

use super::*;
use crate::Screen;

/// Many small leaves in a ball of radius 1.
fn crown() -> Surface {
    let mut random = Random::new(3);
    let mut place = || DVec3::from([0; 3].map(|_| random.between(-1.0, 1.0)));
    let mut positions = Vec::new();
    while positions.len() < 3 * 400 {
        let at = place();
        if at.length() > 0.9 {
            continue;
        }
        positions.extend([at, at + place() * 0.1, at + place() * 0.1]);
    }
    let triangles = (0..positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    Surface {
        triangles: triangles.collect(),
        normals: vec![Vec3::Y; positions.len()],
        positions,
        uvs: Vec::new(),
        colors: Vec::new(),
        holds: Vec::new(),
        material: Arc::new(Material {
            name: String::new(),
            base_color: [0.1, 0.4, 0.1, 1.0],
            texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: true,
            finish: Finish::default(),
        }),
    }
}

fn seen(surfaces: &[Surface]) -> Seen {
    Seen::new(surfaces, judge(60.0), 60.0)
}

const SPHERE: BoundingSphere = BoundingSphere {
    centre: DVec3::ZERO,
    radius: 1.0,
};

fn judge(pixels_high: f64) -> Judge {
    let [views, ..] = ViewSet::held_out(SPHERE);
    Judge::new(&views, SPHERE, 2.0, Screen::default(), pixels_high)
}

/// Walls about the crown: squares of side 4 in these directions.
fn walls(toward: impl IntoIterator<Item = DVec3>) -> Surface {
    let mut walls = crown();
    walls.positions.clear();
    for toward in toward {
        let x = toward.any_orthonormal_vector();
        let y = toward.cross(x);
        let corners = [[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]];
        let corners = corners.map(|[a, b]| toward * 1.5 + x * a + y * b);
        walls.positions.extend(corners);
    }
    let squares = 0..walls.positions.len() as u32 / 4;
    let square = |k: u32| [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|corner| 4 * k + corner));
    walls.triangles = squares.flat_map(square).collect();
    walls.normals = vec![Vec3::Y; walls.positions.len()];
    walls
}

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

#[test]
fn a_smaller_difference_takes_more_cards_and_none_is_beyond_it() {
    let surfaces = [crown()];
    let seen = seen(&surfaces);
    let mut search = Search::new(&surfaces);
    let mut found = |most_flip: f64| {
        let found = search.fewest(&seen, most_flip, most(), |made| made, &mut go_on);
        found.unwrap()
    };
    let [all, many, few] = [0.037, 0.05, 0.07].map(|most_flip| {
        let found = found(most_flip);
        found.map(|found| {
            assert!(found.flip <= most_flip);
            found.impostor.surface.triangles.len()
        })
    });
    assert!(
        all > many && many > few && few.is_some(),
        "{all:?} {many:?} {few:?}"
    );
    // Hardly fewer would do.
    let fewer = (few.unwrap() as f64 / 2.0 / STEP / STEP).round() as usize;
    let of_fewer = search
        .finished(fewer, &seen, f64::INFINITY, |made| made, &mut go_on)
        .unwrap()
        .unwrap();
    assert!(of_fewer.flip > 0.07, "{fewer} cards: {}", of_fewer.flip);
    for (most_flip, most) in [(1e-4, most()), (1.0, 7)] {
        let found = search.fewest(&seen, most_flip, most, |made| made, &mut go_on);
        let found = found.unwrap();
        assert!(found.is_none(), "within {most_flip} of at most {most}");
    }
}

/// However far it is, a search that is to stop neither bakes nor looks at another number of cards.
#[test]
fn a_search_stops_wherever_it_is_told_to() {
    let surfaces = [crown()];
    let seen = seen(&surfaces);
    // What one run has made the next goes on from.
    let mut search = Search::new(&surfaces);
    for last in 1.. {
        let before = search.sorted.len() + search.rough.len();
        let (mut asked, finished) = (0, Cell::new(0));
        let finish = |made| {
            finished.set(finished.get() + 1);
            made
        };
        let observer = &mut |_| {
            asked += 1;
            match asked < last {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(()),
            }
        };
        let found = search.fewest(&seen, 0.05, most(), finish, observer);
        if let Ok(found) = found {
            // Eight numbers of cards, and three questions about each of those with fine textures.
            assert!(found.is_some() && last > 10, "asked {asked} times");
            assert_eq!(finished.get(), 2);
            return;
        }
        assert!(matches!(found, Err(Error::Stopped)), "at question {last}");
        assert_eq!(asked, last, "it is not asked again");
        let more = search.sorted.len() + search.rough.len() - before;
        assert!(more <= 2, "{more} sorted or baked up to question {last}");
    }
}

/// Where nothing is seen of a plant, no number of cards looks other than it.
#[test]
fn the_fewest_cards_do_where_nothing_is_seen() {
    let surfaces = [crown()];
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let walls = Arc::new(walls(axes.into_iter().flat_map(|axis| [axis, -axis])));
    let seen = Seen::new(&surfaces, judge(60.0).among(vec![walls]), 60.0);
    let mut search = Search::new(&surfaces);
    let found = search.fewest(&seen, 0.05, most(), |made| made, &mut go_on);
    let found = found.unwrap().unwrap();
    assert_eq!(found.flip, 0.0);
    assert_eq!(found.impostor.surface.triangles.len(), 2 * number(0));
}

/// What pictures of its size show of a plant is seen from where no wall hides it.
#[test]
fn large_pictures_are_of_a_view_in_which_the_plant_is_seen() {
    let surfaces = [crown()];
    let of_size = |judge: Judge| {
        let seen = Seen::new(&surfaces, judge, 600.0);
        let cards = Cards::new(&surfaces, 60);
        let cards = Impostor::cards(&cards, 600.0, f64::INFINITY).unwrap();
        [seen.flip(&cards), seen.flip_at_its_size(&cards)]
    };
    let judge = || judge(600.0);
    let [usual, large] = of_size(judge());
    let [views, ..] = ViewSet::held_out(SPHERE);
    let first = views.views()[0].eye().normalize();
    let [usual_behind, large_behind] = of_size(judge().among(vec![Arc::new(walls([first]))]));
    assert!(usual_behind < usual, "the wall hides it in the first view");
    let [beyond, beyond_behind] = [large / usual, large_behind / usual_behind];
    assert!(
        beyond > 1.02 && (beyond_behind / beyond - 1.0).abs() < 0.01,
        "{beyond} {beyond_behind}"
    );
}

#[test]
fn normals_of_half_the_size_are_taken_where_they_look_as_near() {
    let surfaces = [crown()];
    let seen = seen(&surfaces);
    let cards = Cards::new(&surfaces, 60);
    let impostor = Impostor::cards(&cards, 60.0, f64::INFINITY).unwrap();
    let flip = seen.flip_at_its_size(&impostor);
    let with_flip = |flip: f64| Found {
        impostor: impostor.clone(),
        flip,
    };
    let half = seen.with_half_normals(&with_flip(flip)).unwrap();
    assert!(half.flip <= AS_NEAR * flip);
    let sizes = |impostor: &Impostor| {
        let material = &impostor.surface.material;
        let normals = &material.finish.normal_map.as_ref().unwrap().texture;
        let colors = material.texture.as_ref().unwrap();
        [colors, normals].map(|texture| [texture.width, texture.height])
    };
    let [colors, normals] = sizes(&impostor);
    assert_eq!(colors, normals);
    assert_eq!(
        sizes(&half.impostor),
        [colors, normals.map(|side| side / 2)]
    );
    // They are no nearer than this.
    let nearer = with_flip(0.9 * half.flip);
    assert!(seen.with_half_normals(&nearer).is_none());
    let impostor = impostor.flat();
    let flat = Found { impostor, flip };
    assert!(seen.with_half_normals(&flat).is_none());
}
