//! The plants of a file: what stands apart on the ground is judged by itself.
//!
//! Seen from above, plants stand apart where a gap of a twentieth of the largest one's extent lies between them.
//! What does not reach the ground, or is small beside the others, belongs to its nearest plant: a leaf that
//! hangs far out, fallen leaves. More than [`MOST_PLANTS`] are one stand, such as a patch of grass.

use std::collections::VecDeque;

use glam::{DVec2, DVec3};
use secateur_model::{BoundingSphere, Surface};

/// Cells along the longer side of the ground.
const CELLS: f64 = 128.0;

/// The least gap between plants, as a share of the largest one's extent.
const LEAST_GAP: f64 = 0.05;

/// A plant reaches down to this share of the largest one's height above the lowest point.
const GROUND: f64 = 0.15;

/// What has a smaller extent than this share of the largest one's is no plant of its own.
const LEAST_EXTENT: f64 = 0.15;

/// More plants than this are judged as one.
const MOST_PLANTS: usize = 32;

/// Plants that stand apart.
#[derive(Debug)]
pub(super) struct Plants {
    plants: Vec<Plant>,
    ground: Option<Ground>,
}

#[derive(Debug)]
struct Plant {
    /// Wood first.
    surfaces: Vec<Surface>,
    wood: usize,
    sphere: BoundingSphere,
    extent: f64,
}

impl Plant {
    fn of(surfaces: Vec<Surface>, wood: usize) -> Self {
        let [low, high] = bounds(&surfaces);
        Self {
            sphere: sphere_of(&surfaces),
            extent: (high - low).max_element().max(0.0),
            surfaces,
            wood,
        }
    }
}

impl Plants {
    /// The plants of these surfaces, of which `is_wood` says which are wood.
    pub(super) fn of(surfaces: Vec<Surface>, is_wood: &[bool]) -> Self {
        let (surfaces, wood) = wood_first(surfaces, is_wood);
        let Some(ground) = Ground::of(&surfaces) else {
            return Self::one(surfaces, wood);
        };
        let parts = ground.parts(&surfaces).into_iter();
        Self {
            plants: parts.map(|part| Plant::of(part, wood)).collect(),
            ground: Some(ground),
        }
    }

    /// These surfaces as one plant.
    pub(super) fn as_one(surfaces: Vec<Surface>, is_wood: &[bool]) -> Self {
        let (surfaces, wood) = wood_first(surfaces, is_wood);
        Self::one(surfaces, wood)
    }

    fn one(surfaces: Vec<Surface>, wood: usize) -> Self {
        Self {
            plants: vec![Plant::of(surfaces, wood)],
            ground: None,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.plants.len()
    }

    pub(super) fn sphere(&self, plant: usize) -> BoundingSphere {
        self.plants[plant].sphere
    }

    /// The surfaces of a plant, and how many of them, from the first, are wood.
    pub(super) fn surfaces(&self, plant: usize) -> (&[Surface], usize) {
        let plant = &self.plants[plant];
        (&plant.surfaces, plant.wood)
    }

    /// The largest extent of the largest plant.
    pub(super) fn size(&self) -> f64 {
        let extents = self.plants.iter().map(|plant| plant.extent);
        let largest = extents.fold(0.0, f64::max);
        if largest > 0.0 { largest } else { 1.0 }
    }

    /// The plant that stands where a point is.
    pub(super) fn at(&self, point: DVec3) -> usize {
        let of_cell = |ground: &Ground| usize::from(ground.plant_at(point));
        self.ground.as_ref().map_or(0, of_cell)
    }

    /// What of a level stands where each plant does.
    pub(super) fn parts(&self, level: &[Surface]) -> Vec<Vec<Surface>> {
        match &self.ground {
            Some(ground) => ground.parts(level),
            None => vec![level.to_vec()],
        }
    }
}

/// The surfaces with wood first, and how many are wood.
fn wood_first(surfaces: Vec<Surface>, is_wood: &[bool]) -> (Vec<Surface>, usize) {
    let is_wood = |k: usize| is_wood.get(k).copied().unwrap_or(false);
    let wood = (0..surfaces.len()).filter(|k| is_wood(*k)).count();
    let mut numbered: Vec<(usize, Surface)> = surfaces.into_iter().enumerate().collect();
    numbered.sort_by_key(|(k, _)| !is_wood(*k));
    let surfaces = numbered.into_iter().map(|(_, surface)| surface).collect();
    (surfaces, wood)
}

/// Which plant each cell of the ground belongs to.
#[derive(Debug)]
struct Ground {
    low: DVec2,
    cell: f64,
    size: [usize; 2],
    plant_of: Vec<u8>,
    count: usize,
}

/// Of a cell that nothing stands above.
const BARE: u8 = u8::MAX;

impl Ground {
    /// The ground under plants; none where there is one plant alone.
    fn of(surfaces: &[Surface]) -> Option<Self> {
        let [low, high] = bounds(surfaces);
        let extent = high - low;
        let side = extent.x.max(extent.z);
        if !(side > 0.0 && side.is_finite()) {
            return None;
        }
        let cell = side / CELLS;
        let cells = |length: f64| (length / cell) as usize + 1;
        let mut ground = Self {
            low: DVec2::new(low.x, low.z),
            cell,
            size: [cells(extent.x), cells(extent.z)],
            plant_of: Vec::new(),
            count: 0,
        };
        ground.plant_of = vec![BARE; ground.size[0] * ground.size[1]];
        ground.find_plants(surfaces, low.y, high.y)?;
        Some(ground)
    }

