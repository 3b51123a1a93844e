//! Source: every study is one type: its numbers as JSON, its words as a document.
//! Goal: what a study found wrong is said in its document, and a document of nothing proves nothing.
//! Data: memory-minus-identity and compliance on small grids; one seeded defect each.

use crate::shipped::setup;
use judge::claim::{Claim, Place};
use report::StudyDocument;
use studies::extremes::{UnderTest, catalogue, climb, found};
use studies::theory::bound::BoundStudy;

/// The document is sound without the defect, and says `words` with it.
#[track_caller]
fn shows(sound: &StudyDocument, defect: &StudyDocument, words: &str) {
    assert!(sound.holds && !sound.text(132).contains("Does not hold"), "{}", sound.text(132));
    assert!(!defect.holds && defect.text(132).contains(words), "{words}: {}", defect.text(132));
}

#[test]
fn a_bound_says_what_is_violated() {
    let sound = BoundStudy::new(&setup("memory-minus-identity"), 4, 4).expect("a study");
    let document = |bound: &BoundStudy| bound.findings().document;
    let mut defect = sound.clone();
    let place = Place { at: "k = 0.5".into(), ..Place::default() };
    let statement = sound.claims[0].statement;
    defect.claims.push(Claim::at_most(statement, place, [2.0, 0.6], 0.0));
    let words = "at k = 0.5: 2.000000000e0 <= 6.000000000e-1 does not hold";
    shows(&document(&sound), &document(&defect), words);
    defect.claims.clear();
    shows(&document(&sound), &document(&defect), "nothing was compared");
    // The table of all scenes has where Λ stops contracting: k = 4, to the width of its bracket.
    let threshold = document(&sound).threshold.expect("a threshold");
    let k: f64 = threshold.split(' ').next().and_then(|k| k.parse().ok()).expect("a number");
    assert!((k - 4.0).abs() < 2e-6, "{threshold}");
}

#[test]
fn a_rung_that_fails_is_said() {
    let ladders: Vec<_> =
        catalogue(false).into_iter().filter(|ladder| ladder.name == "one-vertex").collect();
    let mut rung = climb(&ladders[0], &ladders[0].rungs[0], &UnderTest::default());
    let sound = found(&ladders, &[], std::slice::from_ref(&rung)).document;
    rung[0].left = f64::NAN;
    let words = format!("one-vertex at {}: no number", rung[0].place.at);
    shows(&sound, &found(&ladders, &[], &[rung]).document, &words);
    shows(&sound, &found(&ladders, &[], &[]).document, "nothing was compared");
}
