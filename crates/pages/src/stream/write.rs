//! A tree and its removal order to a stream.

use std::collections::BTreeMap;

use glam::{DVec3, Vec3Swizzles as _};
use secateur_gltf::LeafSurface;
use secateur_model::{Foliage, LeafId, LodModel, UniformLevel};
use sha2::{Digest, Sha256};

use super::bytes::{align, packed, push_floats, push_shorts, push_words};
use super::head::{Head, Look, SurfaceHead};
use super::part::{Leaves, Part};
use super::wood::{self, Wood};
use super::{MAGIC, VERSION, WriteStreamError};
use crate::preview::{PreviewError, Textures, bounds, look};
use secateur_runtime::wind::hold_words;

/// By how much the leaves of a piece's level are more than those of the one before.
const GROWTH: f64 = 1.15;

/// A stream, and how far it has to be read for each of its levels.
#[derive(Clone, Debug, PartialEq)]
pub struct Stream {
    /// The stream's bytes; each prefix that ends with a piece is a plant.
    pub bytes: Vec<u8>,
    /// Its pieces, the coarsest level first.
    pub pieces: Vec<Piece>,
}

/// A piece of a stream, and the level that it ends in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Piece {
    /// How many bytes of the stream end with it.
    pub bytes: u64,
    /// Leaves of the level.
    pub leaves: u32,
    /// Triangles of the level, wood included.
    pub triangles: u64,
    /// Steps of the removal order that are made at the level.
    pub steps: u32,
}

/// The stream of a tree: its surfaces, and a model of all levels of its foliage.
///
/// Takes time in proportion to the triangles, times a logarithm.
///
/// # Errors
/// [`WriteStreamError`] if there is nothing to see, a picture cannot be packed, or the tree is beyond
/// what a stream counts.
///
/// # Panics
/// If the surfaces or the model are of another foliage.
pub fn write_stream(
    name: &str,
    surfaces: &[LeafSurface],
    foliage: &Foliage,
    model: &LodModel,
) -> Result<Stream, WriteStreamError> {
    if surfaces.iter().all(|s| s.surface.triangles.is_empty()) {
        return Err(PreviewError::NothingToShow.into());
    }
    let levels = levels(model);
    let leaves = Leaves::new(surfaces, foliage);
    let wood = wood::pieces(surfaces);
    let names = model.order().name_count() + wood.len();
    u32::try_from(names).map_err(|_| WriteStreamError::TooMany)?;
    let mut changes = changes(model, &levels);
    let comes = comes(model, &changes);
    let arrivals = wood::arrivals(&wood, surfaces, foliage, &comes, levels.len() as u32);

    let mut textures = Textures::default();
    let head = head(name, surfaces, foliage, model, levels.len(), &mut textures)?;
    let tag = tag(model);
    let mut bytes = MAGIC.to_vec();
    push_words(&mut bytes, [VERSION]);
    bytes.extend(tag);
    let mut drawn = Drawn::default();
    let mut pieces = Vec::new();
    for (number, change) in changes.iter_mut().enumerate() {
        let mut body = Vec::new();
        if number == 0 {
            let json = serde_json::to_vec(&head).expect("numbers and texts make JSON");
            push_words(&mut body, [json.len() as u32, textures.bytes.len() as u32]);
            for part in [&json, &textures.bytes] {
                body.extend(part);
                align(&mut body);
            }
        }
        let twigs = (wood.iter().zip(&arrivals).enumerate())
            .filter(|(_, (_, arrival))| **arrival == number as u32)
            .map(|(index, (twig, _))| (model.order().name_count() + index, twig));
        let writer = BodyWriter {
            surfaces,
            leaves: &leaves,
            model,
        };
        writer.body(change, twigs, &mut drawn, &mut body);
        push_piece(&mut bytes, &tag, number as u32, &body)?;
        pieces.push(Piece {
            bytes: bytes.len() as u64,
            leaves: change.leaves,
            triangles: drawn.triangles,
            steps: change.steps,
        });
    }
    Ok(Stream { bytes, pieces })
}

fn push_piece(
    bytes: &mut Vec<u8>,
    tag: &[u8; 16],
    number: u32,
    body: &[u8],
) -> Result<(), WriteStreamError> {
    let length = u32::try_from(body.len()).map_err(|_| WriteStreamError::TooLarge)?;
    let packed = packed(body);
    let tag = u32::from_le_bytes([tag[0], tag[1], tag[2], tag[3]]);
    push_words(bytes, [number, tag, packed.len() as u32, length]);
    bytes.extend(packed);
    Ok(())
}

