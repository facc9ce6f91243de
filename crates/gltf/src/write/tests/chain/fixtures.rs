//! Small trees that only a chain has trouble with.

use super::*;

/// Every attribute, below a node that mirrors, turns and stretches.
pub(super) fn mirrored_rich() -> Fixture {
    let mut fixture = Fixture::new();
    let normal = [0.0, 0.0, 1.0];
    let mut positions = squares(4);
    positions.iter_mut().for_each(|p| p[2] = 0.0);
    let attributes = json!({
        "POSITION": fixture.vectors(&positions),
        "NORMAL": fixture.vectors(&[normal; 16]),
        "TANGENT": fixture.vectors(&[[1.0, 0.0, 0.0, 1.0]; 16]),
        "TEXCOORD_0": fixture.vectors(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].repeat(4)),
    });
    let targets = json!([{
        "POSITION": fixture.vectors(&[[1.0, 2.0, 3.0]; 16]),
        "NORMAL": fixture.vectors(&[[0.5, 0.0, 0.0]; 16]),
        "TANGENT": fixture.vectors(&[[0.0, 0.0, 0.5]; 16]),
    }]);
    let indices = fixture.indices(UNSIGNED_SHORT, &square_indices(4));
    let mut fixture = fixture.with_leaves(attributes, Some(indices));
    fixture.leaf_primitive()["targets"] = targets;
    fixture.root["nodes"][2]["scale"] = json!([-2, 1, 4]);
    fixture.root["nodes"][0]["rotation"] = json!([0.6, 0, 0, 0.8]);
    fixture.root["nodes"][0]["translation"] = json!([1, 2, 3]);
    fixture
}

/// Morph targets that no animation moves.
pub(super) fn still_morphs() -> Fixture {
    let mut fixture = encodings::morphed();
    fixture.root.as_object_mut().unwrap().remove("animations");
    fixture.root["meshes"][1]["weights"] = json!([0.25, 0.5]);
    fixture.root["meshes"][1]["extras"] = json!({"targetNames": ["wind", "snow"]});
    fixture
}

pub(super) fn with_skin(fixture: &mut Fixture, mesh: usize, vertices: usize) {
    let joints = fixture.elements(UNSIGNED_BYTE, 4, &vec![0.0; 4 * vertices]);
    let weights = fixture.vectors(&vec![[1.0, 0.0, 0.0, 0.0]; vertices]);
    let attributes = &mut fixture.root["meshes"][mesh]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = joints.into();
    attributes["WEIGHTS_0"] = weights.into();
}

/// A trunk and leaves of one skin, whose nodes have transforms that do not count.
pub(super) fn one_skin() -> Fixture {
    let mut fixture = Fixture::new();
    let positions = fixture.vectors(&squares(4));
    let indices = fixture.indices(UNSIGNED_SHORT, &square_indices(4));
    let mut fixture = fixture.with_leaves(json!({"POSITION": positions}), Some(indices));
    with_skin(&mut fixture, 0, 4);
    with_skin(&mut fixture, 1, 16);
    let nodes = fixture.root["nodes"].as_array_mut().unwrap();
    nodes.push(json!({"name": "joint", "translation": [0, 1, 0], "extras": {"sway": 2}}));
    nodes[0]["children"] = json!([1, 2, 3]);
    nodes[1]["skin"] = 0.into();
    nodes[2]["skin"] = 0.into();
    fixture.root["skins"] = json!([{"joints": [3]}]);
    fixture
}

pub(super) fn two_skins() -> Fixture {
    let mut fixture = one_skin();
    fixture.root["skins"] = json!([{"joints": [3]}, {"joints": [3]}]);
    fixture.root["nodes"][2]["skin"] = 1.into();
    fixture
}

pub(super) fn skinned_leaves() -> Fixture {
    let all = encodings::all();
    all.into_iter()
        .find(|(name, _)| *name == "skinned")
        .unwrap()
        .1
}

/// A picture of two colours on a quad of its own, with a hole at the upper left and a normal map.
pub(super) fn picture() -> Surface {
    let texture = |rgba: Vec<u8>| {
        Arc::new(Texture {
            width: 2,
            height: 2,
            rgba,
            wrap: [Wrap::ClampToEdge; 2],
            filters: Filters::default(),
        })
    };
    let [green, brown] = [[60, 140, 40, 255], [120, 80, 40, 255]];
    let hole = [60, 140, 40, 0];
    let map = NormalMap {
        texture: texture([128, 128, 255, 255].repeat(4)),
        scale: 1.0,
    };
    Surface {
        positions: [[0.0, 7.0], [0.0, 0.0], [8.0, 0.0], [8.0, 7.0]]
            .map(|[x, y]| DVec3::new(x, y, 0.5))
            .into(),
        normals: vec![Vec3::Z; 4],
        uvs: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]
            .map(Vec2::from_array)
            .into(),
        colors: Vec::new(),
        holds: Vec::new(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        material: Arc::new(Material {
            name: String::new(),
            base_color: [1.0; 4],
            texture: Some(texture([hole, green, brown, green].concat())),
            alpha_mode: AlphaMode::Mask(0.5),
            double_sided: true,
            finish: Finish {
                normal_map: Some(map),
                ..Finish::default()
            },
        }),
    }
}
