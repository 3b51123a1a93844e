//! A page that needs nothing but itself: the verdicts, the pictures, links to the data.

use super::SceneSummary;
use crate::record::{CaseRecord, Status, counted};
use crate::verdict::{NOTHING_JUDGED, Verdict, cell_texts, exit_code};

/// Plain and light; dark where the reader's system is. Pictures keep their white paper.
const STYLE: &str = "\
:root{color-scheme:light dark}\
body{font:16px/1.5 system-ui,sans-serif;max-width:68rem;margin:2rem auto;padding:0 1rem}\
table{border-collapse:collapse;width:100%;font-size:.92rem}\
th,td{text-align:left;vertical-align:top;padding:.3rem .6rem;border-bottom:1px solid #8886}\
td:nth-child(-n+2){white-space:nowrap}td:nth-child(5){white-space:pre}\
dt{font-weight:600}dd{margin-left:2rem;overflow-wrap:anywhere}\
.scroll{overflow-x:auto}\
.pass{color:#00734f}.miss{color:#b34700;font-weight:600}\
figure{margin:1rem 0}figure svg{max-width:100%;height:auto;background:#fff}\
@media (prefers-color-scheme:dark){.pass{color:#4fd1a5}.miss{color:#ff9a57}}";

/// A picture with its caption.
pub(super) struct Figure {
    /// Its name in the directory of the report.
    pub(super) file: String,
    pub(super) caption: String,
    pub(super) svg: String,
}

/// The page; one list of figures a scene.
pub(super) fn page(
    scenes: &[SceneSummary],
    figures: &[Vec<Figure>],
    records: &[CaseRecord],
    verdicts: &[Verdict],
    provenance: &serde_json::Value,
) -> String {
    let sections: String =
        scenes.iter().zip(figures).map(|(scene, figures)| section(scene, figures)).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>Orders of convergence</title>\n<style>{STYLE}</style>\n</head>\n<body>\n\
         <h1>Orders of convergence</h1>\n<p>{}</p>\n{}{}{sections}{}</body>\n</html>\n",
        summary(records, verdicts),
        "<p>Data: <a href=\"cases.csv\">cases.csv</a>, <a href=\"verdict.json\">verdict.json</a>.</p>\n",
        table(verdicts),
        provenance_list(provenance),
    )
}

fn summary(records: &[CaseRecord], verdicts: &[Verdict]) -> String {
    let met = verdicts.iter().filter(|verdict| verdict.as_expected()).count();
    let failed =
        records.iter().filter(|record| matches!(record.status, Status::Failed { .. })).count();
    let code = exit_code(records, verdicts);
    let judged = match verdicts.len() {
        0 => escaped(NOTHING_JUDGED),
        count => format!("{met} of {} as expected", counted(count, "verdict")),
    };
    let cases = counted(records.len(), "case");
    format!("{judged}; {cases}, {failed} of them failed. Exit code {code}.")
}

fn table(verdicts: &[Verdict]) -> String {
    if verdicts.is_empty() {
        return String::new();
    }
    let heads = ["scene", "norm", "in", "predicted", "observed", "verdict", "why", "reason"];
    let head: String = heads.iter().map(|head| format!("<th>{head}</th>")).collect();
    let rows: String = verdicts.iter().map(row).collect();
    format!(
        "<div class=\"scroll\"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody>\n\
         </table></div>\n"
    )
}

fn row(verdict: &Verdict) -> String {
    let class = if verdict.as_expected() { "pass" } else { "miss" };
    let [scene, norm, variable, predicted, observed, decision, why] =
        cell_texts(verdict).map(|text| escaped(&text));
    let reason = escaped(&verdict.reason);
    format!(
        "<tr><td>{scene}</td><td>{norm}</td><td>{variable}</td><td>{predicted}</td>\
         <td>{observed}</td><td class=\"{class}\">{decision}</td><td>{why}</td><td>{reason}</td></tr>\n"
    )
}

fn section(scene: &SceneSummary, figures: &[Figure]) -> String {
    let figures: String = figures
        .iter()
        .map(|Figure { caption, svg, .. }| {
            let caption = escaped(caption);
            format!("<figure>\n{svg}\n<figcaption>{caption}</figcaption>\n</figure>\n")
        })
        .collect();
    let (name, question) = (escaped(&scene.name), escaped(&scene.question));
    format!("<section>\n<h2>{name}</h2>\n<p>{question}</p>\n{figures}</section>\n")
}

fn provenance_list(provenance: &serde_json::Value) -> String {
    let Some(entries) = provenance.as_object().filter(|entries| !entries.is_empty()) else {
        return String::new();
    };
    let text = |value: &serde_json::Value| value.as_str().map_or(value.to_string(), str::to_owned);
    // Scenes with their hashes come one below the other.
    let lines = |value: &serde_json::Value| match value.as_object() {
        Some(inner) => inner.iter().map(|(key, value)| format!("{key} {}", text(value))).collect(),
        None => vec![text(value)],
    };
    let entry = |(key, value): (&String, &serde_json::Value)| {
        let lines = lines(value).iter().map(|line| escaped(line)).collect::<Vec<_>>();
        format!("<dt>{}</dt><dd>{}</dd>\n", escaped(key), lines.join("<br>"))
    };
    let rows: String = entries.iter().map(entry).collect();
    format!("<h2>Provenance</h2>\n<dl>\n{rows}</dl>\n")
}

fn escaped(text: &str) -> String {
    let mut result = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => result.push_str("&amp;"),
            '<' => result.push_str("&lt;"),
            '>' => result.push_str("&gt;"),
            '"' => result.push_str("&quot;"),
            '\'' => result.push_str("&#39;"),
            other => result.push(other),
        }
    }
    result
}