/// A stream of these bodies, whatever is in them: what tests and the fuzzer need, which would hardly
/// ever find their way through zlib's checksum.
#[doc(hidden)]
pub fn stream_of_bodies<'a>(bodies: impl IntoIterator<Item = &'a [u8]>) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    push_words(&mut bytes, [VERSION]);
    bytes.extend([0; 16]);
    for (number, body) in bodies.into_iter().enumerate() {
        push_piece(&mut bytes, &[0; 16], number as u32, body).expect("a body below 4 GiB");
    }
    bytes
}

/// The steps of each piece's level, the coarsest first, the original last.
fn levels(model: &LodModel) -> Vec<usize> {
    let mut levels = vec![model.order().len()];
    let mut leaves = model.fewest_leaves() as f64;
    while leaves < model.most_leaves() as f64 {
        leaves = (GROWTH * leaves).max(leaves + 1.0);
        let steps = model.steps_to(leaves as usize);
        if levels.last() != Some(&steps) {
            levels.push(steps);
        }
    }
    if levels.last() != Some(&0) {
        levels.push(0);
    }
    levels
}

/// What a level has that the one before has not, and the other way round.
struct Change {
    steps: u32,
    leaves: u32,
    linear_scale: f32,
    gone: Vec<LeafId>,
    resized: Vec<(LeafId, f32)>,
    new: Vec<(LeafId, f32)>,
}

fn changes(model: &LodModel, levels: &[usize]) -> Vec<Change> {
    let mut level = model.finest();
    let mut shown: Vec<f64> = vec![0.0; model.order().name_count()];
    let mut changes = Vec::with_capacity(levels.len());
    for (number, &steps) in levels.iter().enumerate() {
        level.go_to(steps);
        let mut names: Vec<LeafId> = match number {
            0 => (0..shown.len()).map(LeafId::from_index).collect(),
            _ => level.changed().to_vec(),
        };
        names.sort_unstable();
        names.dedup();
        changes.push(change(&level, &names, &mut shown));
    }
    changes
}

fn change(level: &UniformLevel<'_>, names: &[LeafId], shown: &mut [f64]) -> Change {
    let mut change = Change {
        steps: level.steps() as u32,
        leaves: level.leaf_count() as u32,
        linear_scale: level.survivors_area_scale().sqrt() as f32,
        gone: Vec::new(),
        resized: Vec::new(),
        new: Vec::new(),
    };
    for &name in names {
        let now = level.own_area_scale(name).unwrap_or(0.0);
        let before = std::mem::replace(&mut shown[name.index()], now);
        let linear = now.sqrt() as f32;
        match (before == 0.0, now == 0.0) {
            (true, false) => change.new.push((name, linear)),
            (false, true) => change.gone.push(name),
            (false, false) if before != now => change.resized.push((name, linear)),
            _ => {}
        }
    }
    change
}

/// For each original leaf the piece with which it, or one that is like it, comes.
fn comes(model: &LodModel, changes: &[Change]) -> Vec<u32> {
    let originals = model.order().leaf_count() as usize;
    let mut comes = vec![changes.len() as u32; originals];
    for (number, change) in changes.iter().enumerate() {
        for (name, _) in &change.new {
            let leaf = match name.index().checked_sub(originals) {
                None => name.index(),
                Some(made) => model.order().made()[made].donor.index(),
            };
            comes[leaf] = comes[leaf].min(number as u32);
        }
    }
    comes
}

fn head(
    name: &str,
    surfaces: &[LeafSurface],
    foliage: &Foliage,
    model: &LodModel,
    pieces: usize,
    textures: &mut Textures,
) -> Result<Head, WriteStreamError> {
    let mut looks: Vec<Look> = Vec::new();
    let mut of_surfaces = Vec::new();
    for of in surfaces {
        let surface = &of.surface;
        let packed = look(&surface.material, textures)?;
        // Names and kinds are those of a preview page, which draws both.
        let json = serde_json::to_value(&packed).expect("numbers and texts make JSON");
        let mut look: Look = serde_json::from_value(json).expect("a look of the page");
        look.name.clone_from(&surface.material.name);
        let known = looks.iter().position(|other| *other == look);
        let material = known.unwrap_or_else(|| {
            looks.push(look);
            looks.len() - 1
        });
        let of_every = |count: usize| count == surface.positions.len();
        of_surfaces.push(SurfaceHead {
            material,
            is_foliage: of.is_foliage,
            normals: of_every(surface.normals.len()),
            uvs: of_every(surface.uvs.len()),
            colors: of_every(surface.colors.len()),
            holds: of_every(surface.holds.len()),
        });
    }
    let points = || surfaces.iter().flat_map(|s| &s.surface.positions);
    let (low, high) = bounds(points());
    let middle = 0.5 * (low + high);
    let reach = points().map(|p: &DVec3| (*p - middle).xz().length());
    let entries = serde_json::to_value(textures.entries()).expect("numbers make JSON");
    Ok(Head {
        name: name.to_owned(),
        leaves: foliage.leaves().len() as u32,
        triangles: surfaces
            .iter()
            .map(|s| s.surface.triangles.len() as u64)
            .sum(),
        steps: model.order().len() as u32,
        leaf_names: model.order().leaf_count(),
        pieces: pieces as u32,
        order_sha256: model.order().sha256(),
        low: low.to_array(),
        high: high.to_array(),
        reach: reach.fold(0.0, f64::max),
        textures: serde_json::from_value(entries).expect("pictures of the page"),
        materials: looks,
        surfaces: of_surfaces,
    })
}

