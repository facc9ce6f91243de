//! Which level of a plant Bevy draws from where: exactly one, or the two that fade into each other.

mod oak_lods;

use std::time::{Duration, Instant};

use bevy::camera::CameraPlugin;
use bevy::camera::visibility::{VisibilityRange, VisibleEntityRanges};
use bevy::gltf::GltfPlugin;
use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy::scene::ScenePlugin;

/// How long the file may take to load.
const PATIENCE: Duration = Duration::from_secs(60);

fn main() {
    let folder = std::env::args().nth(1).expect("usage: bevy-levels FOLDER");
    let mut app = App::new();
    let assets = AssetPlugin {
        file_path: folder,
        ..default()
    };
    app.add_plugins((
        MinimalPlugins,
        assets,
        TransformPlugin,
        ScenePlugin,
        ImagePlugin::default(),
    ));
    app.add_plugins((
        MeshPlugin,
        CameraPlugin,
        GltfPlugin::default(),
        oak_lods::LodsPlugin,
    ));
    app.init_asset::<StandardMaterial>();
    app.register_type::<MeshMaterial3d<StandardMaterial>>();
    app.finish();
    app.cleanup();
    let scene = app
        .world()
        .resource::<AssetServer>()
        .load(GltfAssetLabel::Scene(0).from_asset("oak.glb"));
    app.world_mut().spawn(SceneRoot(scene));
    let meshes = loaded(&mut app);

    let mut levels: Vec<String> = meshes.iter().map(|mesh| level(&app, *mesh)).collect();
    levels.sort();
    levels.dedup();
    assert!(levels.len() > 2, "{levels:?}");
    let mut last = 0;
    for step in 0..400 {
        let distance = 0.5 * 1.02_f32.powi(step);
        let drawn = drawn_from(&mut app, &meshes, distance);
        let places: Vec<usize> = drawn
            .iter()
            .map(|name| levels.iter().position(|level| level == name).unwrap())
            .collect();
        let (first, final_) = (
            *places.first().expect("something is drawn"),
            *places.last().unwrap(),
        );
        assert!(
            first >= last && final_ <= first + 1,
            "{distance} m: {drawn:?}"
        );
        if first != last || step == 0 {
            println!("{distance:8.2} m: {drawn:?}");
        }
        last = first;
    }
    assert_eq!(last + 1, levels.len(), "the coarsest level is the last");
    println!("Bevy draws one level, or two that fade, at each of 400 distances");
}

/// The meshes of the scene, once all have a range.
fn loaded(app: &mut App) -> Vec<Entity> {
    let start = Instant::now();
    loop {
        app.update();
        let mut found = app
            .world_mut()
            .query_filtered::<(Entity, Has<VisibilityRange>), With<Mesh3d>>();
        let found: Vec<_> = found.iter(app.world()).collect();
        if !found.is_empty() && found.iter().all(|(_, has_range)| *has_range) {
            return found.into_iter().map(|(mesh, _)| mesh).collect();
        }
        assert!(
            start.elapsed() < PATIENCE,
            "meshes without a range: {found:?}"
        );
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// The name of the node of a mesh's level.
fn level(app: &App, mesh: Entity) -> String {
    let world = app.world();
    let mut place = Some(mesh);
    while let Some(entity) = place {
        let name = world
            .get::<Name>(entity)
            .map(|name| name.as_str().to_owned());
        if let Some(name) = name.filter(|name| name.starts_with("oak_LOD") && !name.contains('.')) {
            return name;
        }
        place = world.get::<ChildOf>(entity).map(|child| child.0);
    }
    panic!("a mesh below no level");
}

/// The levels that are in range of a camera so far from the plant.
fn drawn_from(app: &mut App, meshes: &[Entity], distance: f32) -> Vec<String> {
    let camera = app
        .world_mut()
        .spawn((Camera3d::default(), Transform::from_xyz(0.0, 0.0, distance)))
        .id();
    app.update();
    let ranges = app.world().resource::<VisibleEntityRanges>();
    let seen = meshes
        .iter()
        .filter(|mesh| ranges.entity_is_in_range_of_view(**mesh, camera));
    let mut names: Vec<String> = seen.map(|mesh| level(app, *mesh)).collect();
    names.sort();
    names.dedup();
    app.world_mut().despawn(camera);
    names
}
