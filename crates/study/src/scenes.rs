//! Small scenes, each made for one failure.
//!
//! Crowns have about the radius 1 about (0, 2, 0). Seen from 3 radii at 60
//! degrees and 256 x 256 pixels, a pixel is 0.0135 wide at the centre.

use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use secateur_model::{AlphaMode, BoundingSphere, Finish, Material, Plant, Surface};
use secateur_plant::Random;
use secateur_raster::{View, ViewSet};
use secateur_simplify::meshopt::Borders;
use secateur_simplify::vds::{Resize, Ties};

use crate::named_cases::{
    coverage_kept, fsa, information, look, meshopt, resized, shared_deficit, stochastic,
    stochastic_of_half_area,
};
use crate::random::{direction, in_ball, stream};
use crate::{Case, FailureCase};

/// A scene: what is in it, what should go wrong, and what is tried.
pub(crate) struct FailureScene {
    /// What rows call it, as a tree.
    pub(crate) name: &'static str,
    title: &'static str,
    about: &'static str,
    /// The case that should fail; one of [`Self::cases`].
    suspect: fn() -> Case,
    /// What is run on it. The path is that of a file of near cameras.
    pub(crate) cases: fn(&Path) -> Vec<Case>,
    /// The distance of the judging views from the centre, in radii of the crown.
    pub(crate) judged_from_radii: f64,
    build: fn(&mut Crown),
}

/// The distance of near cameras from the centre, in radii of the crown.
const NEAR_RADII: f64 = 0.6;

/// The default, where a level is a share of triangles: leaves become coarser before any goes.
fn by_triangles() -> Case {
    look().of_triangles()
}

fn four_neighbours() -> Case {
    information().with_vds(|vds| vds.neighbours = 4)
}

fn spread_ties(case: Case) -> Case {
    case.with_vds(|vds| vds.ties = Ties::Spread)
}

fn at_256() -> Case {
    information().pixels(256)
}

/// What is run on scenes of leaves about as small as a pixel.
fn small_leaves() -> Vec<Case> {
    vec![
        at_256(),
        information(),
        information().pixels(1024),
        look(),
        by_triangles(),
        fsa(),
        stochastic(),
        meshopt(Borders::PreserveArea),
    ]
}

