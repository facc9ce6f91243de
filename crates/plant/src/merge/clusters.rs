//! Leaf clusters: where, how large, of which leaves.

use glam::DVec3;

/// How large the card of a cluster is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum ClusterSize {
    /// The paper's radius: the mean distance and the mean radius of the leaves.
    #[default]
    Paper,
    /// The radius at which cluster leaves have as much area as the leaves that they stand for.
    ///
    /// Cluster leaves have as much area as the leaves that they stand for: covers as much where they
    /// overlap little, more where they overlap much, as pinnate ones do.
    Area,
}

/// What merging knows of a leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Disc {
    /// The top of the stick that it grows on: O_i of the paper.
    pub(super) anchor: DVec3,
    pub(super) centre: DVec3,
    /// From its centre to its farthest corner, in metres.
    pub(super) radius_m: f64,
}

/// The sums behind R0, of leaves seen from one point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gathered {
    centre: DVec3,
    count: u32,
    distances_m: f64,
    radii_m: f64,
    squares_m2: f64,
    nearest_m: f64,
    donor: u32,
}

impl Gathered {
    pub(super) fn at(centre: DVec3) -> Self {
        Self {
            centre,
            count: 0,
            distances_m: 0.0,
            radii_m: 0.0,
            squares_m2: 0.0,
            nearest_m: f64::INFINITY,
            donor: 0,
        }
    }

    pub(super) fn add(&mut self, leaves: &[u32], discs: &[Disc]) {
        for &leaf in leaves {
            let disc = &discs[leaf as usize];
            let distance_m = (disc.anchor - self.centre).length();
            self.count += 1;
            self.distances_m += distance_m;
            self.radii_m += disc.radius_m;
            self.squares_m2 += disc.radius_m * disc.radius_m;
            let is_nearer =
                distance_m < self.nearest_m || (distance_m == self.nearest_m && leaf < self.donor);
            if is_nearer || self.count == 1 {
                (self.nearest_m, self.donor) = (distance_m, leaf);
            }
        }
    }

    /// A card like the donor's about the centre.
    ///
    /// # Panics
    /// If there is no leaf.
    pub(super) fn card(&self, size: ClusterSize) -> Card {
        assert!(self.count > 0, "a cluster has leaves");
        let count = f64::from(self.count);
        let r0_m = self.distances_m / count + self.radii_m / count;
        Card {
            centre: self.centre,
            radius_m: match size {
                ClusterSize::Paper => r0_m,
                // The area of a card goes with the square of its radius.
                ClusterSize::Area => libm::sqrt(self.squares_m2),
            },
            donor: self.donor,
        }
    }
}

/// How a cluster is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Card {
    pub(super) centre: DVec3,
    /// From its centre to its farthest corner, in metres.
    pub(super) radius_m: f64,
    /// The leaf that it looks like, from 0.
    pub(super) donor: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disc(anchor: DVec3, radius_m: f64) -> Disc {
        Disc {
            anchor,
            // Distances are not to where the leaf is.
            centre: anchor + DVec3::splat(7.0),
            radius_m,
        }
    }

    /// Fig. 6 by hand: leaves 3, 4 and 5 m away with radii 1, 2 and 3.
    #[test]
    fn r0_is_the_mean_distance_and_the_mean_radius() {
        let discs = [
            disc(DVec3::new(0.0, 5.0, 0.0), 1.0),
            disc(DVec3::new(3.0, 1.0, 0.0), 2.0),
            disc(DVec3::new(0.0, 1.0, -5.0), 3.0),
        ];
        let mut gathered = Gathered::at(DVec3::Y);
        gathered.add(&[2], &discs);
        gathered.add(&[0, 1], &discs);
        let card = gathered.card(ClusterSize::Paper);
        assert!((card.radius_m - (12.0 / 3.0 + 2.0)).abs() < 1e-12);
        assert_eq!((card.centre, card.donor), (DVec3::Y, 1));
        // 1 + 4 + 9 squared metres.
        let as_large = gathered.card(ClusterSize::Area);
        assert!((as_large.radius_m - 14f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn of_leaves_equally_near_the_first_lends_its_look() {
        let discs = [2.0, -1.0, 1.0].map(|x| disc(DVec3::X * x, 0.0));
        let mut gathered = Gathered::at(DVec3::ZERO);
        gathered.add(&[2, 1, 0], &discs);
        assert_eq!(gathered.card(ClusterSize::Paper).donor, 1);
    }
}
