//! Images as KTX2 with Basis Universal texels.
//!
//! The texels are Binomial's ETC1S, a fifth of the bytes of its UASTC. The encoder writes files of its own kind,
//! whose parts [`file`] puts into those of Khronos.

mod basis;
mod encode;
mod file;
mod mips;

pub use encode::etc1s;
