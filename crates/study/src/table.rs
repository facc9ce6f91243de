//! Tables of text, written as HTML or as Markdown.

use std::fmt::Write as _;

use crate::chart::escaped;

/// A head of names, and lines of plain text below it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Table {
    pub(crate) head: Vec<String>,
    /// As many cells a line as there are names.
    pub(crate) body: Vec<Vec<String>>,
}

impl Table {
    pub(crate) fn new(head: &[&str]) -> Self {
        Self {
            head: head.iter().map(|&name| name.to_owned()).collect(),
            body: Vec::new(),
        }
    }

    pub(crate) fn push(&mut self, cells: Vec<String>) {
        assert_eq!(cells.len(), self.head.len(), "a cell under every name");
        self.body.push(cells);
    }

    pub(crate) fn html(&self) -> String {
        self.html_of_class("wide")
    }

    /// Of cells whose words may stand below one another where the page is narrow; numbers stay beside their
    /// signs.
    pub(crate) fn prose_html(&self) -> String {
        let joined = |cell: &String| {
            cell.replace(" %", "\u{a0}%")
                .replace(" / ", "\u{a0}/\u{a0}")
        };
        let body = self.body.iter();
        let table = Self {
            head: self.head.clone(),
            body: body
                .map(|cells| cells.iter().map(joined).collect())
                .collect(),
        };
        table.html_of_class("wide prose")
    }

    fn html_of_class(&self, class: &str) -> String {
        let line = |cells: &[String], tag: &str| {
            let cells = cells
                .iter()
                .map(|c| format!("<{tag}>{}</{tag}>", escaped(c)));
            format!("<tr>{}</tr>\n", cells.collect::<String>())
        };
        let body: String = self.body.iter().map(|cells| line(cells, "td")).collect();
        format!(
            "<div class=\"{class}\"><table><thead>{}</thead><tbody>\n{body}</tbody></table></div>\n",
            line(&self.head, "th")
        )
    }

    pub(crate) fn markdown(&self) -> String {
        let mut text = String::new();
        let line = |cells: &[String]| {
            let cells: Vec<String> = cells.iter().map(|c| cell_in_markdown(c)).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        text += &line(&self.head);
        let _ = writeln!(text, "|{}", "---|".repeat(self.head.len()));
        self.body.iter().for_each(|cells| text += &line(cells));
        text
    }
}

/// A cell, in which pairs of backticks are our own and mark code.
fn cell_in_markdown(text: &str) -> String {
    let safe = markdown_escaped(text);
    match text.matches('`').count() % 2 {
        0 => safe.replace("\\`", "`"),
        _ => safe,
    }
}

/// Text from elsewhere as Markdown shows it: no mark of it begins a tag, a link, code, an emphasis or a cell.
pub fn markdown_escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '|' | '\\' | '`' | '*' | '<' | '[' | ']' => safe.extend(['\\', c]),
            c if c.is_control() => safe.push(' '),
            c => safe.push(c),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stay_beside_their_signs_in_prose() {
        let mut table = Table::new(&["left %", "counts"]);
        table.push(vec!["10 %".into(), "1 / 0 of 2".into()]);
        let html = table.prose_html();
        let cells = "<td>10\u{a0}%</td><td>1\u{a0}/\u{a0}0 of 2</td>";
        assert!(
            html.contains(cells) && html.contains("<th>left %</th>"),
            "{html}"
        );
    }

    #[test]
    fn cells_are_escaped_for_either_page() {
        let mut table = Table::new(&["a", "b"]);
        table.push(vec!["<1>".into(), "x|y".into()]);
        table.push(vec!["`a --b`".into(), "a `".into()]);
        assert!(table.html().contains("<td>&lt;1&gt;</td><td>x|y</td>"));
        let lines = [
            "| a | b |",
            "|---|---|",
            "| \\<1> | x\\|y |",
            "| `a --b` | a \\` |",
        ];
        assert_eq!(table.markdown().lines().collect::<Vec<_>>(), lines);
    }
}
