//! Bytes to an order.

use glam::DVec3;
use secateur_model::{
    CornerRef, Foliage, Growth, LeafId, LodModel, NewCorner, NewLeaf, Place, RemovalOrder, Step,
};

use super::bits::BitReader;
use super::{
    HEADER_BYTES, MAGIC, OrderFileError, PLANES_OF_CORNERS, PLANES_OF_TRIANGLES, corner_of,
    donor_of, width,
};

/// The model whose order these bytes are, of this foliage.
///
/// Memory is in proportion to the bytes and to the foliage, whatever the bytes claim.
///
/// # Errors
/// [`OrderFileError`]: the first thing that is wrong.
pub fn read_order(bytes: &[u8], foliage: &Foliage) -> Result<LodModel, OrderFileError> {
    let begins = bytes.get(..MAGIC.len()).map_or_else(
        || MAGIC.starts_with(bytes) && !bytes.is_empty(),
        |magic| magic == MAGIC,
    );
    if !begins {
        return Err(OrderFileError::NoOrder);
    }
    let (head, bits) = bytes
        .split_at_checked(HEADER_BYTES)
        .ok_or(OrderFileError::TruncatedHead(bytes.len()))?;
    let number = |at: usize| {
        let bytes = head[at..at + 4].try_into().expect("four bytes");
        u32::from_le_bytes(bytes)
    };
    let version = number(12);
    if ![PLANES_OF_TRIANGLES, PLANES_OF_CORNERS].contains(&version) {
        return Err(OrderFileError::Version(version));
    }
    let [leaf_count, steps, made_count, shape_count] = [48, 52, 56, 60].map(number);
    if head[16..48] != foliage.sha256() || leaf_count as usize != foliage.leaves().len() {
        return Err(OrderFileError::OtherTree);
    }
    let mut reader = Reader {
        foliage,
        version,
        name_bits: width(leaf_count as usize + made_count as usize),
        leaf_bits: width(leaf_count as usize),
        shape_bits: width(shape_count as usize),
        shapes: Vec::new(),
        bits: BitReader::new(bits),
        order: RemovalOrder::new(leaf_count),
    };
    let cut = |part, index, count| OrderFileError::Truncated {
        part,
        number: index as usize + 1,
        count,
    };
    for index in 0..shape_count {
        let shape = reader.shape().ok_or(cut("shape", index, shape_count))?;
        reader.shapes.push(shape);
    }
    let mut scale = 1.0;
    for index in 0..steps {
        scale = reader.step(scale).map_err(|why| match why {
            Why::Ends => cut("step", index, steps),
            Why::NoSuchThing => OrderFileError::NoSuchThing(index as usize + 1),
        })?;
    }
    let Reader { bits, order, .. } = reader;
    if bits.left() >= 8 {
        return Err(OrderFileError::TooLong(bits.left() / 8));
    }
    if order.made().len() != made_count as usize {
        return Err(OrderFileError::MadeCount {
            made: order.made().len(),
            claimed: made_count,
        });
    }
    Ok(LodModel::new(order, foliage)?)
}

/// What is wrong with a step.
enum Why {
    Ends,
    NoSuchThing,
}

/// Bits that were there, or the file's end.
fn there<T>(read: Option<T>) -> Result<T, Why> {
    read.ok_or(Why::Ends)
}

fn known<T>(found: Option<T>) -> Result<T, Why> {
    found.ok_or(Why::NoSuchThing)
}

/// A corner of a shape: of a donor that is not known yet.
#[derive(Clone, Copy)]
enum ShapeCorner {
    Of { corner: u32, like: u32 },
    InPlane(NewCorner),
}

struct Reader<'a> {
    foliage: &'a Foliage,
    version: u32,
    name_bits: u32,
    leaf_bits: u32,
    shape_bits: u32,
    shapes: Vec<Vec<[ShapeCorner; 3]>>,
    bits: BitReader<'a>,
    order: RemovalOrder,
}

