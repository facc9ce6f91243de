//! An oak in several levels at once, as in the figures of the View-Dependent Multiresolution Model
//! for Foliage (Remolar et al., WSCG 2003): coarse within a sphere (Fig. 11), coarse behind a plane
//! (Fig. 12), by leaf collapse and by a removal order of any other method.
//!
//! ```text
//! cargo run --release --package secateur-levels --example view_dependent -- OUT.png
//! cargo run --release --package secateur-levels --example view_dependent -- OUT.png TREE.glb ORDER
//! ```
//!
//! The radius of the sphere and the place of the plane, in radii of the crown, are those at which
//! as many triangles are left as in the paper, in proportion to the tree's.

use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::ExitCode;

use glam::DVec3;
use image::{RgbaImage, imageops};
use secateur_eval::{Camera, Panel, RenderOptions, contact_sheet, framing, render};
use secateur_gltf::{Document, Tree, plant_to_glb};
use secateur_model::{Lod, LodModel, Surface};
use secateur_plant::{GrowOptions, Species, grow};
use secateur_runtime::order_file::read_order;
use secateur_runtime::view_dependent::{Criterion, InFrontOf, OutsideSphere, ViewDependent};
use secateur_simplify::fsa::{self, FsaOptions};

/// The leaves of the paper's tree, of two triangles each.
const LEAVES: u32 = 20_376;

/// The leaves of its coarsest level shown, of 472 polygons (Fig. 10).
const FEWEST_LEAVES: usize = 236;

/// The triangles of its Figures 11 and 12, as shares of all leaves' triangles.
const SPHERE: [f64; 2] = [27_136.0 / 40_752.0, 13_680.0 / 40_752.0];
const PLANE: [f64; 2] = [24_768.0 / 40_752.0, 18_406.0 / 40_752.0];

const PANEL_PX: [u32; 2] = [250, 286];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (output, given) = match &arguments[..] {
        [output] => (output, None),
        [output, tree, order] => (output, Some((tree.as_str(), order.as_str()))),
        _ => {
            eprintln!("usage: view_dependent OUT.png [TREE.glb ORDER]");
            return ExitCode::from(2);
        }
    };
    match draw(output, given) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn draw(output: &str, given: Option<(&str, &str)>) -> Result<(), Box<dyn Error>> {
    let (tree, model) = match given {
        Some((tree, order)) => {
            let tree = Tree::open(Path::new(tree), &[])?;
            let model = read_order(&std::fs::read(order)?, tree.foliage())?;
            (tree, model)
        }
        None => collapsed_oak()?,
    };
    let sphere = tree.foliage().bounding_sphere().ok_or("no leaf")?;
    let mut cut = ViewDependent::new(&model, tree.foliage());
    let all = tree.foliage().triangles().len();
    let surfaces = surfaces_of(&tree, &Lod::original(model.most_leaves()))?;
    let camera = framing(&surfaces, f64::from(PANEL_PX[0]) / f64::from(PANEL_PX[1]));
    let sight = (camera.target - camera.eye).normalize();
    let mut panels = vec![panels_of("original", &surfaces, &camera, &cut, all)];
    for share in SPHERE {
        let criterion = |t: f64| OutsideSphere {
            centre: sphere.centre,
            radius: t * 2.0 * sphere.radius,
        };
        // More is coarse in a larger sphere.
        let found = found_at(share, &mut cut, &model, &tree, &criterion);
        let surfaces = surfaces_of(&tree, &cut.lod(&model))?;
        let title = format!("sphere {:.2}", 2.0 * found.0);
        panels.push(panels_of(&title, &surfaces, &camera, &cut, found.1));
    }
    for share in PLANE {
        let criterion = |t: f64| InFrontOf {
            point: sphere.centre + (2.0 * t - 1.0) * sphere.radius * DVec3::X,
            normal: DVec3::X,
        };
        let found = found_at(share, &mut cut, &model, &tree, &criterion);
        let surfaces = surfaces_of(&tree, &cut.lod(&model))?;
        let title = format!("plane {:.2}", 2.0 * found.0 - 1.0);
        panels.push(panels_of(&title, &surfaces, &camera, &cut, found.1));
    }
    // From outside, and cut open along the middle.
    let outside: Vec<Panel> = panels.iter().map(|(outside, _)| outside.clone()).collect();
    let mut open = Vec::new();
    for (panel, (_, surfaces)) in outside.iter().zip(&panels) {
        let half: Vec<Surface> = surfaces
            .iter()
            .map(|surface| behind(surface, sphere.centre, sight))
            .collect();
        open.push(Panel {
            title: panel.title.clone(),
            subtitle: "cut open".to_owned(),
            image: picture(&half, &camera),
        });
    }
    stacked(&[contact_sheet(&outside), contact_sheet(&open)]).save(output)?;
    println!("{output}");
    Ok(())
}

