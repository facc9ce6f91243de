use glam::{DMat3, DVec3};
use secateur_model::SegmentIndex;
use secateur_plant::Random;
use wgpu::util::DeviceExt;

use super::*;
use crate::gpu_for_tests::{compute, gpu};

const WORKGROUP: usize = 64;

fn wind() -> Wind {
    Wind::new(DVec2::new(0.6, 0.8), 8.0, 0.5, 40.0)
}

fn hold(x: f32, y: f32, z: f32, along_m: f32) -> Hold {
    Hold {
        segment: Some(SegmentIndex::from_index(7)),
        pivot: Vec3::new(x, y, z),
        along_m,
    }
}

#[test]
fn a_wave_is_a_parabola_up_and_one_down() {
    let at = [0, 8192, 16_384, 24_576, 32_768, 49_152, 65_536].map(wave);
    assert_eq!(at, [0, 12_288, 16_384, 12_288, 0, -16_384, 0]);
}

#[test]
fn the_foot_stands_still_and_what_is_far_along_moves_at_most_as_far_as_was_said() {
    for second in 0..200 {
        let wind = wind().at(f64::from(second) * 0.37, 5.0);
        assert_eq!(wind.bend(&hold(0.0, 0.0, 0.0, 0.0)), Vec3::ZERO);
        let bend = wind.bend(&hold(1.0, 6.0, 2.0, 8.0)).length();
        // The direction is rounded to 1/256.
        assert!(bend < 0.5 * 1.005, "{bend}");
        let near = wind.bend(&hold(1.0, 6.0, 2.0, 4.0)).length();
        assert!((near / bend - 0.25).abs() < 1e-5 || bend == 0.0);
    }
}

/// A leaf keeps its shape: it is moved and turned, no more.
#[test]
fn a_leaf_moves_as_a_rigid_body_and_keeps_to_its_twig() {
    let wind = wind().at(3.3, 5.0);
    let hold = hold(1.0, 6.0, 2.0, 7.5);
    let swayed = |p: Vec3| wind.swayed(p, &hold).as_dvec3();
    let foot = swayed(hold.pivot);
    assert_eq!(foot, (hold.pivot + wind.bend(&hold)).as_dvec3());
    let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| swayed(hold.pivot + axis) - foot);
    let turn = DMat3::from_cols(axes[0], axes[1], axes[2]);
    let rest = turn.transpose() * turn - DMat3::IDENTITY;
    assert!(
        rest.to_cols_array().iter().all(|x| x.abs() < 1e-5),
        "{turn}"
    );
    assert!(wind.half_turn(&hold) != 0.0);
    // Wood at the same point is at the same point.
    assert_eq!(wind.for_wood().swayed(hold.pivot, &hold).as_dvec3(), foot);
}

/// A leaf that has grown about its centre is the same leaf, larger, at any time.
#[test]
fn a_leaf_that_has_grown_makes_the_same_motion() {
    let hold = hold(-2.0, 5.0, 1.0, 6.0);
    let centre = hold.pivot + Vec3::new(0.05, -0.02, 0.01);
    let corner = centre + Vec3::new(0.03, 0.04, -0.02);
    for second in 0..50 {
        let wind = wind().at(f64::from(second) * 0.61, 4.0);
        let [c, original] = [centre, corner].map(|p| wind.swayed(p, &hold));
        let grown = wind.swayed(centre + 2.5 * (corner - centre), &hold);
        let expected = c + 2.5 * (original - c);
        assert!(grown.distance(expected) < 1e-5, "{grown} {expected}");
    }
}

