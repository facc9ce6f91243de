//! What a row says of the sizes of its leaves.

use crate::Row;

/// What a row's setting says of the fit of sizes at the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RowFit {
    /// Nothing: the method has what its preset has.
    Unsaid,
    /// Sizes stay as the method left them: `fit=none`.
    None,
    /// Sizes are fitted: `fit`, `fit=coverage` or a weight of the outline such as `fit=4`.
    Fitted,
}

impl Row {
    /// What the setting says of the fit of sizes.
    pub(crate) fn fit(&self) -> RowFit {
        let words = self.setting.split(' ');
        let mut said = words.filter_map(|word| match word.split_once('=') {
            Some(("fit", "none")) => Some(RowFit::None),
            Some(("fit", _)) => Some(RowFit::Fitted),
            None if word == "fit" => Some(RowFit::Fitted),
            None | Some(_) => None,
        });
        said.next().unwrap_or(RowFit::Unsaid)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::row;

    #[test]
    fn what_is_not_fitted_is_not_taken_for_fitted() {
        for (setting, fit) in [
            ("", RowFit::Unsaid),
            ("triangles fit=none", RowFit::None),
            ("preserve-area fit", RowFit::Fitted),
            ("fit=coverage", RowFit::Fitted),
            ("fit=4 views 6", RowFit::Fitted),
            ("profit=1", RowFit::Unsaid),
        ] {
            let mut row = row("vds", 0.1, 1.0, 1.0);
            row.setting = setting.to_owned();
            assert_eq!(row.fit(), fit, "{setting}");
        }
    }
}
