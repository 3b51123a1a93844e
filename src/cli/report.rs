//! `sweep report DIR`: every output again, from the records alone.

use std::path::PathBuf;

use clap::Args;

use super::{CliError, Scenes, print_text, print_verdicts};
use crate::record::Key;
#[cfg(feature = "pdf")]
use crate::report::pdf;
use crate::report::{Document, write_all};
use crate::scene::Scene;
use crate::setup::Subject;
use crate::sweep::{Provenance, foresee, judge_scene, scene_summary};
use crate::verdict::{exit_code, read_failures, read_foreseen, render_table, restore_reasons};

/// `sweep report`. Scenes are judged by the text that DIR keeps of them, unless --scenes names a
/// folder.
#[derive(Args)]
#[command(
    after_help = "Written into DIR: verdict.json, index.html, report.md (for pull requests), tables.tex (LaTeX, booktabs), report.typ with report.json (Typst), pictures. What bound, gronwall, audit, trade and extremes wrote with --out DIR are chapters of it, with their pictures and those of solve --pictures; a file of theirs that is torn is refused (exit code 2). `make report` writes some of each.\n\nExamples:\n  sweep report reports/latest\n  sweep report reports/latest --pdf report.pdf --date 2026-01-31     (a build with the feature pdf; `make pdf` makes one)"
)]
pub struct Report {
    /// Directory with cases.csv
    dir: PathBuf,
    /// Write the report as a PDF to FILE as well; needs a build with the feature `pdf` (make pdf)
    #[arg(long, value_name = "FILE")]
    pdf: Option<PathBuf>,
    /// Date to print in the PDF; without, it has none
    #[arg(long, value_name = "YYYY-MM-DD", requires = "pdf")]
    date: Option<String>,
}

impl Report {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        if self.pdf.is_some() && cfg!(not(feature = "pdf")) {
            let message = "this build cannot write a PDF: it was built without the feature `pdf`; `make pdf` builds one that can, and writes reports/latest/report.pdf";
            return Err(CliError::other(message));
        }
        let mut records =
            crate::record::read(&self.dir.join("cases.csv")).map_err(CliError::other)?;
        let document = self.dir.join("verdict.json");
        let mut foreseen = Vec::new();
        if document.exists() {
            foreseen = read_foreseen(&document).map_err(CliError::other)?;
            let failures = read_failures(&document).map_err(CliError::other)?;
            restore_reasons(&mut records, &failures);
        }
        let mut names: Vec<String> = records.iter().map(|record| record.scene.clone()).collect();
        names.sort();
        names.dedup();
        let known = Provenance::read(&self.dir)
            .map_err(|(path, reason)| CliError::about(path.display(), reason))?;
        let of_records: Vec<Scene> = names
            .iter()
            .map(|name| self.scene(name, known.as_ref(), scenes))
            .collect::<Result<_, _>>()?;
        let (mut verdicts, mut summaries) = (Vec::new(), Vec::new());
        for scene in &of_records {
            // The cases of the directory are the ones to judge, and those of the scene's own grid
            // must be among them only if the directory was made with that grid.
            let keys: Vec<Key> =
                records.iter().filter(|r| r.scene == scene.name).map(|r| r.key()).collect();
            // Verdicts of an interrupted run were never written, nor what was known of constants.
            let unknown = scene.judge && !foreseen.iter().any(|known| known.scene == scene.name);
            let subject = match Subject::new(scene.clone()) {
                Err(error) if unknown => return Err(error.into()),
                // The verdicts are known; the report goes without bounds on the step size.
                subject => subject.ok(),
            };
            if let Some(subject) = subject.as_ref().filter(|_| unknown) {
                foreseen.extend(foresee(subject, &records));
            }
            verdicts.extend(judge_scene(scene, &records, &keys, &foreseen));
            summaries.push(scene_summary(scene, subject.as_ref()));
        }
        let provenance = known.unwrap_or_else(|| Provenance::new(of_records.iter())).json();
        let document = write_all(&self.dir, &summaries, &records, &verdicts, &provenance, None)?;
        self.typeset(&document)?;
        print_verdicts(&render_table(&verdicts));
        print_text(&format!("report: {}", self.dir.join("index.html").display()));
        if let Some(path) = &self.pdf {
            print_text(&format!("pdf: {}", path.display()));
        }
        Ok(exit_code(&records, &verdicts))
    }

    /// Writes the PDF, if it is asked for.
    #[cfg(feature = "pdf")]
    fn typeset(&self, document: &Document) -> Result<(), CliError> {
        match &self.pdf {
            Some(path) => super::write_file(path, pdf(document, self.date.as_deref())?),
            None => Ok(()),
        }
    }

    /// Refused before anything was done, if a PDF is asked for.
    #[cfg(not(feature = "pdf"))]
    fn typeset(&self, _: &Document) -> Result<(), CliError> {
        Ok(())
    }

    /// The scene by the text that is kept with the records; by the folder of scenes if that is
    /// named, or if no text is kept.
    fn scene(
        &self,
        name: &str,
        known: Option<&Provenance>,
        scenes: &Scenes,
    ) -> Result<Scene, CliError> {
        if let (Some(known), false) = (known, scenes.named)
            && let Some(scene) = known.scene(&self.dir, name)?
        {
            return Ok(scene);
        }
        let scene = scenes.scene(name)?;
        let made_with = known.and_then(|known| known.scenes.get(name));
        if made_with.is_some_and(|hash| *hash != scene.source.hash) {
            let message = format!(
                "the records in {} were made with another text of this scene",
                self.dir.display()
            );
            let hint = match known.is_some_and(|known| known.texts.contains_key(name)) {
                true => {
                    "without --scenes they are judged by their own text, which is kept with them"
                }
                false => "name the folder of that text with --scenes, or run the scene again",
            };
            return Err(scene.error("scene.name", message, hint).into());
        }
        Ok(scene)
    }
}
