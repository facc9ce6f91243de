//! What can be chosen about a run.

use std::sync::Arc;

use secateur_model::{BoundingSphere, Foliage, Memory, PlantSkeleton};
use secateur_raster::{Engine, ViewSet};
use serde::{Deserialize, Serialize};

use crate::fit::{INFORMATION_OUTLINE_WEIGHT, MAX_OUTLINE_WEIGHT, Objective};
use crate::hanging_leaves::HeldBy;
use crate::select::refuse;
use crate::vds::ViewPlan;
use crate::{
    Alpha, Effort, Error, FieldOfView, FinerLevel, Fitting, LeafTriangles, Method, Needles, Preset,
    Resolution, Sides, Target, Views,
};

/// What a run is to do; [`Options::to`] has the defaults of the command line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Options {
    /// What the options began with; it says what [`Fitting::Auto`] is.
    pub preset: Preset,
    /// How much work goes into what is left to the program.
    #[serde(default)]
    pub effort: Effort,
    /// How much is to be left, or how much may be lost.
    pub target: Target,
    /// How leaves are chosen, with the options of the method.
    pub method: Method,
    /// Where they are rasterised.
    pub engine: Engine,
    /// From where VDS looks.
    pub views: Views,
    /// How much of its surroundings a view shows; cameras of one's own have fields of view of their own.
    #[serde(default)]
    pub field_of_view: FieldOfView,
    /// Width and height in pixels of the images in which VDS measures areas.
    pub resolution: Resolution,
    /// Whether holes of leaf textures count.
    pub alpha: Alpha,
    /// From which sides leaves are seen.
    #[serde(default)]
    pub sides: Sides,
    /// For VDS: leaves of fewer triangles, made before any leaf goes. They are
    /// then what costs and coverage are measured against.
    pub leaf_triangles: LeafTriangles,
    /// For VDS to a number of triangles, unless leaves keep all of theirs: how needles grow.
    pub needles: Needles,
    /// Whether the sizes of what is left are fitted to the original at the end.
    pub fit: Fitting,
    /// What the foliage has grown on, as a glTF file tells or a plant that was grown; for methods
    /// that follow branches.
    #[serde(skip)]
    pub skeleton: Option<Arc<PlantSkeleton>>,
    /// How much memory the run may take, with the foliage's copies but without the foliage itself:
    /// what takes much is reckoned beforehand, and refused where it is more. What comes of a run
    /// that is not refused does not depend on it.
    #[serde(skip)]
    pub memory: Memory,
    /// What hides leaves wherever they are looked at: the plant's wood, or what stands before it.
    #[serde(skip)]
    pub occluders: Option<Arc<Foliage>>,
    /// What leaves hang on: those go that would be further from it than it says.
    #[serde(skip)]
    pub held_by: Option<Arc<HeldBy>>,
    /// The finer level in which this one is to be nested: no leaf is left, and no part of the wood, that is gone there.
    /// For [`Method::Vds`] to a number of triangles; others do not look at it.
    #[serde(skip)]
    pub finer: Option<Arc<FinerLevel>>,
    /// Whether the final foliage is rasterised from scratch another way and
    /// compared.
    pub audit: bool,
    /// Whether the driving views are drawn of what is left, for [`Simplified::areas`] and
    /// [`Simplified::vmi_final`]. They are anyhow where an error or an audit is asked for, or sizes are
    /// fitted to information. What is left does not depend on it.
    ///
    /// [`Simplified::areas`]: crate::Simplified::areas
    /// [`Simplified::vmi_final`]: crate::Simplified::vmi_final
    #[serde(skip, default = "shows_what_is_left")]
    pub shows_what_is_left: bool,
    /// Pixels a side, at most, of the pictures in which sizes are fitted to coverage; fewer for a tight field of view, in
    /// which the crown is as large in fewer pixels.
    #[serde(skip, default = "most_fit_px")]
    pub most_fit_px: u32,
}

fn most_fit_px() -> u32 {
    u32::MAX
}

fn shows_what_is_left() -> bool {
    true
}

