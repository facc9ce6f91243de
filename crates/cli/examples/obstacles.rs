//! What stands before a tree: a fence around it, and walls near it, as in the paper's section 5.3.
//! Both scenes are made here, as files that `--scene` reads too; each tree is simplified to a quarter
//! of its leaves from the same cameras with the obstacle and without.
//!
//! `cargo run --release --example obstacles [DIR]`; pictures and scenes go to DIR, or the system's
//! folder for temporary files.

use std::error::Error;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use base64::Engine as _;
use secateur::glam::{DMat3, DMat4, DQuat, DVec3};
use secateur::plant::{GrowOptions, Species, grow};
use secateur::{
    AlphaMode, Document, Finish, Foliage, Lod, Material, Options, Resolution, Simplified, Surface,
    Target, Tree, ViewSet, Views, plant_to_glb, scene_views, simplify,
};
use secateur_eval::{Camera, Panel, RenderOptions, contact_sheet, render};
use secateur_raster::occluders::Occluded;
use secateur_raster::{CpuRasteriser, Rasteriser, Scene};
use serde_json::json;

/// The share of the leaves that is left.
const LEFT: f64 = 0.25;

/// Height of the cameras' eyes, in metres.
const EYE_LEVEL_M: f64 = 1.7;

const PIXELS: u32 = 256;

/// A board or a wall: a box about the origin, placed.
struct Board {
    half: DVec3,
    world_from_board: DMat4,
}

/// What stands around a tree, and the cameras that look at it from there.
struct Site {
    name: &'static str,
    boards: Vec<Board>,
    /// Where cameras stand and what they look at.
    eyes: Vec<DVec3>,
    target: DVec3,
    /// From where the picture is taken; boards nearer to it than the tree are left out of it.
    picture_from: DVec3,
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1);
    let folder = folder.map_or_else(std::env::temp_dir, PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    compare_all(&folder)?;
    Ok(())
}

/// Simplifies an oak behind a fence and among walls. For each, with the obstacle and without, the
/// share of the leaves behind it that are left over that of the leaves before it.
pub(crate) fn compare_all(folder: &Path) -> Result<Vec<(String, f64)>, Box<dyn Error>> {
    let options = GrowOptions {
        leaves: 10_000,
        seed: 3,
    };
    let oak = plant_to_glb(&grow(Species::Oak, &options)?);
    std::fs::write(folder.join("oak.glb"), &oak)?;
    let tree = Document::from_bytes("oak.glb", oak, None)?.into_tree(&[])?;
    let crown = Crown::of(tree.foliage());
    let mut ratios = Vec::new();
    for site in [fence(&crown), walls(&crown)] {
        ratios.extend(compare(&site, &tree, folder)?);
    }
    Ok(ratios)
}

/// The room that leaves take.
struct Crown {
    low: f64,
    high: f64,
    radius: f64,
    centre: DVec3,
}

impl Crown {
    fn of(foliage: &Foliage) -> Self {
        let corners = foliage.triangles().iter().flat_map(|t| t.corners);
        let bounds = corners.fold((DVec3::MAX, DVec3::MIN), |(low, high), corner| {
            (low.min(corner), high.max(corner))
        });
        let centre = bounds.0.midpoint(bounds.1);
        let extent = bounds.1 - bounds.0;
        Self {
            low: bounds.0.y,
            high: bounds.1.y,
            radius: 0.5 * extent.x.max(extent.z),
            centre,
        }
    }

    /// A place about the trunk, `distance` crown radii away, at an angle in full turns.
    fn about(&self, distance: f64, turns: f64, height: f64) -> DVec3 {
        let (sin, cos) = (TAU * turns).sin_cos();
        let away = DVec3::new(sin, 0.0, cos) * distance * self.radius;
        DVec3::new(self.centre.x, height, self.centre.z) + away
    }

    fn eyes(&self, count: u32) -> Vec<DVec3> {
        let turns = |k| f64::from(k) / f64::from(count);
        (0..count)
            .map(|k| self.about(4.0, turns(k), EYE_LEVEL_M))
            .collect()
    }
}

/// A fence all around, that hides the lower part of the crown.
fn fence(crown: &Crown) -> Site {
    let count = 40;
    let height = crown.low + 0.3 * (crown.high - crown.low);
    let width = TAU * 1.3 * crown.radius / f64::from(count);
    let board = |k| {
        let turns = f64::from(k) / f64::from(count);
        let turn = DQuat::from_rotation_y(TAU * turns);
        let at = crown.about(1.3, turns, 0.5 * height);
        Board {
            // A gap of a twentieth between boards.
            half: DVec3::new(0.475 * width, 0.5 * height, 0.02),
            world_from_board: DMat4::from_rotation_translation(turn, at),
        }
    };
    Site {
        name: "fence",
        boards: (0..count).map(board).collect(),
        eyes: crown.eyes(12),
        target: crown.centre,
        picture_from: crown.about(3.4, 0.09, crown.centre.y),
    }
}

