//! The tables of numbers as one LaTeX document with booktabs rules.

use crate::document::content::verdict_row;
use crate::document::terminal::VERDICT_HEADS;
use crate::document::{Block, Document, Equation, Figure, Run, Section, Table, Tone};
use crate::symbols::replaced;
use files::harmless;
use judge::verdict::Verdict;

const PREAMBLE: &str = "\\documentclass[10pt]{article}
\\usepackage[T1]{fontenc}
\\usepackage[utf8]{inputenc}
\\usepackage{lmodern,booktabs,longtable,array}
\\usepackage[a4paper,margin=18mm]{geometry}
\\setlength{\\tabcolsep}{4pt}
% A caption stays with the head of its table.
\\newcommand\\room{\\par\\ifdim\\dimexpr\\pagegoal-\\pagetotal\\relax<6\\baselineskip\\newpage\\fi}
\\begin{document}
";

/// Columns with longer cells break their lines.
const LONGEST_CELL: usize = 26;
/// Mean width of a character in `footnotesize` and the distance of two columns, in line widths: 4.1 pt and 8 pt of 494
/// pt.
const CHARACTER: f64 = 0.0083;
const BETWEEN: f64 = 0.0162;
/// `scriptsize` relative to that.
const SMALLER: f64 = 0.875;
/// Minimal total share of the line for breaking columns.
const LEAST: f64 = 0.25;
/// Longest length that counts when columns share the rest.
const LONGEST_SHARE: usize = 70;

/// The tables, except those of code.
pub(crate) fn tables(document: &Document) -> String {
    let shows_code = |t: &&Table| t.rows.iter().flatten().any(|run| run.tone == Tone::Code);
    let tables: String = document.tables().filter(|t| !shows_code(t)).map(table).collect();
    format!("{PREAMBLE}\\section*{{{}}}\n\n{tables}\\end{{document}}\n", escaped(&document.title))
}

fn table(table: &Table) -> String {
    let (size, columns) = columns(table);
    let line = |cells: Vec<String>| format!("{} \\\\\n", cells.join(" & "));
    let head = line(table.head.iter().map(|head| escaped(head)).collect());
    let cell = |run: &Run| escaped(&run.text);
    let rows: String = table.rows.iter().map(|row| line(row.iter().map(cell).collect())).collect();
    // Numbers are set explicitly, so that they match the report.
    format!(
        "\\room\n{{\\{size}\n\\noindent Table {}. {}\\par\\nopagebreak\n\\begin{{longtable}}[l]{{@{{}}{columns}@{{}}}}\n\\toprule\n{head}\\midrule\n\\endhead\n{rows}\\bottomrule\n\\end{{longtable}}}}\n\n",
        table.number,
        escaped(&table.caption),
    )
}

/// Font size and column specification: short columns have natural width, long ones share the rest.
fn columns(table: &Table) -> (&'static str, String) {
    let longest = |column: usize| {
        let cells = table.rows.iter().map(|row| row[column].text.chars().count());
        cells.max().unwrap_or(0)
    };
    let all = 0..table.head.len();
    let is_wide = |column: usize| longest(column) > LONGEST_CELL;
    let short = all.clone().filter(|column| !is_wide(*column));
    let characters: usize =
        short.map(|column| longest(column).max(table.head[column].chars().count())).sum();
    let weight = |column: usize| longest(column).min(LONGEST_SHARE) as f64;
    let weights: f64 = all.clone().filter(|column| is_wide(*column)).map(weight).sum();
    let rest = |size: f64| 1.0 - BETWEEN * all.len() as f64 - size * CHARACTER * characters as f64;
    let least = if weights > 0.0 { LEAST } else { 0.0 };
    let (size, rest) = match rest(1.0) >= least {
        true => ("footnotesize", rest(1.0)),
        false => ("scriptsize", rest(SMALLER).max(0.5 * LEAST)),
    };
    let kind = |column: usize| match (is_wide(column), table.numeric[column]) {
        (true, _) => {
            let share = rest * weight(column) / weights;
            format!(">{{\\raggedright\\arraybackslash}}p{{{share:.3}\\linewidth}}")
        }
        (false, true) => "r".to_owned(),
        (false, false) => "l".to_owned(),
    };
    (size, all.clone().map(kind).collect())
}

/// Escapes words for LaTeX; letters are left to `inputenc`.
fn escaped(text: &str) -> String {
    replaced(text, SIGNS).replace('\n', "; ")
}

