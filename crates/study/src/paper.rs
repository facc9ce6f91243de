//! The paper's own studies: Entropy 2018, 20, 213, Fig. 5, Tables 1 and 2.

use secateur_plant::Species;
use secateur_simplify::{Preset, Views};

use crate::named_cases::{self, fsa, information, look, stochastic};
use crate::{Case, Paper, Published};

/// One of the paper's models, and what is grown to stand for it.
pub(crate) struct Model {
    /// What the paper calls it.
    name: &'static str,
    species: Species,
    pub(crate) leaves: u32,
    printed_in: &'static str,
    /// The shares of leaves that the paper prints figures for.
    levels: [f64; 3],
    /// For each method its label, and for each level the VMI error in per cent and the seconds.
    figures: &'static [(&'static str, [f64; 3], [f64; 3])],
}

/// The label of VDS as it is run here.
const VDS: &str = "vds preset paper";
const FSA: &str = "fsa corners furthest";

/// The seed that all plants are grown with.
pub(crate) const SEED: u64 = 3;

const TABLE_1: [f64; 3] = [0.5, 0.25, 0.1];
const TABLE_2: [f64; 3] = [0.25, 0.1, 0.01];

/// All models of Tables 1 and 2.
pub(crate) const MODELS: [Model; 7] = [
    Model {
        name: "English oak, 20,376 leaves",
        species: Species::Oak,
        leaves: 20_376,
        printed_in: "Table 1",
        levels: TABLE_1,
        figures: &[
            (VDS, [3.71, 4.48, 5.31], [4010.27, 4501.14, 4938.48]),
            (FSA, [12.01, 22.09, 45.17], [98.32, 101.64, 105.93]),
            ("stochastic", [19.75, 25.26, 32.25], [81.36, 83.64, 85.81]),
        ],
    },
    Model {
        name: "Carya illinoinensis, 8,140 leaves",
        species: Species::Carya,
        leaves: 8140,
        printed_in: "Table 1",
        levels: TABLE_1,
        figures: &[
            (VDS, [5.12, 6.64, 14.65], [901.23, 1018.97, 1231.29]),
            (FSA, [32.42, 64.31, 77.86], [40.13, 45.58, 48.23]),
            ("stochastic", [7.54, 14.38, 37.42], [34.08, 37.18, 39.92]),
        ],
    },
    Model {
        name: "Betula lenta, 16,100 leaves",
        species: Species::Birch,
        leaves: 16_100,
        printed_in: "Table 2",
        levels: TABLE_2,
        figures: &[(VDS, [4.27, 9.86, 28.42], [2412.80, 2634.06, 2782.18])],
    },
    Model {
        name: "Alnus glutinosa, 41,155 leaves",
        species: Species::Alder,
        leaves: 41_155,
        printed_in: "Table 2",
        levels: TABLE_2,
        figures: &[(VDS, [10.53, 14.54, 35.47], [9950.32, 10_301.56, 10_745.12])],
    },
    Model {
        name: "Betula populifolia, 20,280 leaves",
        species: Species::Birch,
        leaves: 20_280,
        printed_in: "Table 2",
        levels: TABLE_2,
        figures: &[(VDS, [12.29, 19.84, 39.14], [3137.33, 3350.38, 3432.01])],
    },
    Model {
        name: "Sorbus aucuparia, 2,760 leaves of 18 triangles",
        species: Species::Rowan,
        leaves: 2760,
        printed_in: "Table 2",
        levels: TABLE_2,
        figures: &[(VDS, [14.12, 29.88, 51.40], [642.52, 849.12, 912.41])],
    },
    Model {
        name: "Acer platanoides, 105,688 leaves",
        species: Species::Maple,
        leaves: 105_688,
        printed_in: "Table 2",
        levels: TABLE_2,
        figures: &[(VDS, [9.75, 13.86, 37.15], [14_112.47, 14_405.18, 14_484.03])],
    },
];

/// What is run on every model and every tree.
pub(crate) fn cases() -> Vec<Case> {
    let mut cases = Preset::PAPER.map(named_cases::paper).to_vec();
    cases.extend([look(), information()].map(Case::with_leaves_of_paper));
    cases.extend([fsa(), stochastic()]);
    cases
}