impl Options {
    /// The defaults, with this target: those of [`Preset::Look`]. Audits in debug builds.
    pub fn to(target: Target) -> Self {
        Self::with_preset(Preset::default(), target)
    }

    /// The options of a preset, with this target. Audits in debug builds.
    pub fn with_preset(preset: Preset, target: Target) -> Self {
        Self {
            preset,
            effort: Effort::default(),
            target,
            method: Method::Vds(preset.vds()),
            engine: Engine::default(),
            views: preset.views(),
            field_of_view: FieldOfView::default(),
            resolution: preset.resolution(),
            alpha: preset.alpha(),
            sides: preset.sides(),
            leaf_triangles: preset.leaf_triangles(),
            needles: preset.needles(),
            fit: Fitting::default(),
            skeleton: None,
            memory: Memory::Auto,
            occluders: None,
            held_by: None,
            finer: None,
            audit: cfg!(debug_assertions),
            shows_what_is_left: shows_what_is_left(),
            most_fit_px: most_fit_px(),
        }
    }

    /// Whether a level is to show as much of the crown in what clients draw from afar as there is, by
    /// alpha cutoffs of its own: the look by VDS, where leaves grow as this preset has it and masks count.
    pub fn chooses_cutoffs(&self) -> bool {
        self.is_for_the_look()
            && self.grows_as_its_preset_has_it()
            && self.alpha == Alpha::Mask
            && self.effort.work().fits
    }

    /// All sets of views that a run about a foliage with this bounding sphere looks from, one after
    /// the other. [`Views::Auto`] is taken for the dodecahedron; [`Simplified::driving`](crate::Simplified::driving) knows
    /// what it was.
    pub fn driving(&self, sphere: BoundingSphere) -> Vec<ViewSet> {
        self.plan(sphere).sets()
    }

    /// The views that it begins with.
    pub fn first_views(&self, sphere: BoundingSphere) -> ViewSet {
        self.plan(sphere).first()
    }

    pub(crate) fn plan(&self, sphere: BoundingSphere) -> ViewPlan {
        self.views.plan(sphere).map(|set| self.framed(set))
    }

    /// The field of view to draw with: [`Self::field_of_view`], or the preset's where it is `None`.
    pub fn field_of_view(&self) -> FieldOfView {
        match self.field_of_view {
            FieldOfView::Auto => self.preset.field_of_view(),
            own => own,
        }
    }

    fn framed(&self, views: &ViewSet) -> ViewSet {
        self.framed_as(views, self.field_of_view())
    }

    /// Views with this field of view, but for cameras of the caller's.
    pub(crate) fn framed_as(&self, views: &ViewSet, field_of_view: FieldOfView) -> ViewSet {
        if self.views.are_cameras() {
            return views.clone();
        }
        let tan_half = field_of_view.tan_half();
        let framed = views.with_field_of_view(tan_half);
        framed.expect("a field of view in range, as checked")
    }

    /// What sizes are fitted to, if they are.
    pub fn objective(&self) -> Option<Objective> {
        let information = |outline_weight| Objective::Information { outline_weight };
        match self.fit {
            Fitting::None => None,
            Fitting::Coverage => Some(Objective::Coverage),
            Fitting::Weight(weight) => Some(information(weight)),
            Fitting::Auto if !self.grows_as_its_preset_has_it() || !self.effort.work().fits => None,
            Fitting::Auto => match self.preset {
                Preset::Look => Some(Objective::Coverage),
                Preset::Information => (!matches!(self.target, Target::MaxErrorPercent(_))
                    && matches!(self.method, Method::Vds(_))
                    && self.resolution == Resolution::Auto)
                    .then_some(information(INFORMATION_OUTLINE_WEIGHT)),
                // The paper fits nothing.
                Preset::Paper
                | Preset::PaperNormalised
                | Preset::PaperFull
                | Preset::PaperDeficit
                | Preset::PaperNone => None,
            },
        }
    }

    /// Whether VDS chooses leaves for pictures.
    pub(crate) fn is_for_the_look(&self) -> bool {
        self.preset == Preset::Look && self.method.vds().is_some()
    }

