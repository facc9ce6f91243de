//! Stands from files: a list of plants and places in JSON, or a glTF scene.

use std::collections::{HashMap, HashSet};
use std::ffi::OsStr;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use glam::{DMat4, DQuat, DVec3};
use secateur_eval::{StandCamera, StandKind};
use secateur_gltf::{Detail, Document, GltfError, MAX_THINGS};
use secateur_model::Memory;
use secateur_simplify::whole::WoodMode;
use serde::Deserialize;

use super::{MOST_CAMERAS, PlantKind, PlantPlace, Stand, StandError};
use crate::{Error, Plant};

/// A list of plants of hundred thousands of places.
const MAX_FILE_BYTES: u64 = 64 << 20;

/// Width over height of pictures where nothing is said.
const ASPECT: f64 = 16.0 / 9.0;

/// Nothing nearer than this share of the way to the target is seen, where nothing is said.
const NEAR: f64 = 0.001;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StandFile {
    plants: Vec<PlantEntry>,
    cameras: Vec<CameraEntry>,
    #[serde(default)]
    obstacles: Vec<PathBuf>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PlantEntry {
    file: PathBuf,
    places: Vec<PlaceEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PlaceEntry {
    position: [f64; 3],
    #[serde(default)]
    turn_degrees: f64,
    #[serde(default = "one")]
    scale: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraEntry {
    eye: [f64; 3],
    target: [f64; 3],
    up: Option<[f64; 3]>,
    fov_y_degrees: Option<f64>,
    aspect: Option<f64>,
    near: Option<f64>,
}

fn one() -> f64 {
    1.0
}

impl Stand {
    /// Opens a stand. A `.json` lists plants and cameras; files are looked up in its folder:
    ///
    /// ```json
    /// {"plants": [{"file": "oak.glb", "places": [{"position": [0, 0, 0]},
    ///                                            {"position": [9, 0, 4], "turn_degrees": 40, "scale": 1.2}]}],
    ///  "cameras": [{"eye": [0, 2, 30], "target": [0, 2, 0], "fov_y_degrees": 60, "aspect": 1.78}],
    ///  "obstacles": ["wall.glb"]}
    /// ```
    ///
    /// In a glTF scene the [things that have leaves](Document::scene_kinds) are plants, all others obstacles; its
    /// cameras are those of [`Document::cameras`].
    ///
    /// # Errors
    /// [`Error::Stand`] if a list is none or a number is out of range, [`Error::Gltf`] if a file can't be read.
    pub fn open(path: &Path, memory: Memory) -> Result<Self, Error> {
        let is_list = path.extension().and_then(OsStr::to_str);
        let mut stand = match is_list.is_some_and(|end| end.eq_ignore_ascii_case("json")) {
            true => of_list(path, memory)?,
            false => of_scene(Document::open_within(path, memory)?)?,
        };
        let count = stand.cameras.len();
        if count > MOST_CAMERAS {
            stand.notes.push(format!(
                "of {count} cameras {MOST_CAMERAS} are looked from, spread evenly"
            ));
            let spread = (0..MOST_CAMERAS).map(|k| stand.cameras[k * count / MOST_CAMERAS]);
            stand.cameras = spread.collect();
        }
        Ok(stand)
    }
}

fn of_list(path: &Path, memory: Memory) -> Result<Stand, Error> {
    let failed = |reason: String| StandError {
        file: path.display().to_string(),
        reason,
    };
    let mut text = String::new();
    let file = std::fs::File::open(path);
    file.and_then(|file| file.take(MAX_FILE_BYTES + 1).read_to_string(&mut text))
        .map_err(|e| failed(format!("the stand cannot be read: {e}")))?;
    if text.len() as u64 > MAX_FILE_BYTES {
        return Err(failed("holds more than 64 MiB of plants; leave some out".to_owned()).into());
    }
    let list: StandFile = serde_json::from_str(&text)
        .map_err(|e| failed(format!("is no list of plants and cameras: {e}")))?;
    let count: u64 = list
        .plants
        .iter()
        .map(|plant| plant.places.len() as u64)
        .sum();
    if count == 0 || count > MAX_THINGS {
        return Err(failed(format!(
            "has {count} places of plants; give 1 to {MAX_THINGS}"
        ))
        .into());
    }
    if list.cameras.is_empty() {
        return Err(failed("`cameras` is empty".to_owned()).into());
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut stand = Stand::empty();
    let mut names = HashSet::new();
    let mut known: HashMap<&Path, usize> = HashMap::new();
    for (index, entry) in list.plants.iter().enumerate() {
        let kind = match known.get(&*entry.file) {
            Some(kind) => *kind,
            None => {
                let document = Document::open_within(&folder.join(&entry.file), memory)?;
                let stem = entry
                    .file
                    .file_stem()
                    .and_then(OsStr::to_str)
                    .unwrap_or("plant");
                let mut name = stem.to_owned();
                while !names.insert(name.clone()) {
                    name.push_str("_2");
                }
                stand.kinds.push(PlantKind::of(name, document)?);
                known.insert(&entry.file, stand.kinds.len() - 1);
                stand.kinds.len() - 1
            }
        };
        for (number, place) in entry.places.iter().enumerate() {
            let world_from_own = place.matrix().ok_or_else(|| {
                failed(format!("plants[{index}].places[{number}]: position and turn must be finite, scale above 0"))
            })?;
            stand.places.push(PlantPlace {
                kind,
                name: format!("{}_{}", stand.kinds[kind].name, stand.places.len()),
                world_from_own,
            });
        }
    }
    for (index, camera) in list.cameras.iter().enumerate() {
        let camera = camera
            .camera()
            .map_err(|what| failed(format!("cameras[{index}]: {what}")))?;
        stand.cameras.push(camera);
    }
    for obstacle in &list.obstacles {
        let document = Document::open_within(&folder.join(obstacle), memory)?;
        stand
            .obstacles
            .push((drawn(&document)?, vec![DMat4::IDENTITY]));
    }
    Ok(stand)
}

fn of_scene(document: Document) -> Result<Stand, Error> {
    let cameras = document.cameras()?;
    let mut stand = Stand::empty();
    let mut first_problem = None;
    for kind in document.scene_kinds()? {
        match PlantKind::of(kind.name.clone(), kind.document.clone()) {
            Ok(plant) => {
                stand.kinds.push(plant);
                let number = stand.kinds.len() - 1;
                let place = |(k, placed): (usize, secateur_gltf::Placement)| PlantPlace {
                    kind: number,
                    name: format!("{}_{k}", placed.name),
                    world_from_own: placed.world_from_own,
                };
                stand
                    .places
                    .extend(kind.placements.into_iter().enumerate().map(place));
            }
            Err(problem) => {
                stand
                    .notes
                    .push(format!("{} is taken for an obstacle: {problem}", kind.name));
                first_problem.get_or_insert(problem);
                let places = kind.placements.iter().map(|placed| placed.world_from_own);
                stand
                    .obstacles
                    .push((drawn(&kind.document)?, places.collect()));
            }
        }
    }
    if stand.places.is_empty() {
        return Err(match first_problem {
            Some(problem) => problem.into(),
            None => StandError {
                file: document.name().to_owned(),
                reason: "its scene has no plants: it has no node with a mesh".to_owned(),
            }
            .into(),
        });
    }
    stand.cameras = cameras
        .iter()
        .map(|camera| StandCamera {
            eye: camera.eye,
            forward: camera.forward,
            up: camera.up,
            tan_half_fov_y: camera.tan_half_fov / camera.aspect.unwrap_or(1.0).max(1.0),
            aspect: camera.aspect.unwrap_or(ASPECT).clamp(0.05, 20.0),
            near: camera.near,
        })
        .collect();
    Ok(stand)
}

impl Stand {
    fn empty() -> Self {
        Self {
            kinds: Vec::new(),
            places: Vec::new(),
            cameras: Vec::new(),
            obstacles: Vec::new(),
            notes: Vec::new(),
        }
    }
}

impl PlantKind {
    fn of(name: String, document: Document) -> Result<Self, GltfError> {
        let drawn = drawn(&document)?;
        let plant = Plant::of_decided(document.clone(), &[], WoodMode::Auto)?;
        Ok(Self {
            name,
            plant,
            document,
            drawn,
        })
    }
}

/// What is drawn of a file.
///
/// # Errors
/// [`GltfError`] if it can't be read.
pub fn drawn(document: &Document) -> Result<StandKind, GltfError> {
    let drawn = document.drawn_scene(Detail::Color)?.into_iter();
    Ok(StandKind::new(drawn.map(|drawn| drawn.surface).collect()))
}

impl PlaceEntry {
    fn matrix(&self) -> Option<DMat4> {
        let turn = DQuat::from_rotation_y(self.turn_degrees.to_radians());
        let position = DVec3::from_array(self.position);
        let matrix =
            DMat4::from_scale_rotation_translation(DVec3::splat(self.scale), turn, position);
        (matrix.is_finite() && self.scale > 0.0).then_some(matrix)
    }
}

impl CameraEntry {
    fn camera(&self) -> Result<StandCamera, &'static str> {
        let [eye, target] = [self.eye, self.target].map(DVec3::from_array);
        let way = target - eye;
        let forward = way.normalize_or_zero();
        if forward == DVec3::ZERO || !way.is_finite() {
            return Err("`eye` and `target` must be two points");
        }
        let usual = if forward.y.abs() > 0.999 {
            DVec3::Z
        } else {
            DVec3::Y
        };
        let up = self.up.map_or(usual, DVec3::from_array);
        if forward.cross(up).length() < 1e-9 || !up.is_finite() {
            return Err("`up` must not point along the view");
        }
        let fov = self.fov_y_degrees.unwrap_or(60.0);
        let aspect = self.aspect.unwrap_or(ASPECT);
        let near = self.near.unwrap_or(NEAR * way.length());
        match (
            fov > 0.0 && fov < 180.0,
            (0.05..=20.0).contains(&aspect),
            near > 0.0 && near.is_finite(),
        ) {
            (false, ..) => Err("`fov_y_degrees` must be above 0 and below 180"),
            (_, false, _) => Err("`aspect` must be from 0.05 to 20"),
            (.., false) => Err("`near` must be above 0"),
            _ => Ok(StandCamera {
                eye,
                forward,
                up,
                tan_half_fov_y: (fov.to_radians() / 2.0).tan(),
                aspect,
                near,
            }),
        }
    }
}
