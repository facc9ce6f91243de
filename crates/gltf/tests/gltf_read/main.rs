//! Reading glTF: encodings, broken files, the choice of foliage, real trees.

mod base_colors;
mod broken;
mod choice;
mod claims;
mod corpus;
mod encodings;
mod links;
mod placing;
mod real_trees;
mod roles;
mod seeds;
mod skeletons;
mod small_tree;
mod textures;
mod wood_pieces;
