//! How much of a switch between levels is seen on a walk from near to far: the difference from each frame to the next,
//! where levels switch at once, where they cross-fade, dithered, over their blend bands, and where they morph.
//!
//! `cargo run --release --example walk -- PLANT.glb...` prints a line for each switch: what moving alone does to a frame,
//! and the largest step with each. At 1.5 m/s, 60 frames a second, on a screen of 1080 pixels. Levels are nested; to an
//! impostor they cross-fade.

use std::error::Error;

use glam::{DMat4, DVec3};
use secateur::stand::drawn;
use secateur::{Detail, Document, GltfError, Layout, LevelsOptions, Plant, Surface};
use secateur_eval::{JudgedStand, StandCamera, StandKind, StandPicture, StandPlace};
use secateur_levels::chain::BlendBand;
use secateur_runtime::Screen;

/// Metres in a frame.
const STEP_M: f64 = 1.5 / 60.0;

fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "plant, switch, metres, pixels, frames of the band, moving alone, switching at once, cross-fading, morphing"
    );
    for file in std::env::args().skip(1) {
        let largest = walk(&file)?;
        println!(
            "{file}: largest step {:.3} at once, {:.3} cross-fading, {:.3} morphing",
            largest[0], largest[1], largest[2]
        );
    }
    Ok(())
}

/// A level as it is written, with its surfaces at both ends of the way to the next.
struct Drawn {
    kind: StandKind,
    ways: [Vec<Surface>; 2],
}

impl Drawn {
    fn of(document: &Document) -> Result<Self, GltfError> {
        let surfaces = |document: &Document| -> Result<Vec<Surface>, GltfError> {
            let drawn = document.drawn_scene(Detail::Color)?.into_iter();
            Ok(drawn.map(|drawn| drawn.surface).collect())
        };
        Ok(Self {
            kind: drawn(document)?,
            ways: [surfaces(document)?, surfaces(&document.at_end_of_morph())?],
        })
    }

    /// The level after this share of the way to the next.
    fn on_its_way(&self, share: f64) -> StandKind {
        let [begin, end] = &self.ways;
        let mixed = begin.iter().zip(end).map(|(begin, end)| {
            let positions = begin.positions.iter().zip(&end.positions);
            Surface {
                positions: positions.map(|(from, to)| from.lerp(*to, share)).collect(),
                ..begin.clone()
            }
        });
        StandKind::new(mixed.collect())
    }
}

/// The largest steps of a plant: switching at once, cross-fading, and morphing.
fn walk(file: &str) -> Result<[f64; 3], Box<dyn Error>> {
    let options = LevelsOptions {
        morph: true,
        ..LevelsOptions::default()
    };
    let levels = Plant::open(file)?.levels(&options)?;
    let files = levels.to_bytes(Layout::Files)?.files;
    let drawn = files.into_iter().map(|file| {
        let document = Document::from_bytes(&file.name, file.bytes, None)?;
        Drawn::of(&document)
    });
    let drawn: Vec<Drawn> = drawn.collect::<Result<_, _>>()?;
    let mut largest = [0.0f64; 3];
    for (k, level) in levels.chain.levels.iter().enumerate() {
        let Some(band) = level.blend.filter(|band| band.begin > 0.0) else {
            continue;
        };
        let walk = Walk::new(&drawn[0].kind, [&drawn[k].kind, &drawn[k + 1].kind], band);
        let [alone, at_once, fading] = walk.steps();
        let morphing = level.morph.as_ref().map(|_| walk.morphing(&drawn[k]));
        let morphing = morphing.unwrap_or(fading);
        let frames = ((band.end - band.begin) / STEP_M).ceil();
        println!(
            "{file}, {k} to {}, {:.1}, {:.0}, {frames}, {alone:.3}, {at_once:.3}, {fading:.3}, {morphing:.3}",
            k + 1,
            band.begin,
            band.begin_px
        );
        for (largest, step) in largest.iter_mut().zip([at_once, fading, morphing]) {
            *largest = largest.max(step);
        }
    }
    Ok(largest)
}

