//! Why a study ended early, in one sentence.

use std::io;
use std::path::{Path, PathBuf};

use secateur_eval::MeasureError;
use secateur_gltf::GltfError;
use secateur_levels::chain::ChainError;
use secateur_raster::CamerasError;

/// What keeps a study from its end.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// What was asked for can't be studied, or a file of the study is not what it should be.
    #[error("{0}")]
    Refused(String),
    /// A file can't be read or written; the program says why.
    #[error("{}: {what}: {error}", path.display())]
    File {
        /// Path of the file.
        path: PathBuf,
        /// What can't be done.
        what: &'static str,
        /// What the system said.
        error: io::Error,
    },
    /// A tree, and what is wrong with it.
    #[error("{}: {reason}", path.display())]
    Tree {
        /// Path of the tree's file.
        path: PathBuf,
        /// Why it can't be studied.
        reason: String,
    },
    /// Another study is at work in the folder.
    #[error("{}: another study is at work in this folder", .0.display())]
    Locked(PathBuf),
    /// The user has stopped it.
    #[error(
        "stopped; the finished rows are kept in {}, and the same command goes on from there",
        .0.display()
    )]
    Stopped(PathBuf),
    /// A tree can't be read.
    #[error(transparent)]
    Gltf(#[from] GltfError),
    /// A foliage can't be simplified as asked.
    #[error(transparent)]
    Simplify(#[from] secateur_simplify::Error),
    /// A result can't be judged.
    #[error(transparent)]
    Measure(#[from] MeasureError),
    /// A chain of levels can't be made.
    #[error(transparent)]
    Chain(#[from] ChainError),
    /// A file of cameras is not what it should be.
    #[error(transparent)]
    Cameras(#[from] CamerasError),
}

impl Error {
    pub(crate) fn of_file(path: &Path, what: &'static str, error: io::Error) -> Self {
        let path = path.to_owned();
        Self::File { path, what, error }
    }

    /// This error with the tree's file before it, where the foliage is to blame and the file is not
    /// named yet.
    pub(crate) fn about(self, path: &Path) -> Self {
        match self {
            Self::Simplify(_) | Self::Measure(_) | Self::Chain(_) => Self::Tree {
                path: path.to_owned(),
                reason: self.to_string(),
            },
            other => other,
        }
    }
}
