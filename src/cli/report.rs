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
        let typesetter = self.pdf.as_deref().map(Typesetter::find).transpose()?;
        let _held = self.hold()?;
        let path = self.dir.join("cases.csv");
        let read = read_table(&path).and_then(|table| table.unchanged(&path));
        let CaseTable { cases: mut records, torn, .. } = read?;
        let Earlier { failures, foreseen, cause } = read_earlier(&self.dir.join("verdict.json"))?;
        restore_reasons(&mut records, &failures);
        let known = Provenance::read(&self.dir)?;
        if let Some(other) = known.as_ref().and_then(Provenance::other_version) {
            let hint = "report them by that version, or run the scenes again by this one";
            return Err(CliError::about(self.dir.display(), format!("{other}; {hint}")));
        }
        let of_records: Vec<Scene> = self
            .names(&records, known.as_ref())?
            .iter()
            .map(|name| self.scene(name, known.as_ref(), scenes))
            .collect::<Result<_, _>>()?;
        let (mut verdicts, mut summaries, mut missing) = (Vec::new(), Vec::new(), Vec::new());
        for scene in &of_records {
            let owed = owed(scene, &records, known.as_ref());
            // An interrupted run wrote neither verdicts nor predicted constants.
            let unknown = scene.judge && !foreseen.iter().any(|known| known.scene == scene.name);
            let subject = match Subject::new(scene.clone()) {
                Err(error) if unknown => return Err(error.into()),
                // The report can omit the bounds on the step size.
                subject => subject.ok(),
            };
            verdicts.extend(match subject.as_ref().filter(|_| unknown) {
                Some(subject) => judge_subject(subject, &records, &owed.keys),
                None => judge_scene(scene, &records, &owed.keys, &foreseen),
            });
            let mut summary = scene_summary(scene, subject.as_ref());
            if !owed.missing.is_empty() {
                summary.remarks.push(unfinished_in_words(&owed.missing));
            }
            summaries.push(summary);
            missing.extend(owed.missing);
        }
        let provenance = known.unwrap_or_else(|| Provenance::new(of_records.iter())).json();
        write_all(&self.dir, &summaries, &records, &verdicts, &provenance, None, cause.as_ref())?;
        if let Some(typesetter) = &typesetter {
            typesetter.set(&self.dir, self.date.as_deref())?;
        }
        print_verdicts(&verdicts);
        print_text(&format!("report: {}", self.dir.join("index.html").display()));
        if let Some(path) = &self.pdf {
            print_text(&format!("pdf: {}", path.display()));
        }
        match self.unfinished(torn, &missing) {
            Some(error) => Err(error),
            None => Ok(exit_code(&records, &verdicts)),
        }
    }

    /// Locks the directory, since a running sweep has no final results. A directory without a table, e.g. a mistyped
    /// name, is not created.
    fn hold(&self) -> Result<OutputDirectory, CliError> {
        let table = self.dir.join("cases.csv");
        std::fs::metadata(&table).map_err(|error| CliError::about(table.display(), error))?;
        Ok(OutputDirectory::take(&self.dir)?)
    }

    /// The scenes of the records, and those planned.
    fn names(
        &self,
        records: &[CaseRecord],
        known: Option<&Provenance>,
    ) -> Result<BTreeSet<String>, CliError> {
        let planned = known.into_iter().flat_map(|known| known.scenes.keys());
        let names: BTreeSet<String> =
            records.iter().map(|record| &record.scene).chain(planned).cloned().collect();
        if names.is_empty() {
            let reason = "no cases in it, and no provenance.json that says which were to be there";
            return Err(CliError::about(self.dir.join("cases.csv").display(), reason));
        }
        Ok(names)
    }

    /// An error about cases still owed; the report shows the rest.
    fn unfinished(&self, torn: bool, missing: &[Key]) -> Option<CliError> {
        let cut = "the last line of cases.csv is incomplete and was ignored";
        let open = (!missing.is_empty()).then(|| unfinished_in_words(missing));
        let all: Vec<String> = torn.then(|| cut.into()).into_iter().chain(open).collect();
        let unfinished = format!("unfinished: {}", all.join("; "));
        (!all.is_empty()).then(|| CliError::about(self.dir.display(), unfinished))
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

struct Owed {
    /// Cases that exist or are owed.
    keys: Vec<Key>,
    /// Missing or incomplete cases.
    missing: Vec<Key>,
}

/// Planned by the provenance; without one only existing cases are known.
fn owed(scene: &Scene, records: &[CaseRecord], known: Option<&Provenance>) -> Owed {
    let of_scene = records.iter().filter(|record| record.scene == scene.name);
    let mut keys: Vec<Key> = of_scene.map(CaseRecord::key).collect();
    let known = known.filter(|known| known.scenes.contains_key(&scene.name));
    let planned = known.map_or_else(Vec::new, |known| planned(scene, known));
    let missing = missing_cases(&scene.name, &planned, records);
    keys.extend(missing.iter().cloned());
    keys.sort();
    keys.dedup();
    Owed { keys, missing }
}

// The PDF of a report, by the program `typeset` that stands beside this one.

/// The program, and the file for its PDF.
pub(super) struct Typesetter<'a> {
    program: PathBuf,
    file: &'a Path,
}

impl<'a> Typesetter<'a> {
    /// The program beside this one.
    pub(super) fn find(file: &'a Path) -> Result<Self, CliError> {
        let name = format!("typeset{}", std::env::consts::EXE_SUFFIX);
        let program = std::env::current_exe()?.with_file_name(name);
        if program.is_file() {
            return Ok(Self { program, file });
        }
        Err(CliError::other(format!(
            "a PDF is set by the program `typeset`, and {} is not there: in a clone `make pdf` builds it for target/release, `cargo install --path crates/report --features pdf` for an installed sweep; without it, `typst compile report.typ` sets what `sweep report` writes",
            program.display()
        )))
    }

    /// Sets the report in a directory.
    pub(super) fn set(&self, dir: &Path, date: Option<&str>) -> Result<(), CliError> {
        let output = Command::new(&self.program).arg(dir).args(date).output();
        let output = output.map_err(|error| CliError::about(self.program.display(), error))?;
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr);
            let reason = format!("ended with {}: {}", output.status, said.trim_end());
            return Err(CliError::about(self.program.display(), reason));
        }
        Ok(write_named(self.file, &output.stdout)?)
    }
}