    /// Names the plant of each cell, if there are several.
    fn find_plants(&mut self, surfaces: &[Surface], low: f64, high: f64) -> Option<()> {
        let mut lowest = vec![f64::INFINITY; self.plant_of.len()];
        let mut highest = vec![f64::NEG_INFINITY; self.plant_of.len()];
        for corners in surfaces.iter().flat_map(triangles) {
            let [a, b, c] = corners.map(|corner| self.cell_of(corner));
            let (columns, rows) = (
                a[0].min(b[0]).min(c[0])..=a[0].max(b[0]).max(c[0]),
                a[1].min(b[1]).min(c[1])..=a[1].max(b[1]).max(c[1]),
            );
            let heights = corners.map(|corner| corner.y);
            let bottom = heights.into_iter().fold(f64::INFINITY, f64::min);
            let top = heights.into_iter().fold(f64::NEG_INFINITY, f64::max);
            for row in rows {
                for column in columns.clone() {
                    let cell = row * self.size[0] + column;
                    lowest[cell] = lowest[cell].min(bottom);
                    highest[cell] = highest[cell].max(top);
                }
            }
        }
        let is_bare: Vec<bool> = lowest.iter().map(|y| !y.is_finite()).collect();
        // The extent of the largest plant is not known before they are: gaps of one cell are closed first.
        let mut reach = 1;
        let mut clusters = self.clusters(&is_bare, reach);
        for _ in 0..2 {
            let extents: Vec<f64> = clusters
                .iter()
                .map(|cells| self.extent(cells, (&lowest, &highest)))
                .collect();
            let largest = extents.iter().copied().fold(0.0, f64::max);
            reach = ((LEAST_GAP * largest / self.cell).ceil() as usize).max(1);
            clusters = self.clusters(&is_bare, reach);
        }
        let extents: Vec<f64> = clusters
            .iter()
            .map(|cells| self.extent(cells, (&lowest, &highest)))
            .collect();
        let largest = extents.iter().copied().fold(0.0, f64::max);
        let is_plant = |(cells, extent): (&Vec<usize>, &f64)| {
            let bottom = cells
                .iter()
                .map(|k| lowest[*k])
                .fold(f64::INFINITY, f64::min);
            bottom - low <= GROUND * (high - low) && *extent >= LEAST_EXTENT * largest
        };
        let plants = clusters.iter().zip(&extents).filter(|pair| is_plant(*pair));
        let plants: Vec<&Vec<usize>> = plants.map(|(cells, _)| cells).collect();
        if !(2..=MOST_PLANTS).contains(&plants.len()) {
            return None;
        }
        self.count = plants.len();
        for (plant, cells) in (0u8..).zip(plants) {
            for cell in cells {
                self.plant_of[*cell] = plant;
            }
        }
        self.spread();
        Some(())
    }

    /// Cells with something above them, those no farther apart than `reach` cells together.
    fn clusters(&self, is_bare: &[bool], reach: usize) -> Vec<Vec<usize>> {
        let mut is_known = is_bare.to_vec();
        let mut clusters = Vec::new();
        for first in 0..is_bare.len() {
            if is_known[first] {
                continue;
            }
            is_known[first] = true;
            let mut cluster = vec![first];
            let mut next = 0;
            while let Some(&cell) = cluster.get(next) {
                next += 1;
                let [column, row] = [cell % self.size[0], cell / self.size[0]];
                let rows = row.saturating_sub(reach)..(row + reach + 1).min(self.size[1]);
                let columns = column.saturating_sub(reach)..(column + reach + 1).min(self.size[0]);
                for near in rows.flat_map(|row| columns.clone().map(move |column| (row, column))) {
                    let near = near.0 * self.size[0] + near.1;
                    if !is_known[near] {
                        is_known[near] = true;
                        cluster.push(near);
                    }
                }
            }
            clusters.push(cluster);
        }
        clusters
    }

