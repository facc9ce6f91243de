//! A stream to a plant, piece by piece.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{Vec2, Vec3, Vec4};
use secateur_model::{Hold, Material, Surface};

use super::bytes::{Numbers, unpacked};
use super::head::{Head, SurfaceHead};
use super::part::{Part, Vertex};
use super::{MAGIC, PIECE_HEAD_BYTES, START_BYTES, StreamError, VERSION};
use secateur_runtime::wind::{HOLD_WORDS, NOTHING, hold_of};

/// Reads a stream as it arrives.
///
/// Memory is in proportion to the bytes, at most 256 times as much while a piece is unpacked.
#[derive(Debug, Default)]
pub struct StreamReader {
    /// Bytes that belong to no piece that is whole yet.
    waiting: Vec<u8>,
    tag: Option<u32>,
    taken: u64,
    plant: Option<StreamedPlant>,
}

/// A plant that has arrived in part: whole at any time, finer with each piece.
#[derive(Debug)]
pub struct StreamedPlant {
    head: Head,
    materials: Vec<Arc<Material>>,
    pieces: u32,
    steps: u32,
    leaves: u32,
    linear_scale: f32,
    parts: BTreeMap<u32, Placed>,
}

#[derive(Debug)]
struct Placed {
    surface: usize,
    scale: f32,
    part: Part,
}

/// The plant of a stream, or of what there is of it, and how many of its bytes were of use.
///
/// # Errors
/// [`StreamError`]: the first thing that is wrong. An end within a piece is none, but for the first.
pub fn read_stream(bytes: &[u8]) -> Result<(StreamedPlant, u64), StreamError> {
    let mut reader = StreamReader::default();
    reader.push(bytes)?;
    let used = reader.bytes_used();
    Ok((reader.finish()?, used))
}

impl StreamReader {
    /// Takes bytes that have arrived, as many as there are, and returns how many pieces they made
    /// whole.
    ///
    /// # Errors
    /// [`StreamError`]; the plant is that of the pieces before.
    pub fn push(&mut self, bytes: &[u8]) -> Result<u32, StreamError> {
        self.waiting.extend_from_slice(bytes);
        let waiting = std::mem::take(&mut self.waiting);
        let mut at = 0;
        let read = self.read(&waiting, &mut at);
        self.waiting = waiting[at..].to_vec();
        self.taken += at as u64;
        read
    }

    fn read(&mut self, bytes: &[u8], at: &mut usize) -> Result<u32, StreamError> {
        let tag = match self.tag {
            Some(tag) => tag,
            None => {
                let Some(tag) = start(bytes)? else {
                    return Ok(0);
                };
                *at += START_BYTES;
                self.tag = Some(tag);
                tag
            }
        };
        let mut pieces = 0;
        while let Some(piece) = piece_at(&bytes[*at..]) {
            let expected = self.plant.as_ref().map_or(0, |plant| plant.pieces);
            if self.plant.as_ref().is_some_and(StreamedPlant::is_whole) {
                return Err(StreamError::TooLong);
            }
            if piece.tag != tag {
                return Err(StreamError::OtherTree(expected));
            }
            if piece.number != expected {
                let found = piece.number;
                return Err(StreamError::OutOfOrder { found, expected });
            }
            let Some(packed) = piece.packed else {
                break;
            };
            let body = unpacked(packed, piece.bytes);
            let body = body.ok_or(StreamError::Packing(expected))?;
            let damaged = |what| StreamError::Damaged {
                number: expected,
                what,
            };
            match &mut self.plant {
                Some(plant) => plant.refine(Numbers::new(&body)).map_err(damaged)?,
                none => *none = Some(StreamedPlant::first(&body).map_err(damaged)?),
            }
            *at += PIECE_HEAD_BYTES + packed.len();
            pieces += 1;
        }
        Ok(pieces)
    }

    /// The plant, once its first piece is there.
    pub fn plant(&self) -> Option<&StreamedPlant> {
        self.plant.as_ref()
    }

    /// How many bytes the pieces have that are whole.
    pub fn bytes_used(&self) -> u64 {
        self.taken
    }

