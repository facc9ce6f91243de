//! What a plant shows of its opaque textures, and what levels show beside that.
//!
//! Bark that is unwrapped lies in charts: islands of a texture between which it has any colour, mostly black. Their
//! edges bend, and a coarser level cuts the corners: it shows slits of what lies between. Such a level has the colours
//! of the charts there instead.

use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::sync::Arc;

use glam::Vec2;
use secateur_gltf::{Document, DrawnSurface};
use secateur_model::{AlphaMode, Surface, Texture};

use super::level_surfaces::by_material;
use super::smaller_base_colors::shows_base_color;
use crate::clear_texels::{Dilated, fill};

/// Cells along a side of the grid in which charts are remembered, at most.
const MOST_CELLS: u32 = 1024;

/// A level may show this share of its cells beside the charts: seams are rounded somewhere.
const HARDLY: f64 = 0.001;

/// Colours beside the charts that differ by no more than this from those within, in the mean, of 255, are as good:
/// whoever painted them has seen to it.
const ALIKE: f64 = 12.0;

/// Boxes about the triangles of a texture that is not tiled cover it at most so often: each has twice the area of its
/// triangle or a few times that, and mirrored halves of a plant share their charts.
const MOST_LAYERS: f32 = 16.0;

/// A texture of more texels keeps what lies between its charts: as PNG it would be tens of megabytes.
const MOST_TEXELS: u64 = 4096 * 2048;

/// Base colour textures for the materials of a level that shows other colours beside the charts of its plant: they have
/// the colours of the charts there. Both are given as they are drawn.
pub fn filled_charts(
    document: &Document,
    plant: &[DrawnSurface],
    level: &[DrawnSurface],
) -> Vec<Dilated> {
    let [plant, level] =
        [plant, level].map(|drawn| drawn.iter().map(|drawn| (&drawn.surface, drawn.material)));
    Charts::of(document, plant).filled_for(level)
}

/// The charts of a plant's opaque base colours, by material.
#[derive(Debug, Default)]
pub(super) struct Charts(BTreeMap<usize, Chart>);

/// What surfaces of a material show of its texture.
#[derive(Debug)]
struct Chart {
    texture: Arc<Texture>,
    /// Texture coordinates of the triangles that show it.
    triangles: Vec<[Vec2; 3]>,
    /// Columns and rows of the grid.
    cells: [u32; 2],
    /// By cell, whether any of it is shown.
    is_shown: Vec<bool>,
    filled: OnceCell<Arc<Texture>>,
}

impl Charts {
    /// Of what is drawn of a plant, with the number of each surface's material.
    pub(super) fn of<'s>(
        document: &Document,
        drawn: impl IntoIterator<Item = (&'s Surface, Option<usize>)>,
    ) -> Self {
        let charts = by_material(drawn).into_iter();
        let chart = |(material, surfaces): (usize, Vec<&Surface>)| {
            let look = &surfaces.first()?.material;
            let is_opaque =
                look.alpha_mode == AlphaMode::Opaque && shows_base_color(document, material, look);
            Some((material, Chart::of(&surfaces, is_opaque)?))
        };
        Self(charts.filter_map(chart).collect())
    }

    /// Textures for the materials of a level that shows other colours beside their charts.
    pub(super) fn filled_for<'s>(
        &self,
        level: impl IntoIterator<Item = (&'s Surface, Option<usize>)>,
    ) -> Vec<Dilated> {
        if self.0.is_empty() {
            return Vec::new();
        }
        let of_level = by_material(level).into_iter();
        let filled = |(material, surfaces): (usize, Vec<&Surface>)| {
            let (texture, difference) = self.0.get(&material)?.filled_for(&surfaces)?;
            Some(Dilated {
                material,
                texture,
                difference,
            })
        };
        of_level.filter_map(filled).collect()
    }
}

impl Chart {
    /// Nothing where surfaces show all of a texture, or none.
    fn of(surfaces: &[&Surface], is_opaque: bool) -> Option<Self> {
        let texture = surfaces[0].material.texture.as_ref();
        let texture = texture.filter(|_| is_opaque)?;
        let sides = [texture.width, texture.height];
        if u64::from(sides[0]) * u64::from(sides[1]) > MOST_TEXELS {
            return None;
        }
        let cells = sides.map(|side| side.clamp(1, MOST_CELLS));
        let triangles: Vec<[Vec2; 3]> = coordinates(surfaces).collect();
        let is_shown = shown(&triangles, cells, Touch::Any)?;
        is_shown.contains(&false).then(|| Self {
            texture: Arc::clone(texture),
            triangles,
            cells,
            is_shown,
            filled: OnceCell::new(),
        })
    }

