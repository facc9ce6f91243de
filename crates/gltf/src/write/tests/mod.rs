//! LODs of small trees in every encoding, and of real ones.

mod beyond_cards;
mod chain;
mod check;
#[allow(
    unreachable_pub,
    reason = "integration tests may include this file too"
)]
#[path = "../../../../../tests/clients/clients.rs"]
mod clients;
mod compressed;
mod cutoffs;
mod encodings;
mod every_encoding;
mod fixture;
mod grown;
mod images;
mod left_on_disk;
mod levels_inside;
mod lod_document;
mod new_leaves;
mod on_disk;
mod particulars;
mod real_trees;
mod skeleton;
mod texels;
#[allow(unreachable_pub, reason = "integration tests include this file too")]
#[path = "../../../../../tests/validator/validator.rs"]
mod validator;
