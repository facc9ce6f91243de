//! The fast engine against the literal algorithm: order, growth, costs, areas
//! and VMI must be equal, bit for bit, on every scene and with every reading of
//! the paper.

use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use proptest::prelude::*;
use secateur_model::{Cutout, Foliage, LeafTriangle, Random, Wrap};
use secateur_raster::{CpuRasteriser, ViewSet};
use secateur_simplify::Target;
use secateur_simplify::vds::{
    self, Reference, Resize, Ties, VdsOptions, VdsOutcome, VdsRun, ViewPlan,
};

/// How leaves are scattered: each kind is hard in its own way.
#[derive(Clone, Copy, Debug)]
enum Crown {
    /// Cards of all directions through a ball, several layers deep.
    Ball,
    /// Cards with cut-outs, which show what is behind through their holes.
    Cutouts,
    /// Far apart and around a pixel in size: many are seen nowhere, or in one
    /// view only.
    Specks,
    /// On a coarse grid of positions and directions: thousands of exact ties,
    /// coincident leaves and equal depths.
    Grid,
    /// A few leaves as large as the crown before many small ones.
    Walls,
    /// Long and thinner than a pixel.
    Needles,
}

/// Points and directions drawn by lot.
struct Lots(Random);

impl Lots {
    /// A random number from -1 to 1.
    fn signed(&mut self) -> f64 {
        self.0.between(-1.0, 1.0)
    }

    fn point(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }

    fn direction(&mut self) -> DVec3 {
        loop {
            let p = self.point();
            if (0.01..1.0).contains(&p.length_squared()) {
                return p.normalize();
            }
        }
    }
}

fn card(centre: DVec3, along: DVec3, across: DVec3) -> [LeafTriangle; 2] {
    let corner = |u: f64, v: f64| {
        (
            centre + along * (2.0 * v - 1.0) + across * (2.0 * u - 1.0),
            DVec2::new(u, v),
        )
    };
    let triangle = |c: [(DVec3, DVec2); 3]| LeafTriangle {
        corners: c.map(|x| x.0),
        uvs: c.map(|x| x.1),
    };
    let [a, b, c, d] = [
        corner(0.0, 0.0),
        corner(1.0, 0.0),
        corner(1.0, 1.0),
        corner(0.0, 1.0),
    ];
    [triangle([a, b, c]), triangle([a, c, d])]
}

fn crown(kind: Crown, leaves: usize, seed: u64) -> Foliage {
    let mut random = Lots(Random::new(seed));
    let mask = Cutout::from_fn([16, 16], [Wrap::Repeat, Wrap::ClampToEdge], |x, y| {
        (x as i32 - 8).pow(2) + (y as i32 - 8).pow(2) < 50 && (x / 3 + y / 4) % 2 == 0
    });
    let mut foliage = Foliage::new(vec![Arc::new(mask)]);
    for k in 0..leaves {
        let along = random.direction();
        let across = along.cross(random.direction()).normalize_or(DVec3::X);
        let (centre, size) = match kind {
            Crown::Ball | Crown::Cutouts => (random.direction() * 0.9, 0.25),
            Crown::Specks => (random.point(), 0.012),
            Crown::Grid => {
                let grid = (random.point() * 2.0).round() * 0.4;
                let axes = [DVec3::X, DVec3::Y, DVec3::Z];
                let i = (random.0.bits() % 3) as usize;
                let triangles = card(grid, axes[i] * 0.2, axes[(i + 1) % 3] * 0.2);
                foliage.push_leaf(&triangles, None).unwrap();
                continue;
            }
            Crown::Walls if k < 3 => (random.point() * 0.3, 1.0),
            Crown::Walls => (random.point(), 0.1),
            Crown::Needles => {
                let triangles = card(random.point() * 0.8, along * 0.3, across * 0.006);
                foliage.push_leaf(&triangles, None).unwrap();
                continue;
            }
        };
        let size = size * (1.0 + 0.5 * random.signed());
        let cutout = matches!(kind, Crown::Cutouts).then_some(0);
        foliage
            .push_leaf(&card(centre, along * size, across * size * 0.7), cutout)
            .unwrap();
    }
    foliage
}