/// Two walls in a corner behind the tree; the cameras stand all around.
fn walls(crown: &Crown) -> Site {
    let height = 1.6 * crown.high;
    let wall = |turns: f64| {
        let turn = DQuat::from_rotation_y(TAU * turns);
        let at = crown.about(1.05, turns, 0.5 * height);
        Board {
            half: DVec3::new(2.2 * crown.radius, 0.5 * height, 0.1),
            world_from_board: DMat4::from_rotation_translation(turn, at),
        }
    };
    Site {
        name: "walls",
        boards: [0.5, 0.75].map(wall).into(),
        eyes: crown.eyes(12),
        target: crown.centre,
        picture_from: crown.about(3.4, 0.625, crown.centre.y),
    }
}

/// Simplifies with the obstacle and without, counts, and draws.
fn compare(site: &Site, tree: &Tree, folder: &Path) -> Result<Vec<(String, f64)>, Box<dyn Error>> {
    let file = site.to_gltf();
    let name = format!("{}.gltf", site.name);
    std::fs::write(folder.join(&name), &file)?;
    let scene = Document::from_bytes(&name, file, None)?;
    let (views, obstacle) = (scene_views(&scene.cameras()?)?, scene.occluders()?);

    let foliage = tree.foliage();
    let with_obstacle = seen(foliage, &views, &obstacle)?;
    let without = seen(foliage, &views, &Foliage::default())?;
    // Behind the obstacle is what no view sees past it, and one would see without it.
    let sides: Vec<Option<bool>> = with_obstacle
        .iter()
        .zip(without)
        .map(|(now, bare)| match (now, bare) {
            (true, _) => Some(true),
            (false, true) => Some(false),
            (false, false) => None,
        })
        .collect();
    let mut panels = vec![site.panel("original", &tree.foliage().leaves().len(), tree, None)?];
    let mut ratios = Vec::new();
    println!("{}: {} views", site.name, views.len());
    for (title, occluders) in [("without", None), ("with", Some(Arc::new(obstacle)))] {
        let mut options = Options::to(Target::leaf_share(LEFT));
        options.views = Views::Cameras(views.clone());
        options.resolution = Resolution::Pixels(PIXELS);
        options.occluders = occluders;
        let result: Simplified = simplify(foliage, &options)?;
        let share = |side| {
            let of_side = |leaf: &usize| sides[*leaf] == side;
            let all = (0..sides.len()).filter(of_side).count();
            let left = result.lod.leaves().map(|(leaf, _)| leaf.index());
            let left = left.filter(of_side).count();
            let share = 100.0 * left as f64 / all.max(1) as f64;
            (format!("{left} of {all} ({share:.1} %)"), share)
        };
        let [before, behind, never] = [Some(true), Some(false), None].map(share);
        println!(
            "  {title:<8} left before {}, behind {}, seen by no view anyhow {}; behind / before {:.3}",
            before.0,
            behind.0,
            never.0,
            behind.1 / before.1
        );
        let title = format!("{title} {}", site.name);
        ratios.push((title.clone(), behind.1 / before.1));
        panels.push(site.panel(&title, &result.lod.leaf_count(), tree, Some(&result.lod))?);
    }
    let picture = folder.join(format!("{}.png", site.name));
    contact_sheet(&panels).save(&picture)?;
    println!("  {}", picture.display());
    Ok(ratios)
}

/// Which leaves own a pixel in some view.
fn seen(
    foliage: &Foliage,
    views: &ViewSet,
    occluders: &Foliage,
) -> Result<Vec<bool>, Box<dyn Error>> {
    let scene = Scene {
        foliage,
        lod: &Lod::original(foliage.leaves().len()),
        views,
        resolution: PIXELS,
    };
    let occluded = Occluded {
        rasteriser: &CpuRasteriser,
        occluders,
    };
    let areas = occluded.areas(&scene).map_err(|e| e.to_string())?;
    let mut seen = vec![false; foliage.leaves().len()];
    for row in areas.rows() {
        for (seen, area_px) in seen.iter_mut().zip(&row[1..]) {
            *seen |= *area_px > 0;
        }
    }
    Ok(seen)
}