/// The cases of Fig. 5: run on the model that it is of, and on every tree of the user's.
pub(crate) fn fewer_views() -> [Case; 2] {
    [Views::Icosahedron, Views::Variable]
        .map(|views| named_cases::paper(Preset::Paper).views(views))
}

impl Model {
    /// The grown tree's name.
    pub(crate) fn tree(&self) -> String {
        format!("paper-{}-{}", self.species.name(), self.leaves)
    }

    pub(crate) fn species(&self) -> Species {
        self.species
    }

    /// Whether the paper's Fig. 5 shows this model.
    pub(crate) fn is_of_fig_5(&self) -> bool {
        self.leaves == 20_376
    }

    fn published(&self) -> impl Iterator<Item = Published> + '_ {
        self.figures
            .iter()
            .flat_map(move |(label, errors, seconds)| {
                let figures = self.levels.iter().zip(errors.iter().zip(seconds));
                figures.map(move |(level, (error_percent, seconds))| Published {
                    source: self.printed_in.to_owned(),
                    model: self.name.to_owned(),
                    tree: self.tree(),
                    label: (*label).to_owned(),
                    level: *level,
                    error_percent: *error_percent,
                    seconds: *seconds,
                })
            })
    }
}

/// All printed figures, and what reports say about comparing them.
pub(crate) fn paper() -> Paper {
    let labels = |cases: &[Case]| cases.iter().map(Case::label).collect();
    let by_views = [&[named_cases::paper(Preset::Paper)][..], &fewer_views()].concat();
    Paper {
        about: "Gasch, Remolar, Chover, Rebollo: Viewpoint-Driven Simplification of Plant and Tree Foliage, Entropy 2018, 20, 213. \
            Its models are not to be had: plants of the same number of leaves were grown instead, of the same or a near species. \
            So errors and seconds as such cannot be compared. How many times the error of VDS another method makes on one tree, and \
            how many times as long it takes in one run on one machine, can, with care: leaves of other sizes and crowns of other \
            densities change them too. The judging is the paper's: one icosahedron of 12 views, 512 x 512, VMI error, of leaves as the paper has them: whole polygons, seen from both sides, which is what drives all of these runs too. Each of them stands 10.8 \
            degrees from a view that drives, which flatters what is driven. `preset paper` is VDS with the paper's settings, and Eq. 5's \
            share, of which it is only said that it lies in 0 to 1, as the cost in bits; the presets that begin with its name are other readings \
            of that share. `vds` and `vds preset information` are this program's own, driven by the same leaves. FSA has the corners that are published and SM is this program's own. The times of SM are of drawing lots and no longer of anything \
            else, which the paper's cannot be. Fig. 5 is a chart: of its values the text gives two only, an error of about 5 % and \
            5,000 s at 10 % of the leaves with 20 views."
            .to_owned(),
        figures: MODELS.iter().flat_map(Model::published).collect(),
        comparisons: vec![
            (
                "Every tree: methods as multiples of VDS (Tables 1 and 2)".to_owned(),
                labels(&cases()),
            ),
            (
                "Every tree: 12 views and VNC as multiples of 20 views (Fig. 5)".to_owned(),
                labels(&by_views),
            ),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2 models x 3 methods x 3 levels, and 5 x 1 x 3.
    #[test]
    fn every_printed_figure_is_there_once() {
        let paper = paper();
        let figures = &paper.figures;
        assert_eq!(figures.len(), 33);
        let labels: Vec<String> = cases().iter().map(Case::label).collect();
        assert_eq!(labels[0], VDS);
        assert!(figures.iter().all(|figure| labels.contains(&figure.label)));
        let of_vds: f64 = (figures.iter().filter(|f| f.label == VDS))
            .map(|f| f.error_percent)
            .sum();
        // Added up by hand from the two tables: 13.50 + 26.41 + 42.55 + 60.54 + 71.27 + 95.40 + 60.76.
        assert!((of_vds - 370.43).abs() < 1e-9, "{of_vds}");
        let mut trees: Vec<String> = MODELS.iter().map(Model::tree).collect();
        trees.sort();
        trees.dedup();
        assert_eq!(trees.len(), MODELS.len());
    }
}