impl Reader<'_> {
    fn shape(&mut self) -> Option<Vec<[ShapeCorner; 3]>> {
        let count = self.bits.gamma()?;
        let mut triangles = Vec::new();
        for _ in 0..count {
            let mut corner = || self.shape_corner();
            triangles.push([corner()?, corner()?, corner()?]);
        }
        Some(triangles)
    }

    fn shape_corner(&mut self) -> Option<ShapeCorner> {
        if self.bits.bit()? {
            return self.in_plane().map(ShapeCorner::InPlane);
        }
        let corner = self.bits.small()?;
        let like = self.look(corner)?;
        Some(ShapeCorner::Of { corner, like })
    }

    /// Appends a step and returns the survivors' scale after it.
    fn step(&mut self, scale: f64) -> Result<f64, Why> {
        let (counts, scale) = there(self.head(scale))?;
        let removed = self.names(counts[0])?;
        let names = self.names(counts[1])?;
        let mut grown = Vec::with_capacity(names.len());
        for leaf in names {
            let area_scale = there(self.bits.real())?;
            grown.push(Growth { leaf, area_scale });
        }
        let mut made = Vec::new();
        for k in 0..counts[2] as usize {
            let near = removed.get(k..).unwrap_or_default();
            made.push(self.made(&near[..near.len().min(2)])?);
        }
        self.order.push_unchecked(Step {
            removed: &removed,
            grown: &grown,
            made: &made,
            survivors_area_scale: scale,
        });
        Ok(scale)
    }

    /// How many leaves go, grow and are made, and the survivors' scale.
    fn head(&mut self, scale: f64) -> Option<([u32; 3], f64)> {
        let bits = &mut self.bits;
        if !bits.bit()? {
            return Some(([1, 0, 0], scale));
        }
        if !bits.bit()? {
            return Some(([1, 1, 0], scale));
        }
        if !bits.bit()? {
            return Some(([2, 0, 1], scale));
        }
        let counts = [bits.small()?, bits.small()?, bits.small()?];
        let scale = match bits.bit()? {
            true => bits.real()?,
            false => scale,
        };
        Some((counts, scale))
    }

    fn names(&mut self, count: u32) -> Result<Vec<LeafId>, Why> {
        let ascend = count > 2 && there(self.bits.bit())?;
        let mut names: Vec<LeafId> = Vec::new();
        let mut before = 0_u64;
        for _ in 0..count {
            let number = match ascend {
                true => before + there(self.bits.gamma())?,
                false => there(self.bits.bits(self.name_bits))?,
            };
            before = number;
            names.push(known(named(number))?);
        }
        Ok(names)
    }

    fn made(&mut self, near: &[LeafId]) -> Result<NewLeaf, Why> {
        if there(self.bits.bit())? {
            let number = there(self.bits.bits(self.shape_bits))? as usize;
            let donor = self.donor(near)?;
            return self.of_shape(number, donor);
        }
        let donor = self.donor(near)?;
        let count = there(self.bits.gamma())?;
        let mut corners: Vec<NewCorner> = Vec::new();
        for _ in 0..3 * count {
            let corner = self.corner(near, &corners)?;
            corners.push(corner);
        }
        Ok(NewLeaf {
            donor,
            triangles: corners.as_chunks().0.to_vec(),
        })
    }

    /// A shape has at most as many triangles as what it is made of: a few bits must not make many.
    fn of_shape(&self, number: usize, donor: LeafId) -> Result<NewLeaf, Why> {
        let shape = known(self.shapes.get(number))?;
        let leaves = self.foliage.leaves().len();
        if donor.index() >= leaves || shape.len() > self.foliage.triangles_of(donor).len() {
            return Err(Why::NoSuchThing);
        }
        let placed = |corner: ShapeCorner| match corner {
            ShapeCorner::InPlane(corner) => corner,
            ShapeCorner::Of { corner, like } => NewCorner {
                place: Place::Of(CornerRef {
                    leaf: donor,
                    corner,
                }),
                like,
            },
        };
        Ok(NewLeaf {
            donor,
            triangles: shape.iter().map(|triangle| triangle.map(placed)).collect(),
        })
    }

    fn corner(&mut self, near: &[LeafId], earlier: &[NewCorner]) -> Result<NewCorner, Why> {
        if !there(self.bits.bit())? {
            let which = there(self.bits.bits(1))? as usize;
            let number = there(self.bits.small())?;
            let like = there(self.look(number))?;
            let leaf = *known(near.get(which))?;
            let at = known(corner_of(&self.order, leaf, number))?;
            return Ok(NewCorner {
                place: Place::Of(at),
                like,
            });
        }
        if !there(self.bits.bit())? {
            let number = there(self.bits.small())?;
            return known(earlier.get(number as usize).copied());
        }
        if !there(self.bits.bit())? {
            let number = there(self.bits.bits(self.leaf_bits))?;
            let corner = there(self.bits.small())?;
            let like = there(self.look(corner))?;
            let leaf = known(named(number))?;
            return Ok(NewCorner {
                place: Place::Of(CornerRef { leaf, corner }),
                like,
            });
        }
        if there(self.bits.bit())? {
            return there(self.in_plane());
        }
        let mut real = || there(self.bits.real());
        let place = Place::At(DVec3::new(real()?, real()?, real()?));
        let like = there(self.bits.small())?;
        Ok(NewCorner { place, like })
    }

    fn donor(&mut self, near: &[LeafId]) -> Result<LeafId, Why> {
        let which = match there(self.bits.bit())? {
            false => 0,
            true if !there(self.bits.bit())? => 1,
            true => {
                let number = there(self.bits.bits(self.leaf_bits))?;
                return known(named(number));
            }
        };
        let leaf = *known(near.get(which))?;
        known(donor_of(&self.order, leaf))
    }

    fn look(&mut self, corner: u32) -> Option<u32> {
        match self.bits.bit()? {
            true => Some(corner),
            false => self.bits.small(),
        }
    }

    fn in_plane(&mut self) -> Option<NewCorner> {
        let corners = match self.version {
            PLANES_OF_TRIANGLES => {
                let first = self.bits.small()?.checked_mul(3)?;
                [first, first.checked_add(1)?, first.checked_add(2)?]
            }
            _ => [self.bits.small()?, self.bits.small()?, self.bits.small()?],
        };
        let mut real = || self.bits.real();
        let weights = [real()?, real()?, real()?];
        Some(NewCorner {
            place: Place::InPlaneOf { corners, weights },
            like: self.bits.small()?,
        })
    }
}

/// The leaf of a number from a file.
fn named(number: u64) -> Option<LeafId> {
    LeafId::new(u32::try_from(number).ok()?)
}
