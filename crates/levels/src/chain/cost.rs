//! What a level costs the scene that shows it, as one figure.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Bytes in a KiB.
const KIB: f64 = 1024.0;

/// Bytes of vertices and indices that a triangle of a level is taken to have before the level is written.
const GEOMETRY_BYTES_A_TRIANGLE: u64 = 70;

/// How many times fewer bytes textures are taken to have in a file than on a GPU, before they are written.
const TEXTURES_IN_FILE: u64 = 4;

/// What makes up the cost of a level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LevelParts {
    /// Triangles that are drawn.
    pub triangles: u64,
    /// Primitives that are drawn.
    pub draws: u64,
    /// Bytes of its file, textures included.
    pub bytes: u64,
    /// Bytes of textures, vertices and indices on the GPU.
    pub gpu_bytes: u64,
}

impl LevelParts {
    /// About what a level will have that is not written yet.
    pub(super) fn before_writing(triangles: usize, draws: usize, texture_bytes: u64) -> Self {
        let geometry_bytes = GEOMETRY_BYTES_A_TRIANGLE * triangles as u64;
        Self {
            triangles: triangles as u64,
            draws: draws as u64,
            bytes: geometry_bytes + texture_bytes / TEXTURES_IN_FILE,
            gpu_bytes: geometry_bytes + texture_bytes,
        }
    }
}

/// What each part of a level counts for in its cost, 0 or more. By default the unit is a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct CostWeights {
    /// Weight of a triangle.
    pub triangle: f64,
    /// Weight of a primitive that is drawn.
    pub draw: f64,
    /// Weight of a KiB of its file.
    pub disk_kib: f64,
    /// Weight of a KiB on the GPU.
    pub gpu_kib: f64,
}

impl Default for CostWeights {
    /// A draw counts as much as 50 triangles, a MiB on disk as 20 and one on the GPU as 100.
    fn default() -> Self {
        Self {
            triangle: 1.0,
            draw: 50.0,
            disk_kib: 0.02,
            gpu_kib: 0.1,
        }
    }
}

impl CostWeights {
    /// The cost of a level.
    pub fn cost(&self, level: LevelParts) -> f64 {
        self.triangle * level.triangles as f64
            + self.draw * level.draws as f64
            + self.disk_kib * level.bytes as f64 / KIB
            + self.gpu_kib * level.gpu_bytes as f64 / KIB
    }

    /// Whether all are numbers from 0 on, and not all are 0.
    pub(super) fn are_in_range(&self) -> bool {
        let all = [self.triangle, self.draw, self.disk_kib, self.gpu_kib];
        let is_in_range = |weight: &f64| weight.is_finite() && *weight >= 0.0;
        all.iter().all(is_in_range) && all.iter().any(|weight| *weight > 0.0)
    }
}

impl fmt::Display for CostWeights {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            triangle,
            draw,
            disk_kib,
            gpu_kib,
        } = self;
        write!(
            f,
            "triangle={triangle},draw={draw},disk-kib={disk_kib},gpu-kib={gpu_kib}"
        )
    }
}

impl FromStr for CostWeights {
    type Err = String;

    /// `triangle=1,draw=50,disk-kib=0.02,gpu-kib=0.1`, or some of them: the others stay as they are by default.
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            "write weights of 0 or more, not all 0, such as triangle=1,draw=50,disk-kib=0.02,gpu-kib=0.1"
                .to_owned()
        };
        let mut weights = Self::default();
        for part in text.split(',') {
            let (name, number) = part.split_once('=').ok_or_else(wrong)?;
            let weight = match name.trim() {
                "triangle" => &mut weights.triangle,
                "draw" => &mut weights.draw,
                "disk-kib" => &mut weights.disk_kib,
                "gpu-kib" => &mut weights.gpu_kib,
                _ => return Err(wrong()),
            };
            *weight = number.trim().parse().map_err(|_| wrong())?;
        }
        match weights.are_in_range() {
            true => Ok(weights),
            false => Err(wrong()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_part_counts_by_its_weight() {
        let level = LevelParts {
            triangles: 48,
            draws: 2,
            bytes: 10 << 10,
            gpu_bytes: 1 << 20,
        };
        let cost = CostWeights::default().cost(level);
        assert!((cost - (48.0 + 100.0 + 0.2 + 102.4)).abs() < 1e-9, "{cost}");
        let only_bytes: CostWeights = "triangle=0,draw=0,disk-kib=1,gpu-kib=0".parse().unwrap();
        assert_eq!(only_bytes.cost(level), 10.0);
    }

    #[test]
    fn weights_are_read_as_they_are_written() {
        let usual = CostWeights::default();
        assert_eq!(usual.to_string().parse(), Ok(usual));
        let own: CostWeights = "draw=7".parse().unwrap();
        assert_eq!(own, CostWeights { draw: 7.0, ..usual });
        let none = "triangle=0,draw=0,disk-kib=0,gpu-kib=0";
        for wrong in ["", "draw", "draw=-1", "draw=inf", "depth=1", none] {
            assert!(wrong.parse::<CostWeights>().is_err(), "{wrong}");
        }
    }
}
