//! The figures of a level beside those of its plant, as records have them.

use secateur_eval::Judging;
use secateur_levels::Dilated;
use secateur_levels::chain::LevelReport;
use secateur_raster::AreaTable;
use secateur_raster::measure::vmi::Vmi;
use serde::Serialize;

use crate::Level;
use crate::cutoffs_record::CutoffsRecord;

/// A number of the plant, and of a level of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Counts {
    /// The number of the plant.
    pub original: u64,
    /// The number of the level.
    #[serde(rename = "final")]
    pub left: u64,
}

impl Counts {
    /// Both numbers; what is beyond `u64` becomes the largest one.
    pub fn of(original: impl TryInto<u64>, left: impl TryInto<u64>) -> Self {
        Self {
            original: original.try_into().unwrap_or(u64::MAX),
            left: left.try_into().unwrap_or(u64::MAX),
        }
    }
}

/// The figures of a level beside those of its plant.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct LevelRecord {
    /// Leaves.
    pub leaves: Counts,
    /// Triangles of the whole plant.
    pub triangles: Counts,
    /// How many of these are leaves.
    pub foliage_triangles: Counts,
    /// How many of these are wood.
    pub wood_triangles: Counts,
    /// The method as `--method` spells it.
    pub method: &'static str,
    /// Where leaves were drawn: `cpu` or `gpu`.
    pub engine: &'static str,
    /// The GPU and its driver; none on the CPU.
    pub adapter: Option<String>,
    /// SHA-256 of all that was done to the leaves.
    pub order_sha256: String,
    /// SHA-256 of the pixels of each leaf in each view; none of methods that see none.
    pub areas_sha256: Option<String>,
    /// The largest area of a leaf as a multiple of its original one.
    pub max_area_scale: f64,
    /// VMI of what is left in each driving view, in bits.
    pub vmi_bits: Option<Vec<f64>>,
    /// VMI of the original in each driving view, in bits.
    pub vmi_bits_original: Vec<f64>,
    /// VMI error in the driving views, in per cent.
    pub driving_vmi_error_percent: Option<f64>,
    /// Why it stopped.
    pub stopped: &'static str,
    /// Alpha cutoffs that were chosen; none where all stay.
    pub cutoffs: Option<CutoffsRecord>,
    /// Textures with other colours in clear texels; none where all stay.
    pub colors: Option<Vec<ColorRecord>>,
    /// What drew the result again with the same areas.
    pub audit: Option<&'static str>,
}

/// A texture with other colours in its clear texels, or beside its charts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct ColorRecord {
    /// The number of the material that shows it.
    pub material: usize,
    /// By how much what is seen differs by it, of 255: mip maps of an eighth of the size in the mean over what they show,
    /// or what the level shows beside charts.
    pub difference: f64,
}

impl From<&Dilated> for ColorRecord {
    fn from(one: &Dilated) -> Self {
        Self {
            material: one.material,
            difference: one.difference,
        }
    }
}

impl Level {
    /// What records say of the level: its figures beside those of the plant, and how it came about.
    pub fn record(&self) -> LevelRecord {
        let run = &self.simplified;
        let (before, after) = (self.plant().report(), self.report());
        let counts = |of: fn(&LevelReport) -> u64| Counts::of(of(&before), of(&after));
        let colors = self.colors.iter().map(ColorRecord::from);
        LevelRecord {
            leaves: counts(|of| of.leaves),
            triangles: counts(|of| of.triangles),
            foliage_triangles: counts(|of| of.foliage_triangles),
            wood_triangles: counts(|of| of.wood_triangles),
            method: self.options.method.name(),
            engine: run.engine,
            adapter: run.adapter.clone(),
            order_sha256: after.order_sha256.unwrap_or_default(),
            areas_sha256: run.areas.as_ref().map(AreaTable::sha256),
            max_area_scale: run.passes.max_area_scale(),
            vmi_bits: run.vmi_final.as_ref().map(Vmi::bits),
            vmi_bits_original: run.vmi_original.bits(),
            driving_vmi_error_percent: run.driving_error_percent(),
            stopped: run.stopped.name(),
            cutoffs: self.cutoffs.as_ref().map(CutoffsRecord::from),
            colors: (!self.colors.is_empty()).then(|| colors.collect()),
            audit: run.audited_by,
        }
    }

    /// How many of the views that leaves were chosen or sized from are held-out views, by which a
    /// [judge](crate::judge) looks: figures of such a level are flattered.
    pub fn views_that_judge(&self) -> usize {
        let options = &self.options;
        let is_driven = options.method.vds().is_some() || options.objective().is_some();
        let foliage = self.plant().leaves();
        let about = (foliage.bounding_sphere(), Judging::held_out(foliage));
        let (Some(sphere), Ok(judging)) = about else {
            return 0;
        };
        let sets = self.simplified.driving(options, sphere);
        let counts = (sets.iter()).map(|set| judging.views_that_judge(set, sphere.centre));
        if is_driven { counts.sum() } else { 0 }
    }
}