/// All scenes, in the order of reports.
pub(crate) const SCENES: [FailureScene; 8] = [
    FailureScene {
        name: "scene-sub-pixel",
        title: "Leaves below a pixel",
        about: "4,000 leaves of half a pixel's width at 256 x 256: most are seen in no view or in one, and cost nothing to prune.",
        suspect: at_256,
        cases: |_| small_leaves(),
        judged_from_radii: 3.0,
        build: |crown| {
            for _ in 0..4000 {
                let at = 1.0 * crown.in_ball();
                crown.card(at, 0.003, 0.003);
            }
        },
    },
    FailureScene {
        name: "scene-needles",
        title: "Thin needles",
        about: "1,500 needles 15 pixels long and a quarter of a pixel wide at 256 x 256: rows of holes to a camera.",
        suspect: at_256,
        cases: |_| small_leaves(),
        judged_from_radii: 3.0,
        build: |crown| {
            for _ in 0..1500 {
                let at = 0.95 * crown.in_ball();
                crown.card(at, 0.1, 0.0015);
            }
        },
    },
    FailureScene {
        name: "scene-interior",
        title: "An interior seen from near",
        about: "3,000 leaves that fill a ball, driven from 3 radii and judged from within, at half a radius: what no driving view sees goes first.",
        suspect: information,
        cases: |near| {
            vec![
                information(),
                information().seen_from("near", near),
                look(),
                by_triangles(),
                fsa(),
                stochastic(),
                meshopt(Borders::PreserveArea),
            ]
        },
        judged_from_radii: 0.5,
        build: |crown| {
            for _ in 0..3000 {
                let at = crown.in_ball();
                crown.card(at, 0.05, 0.05);
            }
        },
    },
    FailureScene {
        name: "scene-ties",
        title: "Exact ties",
        about: "1,600 leaves numbered from left to right, driven at 64 x 64 pixels, where most are seen by no view and cost exactly nothing: ties in order eat the crown from its left.",
        suspect: || information().pixels(64),
        cases: |_| {
            vec![
                information().pixels(64),
                spread_ties(information().pixels(64)),
                spread_ties(information()),
                information(),
                look(),
                by_triangles(),
                fsa(),
                stochastic(),
            ]
        },
        judged_from_radii: 3.0,
        build: |crown| {
            let mut places: Vec<DVec3> = (0..1600).map(|_| crown.in_ball()).collect();
            places.sort_by(|a, b| a.x.total_cmp(&b.x));
            for at in places {
                crown.card(at, 0.005, 0.005);
            }
        },
    },
    FailureScene {
        name: "scene-blow-up",
        title: "Resize blow-up",
        about: "40 tight clumps of 40 leaves: the last leaf of a clump can take the area of all and become a plate.",
        suspect: || resized(Resize::Full),
        cases: |_| {
            vec![
                resized(Resize::Full),
                information(),
                four_neighbours(),
                resized(Resize::None),
                coverage_kept(),
                look(),
                by_triangles(),
                stochastic(),
                meshopt(Borders::PreserveArea),
            ]
        },
        judged_from_radii: 3.0,
        build: |crown| {
            for _ in 0..40 {
                let centre = direction(&mut crown.random);
                for _ in 0..40 {
                    let at = centre + 0.12 * crown.in_ball();
                    crown.card(at, 0.02, 0.02);
                }
            }
        },
    },
    FailureScene {
        name: "scene-sparse",
        title: "A sparse crown",
        about: "150 leaves far from each other, through which one looks: a leaf that grows covers what was sky.",
        suspect: information,
        cases: |_| {
            vec![
                information(),
                four_neighbours(),
                resized(Resize::None),
                shared_deficit(),
                coverage_kept(),
                look(),
                by_triangles(),
                fsa(),
                stochastic(),
                meshopt(Borders::PreserveArea),
            ]
        },
        judged_from_radii: 3.0,
        build: |crown| {
            for _ in 0..150 {
                let at = crown.in_ball();
                crown.card(at, 0.04, 0.04);
            }
        },
    },
    FailureScene {
        name: "scene-big-leaf",
        title: "A single big leaf",
        about: "One leaf of a radius's width among 800 small ones: lots may fall on it, and merging may bend it away.",
        suspect: stochastic,
        cases: |_| {
            vec![
                stochastic(),
                stochastic_of_half_area(),
                fsa(),
                information(),
                look(),
                by_triangles(),
                meshopt(Borders::PreserveArea),
            ]
        },
        judged_from_radii: 3.0,
        build: |crown| {
            for _ in 0..800 {
                let at = crown.in_ball();
                crown.card(at, 0.02, 0.02);
            }
            crown.card(DVec3::new(0.2, 0.1, 0.1), 0.5, 0.5);
        },
    },
    FailureScene {
        name: "scene-clusters",
        title: "Clustered leaves",
        about: "30 clusters of 60 leaves with nothing between them: a leaf that grows for its neighbours has to stand for a whole cluster.",
        suspect: information,
        cases: |_| {
            vec![
                information(),
                four_neighbours(),
                shared_deficit(),
                coverage_kept(),
                look(),
                by_triangles(),
                fsa(),
                stochastic(),
                meshopt(Borders::PreserveArea),
            ]
        },
        judged_from_radii: 3.0,
        build: |crown| {
            for _ in 0..30 {
                let centre = 0.9 * direction(&mut crown.random);
                for _ in 0..60 {
                    let at = centre + 0.14 * crown.in_ball();
                    crown.card(at, 0.03, 0.03);
                }
            }
        },
    },
];

/// All scenes as reports describe them.
pub(crate) fn failure_cases() -> Vec<FailureCase> {
    let of_scene = |scene: &FailureScene| FailureCase {
        tree: scene.name.to_owned(),
        title: scene.title.to_owned(),
        about: scene.about.to_owned(),
        suspect: (scene.suspect)().label(),
    };
    SCENES.iter().map(of_scene).collect()
}

impl FailureScene {
    /// The scene as a plant, the same on every machine.
    pub(crate) fn plant(&self) -> Plant {
        let mut crown = Crown {
            random: stream(1),
            leaves: surface("Leaves", [0.10, 0.32, 0.06, 1.0]),
        };
        (self.build)(&mut crown);
        let leaves = crown.leaves.triangles.len() / 2;
        Plant {
            name: self.name.to_owned(),
            wood: trunk(),
            leaves: crown.leaves,
            triangles_per_leaf: vec![2; leaves],
            skeleton: None,
            holds: None,
        }
    }
}

