//! Reading glTF: encodings, broken files, the choice of foliage, real trees.

mod real_trees;
