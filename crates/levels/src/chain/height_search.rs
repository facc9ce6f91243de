//! The lightest level for each height that the screen shows.

use secateur_model::Note;
use secateur_simplify::{Observer, Progress};

use super::cards::{CardSearch, FAR_PX};
use super::error::ChainError;
use super::impostors::PlacedImpostor;
use super::ladder::{Ladder, step_of_share};
use super::level_choice::no_level;
use super::maker::Maker;
use super::options::Wanted;
use super::placed::{LEAST_SHOWN, Placed};
use super::textures::{Client, end_of};
use crate::impostor::Choice;

/// A level that is sought for a height has at most this share of the triangles of the one before it: to switch for
/// less would not pay.
pub(super) const MOST_OF_BEFORE: f64 = 2.0 / 3.0;

/// A level that is sought for a distance that was asked for has at most this share.
const MOST_OF_ASKED: f64 = 0.9;

/// A level, with its step on the ladder and the place where it begins.
struct FoundLevel {
    step: usize,
    place: usize,
    level: Placed,
}

/// A search at heights, the largest first.
struct HeightSearch<'a, 'm, 'c> {
    maker: &'m Maker<'a>,
    client: &'m Client<'m>,
    cards: &'m mut CardSearch<'c>,
    ladder: Ladder<'a, 'm>,
    heights: Vec<f64>,
    /// The share of the triangles of the level before that one may have.
    most_of_before: f64,
    found: Vec<FoundLevel>,
    /// By place further heights at which its level has to do, as none is lighter there.
    serves: Vec<Vec<f64>>,
}

/// For each place the fewest triangles within the limits, but for places that would save too little, and for the
/// last where an impostor stands there whatever a mesh would look like. Where the leaves of the level before fade in
/// clients, one that saves less stands, too. And the cards that stand from the first place on
/// that is far and at which some do.
pub(super) fn lightest(
    maker: &Maker<'_>,
    cards: &mut CardSearch<'_>,
    client: &Client<'_>,
    notes: &mut Vec<Note>,
    observer: &mut Observer<'_>,
) -> Result<(Vec<Placed>, Vec<PlacedImpostor>), ChainError> {
    let mut places = maker.heights();
    if maker.options.chosen_impostor().is_demanded() && places.len() > 1 {
        places.pop();
    }
    let mut search = HeightSearch::new(maker, client, cards, &places);
    let mut far = Vec::new();
    // From here on it is not known that there are no cards.
    let mut may_have_cards = 0;
    let mut place = 0;
    while place < places.len() {
        let [done, of] = [place, places.len()];
        Progress::Level { done, of }.tell(observer)?;
        let is_far = search.is_far(place);
        if is_far && place >= may_have_cards {
            far = search.far_cards((place, false), observer)?;
            if !far.is_empty() {
                break;
            }
            may_have_cards = place + 1;
        }
        match search.sought(place, observer)? {
            Some(sought) => {
                let found = search.serving_before(sought, place, observer)?;
                let begins_here = found.place == place;
                search.found.push(found);
                if is_far && begins_here && search.is_dense(place) {
                    far = search.far_cards((place, true), observer)?;
                    if !far.is_empty() {
                        search.found.pop();
                        break;
                    }
                }
            }
            None => {
                if let Some(earlier) = search.sought_again(place) {
                    place = earlier;
                    continue;
                }
                if is_far && search.is_dense(place) {
                    far = search.far_cards((place, true), observer)?;
                    if !far.is_empty() {
                        break;
                    }
                }
            }
        }
        place += 1;
    }
    search.note_places_without_level(&places[..place], notes);
    let meshes = search.found.into_iter().map(|found| found.level);
    Ok((meshes.collect(), far))
}

impl<'a, 'm, 'c> HeightSearch<'a, 'm, 'c> {
    fn new(
        maker: &'m Maker<'a>,
        client: &'m Client<'m>,
        cards: &'m mut CardSearch<'c>,
        places: &[(f64, String)],
    ) -> Self {
        Self {
            ladder: Ladder::new(maker, client),
            heights: places.iter().map(|(height, _)| *height).collect(),
            most_of_before: match maker.options.wanted {
                Wanted::Distances(_) => MOST_OF_ASKED,
                Wanted::UsualHeights | Wanted::Heights(_) | Wanted::Triangles(_) => MOST_OF_BEFORE,
            },
            found: Vec::new(),
            serves: vec![Vec::new(); places.len()],
            maker,
            client,
            cards,
        }
    }

