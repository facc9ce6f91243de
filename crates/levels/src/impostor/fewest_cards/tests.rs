//! Searches on a small crown.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use secateur_model::{AlphaMode, Finish, Material, Random};
use secateur_simplify::Progress;

use super::*;

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

fn judge(surfaces: &[Surface]) -> DifferenceJudge {
    DifferenceJudge::new(surfaces.to_vec(), &[]).with_turned_normals()
}

/// The crown where it is 60 pixels high, from which cards may look this far.
fn seen(judge: &DifferenceJudge, difference: f64) -> Seen<'_> {
    Seen::new(judge, 60.0, Limits::of_difference(difference))
}

/// Differences that take many cards, fewer and few.
const LIMITS: [f64; 3] = [0.5, 0.8, 1.0];

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
    let judge = judge(&surfaces);
    let mut search = Search::new(&surfaces, u64::MAX);
    let mut found = |difference: f64, most: usize| {
        let seen = seen(&judge, difference);
        let found = search.fewest(&seen, most, |made| made, &mut go_on);
        found.unwrap().map(|found| {
            assert!(found.difference.over(seen.limits) <= 1.0);
            found.impostor.surface.triangles.len()
        })
    };
    let [all, many, few] = LIMITS.map(|difference| found(difference, most()));
    assert!(
        all > many && many > few && few.is_some(),
        "{all:?} {many:?} {few:?}"
    );
    for (difference, most) in [(0.01, most()), (2.0, 7)] {
        let found = found(difference, most);
        assert!(found.is_none(), "within {difference} of at most {most}");
    }
    // A bound that leaves room for them takes none away.
    for (difference, count) in LIMITS.into_iter().zip([all, many, few]) {
        let count = count.unwrap();
        let bounded = found(difference, count.div_ceil(2));
        assert!(
            bounded.is_some_and(|bounded| bounded <= count),
            "{count}: {bounded:?}"
        );
    }
    // Hardly fewer would do.
    let seen = seen(&judge, LIMITS[2]);
    let fewer = (few.unwrap() as f64 / 2.0 / STEP / STEP).round() as usize;
    let of_fewer = search
        .finished(
            fewer,
            &seen,
            Texels::up_to(f64::INFINITY, 60.0, false),
            |made| made,
            &mut go_on,
        )
        .unwrap()
        .unwrap();
    let over = of_fewer.difference.over(seen.limits);
    assert!(over > 1.0, "{fewer} cards: {over}");
}

/// However far it is, a search that is to stop neither bakes nor looks at another number of cards.
#[test]
fn a_search_stops_wherever_it_is_told_to() {
    let surfaces = [crown()];
    let judge = judge(&surfaces);
    let seen = seen(&judge, LIMITS[1]);
    // What one run has made the next goes on from.
    let mut search = Search::new(&surfaces, u64::MAX);
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
        let found = search.fewest(&seen, most(), finish, observer);
        if let Ok(found) = found {
            // Eight numbers of cards, and three questions about each of those with textures of their own.
            assert!(found.is_some() && last > 10, "asked {asked} times");
            assert_eq!(finished.get(), 3);
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
    let judge = judge(&surfaces).in_scene(None, vec![walls]);
    let mut search = Search::new(&surfaces, u64::MAX);
    let found = search.fewest(&seen(&judge, 0.05), most(), |made| made, &mut go_on);
    let found = found.unwrap().unwrap();
    assert_eq!(found.difference, Difference::default());
    assert_eq!(found.impostor.surface.triangles.len(), 2 * number(0));
}

#[test]
fn normals_of_half_the_size_are_taken_where_they_look_as_near() {
    let surfaces = [crown()];
    let judge = judge(&surfaces);
    let seen = seen(&judge, LIMITS[1]);
    let cards = Cards::new(&surfaces, 60);
    let impostor =
        Impostor::cards(&cards, 60.0, Texels::up_to(f64::INFINITY, 60.0, false)).unwrap();
    let over = |found: &Found| found.difference.over(seen.limits);
    let all = Found {
        difference: seen.difference(&impostor),
        impostor,
    };
    let half = seen.with_half_normals(&all).unwrap();
    assert!(over(&half) <= AS_NEAR * over(&all));
    let sizes = |impostor: &Impostor| {
        let material = &impostor.surface.material;
        let normals = &material.finish.normal_map.as_ref().unwrap().texture;
        let colors = material.texture.as_ref().unwrap();
        [colors, normals].map(|texture| [texture.width, texture.height])
    };
    let [colors, normals] = sizes(&all.impostor);
    assert_eq!(colors, normals);
    assert_eq!(
        sizes(&half.impostor),
        [colors, normals.map(|side| side / 2)]
    );
    // Half normals are no nearer than this.
    let nearer = |figure: f64| 0.9 * figure;
    let nearer = Found {
        impostor: all.impostor.clone(),
        difference: Difference {
            difference: nearer(half.difference.difference),
            block_coverage: nearer(half.difference.block_coverage),
            ..half.difference
        },
    };
    assert!(seen.with_half_normals(&nearer).is_none());
    let flat = Found {
        impostor: all.impostor.flat(),
        ..all
    };
    assert!(seen.with_half_normals(&flat).is_none());
}

/// Sticks of a thousandth of the plant's size, which a pixel shows little of.
fn twigs() -> Surface {
    let mut random = Random::new(5);
    let mut place = || DVec3::from([0; 3].map(|_| random.between(-1.0, 1.0)));
    let mut twigs = crown();
    twigs.positions.clear();
    for _ in 0..300 {
        let (at, along) = (place(), place() * 0.3);
        let across = along.any_orthonormal_vector() * 0.01;
        twigs
            .positions
            .extend([at - across, at + across, at + along]);
    }
    twigs.triangles.truncate(300);
    twigs.normals.truncate(900);
    twigs
}

/// The most cards are too small for twigs: fewer are found, with texels that show them.
#[test]
fn cards_are_found_for_thin_plants() {
    let surfaces = [twigs()];
    let judge = judge(&surfaces);
    let found = |seen: &Seen<'_>| {
        let mut search = Search::new(&surfaces, u64::MAX);
        let found = search.fewest(seen, most(), |made| made, &mut go_on);
        found.unwrap()
    };
    let seen = Seen::new(&judge, 16.0, Limits::of_difference(0.5));
    assert!(seen.is_thin);
    let thin = found(&seen).unwrap();
    assert!(thin.difference.over(seen.limits) <= 1.0);
    assert!(thin.impostor.surface.triangles.len() < most());
    let as_solid = Seen {
        is_thin: false,
        ..seen
    };
    assert!(found(&as_solid).is_none());
}