    /// The largest extent of what stands above some cells.
    fn extent(&self, cells: &[usize], (lowest, highest): (&[f64], &[f64])) -> f64 {
        let mut low = [usize::MAX; 2];
        let mut high = [0; 2];
        let (mut bottom, mut top) = (f64::INFINITY, f64::NEG_INFINITY);
        for cell in cells {
            let at = [cell % self.size[0], cell / self.size[0]];
            for axis in 0..2 {
                low[axis] = low[axis].min(at[axis]);
                high[axis] = high[axis].max(at[axis]);
            }
            bottom = bottom.min(lowest[*cell]);
            top = top.max(highest[*cell]);
        }
        let sides = [0, 1].map(|axis| (high[axis] - low[axis] + 1) as f64 * self.cell);
        sides[0].max(sides[1]).max(top - bottom)
    }

    /// Gives every other cell to its nearest plant.
    fn spread(&mut self) {
        let known = (0..self.plant_of.len()).filter(|k| self.plant_of[*k] != BARE);
        let mut queue: VecDeque<usize> = known.collect();
        while let Some(cell) = queue.pop_front() {
            let [column, row] = [cell % self.size[0], cell / self.size[0]];
            let mut beside = Vec::with_capacity(4);
            if column > 0 {
                beside.push(cell - 1);
            }
            if column + 1 < self.size[0] {
                beside.push(cell + 1);
            }
            if row > 0 {
                beside.push(cell - self.size[0]);
            }
            if row + 1 < self.size[1] {
                beside.push(cell + self.size[0]);
            }
            for near in beside {
                if self.plant_of[near] == BARE {
                    self.plant_of[near] = self.plant_of[cell];
                    queue.push_back(near);
                }
            }
        }
    }

    fn plant_at(&self, point: DVec3) -> u8 {
        let [column, row] = self.cell_of(point);
        self.plant_of[row * self.size[0] + column]
    }

    fn cell_of(&self, corner: DVec3) -> [usize; 2] {
        let at = (DVec2::new(corner.x, corner.z) - self.low) / self.cell;
        let within = |at: f64, count: usize| (at.max(0.0) as usize).min(count - 1);
        [within(at.x, self.size[0]), within(at.y, self.size[1])]
    }

    /// The triangles of each plant, by where their middles are.
    fn parts(&self, surfaces: &[Surface]) -> Vec<Vec<Surface>> {
        let part = |plant: u8| {
            let own = |surface: &Surface| {
                let is_own = |corners: &&[u32; 3]| {
                    let corners = corners.map(|c| surface.positions[c as usize]);
                    self.plant_at(corners.iter().sum::<DVec3>() / 3.0) == plant
                };
                Surface {
                    triangles: surface.triangles.iter().filter(is_own).copied().collect(),
                    ..surface.clone()
                }
            };
            surfaces.iter().map(own).collect()
        };
        (0..self.count as u8).map(part).collect()
    }
}

/// The finite corners of the triangles that have them.
fn triangles(surface: &Surface) -> impl Iterator<Item = [DVec3; 3]> + '_ {
    let corners = surface.triangles.iter();
    let corners = corners.map(|t| t.map(|c| surface.positions[c as usize]));
    corners.filter(|corners| corners.iter().all(|c| c.is_finite()))
}

fn bounds(surfaces: &[Surface]) -> [DVec3; 2] {
    let corners = surfaces.iter().flat_map(triangles).flatten();
    corners.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], c| {
        [low.min(c), high.max(c)]
    })
}

/// The sphere about all that is drawn of these surfaces, by the middle of their box.
pub(super) fn sphere_of(surfaces: &[Surface]) -> BoundingSphere {
    let [low, high] = bounds(surfaces);
    let centre = 0.5 * (low + high);
    if !centre.is_finite() {
        return BoundingSphere {
            centre: DVec3::ZERO,
            radius: 0.0,
        };
    }
    let corners = surfaces.iter().flat_map(triangles).flatten();
    let radius = corners
        .map(|c| c.distance_squared(centre))
        .fold(0.0, f64::max);
    BoundingSphere {
        centre,
        radius: radius.sqrt(),
    }
}