/// An oak with as many leaves as the paper's tree, and the order of leaf collapse.
fn collapsed_oak() -> Result<(Tree, LodModel), Box<dyn Error>> {
    let oak = grow(
        Species::Oak,
        &GrowOptions {
            leaves: LEAVES,
            seed: 3,
        },
    )?;
    let tree = Document::from_bytes("oak.glb", plant_to_glb(&oak), None)?.into_tree(&[])?;
    let go_on = &mut |_| ControlFlow::Continue(());
    let order = fsa::simplify(tree.foliage(), FEWEST_LEAVES, &FsaOptions::default(), go_on);
    let order = order.ok_or("broken off")?;
    let model = LodModel::new(order, tree.foliage())?;
    Ok((tree, model))
}

/// Refines by the criterion from 0 to 1 after which the triangles are nearest to a share of all, and
/// returns its place and the triangles.
fn found_at<C: Criterion>(
    share: f64,
    cut: &mut ViewDependent,
    model: &LodModel,
    tree: &Tree,
    criterion: &dyn Fn(f64) -> C,
) -> (f64, usize) {
    let wanted = share * tree.foliage().triangles().len() as f64;
    let (mut low, mut high) = (0.0, 1.0);
    let mut triangles = 0;
    for _ in 0..24 {
        let middle = 0.5 * (low + high);
        cut.refine(&mut criterion(middle));
        triangles = cut.lod(model).foliage(tree.foliage()).triangles().len();
        match triangles as f64 > wanted {
            true => low = middle,
            false => high = middle,
        }
    }
    (low, triangles)
}

fn surfaces_of(tree: &Tree, lod: &Lod) -> Result<Vec<Surface>, Box<dyn Error>> {
    let document = Document::from_bytes("level.glb", tree.lod_to_bytes(lod)?, None)?;
    let surfaces = document.surfaces(&[])?;
    Ok(surfaces.into_iter().map(|(surface, _)| surface).collect())
}

fn panels_of(
    title: &str,
    surfaces: &[Surface],
    camera: &Camera,
    cut: &ViewDependent,
    triangles: usize,
) -> (Panel, Vec<Surface>) {
    println!(
        "{title}: {} leaves, {triangles} triangles of leaves",
        cut.leaf_count()
    );
    let panel = Panel {
        title: title.to_owned(),
        subtitle: format!("{} leaves\n{triangles} triangles", cut.leaf_count()),
        image: picture(surfaces, camera),
    };
    (panel, surfaces.to_vec())
}

fn picture(surfaces: &[Surface], camera: &Camera) -> RgbaImage {
    let [width, height] = PANEL_PX;
    render(surfaces, camera, &RenderOptions::panel(width, height))
}

/// The triangles of a surface that lie behind the plane through a point.
fn behind(surface: &Surface, point: DVec3, sight: DVec3) -> Surface {
    let is_behind = |corner: &u32| {
        let position = surface.positions[*corner as usize];
        (position - point).dot(sight) > 0.0
    };
    let mut half = surface.clone();
    half.triangles
        .retain(|triangle| triangle.iter().all(is_behind));
    half
}

fn stacked(rows: &[RgbaImage]) -> RgbaImage {
    let width = rows.iter().map(RgbaImage::width).max().unwrap_or(1);
    let height = rows.iter().map(RgbaImage::height).sum::<u32>().max(1);
    let mut sheet = RgbaImage::new(width, height);
    let mut y = 0;
    for row in rows {
        imageops::replace(&mut sheet, row, 0, y);
        y += i64::from(row.height());
    }
    sheet
}