impl Site {
    /// Corners and triangles of boards.
    fn mesh<'a>(boards: impl Iterator<Item = &'a Board>) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let (mut corners, mut triangles) = (Vec::new(), Vec::new());
        for board in boards {
            let first = corners.len() as u32;
            for k in 0..8 {
                let sign = |bit: u32| if k >> bit & 1 == 0 { -1.0 } else { 1.0 };
                let corner = DVec3::new(sign(0), sign(1), sign(2)) * board.half;
                corners.push(board.world_from_board.transform_point3(corner));
            }
            // Each face counter-clockwise as seen from outside.
            for [a, b, c, d] in [
                [0, 4, 6, 2],
                [1, 3, 7, 5],
                [0, 1, 5, 4],
                [2, 6, 7, 3],
                [0, 2, 3, 1],
                [4, 5, 7, 6],
            ] {
                triangles.push([a, b, c].map(|corner| first + corner));
                triangles.push([a, c, d].map(|corner| first + corner));
            }
        }
        (corners, triangles)
    }

    /// The scene as a file: one mesh, and a node for each camera.
    fn to_gltf(&self) -> Vec<u8> {
        let (corners, triangles) = Self::mesh(self.boards.iter());
        let mut bytes = Vec::new();
        let (mut low, mut high) = (DVec3::MAX, DVec3::MIN);
        for corner in &corners {
            let corner = corner.as_vec3();
            (low, high) = (low.min(corner.as_dvec3()), high.max(corner.as_dvec3()));
            bytes.extend(corner.to_array().iter().flat_map(|x| x.to_le_bytes()));
        }
        let positions = bytes.len();
        bytes.extend(triangles.iter().flatten().flat_map(|i| i.to_le_bytes()));
        let node = |eye: &DVec3| {
            // A camera looks along its node's -z.
            let back = (*eye - self.target).normalize();
            let right = DVec3::Y.cross(back).normalize();
            let turn = DQuat::from_mat3(&DMat3::from_cols(right, back.cross(right), back));
            json!({ "camera": 0, "translation": eye.to_array(), "rotation": turn.to_array() })
        };
        let mut nodes = vec![json!({ "mesh": 0, "name": self.name })];
        nodes.extend(self.eyes.iter().map(node));
        let data = base64::engine::general_purpose::STANDARD.encode(&bytes);
        let file = json!({
            "asset": { "version": "2.0" },
            "scene": 0,
            "scenes": [{ "nodes": (0..nodes.len()).collect::<Vec<_>>() }],
            "nodes": nodes,
            "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.9, "znear": 0.1 } }],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
            "accessors": [
                { "bufferView": 0, "componentType": 5126, "count": corners.len(), "type": "VEC3",
                  "min": low.to_array(), "max": high.to_array() },
                { "bufferView": 1, "componentType": 5125, "count": 3 * triangles.len(),
                  "type": "SCALAR" },
            ],
            "bufferViews": [
                { "buffer": 0, "byteLength": positions },
                { "buffer": 0, "byteOffset": positions, "byteLength": bytes.len() - positions },
            ],
            "buffers": [{ "byteLength": bytes.len(),
                "uri": format!("data:application/octet-stream;base64,{data}") }],
        });
        file.to_string().into_bytes()
    }

    /// A picture of the tree and of what stands behind it.
    fn panel(
        &self,
        title: &str,
        leaves: &usize,
        tree: &Tree,
        lod: Option<&Lod>,
    ) -> Result<Panel, Box<dyn Error>> {
        let surfaces = match lod {
            None => tree.document().surfaces(&[])?,
            Some(lod) => {
                Document::from_bytes("lod.glb", tree.lod_to_bytes(lod)?, None)?.surfaces(&[])?
            }
        };
        let mut surfaces: Vec<Surface> = surfaces.into_iter().map(|(s, _)| s).collect();
        let towards = (self.picture_from - self.target).normalize();
        let is_behind = |board: &&Board| {
            let at = board.world_from_board.transform_point3(DVec3::ZERO);
            let away = DVec3::new(at.x - self.target.x, 0.0, at.z - self.target.z);
            away.dot(towards) < 0.0
        };
        let (positions, triangles) = Self::mesh(self.boards.iter().filter(is_behind));
        if !triangles.is_empty() {
            surfaces.push(Surface {
                positions,
                triangles,
                normals: Vec::new(),
                uvs: Vec::new(),
                colors: Vec::new(),
                holds: Vec::new(),
                material: Arc::new(Material {
                    name: self.name.to_owned(),
                    base_color: [0.5, 0.42, 0.35, 1.0],
                    texture: None,
                    alpha_mode: AlphaMode::Opaque,
                    double_sided: false,
                    finish: Finish::default(),
                }),
            });
        }
        let camera = Camera {
            eye: self.picture_from,
            target: self.target,
            up: DVec3::Y,
            fov_y_rad: 0.75,
        };
        Ok(Panel {
            title: title.to_owned(),
            subtitle: format!("{leaves} leaves"),
            image: render(&surfaces, &camera, &RenderOptions::panel(300, 300)),
        })
    }
}
