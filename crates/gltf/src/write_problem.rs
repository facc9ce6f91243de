//! Why a glTF file could not be written.

use std::path::PathBuf;

/// Why a glTF file could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteProblem {
    /// Neither .glb nor .gltf.
    #[error("cannot be written: its name must end in .glb or .gltf")]
    Extension,
    /// Levels were asked for as USD, and the name of the file does not end in .usda.
    #[error("cannot be written: the name of USD levels must end in .usda")]
    NotUsda,
    /// The name can't be put into a URI.
    #[error("cannot be written: its name is not Unicode")]
    Name,
    /// Writing it would destroy the input.
    #[error("is a file that the input is made of; choose another name for the output")]
    IsInput,
    /// A level of a chain that is there already.
    #[error("is there already; choose another place, or ask to overwrite it")]
    Exists,
    /// The folder is not there.
    #[error("cannot be written: its folder `{}` does not exist", .0.display())]
    NoFolder(PathBuf),
    /// A texture would be put over another file.
    #[error(
        "cannot be written: its image would replace `{}`, which is another one; choose another folder",
        .0.display()
    )]
    Occupied(PathBuf),
    /// The buffer of a .gltf would be put over a file that is no buffer of the
    /// .gltf that is there.
    #[error(
        "cannot be written: its buffer would replace `{}`, which belongs to no glTF of that name; choose another name, or ask to overwrite it",
        .0.display()
    )]
    UnrelatedBuffer(PathBuf),
    /// The operating system refused.
    #[error("cannot be written: {0}")]
    Io(#[from] std::io::Error),
    /// GLB holds lengths in 32 bits.
    #[error("cannot be written: it would be larger than 4 GiB; name it .gltf instead")]
    TooLarge,
}