    /// The plant of what has arrived.
    ///
    /// # Errors
    /// [`StreamError::CutShort`] if there is none yet.
    pub fn finish(self) -> Result<StreamedPlant, StreamError> {
        let left = &self.waiting[..];
        let of_first = match self.tag {
            None => return self.plant.ok_or(cut_short(left.len(), START_BYTES)),
            Some(_) => piece_at(left).map_or(0, |piece| piece.packed_bytes),
        };
        let needed = START_BYTES + PIECE_HEAD_BYTES + of_first as usize;
        self.plant
            .ok_or(cut_short(START_BYTES + left.len(), needed))
    }
}

fn cut_short(found: usize, needed: usize) -> StreamError {
    StreamError::CutShort {
        found: found as u64,
        needed: needed as u64,
    }
}

/// The tag of the pieces, once the stream's start is there.
fn start(bytes: &[u8]) -> Result<Option<u32>, StreamError> {
    let known = bytes.len().min(MAGIC.len());
    if bytes[..known] != MAGIC[..known] {
        return Err(StreamError::NoStream);
    }
    let mut numbers = Numbers::new(bytes);
    numbers.take(MAGIC.len());
    match numbers.word() {
        Some(VERSION) => {}
        Some(other) => return Err(StreamError::Version(other)),
        None => return Ok(None),
    }
    Ok(numbers
        .take(16)
        .and_then(|tag| tag.first_chunk())
        .map(|tag| u32::from_le_bytes(*tag)))
}

/// A piece, or as much as is there of it.
struct PieceBytes<'a> {
    number: u32,
    tag: u32,
    packed_bytes: u32,
    bytes: u32,
    /// Once all of it is there.
    packed: Option<&'a [u8]>,
}

fn piece_at(bytes: &[u8]) -> Option<PieceBytes<'_>> {
    let mut numbers = Numbers::new(bytes);
    let [number, tag, packed_bytes, unpacked] = numbers.words(4)?[..] else {
        return None;
    };
    Some(PieceBytes {
        number,
        tag,
        packed_bytes,
        bytes: unpacked,
        packed: numbers.take(packed_bytes as usize),
    })
}

const ENDS: &str = "it ends before its numbers do, or has one that is not finite";

