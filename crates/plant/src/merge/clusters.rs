//! Leaf clusters: where, how large, of which leaves.

use glam::DVec3;

/// What merging knows of a leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Disc {
    pub(super) centre: DVec3,
    /// To the farthest corner, in metres.
    pub(super) radius_m: f64,
}

/// The sums behind R0, of leaves seen from one point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gathered {
    centre: DVec3,
    count: u32,
    distances_m: f64,
    radii_m: f64,
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
            nearest_m: f64::INFINITY,
            donor: 0,
        }
    }

    pub(super) fn add(&mut self, leaves: &[u32], discs: &[Disc]) {
        for &leaf in leaves {
            let disc = &discs[leaf as usize];
            let distance_m = (disc.centre - self.centre).length();
            self.count += 1;
            self.distances_m += distance_m;
            self.radii_m += disc.radius_m;
            let is_nearer =
                distance_m < self.nearest_m || (distance_m == self.nearest_m && leaf < self.donor);
            if is_nearer || self.count == 1 {
                (self.nearest_m, self.donor) = (distance_m, leaf);
            }
        }
    }

    /// A card like the donor's, of radius R0 about the centre.
    ///
    /// # Panics
    /// If there is no leaf.
    pub(super) fn card(&self) -> Card {
        assert!(self.count > 0, "a cluster has leaves");
        let count = f64::from(self.count);
        Card {
            centre: self.centre,
            radius_m: self.distances_m / count + self.radii_m / count,
            donor: self.donor,
        }
    }
}

/// How a cluster is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Card {
    pub(super) centre: DVec3,
    /// R0.
    pub(super) radius_m: f64,
    /// The leaf that it looks like, from 0.
    pub(super) donor: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fig. 6 by hand: leaves 3, 4 and 5 m away with radii 1, 2 and 3.
    #[test]
    fn r0_is_the_mean_distance_and_the_mean_radius() {
        let disc = |centre, radius_m| Disc { centre, radius_m };
        let discs = [
            disc(DVec3::new(0.0, 5.0, 0.0), 1.0),
            disc(DVec3::new(3.0, 1.0, 0.0), 2.0),
            disc(DVec3::new(0.0, 1.0, -4.0), 3.0),
        ];
        let mut gathered = Gathered::at(DVec3::Y);
        gathered.add(&[2], &discs);
        gathered.add(&[0, 1], &discs);
        let card = gathered.card();
        assert!((card.radius_m - (11.0 / 3.0 + 2.0)).abs() < 1e-12);
        assert_eq!((card.centre, card.donor), (DVec3::Y, 1));
    }

    #[test]
    fn of_leaves_equally_near_the_first_lends_its_look() {
        let disc = |x| Disc {
            centre: DVec3::X * x,
            radius_m: 0.0,
        };
        let discs = [disc(2.0), disc(-1.0), disc(1.0)];
        let mut gathered = Gathered::at(DVec3::ZERO);
        gathered.add(&[2, 0, 1], &discs);
        assert_eq!(gathered.card().donor, 1);
    }
}