/// A walk through the blend band of two levels.
struct Walk<'a> {
    middle: DVec3,
    size: f64,
    levels: [&'a StandKind; 2],
    band: BlendBand,
}

impl<'a> Walk<'a> {
    fn new(plant: &'a StandKind, levels: [&'a StandKind; 2], band: BlendBand) -> Self {
        Self {
            middle: plant.middle(),
            size: plant.size(),
            levels,
            band,
        }
    }

    /// The step of moving alone, of switching at once, and the largest of those that cross-fading has where dithering
    /// lets a pixel of 16 go over.
    fn steps(&self) -> [f64; 3] {
        let frames = ((self.band.end - self.band.begin) / STEP_M).ceil().max(1.0);
        let at = |frame: f64| self.band.begin + frame * STEP_M;
        let [near, far] =
            [at(0.0), at(1.0)].map(|m| self.levels.map(|level| self.picture(level, m)));
        let [near, _] = near;
        let judge = JudgedStand::new(near.clone());
        let alone = judge.difference(&far[0]).difference;
        let at_once = judge.difference(&far[1]).difference;
        // In between each of the 16 shares is reached by one frame; those at the ends and in the middle are looked at.
        let mut fading = 0.0f64;
        for rank in [0.0, 5.0, 10.0, 15.0] {
            let frame = ((rank + 0.5) / 16.0 * frames).floor();
            let share = |frame: f64| (frame / frames).clamp(0.0, 1.0);
            let mixed = |frame: f64| {
                let [own, next] = self.levels.map(|level| self.picture(level, at(frame)));
                own.dithered(&next, share(frame))
            };
            let judge = JudgedStand::new(mixed(frame));
            fading = fading.max(judge.difference(&mixed(frame + 1.0)).difference);
        }
        [alone, at_once, fading]
    }

    /// The largest step where the first level morphs, that to the next included: at the beginning, in the middle and
    /// at the end.
    fn morphing(&self, level: &Drawn) -> f64 {
        let frames = ((self.band.end - self.band.begin) / STEP_M).ceil().max(1.0);
        let at = |frame: f64| self.band.begin + frame * STEP_M;
        let shown = |frame: f64| match frame < frames {
            true => self.picture(&level.on_its_way(frame / frames), at(frame)),
            false => self.picture(self.levels[1], at(frame)),
        };
        let looked_at = [0.0, 0.5, 1.0].map(|share| (share * (frames - 1.0)).floor());
        let steps = looked_at.map(|frame| {
            let judge = JudgedStand::new(shown(frame));
            judge.difference(&shown(frame + 1.0)).difference
        });
        steps.into_iter().fold(0.0, f64::max)
    }

    /// A level from so many metres off, in a picture that holds it.
    fn picture(&self, level: &StandKind, metres: f64) -> StandPicture {
        let screen = Screen::default();
        // The window of the screen that holds the plant; as large for all frames of a switch.
        let high = screen.pixels_high(self.size, self.band.begin);
        let side_px = (1.2 * high.min(screen.height_px) + 24.0).ceil() as u32;
        let tangent = (screen.field_of_view_degrees.to_radians() / 2.0).tan();
        let camera = StandCamera {
            eye: self.middle + metres * DVec3::new(0.42, 0.1, 0.9).normalize(),
            forward: DVec3::new(-0.42, -0.1, -0.9),
            up: DVec3::Y,
            tan_half_fov_y: tangent * f64::from(side_px) / screen.height_px,
            aspect: 1.0,
            near: 1e-3 * metres,
        };
        let place = StandPlace {
            kind: level,
            world_from_own: DMat4::IDENTITY,
        };
        StandPicture::of(&[place], &camera, side_px)
    }
}
