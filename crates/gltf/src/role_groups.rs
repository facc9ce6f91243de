//! The parts of a document and what each group of them is taken for, before anybody chooses.

use super::choice::{self, Verdict};
use super::error::Fault;
use super::evidence::{self, Evidence};
use super::parts::Part;
use super::picture::Pictures;
use super::roles::SortedParts;
use super::survey::Survey;
use super::{Document, Selector};

/// A document's parts, looked at.
pub(crate) struct Judged<'a> {
    /// Parts of the plant.
    pub(crate) parts: Vec<Part>,
    /// Parts that are not.
    pub(crate) others: Vec<Part>,
    /// Of the plant's.
    pub(crate) survey: Survey,
    /// The images that the evidence needed, decoded, and the budget that they left.
    pub(crate) pictures: Pictures<'a>,
    /// For each group of the survey, why it may be foliage or not.
    pub(crate) evidence: Vec<Evidence>,
    /// For each group of the survey, what its evidence comes to.
    pub(crate) verdicts: Vec<Verdict>,
}

impl Document {
    /// Sorts and surveys the parts, gathers the evidence and judges by it.
    pub(crate) fn judged(&self, selectors: &[Selector]) -> Result<Judged<'_>, Fault> {
        let SortedParts {
            plant: parts,
            survey,
            others,
            budget,
        } = self.sorted_parts(selectors)?;
        let mut pictures = Pictures::new(self, budget);
        let evidence = evidence::gather(self, &survey.groups, &mut pictures)?;
        let verdicts = choice::judge(&survey.groups, &evidence);
        Ok(Judged {
            parts,
            others,
            survey,
            pictures,
            evidence,
            verdicts,
        })
    }
}