/// The cameras of a set about a sphere, moved to a distance of `radii` radii.
pub(crate) fn views_from(views: &ViewSet, sphere: BoundingSphere, radii: f64) -> ViewSet {
    let moved = |view: &View| {
        let eye = sphere.centre - radii * sphere.radius * view.forward();
        let near = 0.02 * sphere.radius;
        View::look_at(
            eye,
            eye + view.forward(),
            view.up(),
            view.tan_half_fov(),
            near,
        )
    };
    let views: Result<Vec<View>, _> = views.views().iter().map(moved).collect();
    ViewSet::new(views.expect("directions about a finite sphere make cameras"))
}

/// Near cameras about a crown, as a file for `--views`.
pub(crate) fn near_cameras(sphere: BoundingSphere) -> String {
    let views = views_from(&ViewSet::dodecahedron(sphere), sphere, NEAR_RADII);
    let camera = |view: &View| {
        serde_json::json!({
            "eye": view.eye().to_array(),
            "target": (view.eye() + view.forward()).to_array(),
            "up": view.up().to_array(),
            "near": view.near(),
        })
    };
    let cameras: Vec<_> = views.views().iter().map(camera).collect();
    serde_json::json!({ "cameras": cameras }).to_string()
}

/// A scene while its leaves are added.
struct Crown {
    random: Random,
    leaves: Surface,
}

impl Crown {
    fn in_ball(&mut self) -> DVec3 {
        in_ball(&mut self.random)
    }

    /// A rectangular leaf about a place, turned at random.
    fn card(&mut self, at: DVec3, half_length: f64, half_width: f64) {
        let along = direction(&mut self.random);
        let across = along.cross(direction(&mut self.random));
        let across = across.normalize_or(along.any_orthonormal_vector());
        let centre = at + DVec3::Y * 2.0;
        let (a, b) = (half_length * along, half_width * across);
        let normal = along.cross(across);
        let corners = [-a - b, a - b, a + b, b - a].map(|corner| centre + corner);
        quad(&mut self.leaves, corners, normal);
    }
}

fn quad(surface: &mut Surface, corners: [DVec3; 4], normal: DVec3) {
    let first = surface.positions.len() as u32;
    surface.positions.extend(corners);
    let normal: Vec3 = normal.as_vec3();
    surface.normals.extend([normal; 4]);
    surface
        .triangles
        .extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|corner| first + corner)));
}

fn trunk() -> Surface {
    let mut wood = surface("Bark", [0.16, 0.10, 0.06, 1.0]);
    let half = 0.03;
    for (x, z) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)] {
        let normal = DVec3::new(x, 0.0, z);
        let side = DVec3::new(-z, 0.0, x);
        let corner = |s: f64, y: f64| half * (normal + s * side) + DVec3::Y * y;
        let corners = [
            corner(-1.0, 0.0),
            corner(1.0, 0.0),
            corner(1.0, 1.2),
            corner(-1.0, 1.2),
        ];
        quad(&mut wood, corners, normal);
    }
    wood
}

fn surface(name: &str, base_color: [f32; 4]) -> Surface {
    Surface::empty(Arc::new(Material {
        name: name.to_owned(),
        base_color,
        texture: None,
        alpha_mode: AlphaMode::Opaque,
        double_sided: true,
        finish: Finish::default(),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::each_once;
    use secateur_gltf::{Document, plant_to_glb};

    #[test]
    fn every_leaf_of_every_scene_is_found() {
        for scene in &SCENES {
            let plant = scene.plant();
            let glb = plant_to_glb(&plant);
            let tree = Document::from_bytes(scene.name, glb, None)
                .and_then(|document| document.into_tree(&[]))
                .unwrap();
            let (found, made) = (
                tree.foliage().leaves().len(),
                plant.triangles_per_leaf.len(),
            );
            assert_eq!(found, made, "{}", scene.name);
        }
    }

    #[test]
    fn every_suspect_is_one_of_the_cases() {
        for scene in &SCENES {
            let cases = (scene.cases)(Path::new("cameras.json"));
            assert!(cases.contains(&(scene.suspect)()), "{}", scene.name);
            assert_eq!(each_once(cases.clone()), cases, "{}", scene.name);
        }
    }

    #[test]
    fn near_cameras_stand_within_the_crown_and_are_read_again() {
        let sphere = BoundingSphere {
            centre: DVec3::new(1.0, 2.0, 3.0),
            radius: 2.0,
        };
        let views = secateur_raster::cameras_from_json("near", &near_cameras(sphere)).unwrap();
        assert_eq!(views.len(), 20);
        for view in views.views() {
            assert!((view.eye().distance(sphere.centre) - 1.2).abs() < 1e-9);
            let to_centre = (sphere.centre - view.eye()).normalize();
            assert!(to_centre.dot(view.forward()) > 1.0 - 1e-9);
        }
    }
}