    /// The texture with the colours of the charts between them, if these surfaces show others there; and how far off
    /// those are, of 255.
    fn filled_for(&self, surfaces: &[&Surface]) -> Option<(Arc<Texture>, f64)> {
        let level: Vec<[Vec2; 3]> = coordinates(surfaces).collect();
        let of_level = shown(&level, self.cells, Touch::Middle)?;
        let all = of_level.iter().filter(|is_shown| **is_shown).count();
        let is_beside = |(own, known): (&bool, &bool)| *own && !*known;
        let pairs = of_level.iter().zip(&self.is_shown);
        let beside: Vec<usize> = (0..of_level.len())
            .zip(pairs)
            .filter_map(|(cell, pair)| is_beside(pair).then_some(cell))
            .collect();
        if beside.len() as f64 <= HARDLY * all as f64 {
            return None;
        }
        let filled = self.filled.get_or_init(|| Arc::new(self.filled()));
        let changed = |cell: &usize| {
            let at = self.texel_of(*cell);
            let [before, after] = [&self.texture, filled].map(|texture| &texture.rgba[at..at + 3]);
            let channels = before.iter().zip(after).map(|(a, b)| a.abs_diff(*b));
            channels.map(f64::from).sum::<f64>() / 3.0
        };
        let mean = beside.iter().map(changed).sum::<f64>() / beside.len() as f64;
        (mean > ALIKE).then(|| (Arc::clone(filled), mean))
    }

    /// The index of the bytes of the texel in the middle of a cell.
    fn texel_of(&self, cell: usize) -> usize {
        let [columns, rows] = self.cells.map(|count| count as usize);
        let [width, height] = [self.texture.width, self.texture.height].map(|side| side as usize);
        let middle = |at: usize, cells: usize, side: usize| (2 * at + 1) * side / (2 * cells);
        let x = middle(cell % columns, columns, width);
        4 * (middle(cell / columns, rows, height) * width + x)
    }

    /// The texture with means of the charts that are near wherever no triangle shows the middle of a texel.
    fn filled(&self) -> Texture {
        let texture = &*self.texture;
        let sides = [texture.width, texture.height];
        let is_shown = shown(&self.triangles, sides, Touch::Middle);
        let is_shown = is_shown.unwrap_or_else(|| vec![true; texture.rgba.len() / 4]);
        let texels = texture.rgba.chunks_exact(4).zip(&is_shown);
        let mut colors: Vec<[u8; 4]> = texels
            .map(|(texel, is_shown)| match is_shown {
                true => [texel[0], texel[1], texel[2], u8::MAX],
                false => [0; 4],
            })
            .collect();
        fill(&mut colors, sides.map(|side| side as usize));
        let texels = texture.rgba.chunks_exact(4).zip(&colors);
        Texture {
            rgba: texels
                .flat_map(|(before, [r, g, b, _])| [*r, *g, *b, before[3]])
                .collect(),
            ..texture.clone()
        }
    }
}

/// The texture coordinates of the triangles of surfaces that have any.
fn coordinates<'s>(surfaces: &'s [&Surface]) -> impl Iterator<Item = [Vec2; 3]> + 's {
    let unwrapped = surfaces.iter().filter(|surface| !surface.uvs.is_empty());
    unwrapped.flat_map(|surface| {
        let corners = surface.triangles.iter();
        corners.map(|corners| corners.map(|corner| surface.uvs[corner as usize]))
    })
}

/// How much of a cell a triangle has to lie in.
#[derive(Clone, Copy)]
enum Touch {
    Any,
    Middle,
}

/// By cell of a grid over a texture that repeats, whether some of these triangles lie in it; nothing where there are none,
/// or they are so large that the texture is tiled.
fn shown(triangles: &[[Vec2; 3]], cells: [u32; 2], touch: Touch) -> Option<Vec<bool>> {
    let scale = Vec2::new(cells[0] as f32, cells[1] as f32);
    let [columns, rows] = cells.map(i64::from);
    let finite = triangles.iter();
    let finite = finite.filter(|triangle| triangle.iter().all(|corner| corner.is_finite()));
    let low = |[a, b, c]: [Vec2; 3]| a.min(b).min(c);
    let high = |[a, b, c]: [Vec2; 3]| a.max(b).max(c);
    let sizes = finite.clone().map(|corners| high(*corners) - low(*corners));
    let (mut most_side, mut sum, mut any) = (0.0f32, 0.0, false);
    for size in sizes {
        most_side = most_side.max(size.max_element());
        sum += size.element_product();
        any = true;
    }
    if !any || most_side > 1.0 || sum > MOST_LAYERS {
        return None;
    }
    let mut is_shown = vec![false; (columns * rows) as usize];
    for triangle in finite {
        let corners = triangle.map(|corner| corner * scale);
        let (low, high) = (low(corners), high(corners));
        let edges = edges(corners, touch);
        let [first, last] = [low, high].map(|at| [at.x.floor() as i64, at.y.floor() as i64]);
        for row in first[1]..=last[1] {
            for column in first[0]..=last[0] {
                let middle = Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
                if edges.iter().all(|edge| edge.is_within(middle)) {
                    let cell = row.rem_euclid(rows) * columns + column.rem_euclid(columns);
                    is_shown[cell as usize] = true;
                }
            }
        }
    }
    Some(is_shown)
}

