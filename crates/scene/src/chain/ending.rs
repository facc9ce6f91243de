//! How a chain ends: its impostor, what switches show, and the textures of its levels.

use secateur_eval::Pictures;
use secateur_simplify::Observer;

use super::error::ChainError;
use super::level::{ChainLevel, ImpostorLevel, Shape};
use super::level_surfaces::LevelSurfaces;
use super::maker::{Made, Maker};
use super::texture_bytes::{bytes_of, texture_bytes};
use super::textures::{Chosen, Client, end_of};
use crate::impostor::crossed::Planes;
use crate::impostor::judge::{Judge, best_crossed};
use crate::impostor::{Choice, Impostor};

/// Two crossed planes whose FLIP is this many times what is wanted are given up: to bake more of them
/// takes as long as to make a level.
const HOPELESS: f64 = 2.0;

/// What of a level a picture is drawn of.
pub(super) enum Pictured {
    Mesh(LevelSurfaces),
    Impostor(Impostor),
}

impl Pictured {
    fn pictures(&self, judge: &Judge) -> Pictures {
        match self {
            Self::Mesh(level) => judge.of_surfaces(&level.surfaces),
            Self::Impostor(impostor) => judge.of_impostor(impostor),
        }
    }
}

fn no_impostor(place: &str, flip: f64, triangles: usize, of_mesh: f64) -> String {
    format!(
        "no impostor at {place}: crossed planes have a FLIP of {flip:.3} there, the mesh of {triangles} triangles {of_mesh:.3}"
    )
}

