//! What a new baseline changes.

use super::left_owing::left_owing;
use super::tolerance::in_percent;
use super::{Baseline, Recorded, RecordedCase};

impl Baseline {
    /// Changes against a new baseline, a line each.
    pub fn changes(&self, new: &Baseline) -> Vec<String> {
        let mut lines = Vec::new();
        for name in self.scenes.keys().filter(|name| !new.scenes.contains_key(*name)) {
            lines.push(format!("{name}: removed"));
        }
        for (name, recorded) in &new.scenes {
            match self.scenes.get(name) {
                None => lines.push(format!("{name}: new, {} cases", recorded.cases.len())),
                Some(old) => lines.extend(changes_of_scene(name, old, recorded)),
            }
        }
        lines
    }
}

impl RecordedCase {
    /// Changes of errors and work against an older record, without the name of the case.
    fn changes(&self, before: &Self) -> Vec<String> {
        let mut lines = Vec::new();
        let new = self.errors.keys().filter(|norm| !before.errors.contains_key(*norm));
        for norm in before.errors.keys().chain(new) {
            let (was, is) = (before.errors.get(norm), self.errors.get(norm));
            if was != is {
                let percent = was.zip(is).map_or(String::new(), |(was, is)| {
                    format!(" ({})", in_percent(is / was - 1.0))
                });
                let [was, is] = [was, is].map(|v| v.map_or("none".into(), |v| format!("{v:.6e}")));
                lines.push(format!("{norm} {was} -> {is}{percent}"));
            }
        }
        for ((_, what, was), (_, _, is)) in before.work().into_iter().zip(self.work()) {
            // Absent in an older baseline is not a change.
            let changed = was.zip(is).filter(|(was, is)| was != is);
            lines.extend(changed.map(|(was, is)| format!("{what} {was} -> {is}")));
        }
        lines
    }
}

fn changes_of_scene(name: &str, old: &Recorded, new: &Recorded) -> Vec<String> {
    let mut lines = Vec::new();
    if old.hash != new.hash {
        lines.push(format!("{name}: the scene file changed"));
    }
    if let (Some(was), Some(is)) = (&old.owes, &new.owes) {
        let changes = left_owing(name, was, is.clone()).into_iter();
        lines.extend(changes.map(|change| change.reason));
    }
    let find = |cases: &'_ [RecordedCase], like: &RecordedCase| {
        cases.iter().position(|case| case.is_case(like.n, like.steps))
    };
    let gone = old.cases.iter().filter(|case| find(&new.cases, case).is_none());
    lines.extend(gone.map(|case| format!("{name}, {}: removed", case.name())));
    for case in &new.cases {
        let changes = match find(&old.cases, case) {
            None => vec!["new".to_owned()],
            Some(before) => case.changes(&old.cases[before]),
        };
        lines.extend(changes.iter().map(|change| format!("{name}, {}: {change}", case.name())));
    }
    lines
}
