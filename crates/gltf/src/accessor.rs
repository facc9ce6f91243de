//! Accessors: elements in buffers, every layout glTF allows.

use std::borrow::Cow;

use serde_json::Value;

use super::Document;
use super::error::{ALLOW_MORE, At, Fault, Problem};
use super::property;

/// The type of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Component {
    /// Signed 8-bit integer, glTF's 5120.
    I8,
    /// Unsigned 8-bit integer, glTF's 5121.
    U8,
    /// Signed 16-bit integer, glTF's 5122.
    I16,
    /// Unsigned 16-bit integer, glTF's 5123.
    U16,
    /// Unsigned 32-bit integer, glTF's 5125.
    U32,
    /// 32-bit float, glTF's 5126.
    F32,
}

impl Component {
    pub(super) fn from_code(json: &Value) -> Result<Self, Problem> {
        let code = property::whole(json, "componentType")?;
        Ok(match code.ok_or(Problem::Missing("componentType"))? {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            other => {
                return Err(Problem::BadProperty {
                    property: "componentType",
                    expected: "one of 5120 to 5123, 5125 and 5126",
                    found: other.to_string(),
                });
            }
        })
    }

    /// glTF's own number for it.
    pub(crate) fn code(self) -> u32 {
        match self {
            Self::I8 => 5120,
            Self::U8 => 5121,
            Self::I16 => 5122,
            Self::U16 => 5123,
            Self::U32 => 5125,
            Self::F32 => 5126,
        }
    }

    /// Bytes a component takes.
    pub(crate) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// Appends the little-endian bytes of the component that is nearest to a number.
    pub(crate) fn push(self, number: f64, bytes: &mut Vec<u8>) {
        match self {
            Self::I8 => bytes.extend((number as i8).to_le_bytes()),
            Self::U8 => bytes.extend((number as u8).to_le_bytes()),
            Self::I16 => bytes.extend((number as i16).to_le_bytes()),
            Self::U16 => bytes.extend((number as u16).to_le_bytes()),
            Self::U32 => bytes.extend((number as u32).to_le_bytes()),
            Self::F32 => bytes.extend((number as f32).to_le_bytes()),
        }
    }

    /// A component from its little-endian bytes.
    fn value(self, b: &[u8], normalized: bool) -> f64 {
        let (value, largest) = match self {
            Self::I8 => (f64::from(b[0] as i8), 127.0),
            Self::U8 => (f64::from(b[0]), 255.0),
            Self::I16 => (f64::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
            Self::U16 => (f64::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
            Self::U32 => (
                f64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])),
                f64::from(u32::MAX),
            ),
            Self::F32 => {
                let value = f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
                return f64::from(value);
            }
        };
        if normalized {
            (value / largest).max(-1.0)
        } else {
            value
        }
    }
}

/// The type of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    /// A single component, such as an index.
    Scalar,
    /// Two to four components.
    Vector(usize),
    /// Two to four columns of as many components, each column on a multiple of
    /// four bytes.
    Matrix(usize),
}

impl Shape {
    fn from_name(json: &Value) -> Result<Self, Problem> {
        Ok(
            match property::text(json, "type")?.ok_or(Problem::Missing("type"))? {
                "SCALAR" => Self::Scalar,
                "VEC2" => Self::Vector(2),
                "VEC3" => Self::Vector(3),
                "VEC4" => Self::Vector(4),
                "MAT2" => Self::Matrix(2),
                "MAT3" => Self::Matrix(3),
                "MAT4" => Self::Matrix(4),
                other => {
                    return Err(Problem::BadProperty {
                        property: "type",
                        expected: "one of SCALAR, VEC2 to VEC4, MAT2 to MAT4",
                        found: super::error::shortened(other),
                    });
                }
            },
        )
    }

    /// Components of an element.
    pub(crate) fn components(self) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Vector(n) => n,
            Self::Matrix(n) => n * n,
        }
    }

    /// Bytes an element takes, with the padding between the columns of a matrix.
    pub(crate) fn bytes(self, component: Component) -> usize {
        match self {
            Self::Scalar => component.bytes(),
            Self::Vector(n) => n * component.bytes(),
            Self::Matrix(n) => n * (n * component.bytes()).next_multiple_of(4),
        }
    }
}