#[test]
fn the_shader_sways_as_its_twin_does() {
    let Some((device, queue)) = gpu() else {
        eprintln!("SKIPPED: there is no GPU adapter");
        return;
    };
    let mut random = Random::new(4);
    for count in [1, 63, 64, 65, 700] {
        let mut between = |low: f64, high: f64| random.between(low, high) as f32;
        let vertices: Vec<(Vec3, Hold)> = (0..count)
            .map(|k| {
                let pivot = Vec3::new(
                    between(-20.0, 20.0),
                    between(0.0, 30.0),
                    between(-20.0, 20.0),
                );
                let arm = Vec3::new(between(-0.2, 0.2), between(-0.2, 0.2), between(-0.2, 0.2));
                let segment = (k % 5 > 0).then(|| SegmentIndex::from_index(70_000 * k));
                let along_m = between(0.0, 40.0);
                (
                    pivot + arm,
                    Hold {
                        segment,
                        pivot,
                        along_m,
                    },
                )
            })
            .collect();
        let wind = wind().at(f64::from(between(0.0, 100.0)), 4.0);
        let words = |v: Vec3| v.to_array().map(f32::to_bits);
        let input: Vec<u32> = vertices
            .iter()
            .flat_map(|(position, hold)| {
                let [x, y, z] = words(*position);
                let [a, b, c] = words(hold.pivot);
                [x, y, z, hold.along_m.to_bits(), a, b, c, number(hold)]
            })
            .collect();
        let uniform = [
            wind.toward.x as u32,
            wind.toward.y as u32,
            wind.axis.x.to_bits(),
            wind.axis.y.to_bits(),
            wind.turns,
            wind.bend.to_bits(),
            wind.flutter.to_bits(),
            count as u32,
        ];
        let buffer = |words: &[u32], usage| {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: None,
                contents: bytemuck::cast_slice(words),
                usage,
            })
        };
        let storage = wgpu::BufferUsages::STORAGE;
        let bound = [
            buffer(&uniform, wgpu::BufferUsages::UNIFORM),
            buffer(&input, storage),
            buffer(&vec![0; 8 * count], storage | wgpu::BufferUsages::COPY_SRC),
        ];
        let groups = count.div_ceil(WORKGROUP) as u32;
        let constants = [("WORKGROUP", WORKGROUP as f64)];
        let shader = (secateur_shaders::WIND, "sway", &constants[..]);
        let found = compute(&device, &queue, shader, &bound, groups);
        let (found, _) = found.as_chunks::<8>();
        for ((position, hold), words) in vertices.iter().zip(found) {
            let bend = wind.bend(hold).to_array().map(f32::to_bits);
            assert_eq!([words[4], words[5], words[6]], bend);
            assert_eq!(words[3], wind.half_turn(hold).to_bits());
            let [x, y, z] = [0, 1, 2].map(|k| f64::from(f32::from_bits(words[k])));
            let expected = wind.swayed(*position, hold).as_dvec3();
            assert!(DVec3::new(x, y, z).distance(expected) < 1e-5);
        }
    }
}

/// The shader's uniform lies in memory as its twin does, `vertices` behind it.
#[test]
fn the_uniform_lies_as_its_twin_lies() {
    use std::mem::offset_of;
    let module = naga::front::wgsl::parse_str(secateur_shaders::WIND).unwrap();
    let uniform = module
        .types
        .iter()
        .find(|(_, of)| of.name.as_deref() == Some("Wind"));
    let naga::TypeInner::Struct { members, span } = &uniform.unwrap().1.inner else {
        panic!("a struct");
    };
    let offsets: Vec<(&str, u32)> = members
        .iter()
        .map(|member| (member.name.as_deref().unwrap(), member.offset))
        .collect();
    let expected = [
        ("toward", offset_of!(Wind, toward)),
        ("axis", offset_of!(Wind, axis)),
        ("turns", offset_of!(Wind, turns)),
        ("bend", offset_of!(Wind, bend)),
        ("flutter", offset_of!(Wind, flutter)),
        ("vertices", size_of::<Wind>()),
    ];
    assert_eq!(offsets, expected.map(|(name, at)| (name, at as u32)));
    assert_eq!(*span, 32);
}
