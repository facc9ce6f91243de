//! Triangles around masks whose answers are known.

use super::*;
use proptest::prelude::*;

const CARD: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

fn card() -> Vec<[DVec2; 3]> {
    let corners = CARD.map(DVec2::from_array);
    [[0, 1, 2], [0, 2, 3]]
        .map(|t: [usize; 3]| t.map(|k| corners[k]))
        .to_vec()
}

fn found(mask: &Cutout, triangles: Vec<[DVec2; 3]>) -> Option<[DVec2; 3]> {
    let texture = CardTexture { triangles, mask };
    let corners = enclosing_triangle(&texture, 256)?;
    Some(corners.map(|weights| weights.at(&texture.triangles[0])))
}

fn twice_area([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a)
}

fn disc(wrap: Wrap, radius: f64) -> Cutout {
    Cutout::from_fn([128, 128], [wrap; 2], |x, y| {
        DVec2::new(f64::from(x) - 63.5, f64::from(y) - 63.5).length() < 128.0 * radius
    })
}

fn mask_count(mask: &Cutout) -> usize {
    let [width, height] = [mask.width(), mask.height()].map(|size| size as i32);
    let all = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    all.filter(|(x, y)| mask.is_opaque(*x, *y)).count()
}

/// The smallest triangle around a disc of radius r has an area of 3 sqrt(3) r^2.
#[test]
fn a_disc_is_held_by_a_triangle_of_hardly_more_than_the_least_area() {
    let triangle = found(&disc(Wrap::ClampToEdge, 0.3), card()).unwrap();
    let least = 27_f64.sqrt() * 0.3 * 0.3;
    let area = 0.5 * twice_area(triangle);
    // A cell more on every side, and sides that face one of 64 directions.
    assert!((least..1.15 * least).contains(&area), "{area} of {least}");
}

#[test]
fn it_faces_as_the_card_does() {
    let mask = disc(Wrap::ClampToEdge, 0.3);
    let back = card().iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    assert!(twice_area(found(&mask, card()).unwrap()) > 0.0);
    assert!(twice_area(found(&mask, back).unwrap()) < 0.0);
}

/// The corners of the triangle reach beyond the card, where discs are again.
#[test]
fn a_texture_that_repeats_may_show_but_little_of_itself_again() {
    assert!(found(&disc(Wrap::Repeat, 0.4), card()).is_none());
    assert!(found(&disc(Wrap::MirroredRepeat, 0.4), card()).is_none());
    assert!(found(&disc(Wrap::Repeat, 0.15), card()).is_some());
    assert!(found(&disc(Wrap::ClampToEdge, 0.4), card()).is_some());
}

/// A disc of which four thin tips stick out, too far for any triangle that holds all and
/// not some of the next.
#[test]
fn tips_are_cut_rather_than_others_shown() {
    let shown = |wrap: Wrap| {
        let mask = Cutout::from_fn([128, 128], [wrap; 2], |x, y| {
            let at = DVec2::new(f64::from(x) - 63.5, f64::from(y) - 63.5);
            let is_tip = at.abs().min_element() < 1.0 && at.abs().max_element() < 60.0;
            at.length() < 48.0 || is_tip
        });
        let triangle = found(&mask, card()).unwrap();
        let is_shown = |x: i32, y: i32| {
            let uv = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5) / 128.0;
            mask.is_opaque(x, y) && Weights::of(&triangle, uv).is_within()
        };
        let count = |x: std::ops::Range<i32>, y: std::ops::Range<i32>| {
            let all = y.flat_map(|y| x.clone().map(move |x| (x, y)));
            all.filter(|(x, y)| is_shown(*x, *y)).count()
        };
        let own = count(0..128, 0..128);
        let of_mask = mask_count(&mask);
        (own, of_mask, count(-256..384, -256..384) - own)
    };
    let (own, all, others) = shown(Wrap::ClampToEdge);
    assert_eq!((own, others), (all, 0));
    let (own, all, others) = shown(Wrap::Repeat);
    assert_eq!(others, 0);
    assert!(
        own < all && own as f64 > (1.0 - 3.0 / 64.0) * all as f64,
        "{own} of {all}"
    );
}

/// Every second texel of a line is between the centres of cells of two by two texels.
#[test]
fn what_is_smaller_than_a_cell_is_held() {
    let mask = Cutout::from_fn([512, 512], [Wrap::ClampToEdge; 2], |x, y| {
        x == 254 && (40..400).contains(&y)
    });
    let triangle = found(&mask, card()).unwrap();
    let ends = [40.0, 400.0].map(|y| DVec2::new(254.5, y) / 512.0);
    assert!(
        ends.iter()
            .all(|uv| Weights::of(&triangle, *uv).is_within())
    );
}