impl StreamedPlant {
    fn first(body: &[u8]) -> Result<Self, &'static str> {
        let mut numbers = Numbers::new(body);
        let mut chunk = |bytes: usize| {
            let chunk = numbers.take(bytes.checked_next_multiple_of(4)?)?;
            chunk.get(..bytes)
        };
        let lengths = chunk(8).ok_or(ENDS)?;
        let lengths = Numbers::new(lengths).words(2).ok_or(ENDS)?;
        let json = chunk(lengths[0] as usize).ok_or(ENDS)?;
        let pictures = chunk(lengths[1] as usize).ok_or(ENDS)?;
        let head: Head = serde_json::from_slice(json).map_err(|_| "its head cannot be read")?;
        let materials = head.materials(pictures)?;
        let mut plant = Self {
            materials,
            pieces: 0,
            steps: head.steps,
            leaves: 0,
            linear_scale: 1.0,
            parts: BTreeMap::new(),
            head,
        };
        plant.refine(numbers)?;
        Ok(plant)
    }

    /// Follows a body; the plant stays as it was where that fails.
    fn refine(&mut self, mut numbers: Numbers<'_>) -> Result<(), &'static str> {
        let [steps, leaves] = numbers.words(2).ok_or(ENDS)?[..] else {
            return Err(ENDS);
        };
        let linear_scale = numbers.floats(1).ok_or(ENDS)?[0];
        let counts = numbers.words(2).ok_or(ENDS)?;
        let gone = numbers.words(counts[0] as usize).ok_or(ENDS)?;
        let resized = numbers.words(counts[1] as usize).ok_or(ENDS)?;
        let scales = numbers.floats(counts[1] as usize).ok_or(ENDS)?;
        let mut new: BTreeMap<u32, Placed> = BTreeMap::new();
        for (surface, of) in self.head.surfaces.iter().enumerate() {
            for (name, placed) in parts(&mut numbers, surface, of)? {
                let is_known = self.parts.contains_key(&name) || new.contains_key(&name);
                if is_known || name == 0 {
                    return Err("it brings a part that is there already");
                }
                new.insert(name, placed);
            }
        }
        if !numbers.is_empty() {
            return Err("it goes on behind its last number");
        }
        if gone
            .iter()
            .chain(&resized)
            .any(|name| !self.parts.contains_key(name))
        {
            return Err("it changes a part that is not there");
        }
        for name in &gone {
            self.parts.remove(name);
        }
        for (name, scale) in resized.iter().zip(scales) {
            if let Some(placed) = self.parts.get_mut(name) {
                placed.scale = scale;
            }
        }
        self.parts.append(&mut new);
        self.pieces += 1;
        (self.steps, self.leaves, self.linear_scale) = (steps, leaves, linear_scale);
        Ok(())
    }

    /// What the plant is called.
    pub fn name(&self) -> &str {
        &self.head.name
    }

    /// Whether all of it has arrived: then it is the original.
    pub fn is_whole(&self) -> bool {
        self.pieces >= self.head.pieces
    }

    /// How many pieces have arrived, and how many there are.
    pub fn pieces(&self) -> [u32; 2] {
        [self.pieces, self.head.pieces]
    }

    /// How many leaves it has now, and how many the original has.
    pub fn leaves(&self) -> [u32; 2] {
        [self.leaves, self.head.leaves]
    }

    /// How many triangles it has now, wood included, and how many the original has.
    pub fn triangles(&self) -> [u64; 2] {
        let now = self.parts.values().map(|p| p.part.triangles.len() as u64);
        [now.sum(), self.head.triangles]
    }

    /// How many steps of the removal order are made, and how many it has.
    pub fn steps(&self) -> [u32; 2] {
        [self.steps, self.head.steps]
    }

    /// The hash of the removal order, as reports have it.
    pub fn order_sha256(&self) -> &str {
        &self.head.order_sha256
    }

    /// The plant as it is now, as textured triangles, each surface with whether it is foliage.
    pub fn surfaces(&self) -> Vec<(Surface, bool)> {
        let heads = self.head.surfaces.iter().zip(&self.materials);
        let mut surfaces: Vec<(Surface, bool)> = heads
            .map(|(head, material)| (empty(material), head.is_foliage))
            .collect();
        for (name, placed) in &self.parts {
            let head = &self.head.surfaces[placed.surface];
            let surface = &mut surfaces[placed.surface].0;
            let is_original_leaf = head.is_foliage && *name <= self.head.leaf_names;
            let scale = match is_original_leaf {
                true => placed.scale * self.linear_scale,
                false => placed.scale,
            };
            append(surface, head, &placed.part, scale);
        }
        surfaces
    }
}

fn empty(material: &Arc<Material>) -> Surface {
    Surface::empty(Arc::clone(material))
}

fn append(surface: &mut Surface, head: &SurfaceHead, part: &Part, scale: f32) {
    let first = surface.positions.len() as u32;
    let vertices = &part.vertices;
    let placed = |v: &Vertex| match scale == 1.0 {
        true => v.position.as_dvec3(),
        false => (part.centre + (v.position - part.centre) * scale).as_dvec3(),
    };
    surface.positions.extend(vertices.iter().map(placed));
    if head.normals {
        let normals = vertices.iter().map(|v| unfolded(v.normal));
        surface.normals.extend(normals);
    }
    if head.uvs {
        surface.uvs.extend(vertices.iter().map(|v| v.uv));
    }
    if head.colors {
        let share = |x: u16| f32::from(x) / f32::from(u16::MAX);
        let colors = vertices
            .iter()
            .map(|v| Vec4::from_array(v.color.map(share)));
        surface.colors.extend(colors);
    }
    if head.holds {
        surface.holds.extend(vertices.iter().map(|v| v.hold));
    }
    let triangles = part
        .triangles
        .iter()
        .map(|t| t.map(|corner| first + corner));
    surface.triangles.extend(triangles);
}

/// The normal that was folded onto a square: see `preview::octahedral`.
fn unfolded(folded: [u16; 2]) -> Vec3 {
    let [u, v] = folded.map(|x| f32::from(x as i16) / f32::from(i16::MAX));
    let z = 1.0 - u.abs() - v.abs();
    let below = (-z).max(0.0);
    Vec3::new(u - below.copysign(u), v - below.copysign(v), z).normalize_or(Vec3::Y)
}

