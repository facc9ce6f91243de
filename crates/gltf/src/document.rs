//! A glTF file as it was found.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicU64;
use std::sync::{Arc, OnceLock};

use serde_json::Value;

use super::buffer::{self, Buffer};
use super::container::{self, Unpacked};
use super::draco::DracoBits;
use super::error::{Fault, GltfError, Problem};
use super::folder;
use super::halves::Halves;
use super::input::read_within;
use super::kept_images::KeptImages;
use super::known_roles::KnownRoles;
use super::property;
use super::selector::Selector;
use super::uri;
use secateur_model::{Budget, Memory};

/// From which size on the buffer of a GLB stays in its file: less is read faster at once.
const LARGE_GLB_BYTES: u64 = 64 << 20;

/// A glTF file as it was found: its JSON, kept whole, and its buffers' bytes.
#[derive(Debug)]
pub struct Document {
    /// The JSON, with everything that this crate doesn't know.
    pub(crate) root: Value,
    /// The JSON as it came, where `root` has another since geometry was decoded.
    pub(crate) undecoded: Option<Arc<Value>>,
    /// How finely numbers were rounded where primitives were compressed by Draco; none where none was.
    pub(crate) draco_bits: Option<DracoBits>,
    /// The bytes of `buffers`, in their order.
    pub(crate) buffers: Vec<Buffer>,
    /// How many bytes these are, those that buffers share counted once.
    pub(crate) data_bytes: u64,
    /// What errors call the file.
    pub(crate) name: String,
    /// The folder in which its URIs are looked up.
    pub(crate) base_dir: Option<PathBuf>,
    /// The decompressed bytes of `bufferViews`, once asked for.
    pub(crate) decompressed_views: Vec<OnceLock<Vec<u8>>>,
    /// How many bytes those are.
    pub(crate) decompressed_bytes: AtomicU64,
    /// What stays decoded, which the levels of its tree share.
    pub(crate) kept_images: Arc<KeptImages>,
    /// What its leaves were named by, where they were.
    pub(crate) selectors: Vec<Selector>,
    /// What is not the plant, where somebody named it.
    pub(crate) not_plant: Vec<Selector>,
    /// Primitives of which pieces were named so.
    pub(crate) halves: Halves,
    /// What parts of the plant that it was made of are.
    pub(crate) known_roles: Option<KnownRoles>,
    /// Whether the alpha of vertex colours is a part of the look, where that is known already.
    pub(crate) vertex_alpha_counts: Option<bool>,
    /// How much memory it was opened with.
    pub(crate) memory: Memory,
    /// What the JSON and the buffers leave of it.
    pub(crate) budget: Budget,
}

impl Document {
    /// What errors call the file: its path, as it was given.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The folder in which its URIs are looked up, where it has one.
    pub fn folder(&self) -> Option<&Path> {
        self.base_dir.as_deref()
    }

    /// How much memory it was opened with.
    pub fn memory(&self) -> Memory {
        self.memory
    }

    /// Reads a .glb or .gltf file and the buffers it names, with the memory of
    /// [`Memory::Auto`]: [`open_within`](Self::open_within).
    ///
    /// # Errors
    /// As [`open_within`](Self::open_within).
    pub fn open(path: &Path) -> Result<Self, GltfError> {
        Self::open_within(path, Memory::Auto)
    }

    /// Reads a .glb or .gltf file and the buffers it names. What it and its images
    /// take of `memory` is reckoned before it is taken, now and whenever more of the
    /// file is asked for.
    ///
    /// Its URIs are looked up in its own folder; if `path` is a symbolic link,
    /// in the folder of the file that it leads to. Links in the folder are
    /// followed as long as they stay in it.
    ///
    /// # Errors
    /// [`GltfError`] if it can't be read, is no glTF 2.0, is truncated, needs
    /// an unknown extension, or a buffer is missing or too short, or a buffer
    /// or an image is outside the file's own folder; [`Problem::Memory`] within it
    /// if the file takes more memory than that.
    pub fn open_within(path: &Path, memory: Memory) -> Result<Self, GltfError> {
        Self::open_keeping(path, memory, LARGE_GLB_BYTES)
    }

    /// As [`open_within`](Self::open_within), but the buffer of a GLB of at least `large_bytes`
    /// bytes stays in its file.
    pub(crate) fn open_keeping(
        path: &Path,
        memory: Memory,
        large_bytes: u64,
    ) -> Result<Self, GltfError> {
        let name = path.display().to_string();
        let folder = folder::of(path);
        let large = || match container::unpack_on_disk(path, memory, large_bytes)? {
            Some(unpacked) => Self::from_unpacked(&name, unpacked, Some(&folder)).map(Some),
            None => Ok(None),
        };
        if let Some(document) = large().map_err(|fault: Fault| GltfError::new(&name, fault))? {
            return Ok(document);
        }
        let bytes = read_within(path, memory)?;
        Self::from_bytes_within(&name, bytes, Some(&folder), memory)
    }