/// A texel, between those in the centres of cells of two by two texels, shows again beside the
/// card, on which it is no speck.
#[test]
fn of_a_texture_that_repeats_even_specks_count() {
    let mask = Cutout::from_fn([512, 512], [Wrap::Repeat; 2], |x, y| {
        (200..300).contains(&x) && (200..300).contains(&y) || (x, y) == (10, 20)
    });
    let texture = CardTexture {
        triangles: card(),
        mask: &mask,
    };
    let grid = CellGrid::of(&texture, 256).unwrap();
    let seen = grid.seen(&texture);
    let count = |even_specks: bool| {
        let foreign = grid.foreign(&texture, &seen, even_specks);
        let rows = foreign.sums.iter();
        rows.map(|sums| *sums.last().unwrap()).sum::<u32>()
    };
    // Five by five textures; the middle one is the card.
    assert_eq!(count(false), 24 * 50 * 50);
    assert_eq!(count(true), 24 * (50 * 50 + 1));
}

#[test]
fn what_reaches_the_border_goes_on_beyond_it() {
    let all = Cutout::from_fn([16, 16], [Wrap::ClampToEdge; 2], |_, _| true);
    assert!(found(&all, card()).is_none());
    // The middle half of the texture, of which the rest is empty.
    let middle = |x: u32| (4..12).contains(&x);
    let inside = Cutout::from_fn([16, 16], [Wrap::ClampToEdge; 2], |x, y| {
        middle(x) && middle(y)
    });
    assert!(found(&inside, card()).is_some());
    // A card of that half alone, in an atlas where its neighbours are not empty.
    let half = card()
        .iter()
        .map(|t| t.map(|uv| 0.25 + 0.5 * uv))
        .collect::<Vec<_>>();
    assert!(found(&inside, half.clone()).is_some());
    assert!(found(&all, half).is_none());
}

#[test]
fn nothing_is_around_nothing() {
    let mask = |opaque: bool| {
        Cutout::from_fn([8, 8], [Wrap::ClampToEdge; 2], move |x, _| opaque && x == 3)
    };
    assert!(found(&mask(false), card()).is_none());
    let point = vec![[DVec2::splat(0.5); 3]];
    let line = vec![[DVec2::ZERO, DVec2::X, 2.0 * DVec2::X]];
    let far = vec![[DVec2::ZERO, 1e300 * DVec2::X, 1e300 * DVec2::Y]];
    for triangles in [point, line, far] {
        assert!(found(&mask(true), triangles).is_none());
    }
}

proptest! {
    /// Blots anywhere on a card, wherever in the texture it is and however turned: the
    /// triangle holds all of them but tips, and hardly shows what is none of the card.
    #[test]
    fn all_that_a_card_shows_is_in_the_triangle(
        blots in prop::collection::vec((0.1..0.9, 0.1..0.9, 0.01..0.2), 1..5),
        is_repeated: bool,
        turned in -1.0..1.0,
    ) {
        let wrap = if is_repeated { Wrap::Repeat } else { Wrap::ClampToEdge };
        let is_blot = |x: u32, y: u32| {
            let at = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5) / 64.0;
            blots.iter().any(|(u, v, size)| at.distance(DVec2::new(*u, *v)) < *size)
        };
        let mask = Cutout::from_fn([64, 64], [wrap; 2], is_blot);
        let turn = DVec2::new(1.0, turned).normalize();
        let triangles: Vec<[DVec2; 3]> = card()
            .iter()
            .map(|t| t.map(|uv| 0.5 + turn.rotate(uv - 0.5)))
            .collect();
        let is_on_card = |uv: DVec2| triangles.iter().any(|t| Weights::of(t, uv).is_within());
        let uv_of = |x: i32, y: i32| DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5) / 64.0;
        // What goes on beyond the border of a card may show next to it.
        let is_near_card = |x: i32, y: i32| {
            (-2..=2).any(|v| (-2..=2).any(|u| {
                mask.is_opaque(x + u, y + v) && is_on_card(uv_of(x + u, y + v))
            }))
        };
        if let Some(triangle) = found(&mask, triangles.clone()) {
            let (mut right, mut missing, mut wrong) = (0, 0, 0);
            for y in -128..192 {
                for x in -128..192 {
                    let uv = uv_of(x, y);
                    if !mask.is_opaque(x, y) {
                        continue;
                    }
                    let is_held = Weights::of(&triangle, uv).is_within();
                    match is_on_card(uv) {
                        true => {
                            right += 1;
                            missing += i32::from(!is_held);
                        }
                        false => wrong += i32::from(is_held && !is_near_card(x, y)),
                    }
                }
            }
            // The program looks at other points than the centres of texels.
            prop_assert!(missing <= right / 20 + 1, "{missing} of {right} are missing");
            // The border of a texture that does not repeat, a hundredth of it, goes on.
            let allowed = right / 20 + 8;
            prop_assert!(wrong <= allowed, "{wrong} of {right}");
        }
    }
}
