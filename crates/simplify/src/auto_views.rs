//! From how many views a crown is looked at.
//!
//! A leaf of about a pixel is drawn in some views and missed in others by chance, and coverage that is held
//! in the sum of 20 views is then held less well from elsewhere. Where most leaves are that small, 60 views
//! leave less to chance (`docs/results.md`, What driving costs).

use secateur_model::{BoundingSphere, Budget, Foliage};
use secateur_raster::{MAX_RESOLUTION, OpenEngine};

use crate::memory::take_run;
use crate::resolution::visibility_at;
use crate::shared::Shared;
use crate::{Error, Options, Target, Views};

/// The share of the visible leaves, seen without wood and obstacles, that may cover at most a pixel in every one of 20 views.
const MOST_SMALL: f64 = 0.5;

/// The views of a run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ChosenViews {
    pub(crate) views: Views,
    /// Why, in words; nothing where the caller chose.
    pub(crate) reason: Option<String>,
}

/// The views of a run of this resolution: those that were asked for, or for [`Views::Auto`] the 20 of
/// [`Views::Dodecahedron`], and with a budget of triangles the 60 of [`Views::Dodecahedra`] where most leaves are
/// no larger than a pixel. By leaves the loop is longer and the gain smaller.
pub(crate) fn views_for(
    foliage: &Foliage,
    options: &Options,
    sphere: BoundingSphere,
    resolution: u32,
    engine: &OpenEngine,
    shared: Option<&mut Shared>,
) -> Result<ChosenViews, Error> {
    if !options.views.are_auto() {
        return Ok(ChosenViews {
            views: options.views.clone(),
            reason: None,
        });
    }
    let few = |reason: &str| {
        Ok(ChosenViews {
            views: options.views.instead_of_auto(&Views::Dodecahedron),
            reason: Some(reason.to_owned()),
        })
    };
    if let Some(views) = &options.effort.work().views {
        return Ok(ChosenViews {
            views: options.views.instead_of_auto(views),
            reason: Some(format!("of effort {}", options.effort.name())),
        });
    }
    if options.method.vds().is_none() {
        return few("the method does not look");
    }
    if !matches!(options.target, Target::Triangles(_)) {
        return few("only with a budget of triangles may there be 60");
    }
    if !(options.is_for_the_look() && options.grows_as_its_preset_has_it()) {
        return few("only the look, with growth as it has it, may have 60");
    }
    // What is out of range is refused later.
    if !(1..=MAX_RESOLUTION).contains(&resolution) {
        return few("the resolution is out of range");
    }
    let mut none = None;
    let known = shared.map_or(&mut none, |shared| &mut shared.views);
    if let Some(known) = known {
        return Ok(known.clone());
    }
    let first = options.first_views(sphere);
    take_run(
        &mut Budget::new(options.memory),
        foliage,
        options,
        &first,
        resolution,
    )?;
    let seen = visibility_at(foliage, &first, resolution, engine)?;
    let reason = format!(
        "of the leaves that other leaves do not hide {:.1} % cover at most a pixel in every one of 20 views; with more than {:.0} % there are 60",
        100.0 * seen.share_at_most_a_pixel(),
        100.0 * MOST_SMALL
    );
    let views = match seen.share_at_most_a_pixel() > MOST_SMALL {
        true => options.views.instead_of_auto(&Views::Dodecahedra),
        false => options.views.instead_of_auto(&Views::Dodecahedron),
    };
    let chosen = ChosenViews {
        views,
        reason: Some(reason),
    };
    *known = Some(chosen.clone());
    Ok(chosen)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Method, Preset, Resolution, Shared, simplify, simplify_sharing, sphere_of};
    use glam::{DQuat, DVec3};
    use secateur_model::LeafTriangle;
    use std::ops::ControlFlow;

    /// Cards of this side in a ball of radius 10, which is about 19 pixels wide in pictures of 64.
    fn crown(side: f64) -> Foliage {
        let mut random = secateur_model::Random::new(3);
        let mut foliage = Foliage::default();
        while foliage.leaves().len() < 60 {
            let at = [(); 3].map(|()| random.between(-10.0, 10.0));
            let at = DVec3::from_array(at);
            if at.length() > 10.0 {
                continue;
            }
            let (a, b) = (DVec3::new(side, 0.0, side / 2.0), DVec3::Y * side);
            let corners = [at, at + a, at + a + b, at + b];
            let triangles =
                [[0, 1, 2], [0, 2, 3]].map(|t| LeafTriangle::plain(t.map(|i: usize| corners[i])));
            foliage.push_leaf(&triangles, None).unwrap();
        }
        foliage
    }

    fn options(target: Target) -> Options {
        Options {
            resolution: Resolution::Pixels(64),
            ..Options::to(target)
        }
    }

    fn views_of(foliage: &Foliage, options: &Options) -> Views {
        let sphere = sphere_of(foliage).unwrap();
        let chosen = views_for(foliage, options, sphere, 64, &OpenEngine::cpu(), None);
        chosen.unwrap().views
    }

    #[test]
    fn more_views_look_at_small_leaves() {
        let (small, large) = (crown(0.4), crown(4.0));
        let half = options(Target::triangle_share(0.5));
        assert_eq!(half.views, Views::Auto);
        assert_eq!(views_of(&small, &half), Views::Dodecahedra);
        assert_eq!(views_of(&large, &half), Views::Dodecahedron);
        // By leaves, by a method that does not look, and where the caller chose, there are not more.
        let by_leaves = options(Target::leaf_share(0.5));
        assert_eq!(views_of(&small, &by_leaves), Views::Dodecahedron);
        let pruned = Options {
            method: Method::Stochastic(Default::default()),
            ..half.clone()
        };
        assert_eq!(views_of(&small, &pruned), Views::Dodecahedron);
        for own in [Views::Cube, Views::Dodecahedron] {
            let asked = Options {
                views: own.clone(),
                ..half.clone()
            };
            assert_eq!(views_of(&small, &asked), own);
        }
        // Growth in proportion to cost depends on the number of views.
        for asked in [
            Options {
                method: Method::Vds(Preset::Information.vds()),
                ..half.clone()
            },
            Options {
                views: Views::Auto,
                resolution: Resolution::Pixels(64),
                ..Options::with_preset(Preset::Information, half.target)
            },
        ] {
            assert_eq!(views_of(&small, &asked), Views::Dodecahedron);
        }
        let turn = DQuat::from_rotation_x(1.0);
        let turned = |views| Views::Turned {
            views: Box::new(views),
            turn,
        };
        let asked = Options {
            views: turned(Views::Auto),
            ..half
        };
        assert_eq!(views_of(&small, &asked), turned(Views::Dodecahedra));
    }

    #[test]
    fn a_run_is_the_one_by_the_views_it_names() {
        for side in [0.4, 4.0] {
            let foliage = crown(side);
            let by_itself = options(Target::triangle_share(0.2));
            let found = simplify(&foliage, &by_itself).unwrap();
            let reason = found.views_reason.as_deref().unwrap();
            assert!(reason.contains("at most a pixel"), "{reason}");
            let asked = Options {
                views: found.driven_by.clone(),
                ..by_itself
            };
            let same = simplify(&foliage, &asked).unwrap();
            assert_eq!(found.views.len(), if side < 1.0 { 60 } else { 20 });
            assert_eq!((same.views_reason, same.driven_by), (None, found.driven_by));
            assert_eq!((same.lod, same.views), (found.lod, found.views));
        }
    }

    /// Nothing is drawn of what is refused.
    #[test]
    fn what_is_out_of_range_is_refused_as_ever() {
        let foliage = crown(0.4);
        for resolution in [0, MAX_RESOLUTION + 1] {
            let options = Options {
                resolution: Resolution::Pixels(resolution),
                ..Options::to(Target::triangle_share(0.5))
            };
            let error = simplify(&foliage, &options).unwrap_err();
            assert!(matches!(error, Error::Vds(_)), "{error}");
        }
        let options = Options {
            memory: secateur_model::Memory::Bytes(1 << 20),
            ..options(Target::triangle_share(0.5))
        };
        let error = simplify(&foliage, &options).unwrap_err();
        assert!(error.to_string().contains("20 views of 64 x 64"), "{error}");
    }

    /// Runs by leaves and by triangles look from different views.
    #[test]
    fn what_was_found_from_other_views_is_not_shared() {
        let foliage = crown(0.4);
        let mut shared = Shared::default();
        for target in [
            Target::leaves(30),
            Target::triangles(40),
            Target::leaves(10),
            Target::triangles(12),
        ] {
            let options = Options {
                leaf_triangles: crate::LeafTriangles::Keep,
                ..options(target)
            };
            let alone = simplify(&foliage, &options).unwrap();
            let engine = OpenEngine::cpu();
            let mut go_on = |_| ControlFlow::Continue(());
            let sharing =
                simplify_sharing(&engine, &foliage, &options, Some(&mut shared), &mut go_on)
                    .unwrap();
            assert_eq!(alone.costs, sharing.costs, "{target:?}");
            assert_eq!(alone.lod, sharing.lod, "{target:?}");
            let views = match target {
                Target::Triangles(_) => 60,
                _ => 20,
            };
            assert_eq!((alone.views.len(), sharing.views.len()), (views, views));
            assert_eq!(alone.views, sharing.views);
            assert_eq!(alone.vmi_original, sharing.vmi_original);
        }
    }
}