/// What an accessor is, before any of its data is looked at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Accessor {
    pub(crate) index: usize,
    pub(crate) count: usize,
    pub(crate) component: Component,
    pub(crate) shape: Shape,
    pub(crate) normalized: bool,
    pub(crate) view: Option<usize>,
    pub(crate) byte_offset: usize,
    pub(crate) is_sparse: bool,
}

impl Accessor {
    /// Bytes an element takes when elements are packed tightly.
    pub(crate) fn element_bytes(&self) -> usize {
        self.shape.bytes(self.component)
    }

    /// Such as `VEC3 of FLOAT`.
    pub(crate) fn kind(&self) -> String {
        let shape = match self.shape {
            Shape::Scalar => "SCALAR".to_owned(),
            Shape::Vector(n) => format!("VEC{n}"),
            Shape::Matrix(n) => format!("MAT{n}"),
        };
        let component = match self.component {
            Component::I8 => "BYTE",
            Component::U8 => "UNSIGNED_BYTE",
            Component::I16 => "SHORT",
            Component::U16 => "UNSIGNED_SHORT",
            Component::U32 => "UNSIGNED_INT",
            Component::F32 => "FLOAT",
        };
        format!("{shape} of {component}")
    }
}

/// The elements of an accessor, packed tightly, sparse ones put in.
#[derive(Clone, Debug)]
pub(crate) struct Elements<'a> {
    pub(crate) accessor: Accessor,
    /// `count * element_bytes` bytes, little-endian.
    pub(crate) bytes: Cow<'a, [u8]>,
}

impl Elements<'_> {
    /// Elements as arrays of `N` numbers: integers divided by their range where
    /// the accessor is normalised.
    ///
    /// # Panics
    /// If the elements don't have `N` components, or are matrices.
    pub(crate) fn vectors<const N: usize>(&self) -> impl ExactSizeIterator<Item = [f64; N]> + '_ {
        let accessor = &self.accessor;
        assert!(
            accessor.shape.components() == N && !matches!(accessor.shape, Shape::Matrix(_)),
            "{} is not {N} numbers",
            accessor.kind()
        );
        let (component, normalized) = (accessor.component, accessor.normalized);
        let size = component.bytes();
        self.bytes
            .chunks_exact(accessor.element_bytes())
            .map(move |element| {
                std::array::from_fn(|k| component.value(&element[k * size..], normalized))
            })
    }

    /// Unsigned whole numbers: indices.
    ///
    /// # Panics
    /// If the accessor isn't SCALAR of an unsigned type.
    pub(crate) fn indices(&self) -> Vec<u32> {
        let accessor = &self.accessor;
        assert!(is_index(accessor), "{} is no index", accessor.kind());
        let word = |b: &[u8]| match *b {
            [a] => u32::from(a),
            [a, b] => u32::from(u16::from_le_bytes([a, b])),
            [a, b, c, d] => u32::from_le_bytes([a, b, c, d]),
            _ => unreachable!("an index takes 1, 2 or 4 bytes"),
        };
        self.bytes
            .chunks_exact(accessor.element_bytes())
            .map(word)
            .collect()
    }
}

/// Whether an accessor can hold the indices of a primitive.
pub(crate) fn is_index(accessor: &Accessor) -> bool {
    use Component::{U8, U16, U32};
    accessor.shape == Shape::Scalar && matches!(accessor.component, U8 | U16 | U32)
}

/// The most bytes of zeros that accessors without a bufferView stand for, however
/// large the file.
const MAX_ZERO_BYTES: u64 = 64 << 20;

/// Bytes of zeros allowed however small the file: 64 KiB.
const FREE_ZERO_BYTES: u64 = 64 << 10;

/// Bytes of zeros allowed for each byte of the file's buffers. Sparse morph targets
/// need some: each stands for all vertices, which are data elsewhere, perhaps
/// compressed.
const ZERO_BYTES_PER_BYTE: u64 = 64;

impl Document {
    /// What `accessors[index]` is. Its range within its bufferView is checked.
    pub(crate) fn accessor(&self, index: usize) -> Result<Accessor, Fault> {
        let json = property::entry(&self.root, "accessors", index)?;
        let accessor = self
            .describe(index, json)
            .at(|| self.place("accessors", index))?;
        self.check_extent(&accessor)?;
        Ok(accessor)
    }