fn both(foliage: &Foliage, job: &VdsRun) -> (VdsOutcome, VdsOutcome) {
    let go_on = &mut |_: vds::Progress| ControlFlow::Continue(());
    let fast = vds::fast::simplify(foliage, job, &CpuRasteriser, go_on).unwrap();
    let slow = vds::reference::simplify(foliage, job, go_on).unwrap();
    (fast, slow)
}

fn any_crown() -> impl Strategy<Value = Crown> {
    prop_oneof![
        Just(Crown::Ball),
        Just(Crown::Cutouts),
        Just(Crown::Specks),
        Just(Crown::Grid),
        Just(Crown::Walls),
        Just(Crown::Needles),
    ]
}

fn any_resize() -> impl Strategy<Value = Resize> {
    prop_oneof![
        2 => Just(Resize::Normalised),
        2 => Just(Resize::Steady),
        1 => Just(Resize::Literal),
        1 => Just(Resize::Full),
        1 => Just(Resize::Deficit),
        1 => Just(Resize::None),
    ]
}

/// The view sets by name: 20, 12, 8, 6, 0 for VNC, and 1 for a rig that turns.
fn plan(foliage: &Foliage, views: usize) -> ViewPlan {
    let sphere = foliage.bounding_sphere().unwrap();
    ViewPlan::Fixed(match views {
        0 => return ViewPlan::variable(sphere),
        1 => return ViewPlan::turning(sphere),
        6 => ViewSet::octahedron(sphere),
        8 => ViewSet::cube(sphere),
        12 => ViewSet::icosahedron(sphere),
        _ => ViewSet::dodecahedron(sphere),
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 210, max_shrink_iters: 40, ..ProptestConfig::default() })]

    #[test]
    fn same_order_growth_and_vmi(
        kind in any_crown(),
        leaves in 60usize..68,
        seed in any::<u64>(),
        resolution in prop_oneof![Just(16u32), Just(24), Just(37)],
        views in prop_oneof![6 => Just(6usize), 2 => Just(8), 1 => Just(12), 1 => Just(20), 2 => Just(0), 1 => Just(1)],
        reference in prop_oneof![Just(Reference::Original), Just(Reference::Previous)],
        resize in any_resize(),
        ties in prop_oneof![Just(Ties::Order), Just(Ties::Spread)],
        neighbours in 1usize..5,
        max_coverage in proptest::option::weighted(0.3, 0.8..1.2f64),
        kept in prop_oneof![5 => 0.6..0.95f64, 1 => 0.0..0.6f64],
        max_error in proptest::option::weighted(0.2, 0.5..30.0f64),
    ) {
        let foliage = crown(kind, leaves, seed);
        let options = VdsOptions {
            reference,
            resize,
            neighbours,
            max_coverage,
            ties,
        };
        let to_leaves = Target::leaves((kept * leaves as f64) as u64);
        let job = VdsRun {
            options,
            views: plan(&foliage, views),
            resolution,
            target: max_error.map_or(to_leaves, Target::MaxErrorPercent),
        };
        let (fast, slow) = both(&foliage, &job);
        prop_assert_eq!(&fast.order.removed(), &slow.order.removed());
        prop_assert_eq!(fast, slow);
    }
}

/// Larger crowns, at more pixels a leaf.
#[test]
fn three_hundred_leaves_agree() {
    for (kind, seed, leaves) in [(Crown::Cutouts, 1, 270), (Crown::Walls, 2, 220)] {
        let foliage = crown(kind, 300, seed);
        let mut job = VdsRun::to_leaves(ViewSet::new(Vec::new()), 24, leaves);
        job.views = plan(&foliage, 6);
        let (fast, slow) = both(&foliage, &job);
        assert_eq!(fast, slow, "{kind:?}");
    }
}