/// Special or unknown signs, each before its LaTeX. After a line break a bracket would be read as its argument.
const SIGNS: &str = r#"
    \ \textbackslash{} { \{ } \} $ \$ & \& % \% # \# _ \_ ^ \textasciicircum{} ~ \textasciitilde{} < $<$ > $>$ | $|$ " ''
    [ {[} ] {]} – -- − $-$ ⟨ $\langle$ ⟩ $\rangle$ Ẽ \~E × $\times$ · $\cdot$ ≥ $\geq$ ≤ $\leq$ ≠ $\neq$ ≈ $\approx$
    ± $\pm$ ∞ $\infty$ ∈ $\in$ ∂ $\partial$ ∇ $\nabla$ ∫ $\int$ Σ $\Sigma$ Ω $\Omega$ Γ $\Gamma$ Λ $\Lambda$ Δ $\Delta$
    α $\alpha$ β $\beta$ γ $\gamma$ δ $\delta$ ε $\varepsilon$ ζ $\zeta$ η $\eta$ θ $\theta$ κ $\kappa$ λ $\lambda$ μ $\mu$
    ν $\nu$ ξ $\xi$ π $\pi$ ρ $\rho$ σ $\sigma$ τ $\tau$ φ $\varphi$ ω $\omega$ ℝ $\mathbf{R}$ 𝒜 $\mathcal{A}$
    ℬ $\mathcal{B}$ 𝒮 $\mathcal{S}$ ‖ $\|$ √ $\surd$ → $\to$ ⊂ $\subset$ ½ $\frac12$ … \dots{} ′ $'$
    ⁰ $^0$ ¹ $^1$ ² $^2$ ³ $^3$ ⁻ $^-$ ₀ $_0$ ₁ $_1$ ₂ $_2$ ₃ $_3$"#;

// The document for a pull request: outcome, verdicts, remarks, links.

/// The document as Markdown; pictures are linked, tables of evidence folded.
pub(crate) fn markdown(document: &Document) -> String {
    let mut text = format!("# {}\n\n{}\n\n", plain(&document.title), plain(&document.made_by));
    for Section { level, id, title, blocks, .. } in &document.sections {
        let blocks: String = blocks.iter().map(|block| of_block(block, *level > 1)).collect();
        let (marks, title) = ("#".repeat(level + 1), plain(title));
        text += &format!("<a id=\"{id}\"></a>\n\n{marks} {title}\n\n{blocks}");
    }
    text
}

/// The verdicts as a table, with their reasons.
pub(crate) fn verdict_rows(verdicts: &[Verdict]) -> String {
    let row = |verdict: &Verdict| {
        verdict_row(verdict, None).into_iter().chain([Run::plain(&*verdict.reason)]).collect()
    };
    let heads = [&VERDICT_HEADS[..], &["reason"]].concat();
    rows(&Table::new("", &heads, verdicts.iter().map(row).collect()))
}

fn of_block(block: &Block, folded: bool) -> String {
    match block {
        Block::Text(runs) => format!("{}\n\n", runs.iter().map(of_run).collect::<String>()),
        Block::Formulas(formulas) => {
            let line =
                |Equation { plain, number, .. }: &Equation| format!("    {plain}    {number}\n");
            format!("{}\n", formulas.iter().map(line).collect::<String>())
        }
        Block::Table(table) if folded => {
            let (number, caption, rows) = (table.number, html(&table.caption), rows(table));
            format!(
                "<details><summary>Table {number}. {caption}</summary>\n\n{rows}\n</details>\n\n"
            )
        }
        Block::Table(table) => {
            format!("Table {}. {}\n\n{}\n", table.number, plain(&table.caption), rows(table))
        }
        Block::Figure(Figure { number, file, caption, .. }) => {
            format!("Figure {number}. {}\n\n![{}](<{file}>)\n\n", plain(caption), plain(caption))
        }
        Block::Code(text) => format!("```sh\n{}\n```\n\n", harmless(text)),
        Block::Scene(text) => format!(
            "<details><summary>The scene file</summary>\n\n```toml\n{}\n```\n\n</details>\n\n",
            harmless(text.trim_end())
        ),
    }
}

fn rows(table: &Table) -> String {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let rule = |numeric: &bool| if *numeric { "---:" } else { "---" }.to_owned();
    let mut text = line(table.head.iter().map(|head| plain(head)).collect());
    text += &line(table.numeric.iter().map(rule).collect());
    for row in &table.rows {
        text += &line(row.iter().map(of_run).collect());
    }
    text
}

fn of_run(run: &Run) -> String {
    let text = match run.tone {
        // A bar ends a cell, even in code.
        Tone::Code if run.text.is_empty() => String::new(),
        Tone::Code => format!("<code>{}</code>", html(&run.text)),
        // Closing stars must not follow a blank.
        Tone::Strong | Tone::Miss => {
            let words = run.text.trim_end();
            format!("**{}**{}", plain(words), &run.text[words.len()..])
        }
        Tone::Plain | Tone::Pass | Tone::Formula => plain(&run.text),
    };
    match &run.target {
        Some(target) => format!("[{text}](<{target}>)"),
        None => text,
    }
}