    /// Whether needles grow across.
    pub(crate) fn widens_needles(&self) -> bool {
        self.needles == Needles::Widen
            && self.method.vds().is_some()
            && matches!(self.target, Target::Triangles(_))
            && self.leaf_triangles != LeafTriangles::Keep
    }

    pub(crate) fn grows_as_its_preset_has_it(&self) -> bool {
        let preset = self.preset.vds();
        self.method.vds().is_some_and(|own| {
            own.resize == preset.resize && own.max_coverage == preset.max_coverage
        })
    }

    /// Whether one run to few leaves gives every level above, a leaf a step: no other leaves are
    /// made first, and no sizes fitted to one level.
    pub fn levels_share_one_order(&self) -> bool {
        self.method.removes_leaf_by_leaf()
            && !matches!(self.target, Target::Triangles(_))
            && !matches!(self.leaf_triangles, LeafTriangles::AtMost(_))
            && self.objective().is_none()
    }

    /// Whether all is in range, and the plant has what the method needs.
    ///
    /// # Errors
    /// [`Error`] with the first that is not.
    pub(crate) fn check(&self, foliage: &Foliage) -> Result<(), Error> {
        self.method.check(foliage, self.skeleton.as_deref())?;
        if let FieldOfView::Degrees(degrees) = self.field_of_view
            && !(0.0 < degrees && degrees < 180.0)
        {
            return refuse("field of view", degrees, "above 0 and below 180 degrees");
        }
        if self.leaf_triangles == LeafTriangles::AtMost(0) {
            return refuse("number of a leaf's triangles", 0.0, "from 1 upwards");
        }
        if let Some(Objective::Information { outline_weight }) = self.objective()
            && !(0.0..=MAX_OUTLINE_WEIGHT).contains(&outline_weight)
        {
            return refuse("weight of the outline", outline_weight, "from 0 to 100");
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fsa::FsaOptions;
    use crate::vds::{Resize, VdsOptions};

    fn with_vds(options: &Options, change: impl FnOnce(&mut VdsOptions)) -> Options {
        let mut options = options.clone();
        change(options.method.vds_mut().unwrap());
        options
    }

    /// A crown that is meant to get thinner is not made dense again by its masks.
    #[test]
    fn the_look_alone_chooses_cutoffs() {
        let of = |preset| Options::with_preset(preset, Target::leaf_share(0.1));
        let look = of(Preset::Look);
        assert!(look.chooses_cutoffs());
        assert!(!of(Preset::Information).chooses_cutoffs());
        assert!(!of(Preset::Paper).chooses_cutoffs());
        assert!(!with_vds(&look, |vds| vds.resize = Resize::None).chooses_cutoffs());
        let solid = Options {
            alpha: Alpha::Ignore,
            ..look.clone()
        };
        assert!(!solid.chooses_cutoffs());
    }

    #[test]
    fn sizes_are_fitted_unasked_where_all_else_is_left_to_the_program_too() {
        let usual = Some(Objective::Information {
            outline_weight: INFORMATION_OUTLINE_WEIGHT,
        });
        let triangles = Target::triangle_share(0.5);
        let information = Options::with_preset(Preset::Information, triangles);
        let look = Options::to(triangles);
        assert_eq!(information.objective(), usual);
        assert_eq!(look.objective(), Some(Objective::Coverage));
        // Only what one asks to be shown best is fitted to coverage at any target and resolution.
        let pixels = Resolution::Pixels(512);
        for (target, of_information) in [
            (Target::leaf_share(0.5), usual),
            (Target::leaves(3), usual),
            (Target::MaxErrorPercent(5.0), None),
        ] {
            let information = Options::with_preset(Preset::Information, target);
            assert_eq!(information.objective(), of_information);
            assert_eq!(Options::to(target).objective(), Some(Objective::Coverage));
        }
        let at = |options: &Options, resolution| Options {
            resolution,
            ..options.clone()
        };
        assert_eq!(at(&information, pixels).objective(), None);
        assert_eq!(at(&look, pixels).objective(), Some(Objective::Coverage));
        for auto in [information, look] {
            let others = [
                Options {
                    method: Method::Fsa(FsaOptions::default()),
                    ..auto.clone()
                },
                with_vds(&auto, |vds| vds.resize = Resize::None),
                with_vds(&auto, |vds| vds.max_coverage = Some(1.5)),
                Options {
                    fit: Fitting::None,
                    ..auto.clone()
                },
            ];
            for other in others {
                assert_eq!(other.objective(), None, "{other:?}");
                let asked = Options {
                    fit: Fitting::Weight(3.0),
                    ..other.clone()
                };
                let outline_weight = 3.0;
                assert_eq!(
                    asked.objective(),
                    Some(Objective::Information { outline_weight })
                );
                let asked = Options {
                    fit: Fitting::Coverage,
                    ..other
                };
                assert_eq!(asked.objective(), Some(Objective::Coverage));
            }
        }
    }

    /// The paper's settings, each of them, and nothing but the reading of Eq. 5 between them.
    #[test]
    fn the_papers_presets_differ_in_eq_5_alone() {
        let of = |preset| Options::with_preset(preset, Target::leaf_share(0.5));
        let literal = of(Preset::Paper);
        let plain = VdsOptions {
            resize: Resize::Literal,
            ..VdsOptions::default()
        };
        assert_eq!(literal.method, Method::Vds(plain));
        assert_eq!(literal.views, Views::Dodecahedron);
        assert_eq!(literal.resolution, Resolution::Pixels(256));
        assert_eq!(literal.alpha, Alpha::Ignore);
        assert_eq!(literal.leaf_triangles, LeafTriangles::Keep);
        let mut readings = Vec::new();
        for preset in Preset::PAPER {
            let own = of(preset);
            assert!(preset.is_paper() && own.levels_share_one_order());
            for target in [Target::leaf_share(0.5), Target::triangle_share(0.5)] {
                assert_eq!(Options::with_preset(preset, target).objective(), None);
            }
            readings.push(own.method.vds().unwrap().resize);
            let same = with_vds(&own, |vds| vds.resize = Resize::Literal);
            assert_eq!(
                Options {
                    preset: Preset::Paper,
                    ..same
                },
                literal
            );
        }
        let all = [
            Resize::Literal,
            Resize::Normalised,
            Resize::Full,
            Resize::Deficit,
            Resize::None,
        ];
        assert_eq!(readings, all);
    }

    #[test]
    fn a_value_has_one_spelling() {
        for text in ["auto", "256", "2048"] {
            assert_eq!(text.parse::<Resolution>().unwrap().to_string(), text);
        }
        for text in ["auto", "tight", "60", "38.9"] {
            assert_eq!(text.parse::<FieldOfView>().unwrap().to_string(), text);
        }
        for bad in ["0", "180", "-1", "NaN", "wide"] {
            assert!(bad.parse::<FieldOfView>().is_err(), "{bad}");
        }
        for text in ["auto", "keep", "2"] {
            assert_eq!(text.parse::<LeafTriangles>().unwrap().to_string(), text);
        }
        for text in ["auto", "none", "coverage", "0.95", "4"] {
            assert_eq!(text.parse::<Fitting>().unwrap().to_string(), text);
        }
        for bad in ["0", "2049", "-1", "many"] {
            assert!(bad.parse::<Resolution>().is_err(), "{bad}");
        }
        for bad in ["-1", "101", "NaN", "some"] {
            assert!(bad.parse::<Fitting>().is_err(), "{bad}");
        }
        assert!("0".parse::<LeafTriangles>().is_err());
    }

    #[test]
    fn options_come_back_from_json() {
        let options = Options {
            fit: Fitting::Weight(4.0),
            leaf_triangles: LeafTriangles::AtMost(2),
            audit: false,
            ..Options::with_preset(Preset::Information, Target::triangle_share(0.25))
        };
        let json = serde_json::to_value(&options).unwrap();
        assert_eq!(json["method"]["vds"]["resize"], "normalised");
        assert_eq!(json["fit"], "4");
        assert_eq!(json["views"], "turning");
        let again: Options = serde_json::from_value(json).unwrap();
        assert_eq!(again, options);
    }
}
