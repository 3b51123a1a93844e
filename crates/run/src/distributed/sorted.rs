//! External sort of the cases of many tables by key.
//!
//! Cases are collected up to a fixed number, sorted and written as tables, which are then merged.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::path::{Path, PathBuf};

use judge::record::{CaseRecord, CaseStream, Key, RecordError, TableWriter};

/// Cases sorted in memory at once: some 40 MB with the norms of a contact scene.
pub const AT_ONCE: usize = 32_768;

/// A sorted source: a table, or the rest in memory.
type Source = Box<dyn Iterator<Item = Result<CaseRecord, RecordError>>>;

/// All cases by scene, n and steps; of equal keys those of earlier tables come first.
pub(crate) struct SortedCases {
    sources: Vec<Source>,
    /// The next case of each source.
    heads: BinaryHeap<Reverse<(Key, usize)>>,
    next: Vec<Option<CaseRecord>>,
}

impl SortedCases {
    /// Sorts the cases of `tables`, with at most `at_once` of them in memory and temporary files below `folder`.
    ///
    /// # Errors
    /// [`RecordError`] of a table, or of a file below `folder`.
    pub(crate) fn new(
        tables: &[PathBuf],
        folder: &Path,
        at_once: usize,
    ) -> Result<Self, RecordError> {
        let mut sources: Vec<Source> = Vec::new();
        let mut kept: Vec<CaseRecord> = Vec::new();
        for table in tables {
            for case in CaseStream::open(table)? {
                kept.push(case?);
                if kept.len() >= at_once {
                    let path = folder.join(format!("{}.csv", sources.len()));
                    sources.push(written(&mut kept, &path)?);
                }
            }
        }
        kept.sort_by_cached_key(CaseRecord::key);
        sources.push(Box::new(kept.into_iter().map(Ok)));
        let mut sorted = Self {
            next: sources.iter().map(|_| None).collect(),
            sources,
            heads: BinaryHeap::new(),
        };
        (0..sorted.sources.len()).try_for_each(|source| sorted.advance(source))?;
        Ok(sorted)
    }

    fn advance(&mut self, source: usize) -> Result<(), RecordError> {
        self.next[source] = self.sources[source].next().transpose()?;
        if let Some(case) = &self.next[source] {
            self.heads.push(Reverse((case.key(), source)));
        }
        Ok(())
    }

    pub(crate) fn next(&mut self) -> Result<Option<(Key, CaseRecord)>, RecordError> {
        let Some(Reverse((key, source))) = self.heads.pop() else { return Ok(None) };
        let case = self.next[source].take();
        self.advance(source)?;
        Ok(case.map(|case| (key, case)))
    }

    pub(crate) fn is_next(&self, key: &Key) -> bool {
        self.heads.peek().is_some_and(|Reverse((next, _))| next == key)
    }

    pub(crate) fn scene(&self) -> Option<&str> {
        self.heads.peek().map(|Reverse((key, _))| key.scene.as_str())
    }
}

fn written(cases: &mut Vec<CaseRecord>, path: &Path) -> Result<Source, RecordError> {
    cases.sort_by_cached_key(CaseRecord::key);
    let mut table = TableWriter::create(path)?;
    cases.drain(..).try_for_each(|mut case| table.append(&mut case))?;
    table.finish()?;
    Ok(Box::new(CaseStream::open(path)?))
}

/// Whether two records of one case agree in every column but `seconds_*`.
pub(crate) fn agree(a: &CaseRecord, b: &CaseRecord) -> bool {
    let timeless = |case: &CaseRecord| {
        let mut case = CaseRecord {
            seconds_load: 0.0,
            seconds_assemble: 0.0,
            seconds_factor: 0.0,
            seconds_solve: 0.0,
            seconds_total: 0.0,
            ..case.clone()
        };
        case.errors.sort_by(|a, b| a.norm.cmp(&b.norm));
        // As text: NaN agrees with NaN, and 0 not with -0.
        format!("{case:?}")
    };
    timeless(a) == timeless(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use judge::record::{NormError, Status};

    fn case(n: u32, steps: u32, error: f64) -> CaseRecord {
        CaseRecord {
            status: Status::Converged,
            errors: vec![NormError { norm: "V_max".into(), error: Some(error), floor: None }],
            ..CaseRecord::without_work("block", Some(n), steps, 1.0 / f64::from(steps))
        }
    }

    #[test]
    fn the_order_is_that_of_keys_however_many_fit_in_memory() {
        let folder = std::env::temp_dir().join(format!("gronwall-sorted-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        // 60 cases in three tables, scattered; one of them twice.
        let tables: Vec<PathBuf> = (0..3)
            .map(|part| {
                let path = folder.join(format!("part-{part}.csv"));
                let mut table = TableWriter::create(&path).unwrap();
                for i in (0..60u32).filter(|i| (i * 7) % 3 == part) {
                    let i = (i * 37) % 60;
                    table.append(&mut case(i / 8, 1 + i % 8, f64::from(i))).unwrap();
                }
                table.append(&mut case(100, 1, f64::from(part))).unwrap();
                table.finish().unwrap();
                path
            })
            .collect();
        let sorted = |at_once: usize| {
            let mut sorted = SortedCases::new(&tables, &folder, at_once).unwrap();
            let mut all = Vec::new();
            while let Some((key, case)) = sorted.next().unwrap() {
                all.push((key, case.errors[0].error));
            }
            all
        };
        let whole = sorted(1000);
        assert_eq!(whole.len(), 63);
        assert!(whole.windows(2).all(|pair| pair[0].0 <= pair[1].0));
        let twice: Vec<_> = whole[60..].iter().map(|(_, error)| *error).collect();
        assert_eq!(twice, [Some(0.0), Some(1.0), Some(2.0)], "in the order of the tables");
        for at_once in [1, 7, 20, 63] {
            assert_eq!(sorted(at_once), whole, "{at_once} at once");
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn records_agree_but_for_seconds() {
        let one = CaseRecord { seconds_total: 1.0, ..case(4, 4, 0.1) };
        let other = CaseRecord { seconds_total: 2.0, ..one.clone() };
        assert!(agree(&one, &other));
        assert!(!agree(&one, &case(4, 4, 0.1 + 1e-17 * 2.0)));
        assert!(!agree(&one, &CaseRecord { newton_iterations: 1, ..one.clone() }));
        assert!(agree(&case(4, 4, f64::NAN), &case(4, 4, f64::NAN)));
    }
}