fn tag(model: &LodModel) -> [u8; 16] {
    let mut hash = Sha256::new();
    hash.update(model.foliage_sha256());
    hash.update(model.order().sha256());
    let mut tag = [0; 16];
    tag.copy_from_slice(&hash.finalize()[..16]);
    tag
}

/// What a reader has at some piece: triangles, and those of each part that may go.
#[derive(Default)]
struct Drawn {
    triangles: u64,
    of_leaf: BTreeMap<LeafId, u64>,
}

struct BodyWriter<'a> {
    surfaces: &'a [LeafSurface],
    leaves: &'a Leaves<'a>,
    model: &'a LodModel,
}

impl BodyWriter<'_> {
    fn body<'w>(
        &self,
        change: &Change,
        twigs: impl Iterator<Item = (usize, &'w Wood)>,
        drawn: &mut Drawn,
        body: &mut Vec<u8>,
    ) {
        push_words(body, [change.steps, change.leaves]);
        push_floats(body, [change.linear_scale]);
        push_words(
            body,
            [change.gone.len() as u32, change.resized.len() as u32],
        );
        push_words(body, change.gone.iter().map(|name| name.get()));
        push_words(body, change.resized.iter().map(|(name, _)| name.get()));
        push_floats(body, change.resized.iter().map(|(_, scale)| *scale));
        for name in &change.gone {
            drawn.triangles -= drawn.of_leaf.remove(name).unwrap_or(0);
        }
        let mut of_surface: Vec<Vec<(u32, f32, Part)>> = Vec::new();
        of_surface.resize_with(self.surfaces.len(), Vec::new);
        for &(name, scale) in &change.new {
            let (surface, part) = self.leaf(name);
            let triangles = part.triangles.len() as u64;
            drawn.triangles += triangles;
            drawn.of_leaf.insert(name, triangles);
            of_surface[surface].push((name.get(), scale, part));
        }
        for (index, twig) in twigs {
            drawn.triangles += twig.triangle_count() as u64;
            of_surface[twig.surface].push((index as u32 + 1, 1.0, twig.part(self.surfaces)));
        }
        for (parts, surface) in of_surface.iter().zip(self.surfaces) {
            push_parts(body, parts, surface);
        }
    }

    fn leaf(&self, name: LeafId) -> (usize, Part) {
        let order = self.model.order();
        match name.index().checked_sub(order.leaf_count() as usize) {
            None => self.leaves.original(name),
            Some(made) => self.leaves.made(&order.made()[made]),
        }
    }
}

fn push_parts(body: &mut Vec<u8>, parts: &[(u32, f32, Part)], of: &LeafSurface) {
    let vertices = || parts.iter().flat_map(|(.., part)| &part.vertices);
    let triangles = || parts.iter().flat_map(|(.., part)| &part.triangles);
    let counts = [parts.len(), vertices().count(), triangles().count()];
    push_words(body, counts.map(|n| n as u32));
    push_words(body, parts.iter().map(|(name, ..)| *name));
    push_words(body, parts.iter().map(|(.., p)| p.vertices.len() as u32));
    push_words(body, parts.iter().map(|(.., p)| p.triangles.len() as u32));
    push_floats(body, parts.iter().flat_map(|(.., p)| p.centre.to_array()));
    push_floats(body, parts.iter().map(|(_, scale, _)| *scale));
    push_floats(body, vertices().flat_map(|v| v.position.to_array()));
    let surface = &of.surface;
    let of_every = |count: usize| count == surface.positions.len();
    if of_every(surface.normals.len()) {
        push_shorts(body, vertices().flat_map(|v| v.normal));
    }
    if of_every(surface.uvs.len()) {
        push_floats(body, vertices().flat_map(|v| v.uv.to_array()));
    }
    if of_every(surface.colors.len()) {
        push_shorts(body, vertices().flat_map(|v| v.color));
    }
    if of_every(surface.holds.len()) {
        push_words(body, vertices().flat_map(|v| hold_words(&v.hold)));
    }
    push_words(body, triangles().flatten().copied());
}
