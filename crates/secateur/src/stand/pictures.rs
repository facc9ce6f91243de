//! What cameras see of a stand, and the levels that its kinds need there.

use secateur_eval::{JudgedStand, StandCamera, StandKind, StandPicture, StandPlace};
use secateur_simplify::Observer;

use super::{KindLevels, PlantPlace, Stand, StandOptions};
use crate::{Error, Session};

impl Stand {
    /// What a camera sees of the stand, with each place as this kind, or without it.
    pub(super) fn picture(
        &self,
        kinds: &[Option<&StandKind>],
        camera: &StandCamera,
        height_px: u32,
    ) -> StandPicture {
        let nothing = StandKind::new(Vec::new());
        let mut all = Vec::new();
        for (place, kind) in self.places.iter().zip(kinds) {
            all.push(StandPlace {
                kind: kind.unwrap_or(&nothing),
                world_from_own: place.world_from_own,
            });
        }
        for (kind, places) in &self.obstacles {
            all.extend(places.iter().map(|matrix| StandPlace {
                kind,
                world_from_own: *matrix,
            }));
        }
        StandPicture::of(&all, camera, height_px)
    }

    /// By place and camera, how many pixels show it, and how many pixels high it is.
    pub(super) fn seen(&self, truths: &[JudgedStand], height_px: u32) -> Vec<Vec<(f64, f64)>> {
        let of_place = |(number, place): (usize, &PlantPlace)| {
            let kind = &self.kinds[place.kind].drawn;
            let scale = place.world_from_own.determinant().abs().cbrt();
            let middle = place.world_from_own.transform_point3(kind.middle());
            let pairs = self.cameras.iter().zip(truths);
            let of_camera = |(camera, truth): (&StandCamera, &JudgedStand)| {
                let high = camera.pixels_high(scale * kind.size(), middle, height_px);
                (truth.picture.seen_px[number], high)
            };
            pairs.map(of_camera).collect()
        };
        self.places.iter().enumerate().map(of_place).collect()
    }

    pub(super) fn kind_levels(
        &self,
        seen: &[Vec<(f64, f64)>],
        options: &StandOptions,
        session: &Session,
        observer: &mut Observer<'_>,
    ) -> Result<Vec<KindLevels>, Error> {
        let mut all = Vec::new();
        for (number, kind) in self.kinds.iter().enumerate() {
            let places = self
                .places
                .iter()
                .zip(seen)
                .filter(|(place, _)| place.kind == number);
            let seen = places
                .flat_map(|(_, seen)| seen)
                .filter(|(px, _)| *px > 0.0);
            let range = seen.fold([0.0f64, f64::INFINITY], |[most, least], (_, high)| {
                [most.max(*high), least.min(*high)]
            });
            all.push(match range[0] > 0.0 {
                true => kind.levels(range, options, session, observer)?,
                false => kind.as_it_is()?,
            });
        }
        Ok(all)
    }
}
