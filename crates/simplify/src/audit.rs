//! The final foliage drawn again, another way, and compared.

use secateur_model::Foliage;
use secateur_raster::occluders::Occluded;
use secateur_raster::{AreaTable, CpuRasteriser, OpenEngine, RasterError, Rasteriser, Scene};

use crate::Error;

/// Rasterises the scene from scratch by the path that `engine` does not use and
/// compares the areas. Returns what it was compared with.
///
/// The other path of the CPU is a GPU where there is one, software drivers
/// included, else drawing with a depth buffer instead of sorted fragments.
///
/// # Errors
/// [`Error::Audit`] if they differ.
pub(crate) fn audit(
    areas: &AreaTable,
    scene: &Scene<'_>,
    engine: &OpenEngine,
    occluders: Option<&Foliage>,
) -> Result<&'static str, Error> {
    let (path, again) = other_path(scene, engine, occluders)?;
    if let Some(difference) = first_difference(areas, &again) {
        return Err(Error::Audit(format!("{difference} by the {path}")));
    }
    Ok(path)
}

fn other_path(
    scene: &Scene<'_>,
    engine: &OpenEngine,
    occluders: Option<&Foliage>,
) -> Result<(&'static str, AreaTable), Error> {
    #[cfg(feature = "gpu")]
    if engine.name() == "cpu" {
        use secateur_raster::gpu::{Device, Preference};
        let device = Device::find(Preference::Any).map_err(RasterError::from);
        match device.and_then(|device| areas(&device, scene, occluders)) {
            Ok(areas) => return Ok(("GPU", areas)),
            Err(reason) => tracing::debug!("no GPU for the audit: {reason}"),
        }
    }
    #[cfg(not(feature = "gpu"))]
    let _ = engine;
    Ok((
        "CPU's depth buffer",
        areas(&CpuRasteriser, scene, occluders)?,
    ))
}

fn areas(
    rasteriser: &dyn Rasteriser,
    scene: &Scene<'_>,
    occluders: Option<&Foliage>,
) -> Result<AreaTable, RasterError> {
    match occluders {
        Some(occluders) => Occluded {
            rasteriser,
            occluders,
        }
        .areas(scene),
        None => rasteriser.areas(scene),
    }
}

fn first_difference(areas: &AreaTable, again: &AreaTable) -> Option<String> {
    if areas.as_slice().len() != again.as_slice().len() {
        return Some("the tables differ in size".to_owned());
    }
    let mut pairs = areas.as_slice().iter().zip(again.as_slice());
    let place = pairs.position(|(a, b)| a != b)?;
    let width = areas.leaf_count() + 1;
    let (view, leaf) = (place / width, place % width);
    let [kept, drawn] = [areas, again].map(|table| table.as_slice()[place]);
    Some(format!(
        "in view {view} leaf {leaf} has {kept} pixels by the run and {drawn}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_is_named() {
        let table = |areas: &[u32]| AreaTable::from_rows(1, areas.to_vec());
        let [a, b] = [table(&[3, 1, 4, 0]), table(&[3, 1, 2, 2])];
        assert_eq!(first_difference(&a, &a), None);
        assert_eq!(
            first_difference(&a, &b).unwrap(),
            "in view 1 leaf 0 has 4 pixels by the run and 2"
        );
    }

    #[test]
    fn areas_that_are_not_those_of_the_foliage_do_not_pass() {
        use secateur_model::{Foliage, LeafTriangle, Lod};
        let mut foliage = Foliage::default();
        let corners = [glam::DVec3::ZERO, glam::DVec3::X, glam::DVec3::Y];
        foliage
            .push_leaf(&[LeafTriangle::plain(corners)], None)
            .unwrap();
        let views = secateur_raster::ViewSet::cube(foliage.bounding_sphere().unwrap());
        let scene = Scene {
            foliage: &foliage,
            lod: &Lod::original(1),
            views: &views,
            resolution: 32,
        };
        let engine = OpenEngine::cpu();
        let true_areas = CpuRasteriser.areas(&scene).unwrap();
        assert!(audit(&true_areas, &scene, &engine, None).is_ok());
        // A pixel of the background too many, and one of the leaf too few.
        let mut wrong = true_areas.as_slice().to_vec();
        wrong[0] += 1;
        wrong[1] -= 1;
        let error = audit(&AreaTable::from_rows(1, wrong), &scene, &engine, None).unwrap_err();
        let text = error.to_string();
        assert!(
            text.contains("in view 0 leaf 0") && text.contains("report"),
            "{text}"
        );
    }
}
