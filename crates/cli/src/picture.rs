//! Pictures: contact sheets, and what the views see.

use std::io::Cursor;
use std::path::Path;

use image::{ExtendedColorType, ImageEncoder, RgbaImage, codecs::png::PngEncoder};
use secateur::{Document, Lod, Selector, StagedFiles, Surface};
use secateur_eval::{Camera, Panel, RenderOptions, contact_sheet, framing, render};
use secateur_raster::{Scene, cpu};

use super::failure::Failure;
use super::output;

const PANEL_WIDTH: u32 = 560;
const PANEL_HEIGHT: u32 = 640;

/// A tree to be shown.
pub(crate) struct Exhibit {
    pub(crate) title: String,
    pub(crate) subtitle: String,
    pub(crate) surfaces: Vec<Surface>,
}

/// All surfaces of a file.
pub(crate) fn surfaces(
    document: &Document,
    selectors: &[Selector],
) -> Result<Vec<Surface>, Failure> {
    let surfaces = document.surfaces(selectors)?;
    Ok(surfaces.into_iter().map(|(surface, _)| surface).collect())
}

/// Trees side by side as the bytes of a PNG, the first one setting the camera.
pub(crate) fn sheet(exhibits: &[Exhibit]) -> Result<Vec<u8>, Failure> {
    side_by_side(exhibits, [PANEL_WIDTH, PANEL_HEIGHT])
}

/// As a [`sheet`], small, for pages of many plants.
pub(crate) fn strip(exhibits: &[Exhibit]) -> Result<Vec<u8>, Failure> {
    side_by_side(exhibits, [PANEL_WIDTH / 3, PANEL_HEIGHT / 3])
}

fn side_by_side(exhibits: &[Exhibit], [width, height]: [u32; 2]) -> Result<Vec<u8>, Failure> {
    let aspect = f64::from(width) / f64::from(height);
    let empty = Vec::new();
    let first = exhibits.first().map_or(&empty, |e| &e.surfaces);
    let camera: Camera = framing(first, aspect);
    let options = RenderOptions::panel(width, height);
    let panel = |exhibit: &Exhibit| Panel {
        title: exhibit.title.clone(),
        subtitle: exhibit.subtitle.clone(),
        image: render(&exhibit.surfaces, &camera, &options),
    };
    let panels: Vec<Panel> = exhibits.iter().map(panel).collect();
    let sheet: RgbaImage = contact_sheet(&panels);
    png_of(&sheet)
}

/// Stages the leaf-ID image of every view: `NAME-view-00.png` and so on.
pub(crate) fn stage_leaf_ids(
    staged: &mut StagedFiles,
    input: &Document,
    folder: &Path,
    name: &str,
    scene: &Scene<'_>,
) -> Result<(), Failure> {
    let left = scene.lod.foliage(scene.foliage);
    let all_left = Lod::original(left.leaves().len());
    let scene = match scene.lod.is_of_originals() {
        true => *scene,
        false => Scene {
            foliage: &left,
            lod: &all_left,
            ..*scene
        },
    };
    for (number, view) in scene.views.views().iter().enumerate() {
        let rgb = cpu::draw_leaf_ids(&scene, view).to_rgb();
        let bytes = png(&rgb, [scene.resolution; 2], ExtendedColorType::Rgb8)?;
        let file = folder.join(format!("{name}-view-{number:02}.png"));
        output::check_spares(input, &[&file])?;
        output::stage_derived(staged, &file, &bytes)?;
    }
    Ok(())
}

/// A picture as the bytes of a PNG.
pub(crate) fn png_of(image: &RgbaImage) -> Result<Vec<u8>, Failure> {
    let size = [image.width(), image.height()];
    png(image.as_raw(), size, ExtendedColorType::Rgba8)
}

fn png(
    pixels: &[u8],
    [width, height]: [u32; 2],
    kind: ExtendedColorType,
) -> Result<Vec<u8>, Failure> {
    let mut bytes = Cursor::new(Vec::new());
    let encoder = PngEncoder::new(&mut bytes);
    let result = encoder.write_image(pixels, width, height, kind);
    result.map_err(|e| Failure::input(format!("the picture cannot be encoded: {e}")))?;
    Ok(bytes.into_inner())
}