/// A line, and on which side of it, or how far beyond, the middle of a cell may lie.
struct Edge {
    from: Vec2,
    inward: Vec2,
    least: f32,
}

impl Edge {
    fn is_within(&self, middle: Vec2) -> bool {
        self.inward.dot(middle - self.from) >= self.least
    }
}

fn edges(corners: [Vec2; 3], touch: Touch) -> [Edge; 3] {
    let turn = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]);
    let side = if turn < 0.0 { -1.0 } else { 1.0 };
    [0, 1, 2].map(|k| {
        let from = corners[k];
        let inward = (corners[(k + 1) % 3] - from).perp() * side;
        let least = match touch {
            // Half of a cell reaches this far across the line.
            Touch::Any => -0.5 * (inward.x.abs() + inward.y.abs()),
            Touch::Middle => 0.0,
        };
        Edge {
            from,
            inward,
            least,
        }
    })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use secateur_model::{Filters, Finish, Material, Wrap};

    use super::*;

    /// A texture of 64 x 64 texels: brown in a disc about its middle, and this colour beside it.
    fn disc(beside: [u8; 3]) -> Texture {
        let texel = |at: u32| {
            let from_middle = [at % 64, at / 64].map(|k| k as f32 - 31.5);
            let [r, g, b] = match Vec2::from(from_middle).length() < 28.0 {
                true => [120, 80, 50],
                false => beside,
            };
            [r, g, b, 255]
        };
        Texture {
            width: 64,
            height: 64,
            rgba: (0..64 * 64).flat_map(texel).collect(),
            wrap: [Wrap::Repeat; 2],
            filters: Filters::default(),
        }
    }

    /// A polygon of `corners` corners about the middle of a texture; `radius` is in texture coordinates.
    fn fan(corners: u32, radius: f32, texture: Texture) -> Surface {
        let at = |k: u32| {
            let angle = k as f32 / corners as f32 * std::f32::consts::TAU;
            Vec2::splat(0.5) + radius * Vec2::from_angle(angle)
        };
        let uvs: Vec<Vec2> = (0..corners).map(at).collect();
        Surface {
            positions: uvs
                .iter()
                .map(|uv| DVec3::new(uv.x.into(), uv.y.into(), 0.0))
                .collect(),
            normals: Vec::new(),
            uvs,
            colors: Vec::new(),
            holds: Vec::new(),
            triangles: (2..corners).map(|k| [0, k - 1, k]).collect(),
            material: Arc::new(Material {
                name: String::new(),
                base_color: [1.0; 4],
                texture: Some(Arc::new(texture)),
                alpha_mode: AlphaMode::Opaque,
                double_sided: false,
                finish: Finish::default(),
            }),
        }
    }

    /// What a level shows that has this radius where its plant has .42, of a texture with this colour beside that.
    fn filled(radius: f32, beside: [u8; 3]) -> Option<(Arc<Texture>, f64)> {
        let [plant, level] =
            [(40, 0.42), (8, radius)].map(|(corners, radius)| fan(corners, radius, disc(beside)));
        let chart = Chart::of(&[&plant], true).unwrap();
        chart.filled_for(&[&level])
    }

    #[test]
    fn a_level_that_reaches_beyond_a_chart_shows_its_colours_there() {
        let (texture, difference) = filled(0.49, [0; 3]).unwrap();
        assert_eq!(texture.rgba, [120, 80, 50, 255].repeat(64 * 64));
        assert!((50.0..=250.0 / 3.0).contains(&difference), "{difference}");
        // Within the chart, and beside it where its painter has filled it.
        assert_eq!(filled(0.41, [0; 3]), None);
        assert_eq!(filled(0.49, [115, 85, 45]), None);
    }

    #[test]
    fn what_is_tiled_or_shown_whole_has_no_charts() {
        let whole = fan(4, 0.8, disc([0; 3]));
        assert!(
            Chart::of(&[&whole], true).is_none(),
            "wider than the texture"
        );
        let part = fan(40, 0.42, disc([0; 3]));
        assert!(Chart::of(&[&part], true).is_some());
        assert!(Chart::of(&[&part], false).is_none(), "cut out");
    }

    /// A cell that a triangle only touches is shown, but its middle is not.
    #[test]
    fn cells_are_touched_or_hit_in_the_middle() {
        let triangle = [[0.3, 0.3], [0.9, 0.3], [0.3, 0.9]].map(Vec2::from);
        let turned = [triangle[0], triangle[2], triangle[1]];
        for triangle in [triangle, turned] {
            let count = |touch| {
                let cells = shown(&[triangle], [4, 4], touch).unwrap();
                cells.into_iter().filter(|is_shown| *is_shown).count()
            };
            assert_eq!((count(Touch::Any), count(Touch::Middle)), (6, 3));
        }
        // The texture repeats.
        let beyond = triangle.map(|corner| corner - Vec2::new(1.0, 2.0));
        let of = |triangle| shown(&[triangle], [4, 4], Touch::Middle);
        assert_eq!(of(beyond), of(triangle));
    }
}