    /// Whether cards may stand at a place.
    fn is_far(&self, place: usize) -> bool {
        let choice = self.maker.options.chosen_impostor();
        choice == Choice::Auto && self.heights[place] <= FAR_PX
    }

    /// Whether what is drawn at a place has more triangles than the plant covers pixels there.
    fn is_dense(&self, place: usize) -> bool {
        let drawn = self.found.last().map(|found| &found.level.made);
        let covered_px = self.maker.look.covered_px(self.heights[place]);
        self.maker.triangles_beside(drawn) as f64 > covered_px
    }

    /// Cards from a place on, beside the levels that were found. `is_sought` says whether a level of that place was sought.
    fn far_cards(
        &mut self,
        (place, is_sought): (usize, bool),
        observer: &mut Observer<'_>,
    ) -> Result<Vec<PlacedImpostor>, ChainError> {
        let meshes = self.found.iter().map(|found| found.level.clone());
        let meshes: Vec<Placed> = meshes.collect();
        let at = (&self.heights[..], place);
        let meshes = (&meshes[..], is_sought);
        self.maker
            .far_cards(meshes, at, self.cards, self.client, observer)
    }

    fn end_px(&self, place: usize) -> f64 {
        end_of(self.heights[place], self.heights.get(place + 1).copied())
    }

    /// The lightest level of a place, and its step; nothing where it would save too little.
    fn sought(
        &mut self,
        place: usize,
        observer: &mut Observer<'_>,
    ) -> Result<Option<(usize, Placed)>, ChainError> {
        let (maker, end_px) = (self.maker, self.end_px(place));
        let before = self.found.last();
        let before_fades = before.is_some_and(|before| {
            maker.shown_down_to(&before.level, end_px, self.client) < LEAST_SHOWN
        });
        let most_of_before = match before_fades {
            true => 1.0,
            false => self.most_of_before,
        };
        let first = step_of_share(most_of_before, before.map_or(0, |before| before.step));
        let start = (first, before.is_none());
        if maker.options.morph {
            self.ladder.nest_in(before.map(|before| &before.level.made));
        }
        let at = [&self.heights[place..=place], &self.serves[place][..]].concat();
        let sought = self.ladder.lightest(&at, end_px, start, observer)?;
        let of_before = before.map_or(maker.all, |before| before.level.triangles());
        let pays = |level: &Placed| level.triangles() as f64 <= most_of_before * of_before as f64;
        Ok(sought.filter(|(_, level)| pays(level)))
    }

    /// A level of a place, which takes the place of those before it where it does as well.
    fn serving_before(
        &mut self,
        (step, mut level): (usize, Placed),
        mut place: usize,
        observer: &mut Observer<'_>,
    ) -> Result<FoundLevel, ChainError> {
        let end_px = self.end_px(place);
        while let Some(before) = self.found.last() {
            let look = &self.maker.look;
            let does = |height: &f64| look.over_in_search(&level.made.drawn, *height) <= 1.0;
            if !self.heights[before.place + 1..place].iter().all(does) {
                break;
            }
            let at = (self.heights[before.place], end_px, self.found.len() == 1);
            let Some(earlier) = self.ladder.also_at(&level, at, observer)? else {
                break;
            };
            (place, level) = (before.place, earlier);
            self.found.pop();
        }
        Ok(FoundLevel { step, place, level })
    }

    /// Where nothing lighter stands at a place, what stands before it must do there too: else its own place, where it is
    /// to be sought again so that it does.
    fn sought_again(&mut self, place: usize) -> Option<usize> {
        let height = self.heights[place];
        let before = self.found.last()?;
        let from = before.place;
        let is_known = self.serves[from].contains(&height);
        let drawn = &before.level.made.drawn;
        if is_known || self.maker.look.over_in_search(drawn, height) <= 1.0 {
            return None;
        }
        self.serves[from].push(height);
        self.found.pop();
        Some(from)
    }

    /// Says of each place without a level of its own which level serves there.
    fn note_places_without_level(&self, places: &[(f64, String)], notes: &mut Vec<Note>) {
        for (k, (_, place)) in places.iter().enumerate() {
            if self.found.iter().any(|found| found.place == k) {
                continue;
            }
            let before = self.found.iter().rfind(|found| found.place < k);
            let (before, of_before) = match before {
                Some(found) => ("the level before", found.level.triangles()),
                None => ("the plant itself", self.maker.all),
            };
            let note = format!(
                "{} {before} of {of_before} triangles serves there, since what is within the difference saves less than {:.0} %",
                no_level(place),
                100.0 * (1.0 - self.most_of_before)
            );
            notes.push(note.into());
        }
    }
}