/// Escapes words.
fn plain(text: &str) -> String {
    let signs = r"& &amp; < &lt; \ \\ ` \` * \* _ \_ | \| [ \[ ] \] # \#";
    replaced(text, signs).replace('\n', "<br>")
}

/// Escapes words inside an element, where backslashes do not work.
fn html(text: &str) -> String {
    replaced(text, "& &amp; < &lt; | &#124; * &#42; _ &#95; ` &#96;").replace('\n', "<br>")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// inputenc knows accented letters but no mathematical signs: one without a command would stop LaTeX.
    #[test]
    fn every_sign_of_the_program_has_a_command() {
        let spelt = |c: char| escaped(&c.to_string()) != c.to_string();
        let known = |c: char| c.is_ascii() || spelt(c) || ('\u{c0}'..='\u{ff}').contains(&c);
        for norm in judge::record::NORMS {
            assert!(norm.label.chars().all(known), "{norm:?}");
        }
        assert_eq!(escaped("a_b & 50 % {ε}"), "a\\_b \\& 50 \\% \\{$\\varepsilon$\\}");
        assert_eq!(escaped("≥ 1\n[2]"), "$\\geq$ 1; {[}2{]}");
    }

    fn of(rows: Vec<Vec<&str>>, numeric: Vec<bool>) -> Table {
        let head = vec!["head".to_owned(); numeric.len()];
        let row = |cells: Vec<&str>| cells.into_iter().map(Run::plain).collect();
        let rows = rows.into_iter().map(row).collect();
        Table { number: 1, caption: "a & b".into(), head, numeric, rows, evidence: false }
    }

    #[test]
    fn long_columns_share_what_short_ones_leave() {
        let long = "x".repeat(40);
        let widths = |table: &Table| -> f64 {
            let (_, columns) = columns(table);
            let parts = columns.split("p{").skip(1);
            parts.map(|part| part.split('\\').next().unwrap().parse::<f64>().unwrap()).sum()
        };
        let two = of(vec![vec!["1.0", &long, &long]], vec![true, false, false]);
        let (size, kinds) = columns(&two);
        assert!(size == "footnotesize" && kinds.starts_with("r>{"), "{kinds}");
        let head = CHARACTER * 4.0 + 3.0 * BETWEEN;
        assert!((widths(&two) + head - 1.0).abs() < 2e-3, "{}", widths(&two));
        // Many short columns take a smaller size, and the long one keeps its minimum.
        let short = "1234567890123";
        let mut row = vec![short; 7];
        row.push(&long);
        let mut numeric = vec![true; 7];
        numeric.push(false);
        let crowded = of(vec![row], numeric);
        assert_eq!(columns(&crowded).0, "scriptsize");
        assert!(widths(&crowded) > 0.12);
    }

    /// What would stop LaTeX: a row with another number of cells, an unclosed environment or group, a raw sign.
    fn fault(latex: &str) -> Option<String> {
        let count = |text: &str, what: &str| text.matches(what).count();
        if count(latex, "\\begin{longtable}") != count(latex, "\\end{longtable}") {
            return Some("an open table".into());
        }
        for block in latex.split("\\begin{longtable}").skip(1) {
            let block = block.split("\\end{longtable}").next().unwrap_or("");
            let rows = block.lines().filter(|line| line.ends_with("\\\\"));
            // An escaped sign has no blank before it.
            let cells: Vec<usize> = rows.map(|row| count(row, " & ")).collect();
            if cells.windows(2).any(|pair| pair[0] != pair[1]) || cells.is_empty() {
                return Some(format!("rows of {cells:?} cells"));
            }
        }
        let plain = latex.replace("\\{", "").replace("\\}", "").replace("\\$", "");
        if count(&plain, "{") != count(&plain, "}") || count(&plain, "$") % 2 == 1 {
            return Some("an open group".into());
        }
        latex
            .chars()
            .find(|c| !c.is_ascii() && !('\u{c0}'..='\u{ff}').contains(c))
            .map(|c| format!("the sign {c}"))
    }

    #[test]
    fn tables_are_whole() {
        let rows = vec![vec!["a & b_c", "50 %"], vec!["{Σ} [1]", "1 $"]];
        let sound = super::table(&of(rows, vec![false, true]));
        assert_eq!(fault(&sound), None, "{sound}");
        for (from, to) in [
            ("\\end{longtable}", ""),
            ("50 \\%", "50 & 60"),
            ("{[}1", "{[1"),
            ("1 \\$", "1 $"),
            ("50 \\%", "50 \u{2030}"),
        ] {
            assert!(
                sound.contains(from) && fault(&sound.replacen(from, to, 1)).is_some(),
                "{from}"
            );
        }
    }
}
