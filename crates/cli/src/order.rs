//! Removal orders in files of their own, and in the extras of trees.

use std::path::Path;

use secateur::{Lod, LodModel, Memory, Plant, RemovalOrder, StagedFiles, Tree, WriteOptions};
use secateur_gltf::{is_gltf_name, read_within};
use secateur_runtime::order_file::{self, OrderFileError};

use super::failure::Failure;
use super::output;

/// Refuses a place for an order that could not be written at the end. Into a tree, as its name says, an order goes as
/// extras.
pub(crate) fn check(path: &Path, inputs: &[&Path], options: WriteOptions) -> Result<(), Failure> {
    match is_gltf_name(path) {
        true => output::check_tree(path, inputs, options),
        false => output::check_file(path, inputs),
    }
}

/// Writes an order that appears with the others of `staged`; into the tree's extras where the name
/// is that of a tree.
pub(crate) fn stage(
    staged: &mut StagedFiles,
    path: &Path,
    order: RemovalOrder,
    plant: &mut Plant,
    options: WriteOptions,
) -> Result<(), Failure> {
    let leaves = plant.leaves();
    let model = LodModel::new(order, leaves)
        .map_err(|error| Failure::input(format!("{}: {error}", path.display())))?;
    if !is_gltf_name(path) {
        return output::stage(staged, path, &order_file::write_order(&model, leaves));
    }
    let text = order_file::order_to_base64(&model, leaves);
    let tree = plant.tree_mut();
    if !tree.set_order_base64(&text) {
        let name = tree.document().name();
        let why = "its `extras` are no object, so no order can be put into them";
        return Err(Failure::input(format!("{name}: {why}")));
    }
    let original = Lod::original(tree.foliage().leaves().len());
    let (_, files) = tree.prepare_lod(&original, path, options)?.into_files();
    staged.append(files);
    Ok(())
}

/// The model of a tree: from a file, or from the tree's extras.
pub(crate) fn read(file: Option<&Path>, tree: &Tree) -> Result<LodModel, Failure> {
    let name = match file {
        Some(path) => path.display().to_string(),
        None => tree.document().name().to_owned(),
    };
    let read = match file {
        Some(path) => {
            let bytes = read_within(path, Memory::Auto)?;
            order_file::read_order(&bytes, tree.foliage())
        }
        None => {
            let none = "it has no removal order in its extras: name a file of one by `--order`";
            let text = tree.order_base64();
            let text = text.ok_or_else(|| Failure::input(format!("{name}: {none}")))?;
            order_file::order_from_base64(text, tree.foliage())
        }
    };
    read.map_err(|error| {
        let what_to_do = match error {
            OrderFileError::OtherTree => {
                ": simplify this one with `--order`, with the same `--foliage`"
            }
            _ => "",
        };
        Failure::input(format!("{name}: {error}{what_to_do}"))
    })
}
