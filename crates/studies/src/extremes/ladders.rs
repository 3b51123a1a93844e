//! The ladders as data, `ladders.toml`: texts of scenes with places for numbers, and what every rung must show.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use super::rung::{Ladder, Measure, Rung};
use formula::{Graph, Scope};
use judge::claim::Relation;
use serde::Deserialize;

pub(super) type Texts = BTreeMap<String, String>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Data {
    number: Texts,
    text: Texts,
    ladder: Vec<Given>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Given {
    name: String,
    parameter: String,
    quantity: String,
    why: String,
    measure: Measure,
    #[serde(default)]
    scene: String,
    #[serde(default)]
    with: Texts,
    /// Cells per unit length and steps.
    #[serde(default = "one")]
    n: String,
    #[serde(default = "one")]
    steps: String,
    units: Option<[String; 4]>,
    rungs: Vec<Group>,
}

fn one() -> String {
    "1".to_owned()
}

/// Rungs that must show the same.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Group {
    at: Vec<String>,
    measure: Option<Measure>,
    units: Option<[String; 4]>,
    #[serde(default)]
    with: Texts,
    other: Option<String>,
    against: Option<Texts>,
    /// One of these three.
    most: Option<String>,
    about: Option<String>,
    refused: Option<String>,
    #[serde(default)]
    long: bool,
}

/// What the next order, k³ and more, may do to an order in k from N = 8 on.
const NEXT_ORDER: f64 = 0.15;

static DATA: LazyLock<Data> =
    LazyLock::new(|| toml::from_str(include_str!("ladders.toml")).expect("ladders that are read"));

/// All ladders. The largest meshes and longest marches are climbed only where `long` says so.
pub fn catalogue(long: bool) -> Vec<Ladder> {
    let ladder = |given: &'static Given| {
        let groups = given.rungs.iter().filter(|group| long || !group.long);
        Ladder {
            name: &given.name,
            parameter: &given.parameter,
            quantity: &given.quantity,
            why: &given.why,
            rungs: groups
                .flat_map(|group| group.at.iter().map(|at| rung(given, group, at)))
                .collect(),
        }
    };
    DATA.ladder.iter().map(ladder).collect()
}

fn rung(given: &'static Given, group: &'static Group, at: &str) -> Rung {
    let place = Filling { at, with: vec![&group.with, &given.with], numbers: numbers(at) };
    let number = |text: &str| value(text, &place.numbers);
    let against = group.against.as_ref().into_iter();
    let other = group.other.as_deref().map_or(at, |other| other);
    let beside = Filling {
        at: other,
        with: against.chain(place.with.iter().copied()).collect(),
        numbers: numbers(other),
    };
    let units = group.units.as_ref().or(given.units.as_ref());
    Rung {
        at: at.to_owned(),
        expected: match (&group.most, &group.about, &group.refused) {
            (Some(bound), None, None) => Relation::AtMost(number(bound)),
            (None, Some(order), None) => {
                let order = number(order);
                Relation::Within([order - NEXT_ORDER, order + NEXT_ORDER])
            }
            (None, None, Some(words)) => Relation::Refused(words),
            _ => panic!("{} at {at} expects one thing", given.name),
        },
        measure: group.measure.unwrap_or(given.measure),
        value: number("p"),
        text: place.filled(&given.scene),
        other: (other.to_owned(), number(other), beside.filled(&given.scene)),
        n: number(&given.n) as u32,
        steps: number(&given.steps) as u32,
        units: units.map_or([1.0; 4], |units| units.each_ref().map(|unit| number(unit))),
    }
}

/// p of a rung, and the numbers by name.
fn numbers(at: &str) -> Vec<(String, f64)> {
    let mut numbers = vec![("eps".to_owned(), f64::EPSILON)];
    for (name, text) in &DATA.number {
        numbers.push((name.clone(), value(text, &numbers)));
    }
    numbers.push(("p".to_owned(), value(at, &numbers)));
    numbers
}

/// A number, or an expression of named ones; NaN if it is neither.
fn value(text: &str, numbers: &[(String, f64)]) -> f64 {
    let (mut graph, mut scope) = (Graph::new(), Scope::new(&[]));
    for (name, number) in numbers {
        scope.define(name, graph.constant(*number));
    }
    let constant = || graph.parse(text, &scope).ok().and_then(|node| graph.value_of_constant(node));
    text.parse().ok().or_else(constant).unwrap_or(f64::NAN)
}

/// What stands in the places of a text.
pub(super) struct Filling<'a> {
    pub(super) at: &'a str,
    /// Texts by name, the first before the others, and all before those of the data.
    pub(super) with: Vec<&'a Texts>,
    pub(super) numbers: Vec<(String, f64)>,
}

impl Filling<'_> {
    pub(super) fn filled(&self, text: &str) -> String {
        let mut parts = text.split("${");
        let mut out = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            let (place, rest) = part.split_once('}').unwrap_or((part, ""));
            let named =
                self.with.iter().copied().chain([&DATA.text]).find_map(|texts| texts.get(place));
            out += &match named {
                Some(text) => self.filled(text),
                None if place == "at" => self.at.to_owned(),
                None => format!("{:?}", value(place, &self.numbers)),
            };
            out += rest;
        }
        out
    }
}
