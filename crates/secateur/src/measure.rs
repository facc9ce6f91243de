//! Stub until secateur_eval::measure exists.
use secateur_model::{Foliage, Lod};
use secateur_raster::{Scene, ViewSet, cpu};
use secateur_simplify::lg::LgTable;
use secateur_simplify::vmi::Vmi;

use crate::{Error, sphere_of};

/// Stub.
#[derive(Clone, Copy, Debug)]
pub struct Measurement {
    /// Stub.
    pub vmi_error_percent: f64,
    /// Stub.
    pub silhouette_iou: f64,
    /// Stub.
    pub precision: f64,
    /// Stub.
    pub recall: f64,
    /// Stub.
    pub coverage_ratio: f64,
    /// Stub.
    pub views: usize,
    /// Stub.
    pub resolution: u32,
}

/// Stub.
///
/// # Errors
/// Stub.
pub fn measure(original: &Foliage, simplified: &Foliage) -> Result<Measurement, Error> {
    let views = ViewSet::icosahedron(sphere_of(original)?);
    let table = LgTable::new();
    let of = |foliage: &Foliage| {
        let lod = Lod::original(foliage.leaves().len());
        let scene = Scene {
            foliage,
            lod: &lod,
            views: &views,
            resolution: 512,
        };
        let fill: Vec<bool> = views
            .views()
            .iter()
            .flat_map(|v| cpu::draw_leaf_ids(&scene, v).leaf_ids)
            .map(|l| l > 0)
            .collect();
        (Vmi::of(&cpu::areas(&scene), &table), fill)
    };
    let (a, fa) = of(original);
    let (b, fb) = of(simplified);
    let both = fa.iter().zip(&fb).filter(|(a, b)| **a && **b).count() as f64;
    let [na, nb] = [fa, fb].map(|f| f.iter().filter(|p| **p).count() as f64);
    Ok(Measurement {
        vmi_error_percent: a.error_percent(&b),
        silhouette_iou: both / (na + nb - both),
        precision: both / nb,
        recall: both / na,
        coverage_ratio: nb / na,
        views: views.len(),
        resolution: 512,
    })
}
