//! Lines of a LaTeX table.

/// Commands of lines without cells.
const DRAWN: &str = concat!(
    r"\hline \toprule \midrule \bottomrule \cline \cmidrule ",
    r"\begin \end \centering \caption \label \small",
);

pub(super) fn is_rule(line: &str) -> bool {
    let line = line.trim();
    !line.contains('&') && DRAWN.split(' ').any(|command| line.starts_with(command))
}

pub(super) fn cells(line: &str) -> Vec<String> {
    let line = line.split("\\\\").next().unwrap_or_default();
    line.replace("\\hline", "").split('&').map(|cell| plain(cell.trim())).collect()
}

/// `$1.2\times 10^{-3}$` as `1.2e-3`, `\num{1e-3}` as `1e-3`.
fn plain(cell: &str) -> String {
    let mut text = cell.replace(['$', '~'], "");
    for times in ["\\times10^", "\\times 10^", "\\cdot10^", "\\cdot 10^"] {
        text = text.replace(times, "e");
    }
    for command in ["\\num", "\\textbf", "\\mathbf", "\\textrm", "\\mathrm", "\\text"] {
        text = text.replace(command, "");
    }
    text.retain(|c| !"{}".contains(c));
    // `1.2 e-3`, where the command was set apart.
    let number = text.replace(' ', "");
    if number.parse::<f64>().is_ok() { number } else { text.trim().to_owned() }
}