    /// Reads a file from memory. `name` is what errors call it; `base_dir` is
    /// the folder of its URIs, without which only data URIs can be followed.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn from_bytes(
        name: &str,
        bytes: Vec<u8>,
        base_dir: Option<&Path>,
    ) -> Result<Self, GltfError> {
        Self::from_bytes_within(name, bytes, base_dir, Memory::Auto)
    }

    /// [`from_bytes`](Self::from_bytes), with this much memory.
    ///
    /// # Errors
    /// As [`open_within`](Self::open_within).
    pub fn from_bytes_within(
        name: &str,
        bytes: Vec<u8>,
        base_dir: Option<&Path>,
        memory: Memory,
    ) -> Result<Self, GltfError> {
        let parse = || Self::from_unpacked(name, container::unpack(bytes, memory)?, base_dir);
        parse().map_err(|fault| GltfError::new(name, fault))
    }

    /// What its leaves were named by; empty where the evidence showed them.
    pub fn selectors(&self) -> &[Selector] {
        &self.selectors
    }

    /// Its JSON as it was found, with everything that this crate doesn't know.
    pub fn json(&self) -> &Value {
        &self.root
    }

    /// The files beside it that its buffers and images name, whether they are there or not.
    pub fn files(&self) -> Vec<PathBuf> {
        let Some(folder) = &self.base_dir else {
            return Vec::new();
        };
        let items = ["buffers", "images"].map(|list| self.root.get(list).and_then(Value::as_array));
        let uris = items.into_iter().flatten().flatten();
        let uris = uris.filter_map(|item| item.get("uri")?.as_str());
        uris.filter_map(uri::file)
            .map(|relative| folder.join(relative))
            .collect()
    }

    /// The document of a file that is taken apart already.
    pub(crate) fn from_unpacked(
        name: &str,
        unpacked: Unpacked,
        base_dir: Option<&Path>,
    ) -> Result<Self, Fault> {
        let Unpacked {
            root,
            chunk,
            memory,
            mut budget,
        } = unpacked;
        check_extensions(&root)?;
        let buffers = buffer::load_all(&root, chunk, base_dir, &mut budget)?;
        folder::check_images(&root, base_dir)?;
        let views = property::list(&root, "bufferViews")?.len();
        let mut document = Self {
            root,
            undecoded: None,
            draco_bits: None,
            data_bytes: buffer::distinct_bytes(&buffers),
            buffers,
            name: name.to_owned(),
            base_dir: base_dir.map(Path::to_owned),
            decompressed_views: (0..views).map(|_| OnceLock::new()).collect(),
            decompressed_bytes: AtomicU64::new(0),
            kept_images: Arc::default(),
            selectors: Vec::new(),
            not_plant: Vec::new(),
            halves: Halves::new(),
            known_roles: None,
            vertex_alpha_counts: None,
            memory,
            budget,
        };
        document.decode_draco()?;
        Ok(document)
    }

    /// Its JSON as it came.
    pub(crate) fn root_as_it_came(&self) -> &Value {
        self.undecoded.as_deref().unwrap_or(&self.root)
    }

    /// A fault of this file, with its name.
    pub(crate) fn error(&self, fault: impl Into<Fault>) -> GltfError {
        GltfError::new(&self.name, fault)
    }

    /// `accessors[3]`, with the entry's name where it has one.
    pub(crate) fn place(&self, list: &str, index: usize) -> String {
        property::place(&self.root, list, index)
    }
}

/// A copy shares bytes and decoded images; what was decompressed is decompressed again when it
/// is asked for.
impl Clone for Document {
    fn clone(&self) -> Self {
        let views = self.decompressed_views.len();
        Self {
            root: self.root.clone(),
            undecoded: self.undecoded.clone(),
            draco_bits: self.draco_bits,
            buffers: self.buffers.clone(),
            data_bytes: self.data_bytes,
            name: self.name.clone(),
            base_dir: self.base_dir.clone(),
            decompressed_views: (0..views).map(|_| OnceLock::new()).collect(),
            decompressed_bytes: AtomicU64::new(0),
            kept_images: Arc::clone(&self.kept_images),
            selectors: self.selectors.clone(),
            not_plant: self.not_plant.clone(),
            halves: self.halves.clone(),
            known_roles: self.known_roles.clone(),
            vertex_alpha_counts: self.vertex_alpha_counts,
            memory: self.memory,
            budget: self.budget,
        }
    }
}

/// Extensions that a file may require: those that are read, and those that
/// change nothing that matters here.
const KNOWN_EXTENSIONS: [&str; 15] = [
    "EXT_lights_image_based",
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_xmp_json_ld",
    "MSFT_texture_dds",
];

fn check_extensions(root: &Value) -> Result<(), Problem> {
    for entry in property::list(root, "extensionsRequired")? {
        let name = entry.as_str().unwrap_or("without a name");
        let is_known = KNOWN_EXTENSIONS.contains(&name) || name.starts_with("KHR_materials_");
        if !is_known {
            return Err(Problem::UnknownExtension(super::error::shortened(name)));
        }
    }
    Ok(())
}