/// What the next vertices hang on.
fn holds(numbers: &mut Numbers<'_>, vertices: usize) -> Option<Vec<Hold>> {
    let words = numbers.words(vertices.checked_mul(HOLD_WORDS)?)?;
    let (words, _) = words.as_chunks::<HOLD_WORDS>();
    words.iter().map(|words| hold_of(*words)).collect()
}

/// All vertices that a body has for a surface, one quantity after the other.
struct VertexColumns {
    positions: Vec<f32>,
    normals: Option<Vec<u16>>,
    uvs: Option<Vec<f32>>,
    colors: Option<Vec<u16>>,
    holds: Option<Vec<Hold>>,
}

impl VertexColumns {
    /// The next columns; none if the bytes end before.
    fn read(numbers: &mut Numbers<'_>, vertices: usize, of: &SurfaceHead) -> Option<Self> {
        let positions = numbers.floats(vertices.checked_mul(3)?)?;
        // The positions are there, so this number is small.
        let normals = match of.normals {
            true => Some(numbers.shorts(vertices * 2)?),
            false => None,
        };
        let uvs = match of.uvs {
            true => Some(numbers.floats(vertices * 2)?),
            false => None,
        };
        let colors = match of.colors {
            true => Some(numbers.shorts(vertices * 4)?),
            false => None,
        };
        let holds = match of.holds {
            true => Some(holds(numbers, vertices)?),
            false => None,
        };
        Some(Self {
            positions,
            normals,
            uvs,
            colors,
            holds,
        })
    }

    fn vertex(&self, k: usize) -> Vertex {
        Vertex {
            position: Vec3::from_slice(&self.positions[3 * k..]),
            normal: self
                .normals
                .as_ref()
                .map_or([0; 2], |n| [n[2 * k], n[2 * k + 1]]),
            uv: self
                .uvs
                .as_ref()
                .map_or(Vec2::ZERO, |uv| Vec2::from_slice(&uv[2 * k..])),
            color: self.colors.as_ref().map_or([u16::MAX; 4], |c| {
                [0, 1, 2, 3].map(|channel| c[4 * k + channel])
            }),
            hold: self.holds.as_ref().map_or(NOTHING, |holds| holds[k]),
        }
    }
}

/// The parts that a body has for a surface.
fn parts(
    numbers: &mut Numbers<'_>,
    surface: usize,
    of: &SurfaceHead,
) -> Result<Vec<(u32, Placed)>, &'static str> {
    let counts = numbers.words(3).ok_or(ENDS)?;
    let [count, vertices, triangles] = [0, 1, 2].map(|k| counts[k] as usize);
    let names = numbers.words(count).ok_or(ENDS)?;
    let vertices_of = numbers.words(count).ok_or(ENDS)?;
    let triangles_of = numbers.words(count).ok_or(ENDS)?;
    let three = |count: usize| count.checked_mul(3).ok_or(ENDS);
    let centres = numbers.floats(three(count)?).ok_or(ENDS)?;
    let scales = numbers.floats(count).ok_or(ENDS)?;
    let columns = VertexColumns::read(numbers, vertices, of).ok_or(ENDS)?;
    let corners = numbers.words(three(triangles)?).ok_or(ENDS)?;
    let sum = |counts: &[u32]| counts.iter().map(|n| u64::from(*n)).sum::<u64>();
    if sum(&vertices_of) != vertices as u64 || sum(&triangles_of) != triangles as u64 {
        return Err("its parts have other numbers of vertices or triangles than it says");
    }
    let (corners, _) = corners.as_chunks::<3>();
    let (mut first_vertex, mut first_triangle) = (0, 0);
    let mut parts = Vec::with_capacity(count);
    for (index, &name) in names.iter().enumerate() {
        let own = vertices_of[index] as usize;
        let vertices = (first_vertex..first_vertex + own).map(|k| columns.vertex(k));
        let end = first_triangle + triangles_of[index] as usize;
        let triangles = corners[first_triangle..end].to_vec();
        if triangles
            .iter()
            .flatten()
            .any(|corner| *corner as usize >= own)
        {
            return Err("a triangle has a corner that its part has not");
        }
        let part = Part {
            centre: Vec3::from_slice(&centres[3 * index..]),
            vertices: vertices.collect(),
            triangles,
        };
        first_vertex += own;
        first_triangle = end;
        parts.push((
            name,
            Placed {
                surface,
                scale: scales[index],
                part,
            },
        ));
    }
    Ok(parts)
}
