//! An order to bytes.

use std::collections::HashMap;

use secateur_model::{
    CornerRef, Foliage, Growth, LeafId, LodModel, NewCorner, NewLeaf, Place, RemovalOrder,
};

use super::bits::BitWriter;
use super::{
    HEADER_BYTES, MAGIC, PLANES_OF_CORNERS, PLANES_OF_TRIANGLES, corner_of, donor_of, is_shape,
    width,
};

/// A corner by its bits, so that equal ones are found.
type CornerKey = (u8, [u32; 3], [u64; 3], u32);

/// The bytes of a model's order, which [`read_order`](super::read_order) takes: equal models give
/// equal bytes. `foliage` is that of the model.
pub fn write_order(model: &LodModel, foliage: &Foliage) -> Vec<u8> {
    let order = model.order();
    let shapes = Shapes::of(order, foliage);
    let version = match order.made().iter().all(has_planes_of_triangles) {
        true => PLANES_OF_TRIANGLES,
        false => PLANES_OF_CORNERS,
    };
    let mut writer = Writer {
        order,
        version,
        name_bits: width(order.name_count()),
        leaf_bits: width(order.leaf_count() as usize),
        shape_bits: width(shapes.all.len()),
        bits: BitWriter::default(),
    };
    for shape in &shapes.all {
        writer.shape(shape);
    }
    writer.steps(&shapes);
    let bits = writer.bits.into_bytes();
    let mut bytes = Vec::with_capacity(HEADER_BYTES + bits.len());
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&version.to_le_bytes());
    bytes.extend_from_slice(&model.foliage_sha256());
    let counts = [
        order.leaf_count(),
        order.len() as u32,
        order.made().len() as u32,
        shapes.all.len() as u32,
    ];
    bytes.extend(counts.iter().flat_map(|count| count.to_le_bytes()));
    bytes.extend_from_slice(&bits);
    bytes
}

/// The different shapes of leaves that are made of their donors alone.
struct Shapes<'a> {
    all: Vec<&'a NewLeaf>,
    number_of: HashMap<Vec<CornerKey>, usize>,
    foliage: &'a Foliage,
}

impl<'a> Shapes<'a> {
    fn of(order: &'a RemovalOrder, foliage: &'a Foliage) -> Self {
        let mut shapes = Self {
            all: Vec::new(),
            number_of: HashMap::new(),
            foliage,
        };
        for made in order.made().iter().filter(|made| is_shape(made, foliage)) {
            shapes.number_of.entry(key_of(made)).or_insert_with(|| {
                shapes.all.push(made);
                shapes.all.len() - 1
            });
        }
        shapes
    }

    fn number(&self, made: &NewLeaf) -> Option<usize> {
        match is_shape(made, self.foliage) {
            true => self.number_of.get(&key_of(made)).copied(),
            false => None,
        }
    }
}

/// Whether all planes that corners of a new leaf lie in are those of triangles of its donor.
fn has_planes_of_triangles(made: &NewLeaf) -> bool {
    made.triangles
        .iter()
        .flatten()
        .all(|corner| match corner.place {
            Place::InPlaneOf { corners, .. } => {
                let first = corners[0];
                first % 3 == 0 && corners == [first, first + 1, first + 2]
            }
            Place::Of(_) | Place::At(_) => true,
        })
}

/// What two leaves have in common that are made of their donors in the same way.
fn key_of(made: &NewLeaf) -> Vec<CornerKey> {
    let key = |corner: &NewCorner| match corner.place {
        Place::Of(at) => (0, [at.corner; 3], [0; 3], corner.like),
        Place::InPlaneOf { corners, weights } => {
            (1, corners, weights.map(f64::to_bits), corner.like)
        }
        Place::At(at) => (2, [0; 3], at.to_array().map(f64::to_bits), corner.like),
    };
    made.triangles.iter().flatten().map(key).collect()
}

struct Writer<'a> {
    order: &'a RemovalOrder,
    version: u32,
    name_bits: u32,
    leaf_bits: u32,
    shape_bits: u32,
    bits: BitWriter,
}