impl Maker<'_> {
    /// The impostor that a chain ends in, from which height on, and its FLIP there.
    pub(super) fn impostor(
        &self,
        made: &[(Made, f64, f64)],
        notes: &mut Vec<String>,
        observer: &mut Observer<'_>,
    ) -> Result<Option<(ImpostorLevel, f64, f64)>, ChainError> {
        let choice = self.options.impostor;
        let Some((mesh, begins, _)) = made.last().filter(|_| choice != Choice::None) else {
            return Ok(None);
        };
        // Where heights are asked for, the last of them; else where the last level is half as high.
        let (height, place) = self.heights().pop().unwrap_or_else(|| {
            let height = begins / 2.0;
            (height, format!("{height} pixels"))
        });
        let judge = self.look.judge(self.options.screen, height);
        if choice == Choice::Auto
            && let Some([flip, of_mesh]) = self.hopeless(mesh, &judge, height)
        {
            notes.push(no_impostor(&place, flip, mesh.triangles(), of_mesh));
            return Ok(None);
        }
        let original = judge.of_surfaces(&self.look.original);
        let of_mesh = judge.flip(&original, &judge.of_surfaces(&mesh.drawn.level.surfaces));
        let found = match choice {
            Choice::Octahedral => Impostor::octahedral(&self.look.original, height).map(|made| {
                let flip = judge.flip(&original, &judge.of_impostor(&made));
                (made, flip)
            }),
            _ => best_crossed(&self.look.original, &original, &judge, height),
        };
        let Some((impostor, flip)) = found else {
            return Ok(None);
        };
        let triangles = impostor.surface.triangles.len();
        let is_lighter = triangles < mesh.triangles();
        let is_near = flip <= self.options.max_flip || flip <= of_mesh;
        let mut same_cost = None;
        // A plant that cannot be made so light has no mesh to hold the impostor against.
        if is_lighter
            && (is_near || choice != Choice::Auto)
            && let Ok(equal) = self.level(triangles, observer)
        {
            let pictures = judge.of_surfaces(&equal.drawn.level.surfaces);
            same_cost = Some((equal.triangles() as u64, judge.flip(&original, &pictures)));
        }
        if let Some((triangles, of_equal)) = same_cost
            && choice == Choice::Auto
            && of_equal < flip
        {
            notes.push(format!(
                "no impostor at {place}: crossed planes have a FLIP of {flip:.3} there, a mesh of as many triangles ({triangles}) {of_equal:.3}"
            ));
            return Ok(None);
        }
        if choice == Choice::Auto && !(is_lighter && is_near) {
            notes.push(no_impostor(&place, flip, mesh.triangles(), of_mesh));
            return Ok(None);
        }
        let level = ImpostorLevel {
            impostor,
            mesh_triangles: mesh.triangles() as u64,
            mesh_flip_mean: of_mesh,
            same_cost,
        };
        Ok(Some((level, height, flip)))
    }

    /// In one view the FLIP of the fewest crossed planes and of a mesh, if the planes are so far from the
    /// plant there that more of them will not do.
    fn hopeless(&self, mesh: &Made, judge: &Judge, height: f64) -> Option<[f64; 2]> {
        let fewest = Impostor::crossed(&self.look.original, Planes::ALL[0], height)?;
        let judge = judge.from_one();
        let original = judge.of_surfaces(&self.look.original);
        let of_fewest = judge.flip(&original, &judge.of_impostor(&fewest));
        let of_mesh = judge.flip(&original, &judge.of_surfaces(&mesh.drawn.level.surfaces));
        let most = HOPELESS * of_mesh.max(self.options.max_flip);
        (of_fewest > most).then_some([of_fewest, of_mesh])
    }

    /// The levels with what switching to each shows, but for those that show more than is wanted.
    pub(super) fn without_pops(
        &self,
        levels: Vec<(Pictured, ChainLevel)>,
        notes: &mut Vec<String>,
    ) -> Result<Vec<(Pictured, ChainLevel)>, ChainError> {
        let mut kept: Vec<(Pictured, ChainLevel)> = Vec::new();
        for (pictured, mut level) in levels {
            if let Some((before, _)) = kept.last() {
                let screen = self.options.screen;
                let judge = self.look.judge_of_switches(screen, level.pixels_high);
                let pop = judge.largest_flip(&before.pictures(&judge), &pictured.pictures(&judge));
                if self.options.max_pop.is_some_and(|most| pop > most) {
                    notes.push(format!(
                        "a level of {} triangles is left out: to switch to it at {:.0} pixels would show a FLIP of {pop:.3}",
                        level.triangles(),
                        level.pixels_high
                    ));
                    continue;
                }
                level.pop_flip = Some(pop);
            }
            kept.push((pictured, level));
        }
        Ok(kept)
    }

    /// The levels with textures for where they are seen.
    pub(super) fn with_textures(
        &self,
        levels: Vec<(Pictured, ChainLevel)>,
    ) -> Result<Vec<ChainLevel>, ChainError> {
        let items = self.tree.items();
        let [views] = &self.look.views;
        let client = Client::new(
            &self.look.original,
            views,
            self.look.sphere,
            self.options.screen,
            self.look.height,
        );
        let begins: Vec<f64> = levels.iter().map(|(_, level)| level.pixels_high).collect();
        let mut finished = Vec::new();
        for (number, (pictured, mut level)) in levels.into_iter().enumerate() {
            let begin = level.pixels_high;
            let range = [begin, end_of(begin, begins.get(number + 1).copied())];
            match pictured {
                Pictured::Mesh(drawn) => {
                    let wanted = self.options.textures;
                    let Chosen { textures, as_drawn } =
                        client.choose(&drawn, range, wanted, number == 0);
                    level.texture_bytes =
                        texture_bytes(items.document(), &drawn.materials, &textures);
                    level.textures = textures;
                    level.as_drawn = Some(as_drawn);
                }
                Pictured::Impostor(impostor) => {
                    let material = &impostor.surface.material;
                    let normals = material.finish.normal_map.as_ref();
                    let all = material
                        .texture
                        .iter()
                        .chain(normals.map(|map| &map.texture));
                    level.texture_bytes = all.map(|texture| bytes_of(texture)).sum();
                    if !impostor.needs_sampler() {
                        let surfaces = [impostor.surface];
                        level.as_drawn = Some(client.as_drawn(&surfaces, range));
                    }
                }
            }
            finished.push(level);
        }
        Ok(finished)
    }

    pub(super) fn finished_impostor(
        &self,
        level: ImpostorLevel,
        height: f64,
        flip_mean: f64,
    ) -> ChainLevel {
        ChainLevel {
            shape: Shape::Impostor(Box::new(level)),
            leaves: 0,
            foliage_triangles: 0,
            wood_triangles: 0,
            distance: self.options.screen.distance(self.look.height, height),
            pixels_high: height,
            screen_coverage: 0.0,
            flip_mean,
            pop_flip: None,
            shadow: 0,
            silhouette_iou: None,
            vmi_error_percent: None,
            order_sha256: None,
            order: None,
            textures: Vec::new(),
            texture_bytes: 0,
            as_drawn: None,
        }
    }
}
