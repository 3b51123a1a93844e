//! The tables of numbers as one LaTeX document with booktabs rules: to be compiled, or to be cut from.

use super::{Document, Run, Table, Tone};

const PREAMBLE: &str = "\\documentclass[10pt]{article}
\\usepackage[T1]{fontenc}
\\usepackage[utf8]{inputenc}
\\usepackage{amssymb,booktabs,longtable,array}
\\usepackage[a4paper,margin=18mm]{geometry}
\\setlength{\\tabcolsep}{4pt}
\\begin{document}
";

/// Columns with longer cells than this break their lines.
const LONGEST_CELL: usize = 26;

/// The tables without those that show data as code.
pub(in crate::report) fn tables(document: &Document) -> String {
    let shows_code = |t: &&Table| t.rows.iter().flatten().any(|run| run.tone == Tone::Code);
    let tables: String = document.tables().filter(|t| !shows_code(t)).map(table).collect();
    format!("{PREAMBLE}\\section*{{{}}}\n\n{tables}\\end{{document}}\n", escaped(&document.title))
}

fn table(table: &Table) -> String {
    let wide: Vec<bool> = (0..table.head.len()).map(|column| is_wide(table, column)).collect();
    let share = 0.42 / wide.iter().filter(|wide| **wide).count().max(1) as f64;
    let kind = |column: usize| match (wide[column], table.numeric[column]) {
        (true, _) => format!(">{{\\raggedright\\arraybackslash}}p{{{share:.2}\\linewidth}}"),
        (false, true) => "r".to_owned(),
        (false, false) => "l".to_owned(),
    };
    let columns: String = (0..table.head.len()).map(kind).collect();
    let line = |cells: Vec<String>| format!("{} \\\\\n", cells.join(" & "));
    let head = line(table.head.iter().map(|head| escaped(head)).collect());
    let cell = |run: &Run| escaped(&run.text);
    let rows: String = table.rows.iter().map(|row| line(row.iter().map(cell).collect())).collect();
    // The number is set by hand: it stays that of the report when tables are left out.
    format!(
        "{{\\footnotesize\n\\noindent Table {}. {}\\par\\nopagebreak\n\\begin{{longtable}}[l]{{@{{}}{columns}@{{}}}}\n\\toprule\n{head}\\midrule\n\\endhead\n{rows}\\bottomrule\n\\end{{longtable}}}}\n\n",
        table.number,
        escaped(&table.caption),
    )
}

fn is_wide(table: &Table, column: usize) -> bool {
    let longest = table.rows.iter().map(|row| row[column].text.chars().count()).max();
    longest.is_some_and(|length| length > LONGEST_CELL)
}

/// Words that LaTeX sets as they are. Letters beyond these are left to `inputenc`.
fn escaped(text: &str) -> String {
    let mut result = String::with_capacity(text.len());
    for character in text.chars() {
        match command(character) {
            Some(command) => result.push_str(command),
            None => result.push(character),
        }
    }
    result
}

fn command(character: char) -> Option<&'static str> {
    Some(match character {
        '\\' => "\\textbackslash{}",
        '{' => "\\{",
        '}' => "\\}",
        '$' => "\\$",
        '&' => "\\&",
        '%' => "\\%",
        '#' => "\\#",
        '_' => "\\_",
        '^' => "\\textasciicircum{}",
        '~' => "\\textasciitilde{}",
        '<' => "$<$",
        '>' => "$>$",
        '|' => "$|$",
        '"' => "''",
        // A bracket after the end of a line would be its distance to the next.
        '[' => "{[}",
        ']' => "{]}",
        '\n' => "; ",
        '–' => "--",
        '−' => "$-$",
        '×' => "$\\times$",
        '·' => "$\\cdot$",
        '≥' => "$\\geq$",
        '≤' => "$\\leq$",
        '≠' => "$\\neq$",
        '≈' => "$\\approx$",
        '±' => "$\\pm$",
        '∞' => "$\\infty$",
        '∈' => "$\\in$",
        '∂' => "$\\partial$",
        '∇' => "$\\nabla$",
        '∫' => "$\\int$",
        'Σ' => "$\\Sigma$",
        'Ω' => "$\\Omega$",
        'Γ' => "$\\Gamma$",
        'Λ' => "$\\Lambda$",
        'Δ' => "$\\Delta$",
        'α' => "$\\alpha$",
        'β' => "$\\beta$",
        'γ' => "$\\gamma$",
        'δ' => "$\\delta$",
        'ε' => "$\\varepsilon$",
        'ζ' => "$\\zeta$",
        'η' => "$\\eta$",
        'θ' => "$\\theta$",
        'κ' => "$\\kappa$",
        'λ' => "$\\lambda$",
        'μ' => "$\\mu$",
        'ν' => "$\\nu$",
        'ξ' => "$\\xi$",
        'π' => "$\\pi$",
        'ρ' => "$\\rho$",
        'σ' => "$\\sigma$",
        'τ' => "$\\tau$",
        'φ' => "$\\varphi$",
        'ω' => "$\\omega$",
        'ℝ' => "$\\mathbb{R}$",
        '𝒜' => "$\\mathcal{A}$",
        'ℬ' => "$\\mathcal{B}$",
        '𝒮' => "$\\mathcal{S}$",
        '‖' => "$\\|$",
        '√' => "$\\surd$",
        '→' => "$\\to$",
        '⊂' => "$\\subset$",
        '½' => "$\\frac12$",
        '…' => "\\dots{}",
        '′' => "$'$",
        '⁰' => "$^0$",
        '¹' => "$^1$",
        '²' => "$^2$",
        '³' => "$^3$",
        '⁻' => "$^-$",
        '₀' => "$_0$",
        '₁' => "$_1$",
        '₂' => "$_2$",
        '₃' => "$_3$",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// inputenc alone knows letters with accents and no sign of mathematics: one that has no command would stop LaTeX.
    #[test]
    fn every_sign_of_the_program_has_a_command() {
        let known =
            |c: char| c.is_ascii() || command(c).is_some() || ('\u{c0}'..='\u{ff}').contains(&c);
        for (_, label) in crate::record::NORMS {
            assert!(label.chars().all(known), "{label}");
        }
        assert_eq!(escaped("a_b & 50 % {ε}"), "a\\_b \\& 50 \\% \\{$\\varepsilon$\\}");
        assert_eq!(escaped("≥ 1\n[2]"), "$\\geq$ 1; {[}2{]}");
    }
}
