//! `sweep report DIR`: rebuilds every output from the records, and sets the PDF.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::{CliError, Scenes, print_text, print_verdicts};
use clap::Args;
use files::write_named;
use judge::record::{CaseRecord, CaseTable, Key, read_table};
use judge::verdict::{Earlier, exit_code, read_earlier, restore_reasons};
use report::write_all;
use run::merge::unfinished_in_words;
use run::sweep::{OutputDirectory, Provenance, judge_scene, judge_subject, missing_cases, planned};
use scene::Scene;
use scene::setup::Subject;
use studies::portrait::scene_summary;

/// `sweep report`. Scenes are judged by the text that DIR keeps of them, unless --scenes names a
/// folder.
#[derive(Args)]
#[command(
    after_help = "Written into DIR: verdict.json, index.html, report.md (for pull requests), tables.tex (LaTeX, booktabs), report.typ with report.json (Typst), pictures. The results that studies (bound, trade, …) wrote with --out DIR become chapters, with their pictures and those of solve --pictures. An incomplete file is refused (exit code 2). `make report` writes some of each.\n\nExit codes: those of the verdicts. Also 2 if a planned case is missing, the records are from another version of the program, a row was changed or is incomplete, or a sweep is still writing into DIR. What is missing is named, also in the report.\n\nExamples:\n  sweep report reports/latest\n  sweep report reports/latest --pdf report.pdf --date 2026-01-31     (`make pdf` builds what sets it)"
)]
pub(crate) struct Report {
    /// Directory with cases.csv
    dir: PathBuf,
    /// Write the report as a PDF to FILE as well, by the program `typeset` beside this one (make pdf builds it)
    #[arg(long, value_name = "FILE")]
    pdf: Option<PathBuf>,
    /// Date to print in the PDF; without, it has none
    #[arg(long, value_name = "YYYY-MM-DD", requires = "pdf")]
    date: Option<String>,
}

impl Report {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let pdf = self.pdf.as_ref().map(|file| typesetter().map(|program| (file, program)));
        let pdf = pdf.transpose()?;
        let path = self.dir.join("cases.csv");
        // A directory without a table, e.g. a mistyped name, is not created. A running sweep has no final results.
        std::fs::metadata(&path).map_err(|error| CliError::about(path.display(), error))?;
        let _held = OutputDirectory::take(&self.dir)?;
        let read = read_table(&path).and_then(|table| table.unchanged(&path));
        let CaseTable { cases: mut records, torn, .. } = read?;
        let Earlier { failures, foreseen, cause } = read_earlier(&self.dir.join("verdict.json"))?;
        restore_reasons(&mut records, &failures);
        let known = Provenance::read(&self.dir)?;
        if let Some(other) = known.as_ref().and_then(Provenance::other_version) {
            let hint = "report them by that version, or run the scenes again by this one";
            return Err(CliError::about(self.dir.display(), format!("{other}; {hint}")));
        }
        // Those planned as well.
        let names = known.iter().flat_map(|known| known.scenes.keys());
        let names: BTreeSet<&String> =
            records.iter().map(|record| &record.scene).chain(names).collect();
        if names.is_empty() {
            let reason = "no cases in it, and no provenance.json that says which were to be there";
            return Err(CliError::about(path.display(), reason));
        }
        let of_records: Vec<Scene> = names
            .into_iter()
            .map(|name| self.scene(name, known.as_ref(), scenes))
            .collect::<Result<_, _>>()?;
        let (mut verdicts, mut summaries, mut missing) = (Vec::new(), Vec::new(), Vec::new());
        for scene in &of_records {
            // Without a plan only existing cases are known.
            let plan = known.as_ref().filter(|known| known.scenes.contains_key(&scene.name));
            let plan = plan.map_or_else(Vec::new, |known| planned(scene, known));
            let owed = missing_cases(&scene.name, &plan, &records);
            let of_scene = records.iter().filter(|record| record.scene == scene.name);
            let keys: BTreeSet<Key> =
                of_scene.map(CaseRecord::key).chain(owed.iter().cloned()).collect();
            let keys: Vec<Key> = keys.into_iter().collect();
            // An interrupted run wrote neither verdicts nor predicted constants.
            let unknown = scene.judge && !foreseen.iter().any(|known| known.scene == scene.name);
            let subject = match Subject::new(scene.clone()) {
                Err(error) if unknown => return Err(error.into()),
                // The report can omit the bounds on the step size.
                subject => subject.ok(),
            };
            verdicts.extend(match subject.as_ref().filter(|_| unknown) {
                Some(subject) => judge_subject(subject, &records, &keys),
                None => judge_scene(scene, &records, &keys, &foreseen),
            });
            let mut summary = scene_summary(scene, subject.as_ref());
            if !owed.is_empty() {
                summary.remarks.push(unfinished_in_words(&owed));
            }
            summaries.push(summary);
            missing.extend(owed);
        }
        let provenance = known.unwrap_or_else(|| Provenance::new(of_records.iter())).json();
        write_all(&self.dir, &summaries, &records, &verdicts, &provenance, None, cause.as_ref())?;
        if let Some((file, program)) = &pdf {
            write_named(file, &typeset(program, &self.dir, self.date.as_deref())?)?;
        }
        print_verdicts(&verdicts);
        print_text(&format!("report: {}", self.dir.join("index.html").display()));
        if let Some((path, _)) = &pdf {
            print_text(&format!("pdf: {}", path.display()));
        }
        // The report shows the rest.
        let cut = "the last line of cases.csv is incomplete and was ignored";
        let open = (!missing.is_empty()).then(|| unfinished_in_words(&missing));
        let all: Vec<String> = torn.then(|| cut.into()).into_iter().chain(open).collect();
        if all.is_empty() {
            return Ok(exit_code(&records, &verdicts));
        }
        Err(CliError::about(self.dir.display(), format!("unfinished: {}", all.join("; "))))
    }

    /// The scene by the text kept with the records; from the folder of scenes if that is named, or no text is kept.
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

// The PDF of a report, by the program `typeset` that stands beside this one.

/// The program.
fn typesetter() -> Result<PathBuf, CliError> {
    let name = format!("typeset{}", std::env::consts::EXE_SUFFIX);
    let program = std::env::current_exe()?.with_file_name(name);
    if program.is_file() {
        return Ok(program);
    }
    Err(CliError::other(format!(
        "a PDF is set by the program `typeset`, and {} is not there: in a clone `make pdf` builds it for target/release, `cargo install --path crates/report --features pdf` for an installed sweep; without it, `typst compile report.typ` sets what `sweep report` writes",
        program.display()
    )))
}

/// The report in a directory, set.
fn typeset(program: &Path, dir: &Path, date: Option<&str>) -> Result<Vec<u8>, CliError> {
    let refused = |why: String| CliError::about(program.display(), why);
    let output = Command::new(program).arg(dir).args(date).output();
    let output = output.map_err(|error| refused(error.to_string()))?;
    if output.status.success() {
        return Ok(output.stdout);
    }
    let said = String::from_utf8_lossy(&output.stderr);
    Err(refused(format!("ended with {}: {}", output.status, said.trim_end())))
}