impl Writer<'_> {
    fn shape(&mut self, shape: &NewLeaf) {
        self.bits.gamma(shape.triangles.len() as u64);
        for corner in shape.triangles.iter().flatten() {
            match corner.place {
                Place::InPlaneOf { corners, weights } => {
                    self.bits.bits(1, 1);
                    self.in_plane(corners, weights, corner.like);
                }
                Place::Of(CornerRef { corner: number, .. }) => {
                    self.bits.bits(0, 1);
                    self.bits.small(number);
                    self.look(number, corner.like);
                }
                Place::At(_) => unreachable!("shapes are of their donors alone"),
            }
        }
    }

    fn steps(&mut self, shapes: &Shapes<'_>) {
        let mut scale = 1.0;
        for step in self.order.steps() {
            let is_new_scale = f64::to_bits(step.survivors_area_scale) != f64::to_bits(scale);
            scale = step.survivors_area_scale;
            let counts = [step.removed.len(), step.grown.len(), step.made.len()];
            match counts {
                [1, 0, 0] if !is_new_scale => self.bits.bits(0b0, 1),
                [1, 1, 0] if !is_new_scale => self.bits.bits(0b01, 2),
                [2, 0, 1] if !is_new_scale => self.bits.bits(0b011, 3),
                _ => {
                    self.bits.bits(0b111, 3);
                    counts.iter().for_each(|&n| self.bits.small(n as u32));
                    self.bits.bits(is_new_scale.into(), 1);
                    if is_new_scale {
                        self.bits.real(scale);
                    }
                }
            }
            self.names(step.removed);
            let names: Vec<LeafId> = step.grown.iter().map(|growth| growth.leaf).collect();
            self.names(&names);
            for Growth { area_scale, .. } in step.grown {
                self.bits.real(*area_scale);
            }
            for (k, made) in step.made.iter().enumerate() {
                self.made(made, step.removed.get(k..).unwrap_or_default(), shapes);
            }
        }
    }

    fn names(&mut self, names: &[LeafId]) {
        let ascend = names.len() > 2 && names.is_sorted_by(|a, b| a < b);
        if names.len() > 2 {
            self.bits.bits(ascend.into(), 1);
        }
        let mut before = 0;
        for name in names {
            match ascend {
                true => self.bits.gamma((name.get() - before).into()),
                false => self.bits.bits(name.get().into(), self.name_bits),
            }
            before = name.get();
        }
    }

    /// `removed` are the step's removed leaves from the one on that has this leaf's place.
    fn made(&mut self, made: &NewLeaf, removed: &[LeafId], shapes: &Shapes<'_>) {
        let near = &removed[..removed.len().min(2)];
        let shape = shapes.number(made);
        self.bits.bits(shape.is_some().into(), 1);
        if let Some(number) = shape {
            self.bits.bits(number as u64, self.shape_bits);
            return self.donor(made.donor, near);
        }
        self.donor(made.donor, near);
        self.bits.gamma(made.triangles.len() as u64);
        let corners = made.triangles.as_flattened();
        for (k, corner) in corners.iter().enumerate() {
            if let Some(earlier) = corners[..k].iter().position(|c| c == corner) {
                self.bits.bits(0b01, 2);
                self.bits.small(earlier as u32);
                continue;
            }
            match corner.place {
                Place::Of(at) => match self.near_corner(at, near) {
                    Some((which, number)) => {
                        self.bits.bits(0b0, 1);
                        self.bits.bits(which as u64, 1);
                        self.bits.small(number);
                        self.look(number, corner.like);
                    }
                    None => {
                        self.bits.bits(0b011, 3);
                        self.bits.bits(at.leaf.get().into(), self.leaf_bits);
                        self.bits.small(at.corner);
                        self.look(at.corner, corner.like);
                    }
                },
                Place::At(at) => {
                    self.bits.bits(0b0111, 4);
                    at.to_array().iter().for_each(|x| self.bits.real(*x));
                    self.bits.small(corner.like);
                }
                Place::InPlaneOf { corners, weights } => {
                    self.bits.bits(0b1111, 4);
                    self.in_plane(corners, weights, corner.like);
                }
            }
        }
    }

    /// Which of the near leaves has this corner, and by what number.
    fn near_corner(&self, at: CornerRef, near: &[LeafId]) -> Option<(usize, u32)> {
        near.iter().enumerate().find_map(|(which, &leaf)| {
            let made = leaf.get().checked_sub(self.order.leaf_count() + 1);
            let mut numbers = match made {
                None => at.corner..at.corner + 1,
                Some(made) => 0..3 * self.order.made()[made as usize].triangles.len() as u32,
            };
            let is_it = |n: &u32| corner_of(self.order, leaf, *n) == Some(at);
            numbers.find(is_it).map(|number| (which, number))
        })
    }

    fn donor(&mut self, donor: LeafId, near: &[LeafId]) {
        let mut of_near = near.iter().map(|leaf| donor_of(self.order, *leaf));
        match of_near.position(|near| near == Some(donor)) {
            Some(0) => self.bits.bits(0b0, 1),
            Some(_) => self.bits.bits(0b01, 2),
            None => {
                self.bits.bits(0b11, 2);
                self.bits.bits(donor.get().into(), self.leaf_bits);
            }
        }
    }

    fn look(&mut self, corner: u32, like: u32) {
        self.bits.bits((corner == like).into(), 1);
        if corner != like {
            self.bits.small(like);
        }
    }

    fn in_plane(&mut self, corners: [u32; 3], weights: [f64; 3], like: u32) {
        match self.version {
            PLANES_OF_TRIANGLES => self.bits.small(corners[0] / 3),
            _ => corners.iter().for_each(|corner| self.bits.small(*corner)),
        }
        weights.iter().for_each(|w| self.bits.real(*w));
        self.bits.small(like);
    }
}
