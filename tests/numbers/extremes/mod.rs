//! Source: the invariance of (5.1)-(5.5) under units, Céa's lemma, (2.9), (3.4), (3.15), and rounding analysis.
//! Goal: every ladder is as expected on the solver as it is, and each kind of expectation fails on a seeded defect; results
//!   of small problems are those of arithmetic with twice the digits.
//! Data: the catalogue of `sweep extremes`, its dearest rungs left out.

mod command;
mod defects;
mod doubled;

use judge::claim::{Claim, Relation};
use studies::extremes::{Ladder, UnderTest, catalogue, climb};

/// A ladder of the catalogue.
fn ladder(name: &str) -> Ladder {
    let found = catalogue(false).into_iter().find(|ladder| ladder.name == name);
    found.unwrap_or_else(|| panic!("no ladder {name}"))
}

/// One rung climbed.
fn row(name: &str, at: &str, under_test: &UnderTest<'_>) -> Vec<Claim> {
    let ladder = ladder(name);
    let rung = ladder.rungs.iter().find(|rung| rung.at == at);
    climb(&ladder, rung.unwrap_or_else(|| panic!("no rung {at} of {name}")), under_test)
}

/// Rungs that take more than a moment: `sweep extremes` climbs them.
fn is_dear(ladder: &str, at: &str) -> bool {
    ladder == "locking"
        || (ladder == "mesh" && ["32", "64"].contains(&at))
        || (ladder == "march" && at == "1e4")
}

#[test]
fn every_rung_is_as_expected() {
    let under_test = UnderTest::default();
    let mut wrong = Vec::new();
    for ladder in catalogue(false) {
        for rung in ladder.rungs.iter().filter(|rung| !is_dear(ladder.name, &rung.at)) {
            let claims = climb(&ladder, rung, &under_test);
            assert!(!claims.is_empty());
            wrong.extend(claims.iter().filter_map(Claim::reason));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn ladders_have_names_of_their_own_and_rungs_too() {
    for long in [false, true] {
        let ladders = catalogue(long);
        for (i, ladder) in ladders.iter().enumerate() {
            assert!(ladders[..i].iter().all(|other| other.name != ladder.name), "{}", ladder.name);
            assert!(!ladder.why.is_empty() && ladder.rungs.len() >= 4, "{}", ladder.name);
            for (r, rung) in ladder.rungs.iter().enumerate() {
                let others = &ladder.rungs[..r];
                // A name that the data do not know is NaN.
                let bound = match rung.expected {
                    Relation::AtMost(most) => most,
                    Relation::Within([_, most]) => most,
                    _ => 0.0,
                };
                assert!(bound.is_finite(), "{} {}", ladder.name, rung.at);
                assert!(
                    others.iter().all(|other| other.at != rung.at),
                    "{} {}",
                    ladder.name,
                    rung.at
                );
            }
        }
    }
}