    /// What the JSON of an accessor says, not checked against its data.
    pub(crate) fn describe(&self, index: usize, json: &Value) -> Result<Accessor, Problem> {
        Ok(Accessor {
            index,
            count: property::required_index(json, "count")?,
            component: Component::from_code(json)?,
            shape: Shape::from_name(json)?,
            normalized: property::flag(json, "normalized")?,
            view: property::index(json, "bufferView")?,
            byte_offset: property::index(json, "byteOffset")?.unwrap_or(0),
            is_sparse: json.get("sparse").is_some(),
        })
    }

    /// The most bytes of zeros that accessors without data may stand for: memory
    /// follows the size of the file, not what it claims.
    pub(super) fn max_zero_bytes(&self) -> u64 {
        let covered = ZERO_BYTES_PER_BYTE.saturating_mul(self.data_bytes);
        covered.saturating_add(FREE_ZERO_BYTES).min(MAX_ZERO_BYTES)
    }

    fn check_extent(&self, accessor: &Accessor) -> Result<(), Fault> {
        let place = || self.place("accessors", accessor.index);
        let element_bytes = accessor.element_bytes();
        let Some(view) = accessor.view else {
            let bytes = accessor.count as u128 * element_bytes as u128;
            let limit = self.max_zero_bytes();
            if bytes <= u128::from(limit) {
                let what = || format!("{} elements of zeros", accessor.count);
                let taken = self.budget.clone().take(bytes as u64, what, ALLOW_MORE);
                return taken.map_err(Problem::from).at(place);
            }
            return Err(Problem::TooManyZeros {
                count: accessor.count as u64,
                element_bytes,
                limit,
            })
            .at(place);
        };
        let stride = self.stride(accessor, view)?;
        let length = self.view_length(view)?;
        let start = accessor.byte_offset as u128;
        let end = match accessor.count {
            0 => start,
            count => start + (count as u128 - 1) * stride as u128 + element_bytes as u128,
        };
        self.check_range(view, start, end, length).at(place)
    }

    /// Bytes from one element of an accessor to the next in its bufferView.
    fn stride(&self, accessor: &Accessor, view: usize) -> Result<usize, Fault> {
        let json = property::entry(&self.root, "bufferViews", view)
            .at(|| self.place("accessors", accessor.index))?;
        let element_bytes = accessor.element_bytes();
        let place = || self.place("bufferViews", view);
        match property::whole(json, "byteStride").at(place)? {
            None => Ok(element_bytes),
            Some(stride) if (element_bytes as u64..=252).contains(&stride) => Ok(stride as usize),
            Some(stride) => Err(Problem::BadStride {
                stride,
                element_bytes,
            })
            .at(place),
        }
    }

    /// The elements of `accessors[index]`.
    pub(crate) fn elements(&self, index: usize) -> Result<Elements<'_>, Fault> {
        let accessor = self.accessor(index)?;
        let size = accessor.element_bytes();
        let mut bytes = match accessor.view {
            None => Cow::Owned(vec![0; accessor.count * size]),
            Some(view) => {
                let stride = self.stride(&accessor, view)?;
                let held = self.held_view(view)?;
                let start = accessor.byte_offset as u128;
                let extent = match accessor.count {
                    0 => 0,
                    count => (count - 1) * stride + size,
                };
                // A compressed view may hold less than its JSON says.
                self.check_range(view, start, start + extent as u128, held.len() as u64)
                    .at(|| self.place("accessors", index))?;
                let start = if extent == 0 { 0 } else { accessor.byte_offset };
                let data = held.bytes(start..start + extent);
                let data = data.at(|| self.place("bufferViews", view))?;
                if stride == size {
                    data
                } else {
                    let mut tight = Vec::with_capacity(accessor.count * size);
                    for start in (0..accessor.count).map(|element| element * stride) {
                        tight.extend_from_slice(&data[start..start + size]);
                    }
                    Cow::Owned(tight)
                }
            }
        };
        if accessor.is_sparse {
            self.substitute_sparse(&accessor, bytes.to_mut())?;
        }
        Ok(Elements { accessor, bytes })
    }
}
