//! `sweep check`: verifies the manufactured data and the hypotheses of a scene, and says what it requires, without a solve.
//! Floors alone are measured by runs, where they are asked for.

use std::cmp::Reverse;
use std::collections::BTreeSet;

use super::abstract_problem::{fact, of_table, step_facts};
use super::list::{terms, truth};
use super::machine::Common;
use super::scenes::{Grid, admit};
use super::{
    CliError, Scenes, TABLE_WIDTH, abstract_problem, print_beside, print_json, print_text, width,
};
use clap::Args;
use exact::{Finding, Status, check};
use fem::contact::Plan;
use files::digits;
use judge::verdict::{Foreseen, ForeseenConstant, LeadingPoint, Variable};
use report::json_table;
use run::sweep::{
    CasePlan, Cost, MemoryLimit, PlanCost, ScenePlan, admit_constants, admit_plan, floors_beside,
    foresee_plan,
};
use scene::setup::{Constants, Setup, Smallness, Subject, constants, sides};
use scene::{Data, Hypothesis, Prediction, RelaxationTerm, Scene};
use serde_json::Value;
use studies::theory::bound::sampled::table_of_body;
use studies::theory::corner::corners;
use vhi::history::FastConvolution;
use vhi::law::INTERPOLATED_TO;

/// `sweep check`.
#[derive(Args)]
#[command(
    after_help = "A floor is the part of an error that does not come from the discretisation. To measure it, one of its sources is made better: solver (residual to 1/100 of the tolerance, or to rounding), history (direct sum in place of the recursion), load and error quadrature (the next rule), reference (a run with 16 N steps; for reference scenes a reference of half the cells and steps, its floor estimated likewise). Cases are the finest n with the fewest steps and the coarsest n with the most, unless --n and --steps name them.\n\nKeys of --json: docs/JSON.md."
)]
pub(crate) struct Check {
    /// Name of a scene, or path of a TOML file
    scene: String,
    #[command(flatten)]
    grid: Grid,
    /// Measure the part of the errors that is not discretisation: four to six runs of each of two cases
    #[arg(long)]
    floors: bool,
    #[command(flatten)]
    common: Common,
}

impl Check {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let scene = scenes.scene(&self.scene)?;
        let overrides = self.grid.overrides();
        overrides.check(&scene)?;
        let limit = self.common.allowance.limit();
        admit_constants(&scene, true, &limit)?;
        let mut plan = ScenePlan::new(Subject::new(scene)?, &overrides);
        if let Some(remark) = plan.step_remark()? {
            super::output::remark(&plan.scene().name, &remark);
        }
        let findings = findings(&plan, &limit)?;
        let failed = findings.iter().any(|finding| finding.status == Status::Failed);
        let costs = match plan.costs() {
            // The finding says it.
            Err(_) if failed => PlanCost { cases: Vec::new(), reference: None },
            costs => costs?,
        };
        let floors = if self.floors { Some(self.measure(&mut plan, &limit)?) } else { None };
        let document = document(&plan, &findings, &costs, floors);
        match self.common.json {
            true => print_json(&document)?,
            false => print_in_words(plan.scene(), &document),
        }
        Ok(u8::from(failed))
    }

    /// The floors of two of the scene's cases, or of those on the grid that is given.
    fn measure(&self, plan: &mut ScenePlan, limit: &MemoryLimit) -> Result<Value, CliError> {
        if plan.cases.is_empty() {
            return Err(plan.scene().no_case("run").into());
        }
        let largest = plan.cases.iter().max_by_key(|case| (case.n, Reverse(case.steps)));
        let longest = plan.cases.iter().max_by_key(|case| (case.steps, Reverse(case.n)));
        let two: Vec<CasePlan> = [largest, longest].into_iter().flatten().cloned().collect();
        let all = plan.cases.clone();
        plan.cases.retain(|case| !self.grid.is_own() || two.contains(case));
        let beside = |cases: &[(&CasePlan, &Cost)]| floors_beside(plan.scene().dimension, cases);
        admit_plan(plan, 1, limit, beside)?;
        let mut measured = Vec::new();
        for case in &plan.cases {
            measured.extend(plan.floors(case)?.into_iter().map(|row| {
                let mut json = serde_json::json!(row);
                json["n"] = case.n.into();
                json["steps"] = case.steps.into();
                json["ratio"] = (row.estimated / row.measured).into();
                json
            }));
        }
        plan.cases = all;
        Ok(measured.into())
    }
}

fn findings(plan: &ScenePlan, limit: &MemoryLimit) -> Result<Vec<Finding>, CliError> {
    let setup = match &plan.subject {
        Subject::Contact(setup) => setup,
        Subject::Abstract(setup) => return Ok(abstract_problem::findings(setup)),
    };
    if let Some(sweep) = &setup.scene.sweep {
        for n in sweep.n.iter().copied().chain(sweep.reference.map(|reference| reference.n)) {
            admit(setup, None, (n, 1), limit)?;
        }
    }
    let mut findings = Vec::new();
    if let Some(exact) = &setup.exact {
        findings.extend(check(exact, &sides(&setup.body)));
        // A scene whose errors tend to zero at no rate claims no regularity.
        let no_rate = setup.scene.predicts.iter().any(Prediction::tends_to_zero);
        let rough = no_rate || setup.scene.violates.contains(&Hypothesis::RegularInSpace);
        // Where (5.25) is not claimed f0 may be infinite at a point, and quadrature of the strong form does not judge the weak
        // one that the solver is given.
        let loads = |of: &&mut Finding| of.subject == "loads" && of.status == Status::Failed;
        for finding in findings.iter_mut().filter(loads).filter(|_| rough) {
            finding.status = Status::Weak;
            finding.text += ": (5.25) does not hold, f0 may not be integrable by a fixed rule";
        }
    }
    findings.extend(interfaces(setup));
    let inner = setup.body.domain.inner_groups();
    if !inner.is_empty() {
        let text = format!("passed over, since they bound nothing: {}", inner.join(", "));
        findings.push(Finding::new("groups", Status::Fact, inner.len() as f64, text));
    }
    findings.extend(hypotheses(setup, &constants(setup)?));
    // Corners do not matter for an exact solution, and a two-sided law is what it was made for.
    if let Data::Loads { .. } = &setup.body.data {
        findings.extend(corners(&setup.body).iter().map(|corner| {
            let order = corner.order();
            let text = format!("{}; order in h {order:.4}", corner.in_words());
            let status = if order < 1.0 { Status::Weak } else { Status::Fact };
            Finding::new("corner", status, order, text)
        }));
        if let Some((law, instead)) = setup.body.laws().find_map(|l| Some((l, l.one_sided()?))) {
            let text = format!(
                "two-sided: p < 0 and the body is pulled where contact is open; {instead} presses alone"
            );
            findings.push(Finding::new("law", Status::Weak, law.slope_before, text));
        }
    }
    Ok(findings)
}

fn document(
    plan: &ScenePlan,
    findings: &[Finding],
    costs: &PlanCost,
    floors: Option<Value>,
) -> Value {
    let scene = plan.scene();
    let rows = plan.cases.iter().zip(&costs.cases);
    let reference = plan.reference.zip(costs.reference);
    let mut document = serde_json::json!({
        "scene": scene.name,
        "findings": findings,
        "terms": terms(scene),
        "truth": truth(scene),
        "regions": regions(plan),
        "algorithm": algorithms(plan, costs),
        "rule": scene.time.rule.in_words(),
        "history": history(plan),
        "reference": reference.map(|(run, cost)| run_json(Some(run.n), run.steps, &cost)),
        "cases": rows.map(|(case, cost)| case_json(plan, case, cost)).collect::<Vec<_>>(),
        "constants": predicted_constants(plan),
    });
    if let Some(floors) = floors {
        document["floors"] = floors;
    }
    document
}

/// What the scene requires, the findings, the cases, the floors.
fn print_in_words(scene: &Scene, document: &Value) {
    let say = |label: &str, words: &str| print_beside(label, 11, words);
    let text = |key: &str| document[key].as_str().unwrap_or_default();
    let rows = |key: &str| document[key].as_array().into_iter().flatten();
    let number = |value: &Value, figures| digits(value.as_f64().unwrap_or(f64::NAN), figures);
    let cases = rows("cases").count() > 0;
    print_beside("", 0, &format!("{}: {}", scene.name, scene.question));
    say("terms", &terms(scene).join(", "));
    say("truth", text("truth"));
    for region in rows("regions") {
        let [low, high] = [0, 1].map(|i| number(&region["eigenvalues"][i], 5));
        let name = region["name"].as_str().unwrap_or_default();
        say(
            "region",
            &format!("{name}: eigenvalues of the elasticity tensor from {low} to {high}"),
        );
    }
    if cases {
        say("algorithm", text("algorithm"));
    }
    say("rule", text("rule"));
    say("history", text("history"));
    let reference = &document["reference"];
    if let Some(bytes) = reference["memory_bytes_predicted"].as_f64() {
        let (n, steps) = (&reference["n"], &reference["steps"]);
        say("reference", &format!("n = {n}, N = {steps}: {:.0} MB", bytes / 1e6));
    }
    rows("constants").for_each(|constant| say("constant", &constant_in_words(constant)));
    for finding in rows("findings") {
        let of = |key: &str| finding[key].as_str().unwrap_or_default();
        print_beside(&format!("{:<28} {:<9} ", of("subject"), of("status")), 39, of("text"));
    }
    let wide = width(TABLE_WIDTH);
    if cases {
        let columns = ">n = n; >N = steps; >unknowns = dofs; >memory = memory_bytes_predicted MB; \
                       >bytes of history = history_bytes";
        print_text(&json_table(&document["cases"], columns, wide));
    }
    if !document["floors"].is_null() {
        let columns = ">n = n; >N = steps; norm = norm; part = part; >error = error 2; >measured = measured 2; \
                       >estimated = estimated 2; >ratio = ratio 2";
        print_text(&json_table(&document["floors"], columns, wide));
    }
}

fn run_json(n: Option<u32>, steps: u32, cost: &Cost) -> Value {
    serde_json::json!({
        "n": n,
        "steps": steps,
        "plan": cost.plan.name(),
        "memory_bytes_predicted": cost.memory_bytes.round() as u64,
    })
}

fn case_json(plan: &ScenePlan, case: &CasePlan, cost: &Cost) -> Value {
    let mut json = run_json(case.n, case.steps, cost);
    json["dofs"] = cost.dofs.into();
    // Of the vectors of unknowns.
    let vectors = match &plan.subject {
        Subject::Contact(setup) => setup.history_vectors(case.steps),
        Subject::Abstract(_) => case.steps as usize + 1,
    };
    json["history_bytes"] = (vectors * cost.dofs * size_of::<f64>()).into();
    json["norms"] = serde_json::json!(case.norms);
    json
}

/// The algorithm of all runs, or the meshes with each.
fn algorithms(plan: &ScenePlan, costs: &PlanCost) -> String {
    let mesh_sizes = plan.cases.iter().map(|case| case.n.unwrap_or_default());
    let ns = mesh_sizes.chain(plan.reference.map(|reference| reference.n));
    let mut found: Vec<(&'static str, BTreeSet<u32>)> = Vec::new();
    for (n, cost) in ns.zip(costs.cases.iter().chain(&costs.reference)) {
        let name = algorithm(&plan.subject, cost.plan);
        match found.iter_mut().find(|(known, _)| *known == name) {
            Some((_, meshes)) => _ = meshes.insert(n),
            None => found.push((name, BTreeSet::from([n]))),
        }
    }
    if let [(name, _)] = found[..] {
        return name.to_string();
    }
    let each = found.iter().map(|(name, meshes)| {
        let list: Vec<String> = meshes.iter().map(u32::to_string).collect();
        format!("{name} for n = {}", list.join(", "))
    });
    each.collect::<Vec<_>>().join("; ")
}

fn algorithm(subject: &Subject, plan: Plan) -> &'static str {
    let Subject::Contact(setup) = subject else {
        return "semismooth Newton with active set, dense LU";
    };
    let model = &setup.model;
    match plan {
        Plan::Linear if Plan::changes_factor(model) => {
            "linear: one Cholesky factor for each weight of the last slot (two on equal steps by the trapezoidal rule), one solve per level"
        }
        Plan::Linear => {
            "linear, memory a multiple of the elasticity or absent: one Cholesky factor, one solve per level"
        }
        Plan::Condensed if Plan::changes_factor(model) => {
            "contact condensed onto Gamma3: one Cholesky factor for each weight of the last slot (two on equal steps by the trapezoidal rule), semismooth Newton with active set on the unknowns of Gamma3, one solve per level in the volume"
        }
        Plan::Condensed => {
            "contact condensed onto Gamma3: one Cholesky factor, semismooth Newton with active set on the unknowns of Gamma3, one solve per level in the volume"
        }
        Plan::Newton if model.projection.is_none() => {
            "semismooth Newton with active set; the Cholesky factor is kept while the active set stays, and preconditions BiCGStab after"
        }
        Plan::Newton => {
            "semismooth Newton with active set, rank-one zeta piece; a Cholesky factor preconditions BiCGStab until its extra iterations have cost a new one"
        }
    }
}

/// The named regions with the extreme eigenvalues of 𝒜, and the rest of the body.
fn regions(plan: &ScenePlan) -> Vec<Value> {
    let Subject::Contact(setup) = &plan.subject else { return Vec::new() };
    let material = &setup.body.material;
    if material.regions.is_empty() {
        return Vec::new();
    }
    let named = material.regions.iter().map(|region| (region.name.as_str(), &region.elastic));
    let all = std::iter::once(("elsewhere", &material.elastic)).chain(named);
    all.map(|(name, elastic)| {
        let (low, high) = elastic.eigenvalues(setup.scene.dimension);
        serde_json::json!({ "name": name, "eigenvalues": [low, high] })
    })
    .collect()
}

fn history(plan: &ScenePlan) -> String {
    let Subject::Contact(setup) = &plan.subject else {
        return "direct sum, O(n) at step n".into();
    };
    let trapezoidal = setup.model.time_rule.is_trapezoidal();
    let of_term = |memory: &RelaxationTerm| match &memory.exponentials {
        Some(terms) if trapezoidal => {
            format!("recursion, {} exponential(s), O(1) per step", terms.len())
        }
        None if trapezoidal => format!(
            "direct trapezoidal sum, O(n) at step n; from {} steps on O(1) per step by interpolation of the kernel to {INTERPOLATED_TO:.0e}, where it is smooth",
            FastConvolution::foreseen_from(INTERPOLATED_TO)
        ),
        _ => "direct sum by the rule's own weights, O(n) at step n".into(),
    };
    match &setup.body.material.memory[..] {
        [] => "none".into(),
        [memory] => of_term(memory),
        terms => {
            let each: Vec<String> = terms.iter().map(of_term).collect();
            format!("{} terms: {}", terms.len(), each.join("; "))
        }
    }
}

/// Shape of the cells on the coarsest mesh of the sweep.
fn mesh_quality(setup: &Setup) -> Finding {
    let n = setup.scene.sweep.as_ref().and_then(|sweep| sweep.n.iter().min().copied()).unwrap_or(4);
    let q = setup.body.domain.mesh(n).quality();
    let text = format!(
        "n = {n}: smallest angle {} degrees, longest edge over altitude at most {}, h_max = {}, h_max/h_min = {}",
        digits(q.smallest_angle, 3),
        digits(q.aspect, 3),
        digits(q.longest, 4),
        digits(q.longest / q.shortest, 3)
    );
    Finding::new("mesh", Status::Fact, q.smallest_angle, text)
}

/// Whether the meshes of the sweep follow the boundaries of the regions.
fn interfaces(setup: &Setup) -> Option<Finding> {
    let sweep = setup.scene.sweep.as_ref()?;
    if setup.body.material.regions.is_empty() {
        return None;
    }
    let (mut fit, mut cut) = (Vec::new(), None);
    for &n in &sweep.n {
        match setup.check_regions(n) {
            Ok(()) => fit.push(n.to_string()),
            Err(error) => cut = cut.or(Some(error)),
        }
    }
    let fits = format!("no cell is cut on n = {}", fit.join(", "));
    let (status, value, text) = match cut {
        None => (Status::Verified, fit.len() as f64, fits),
        Some(error) => (Status::Failed, f64::NAN, error.to_string()),
    };
    Some(Finding::new("mesh lines on interfaces", status, value, text))
}

/// Constants of the trace in their ranges, and their proved bounds.
fn trace_findings(c: &Constants) -> Vec<Finding> {
    let limits = [
        ("c_j^2", c.c_j_squared, c.c_j_range),
        ("c_nu^2", c.c_nu_squared, c.c_nu_range),
        ("c_tau^2", c.c_tau_squared, c.c_tau_range),
    ];
    let bounds = [("c_j^2", c.c_j_squared_bound), ("c_nu^2", c.c_nu_squared_bound)];
    // The value beside its range: the same that `bound` prints.
    let known = |(name, value, range): (&str, f64, [f64; 2])| {
        let [least, most] = range.map(|end| digits(end, 7));
        fact(name, value, &format!("limit of meshes, between {least} and {most}; no bound"))
    };
    let proved = |(name, bound): (&str, Option<f64>)| {
        let name = format!("{name}, upper bound");
        Some(fact(&name, bound?, "proved: distance to the clamped side"))
    };
    let limits = limits.into_iter().filter(|(_, value, _)| *value > 0.0).map(known);
    limits.chain(bounds.into_iter().filter_map(proved)).collect()
}

/// (2.9), for all c_j² and c_τ² in their ranges.
fn smallness(c: &Constants) -> Finding {
    let [low, high] = c.m0_range;
    let range = match low == high {
        true => format!("m0 = {}", digits(c.m0, 7)),
        false => {
            let [m0, low, high] = [c.m0, low, high].map(|value| digits(value, 7));
            format!("m0 = {m0}, between {low} and {high}")
        }
    };
    let (status, text) = match c.smallness() {
        Smallness::Holds => (Status::Verified, range),
        Smallness::Fails => (Status::Weak, range),
        Smallness::Unknown => {
            (Status::Unknown, format!("{range}: neither verified nor refused, its sign is unknown"))
        }
    };
    Finding::new("m0 > 0 (2.9)", status, c.m0, text)
}

/// Constants of the paper, with their origin.
fn hypotheses(setup: &Setup, c: &Constants) -> Vec<Finding> {
    let mut findings = vec![mesh_quality(setup)];
    findings.extend(of_table(table_of_body(setup, c), &smallness(c)));
    findings.extend(trace_findings(c));
    if let Some(coulomb) = &c.coulomb {
        let [a, b] = coulomb.coefficients(c.alpha_nu, c.c_j_squared, c.c_tau_squared);
        findings.push(fact("A", a, "of |v_nu|^2 in (2.9): friction follows the normal law"));
        findings.push(fact("B", b, "of |v_tau|^2 in (2.9)"));
    }
    let (power, singular) = c.singular;
    if c.is_nested() {
        let note = "of histories of histories: S has |B| + T |q||r|";
        findings.push(fact("|q||r|", singular.operator, note));
    } else if power > 0.0 {
        let note = format!("the same of C in the terms t^-{power} C");
        findings.push(fact("|C|", singular.operator, &note));
    }
    findings.extend(step_facts(&c.step_bounds(setup.model.time_rule.as_ref())));
    findings
}

/// The predicted constants of a plan.
fn predicted_constants(plan: &ScenePlan) -> Vec<Value> {
    let orders = plan.scene().predicts.iter().map(|prediction| prediction.order);
    let one = |(known, order): (&ForeseenConstant, f64)| {
        let ForeseenConstant { norm, variable, foreseen, .. } = known;
        let (predicted, limit, not_predicted) = match foreseen {
            Foreseen::Nothing { not_predicted } => (None, None, Some(not_predicted)),
            Foreseen::Leading(line) => {
                let step = |p: &LeadingPoint| match variable {
                    Variable::H => p.h.unwrap_or(f64::NAN),
                    _ => p.k,
                };
                let finest = line.points.iter().min_by(|a, b| step(a).total_cmp(&step(b)));
                (finest.map(|point| point.error / step(point).powf(order)), line.limit, None)
            }
        };
        serde_json::json!({
            "norm": norm, "variable": variable, "order": order,
            "predicted": predicted, "limit": limit, "not_predicted": not_predicted,
        })
    };
    foresee_plan(plan).iter().zip(orders).map(one).collect()
}

fn constant_in_words(json: &Value) -> String {
    let (name, letter) = match json["variable"].as_str() {
        Some("h") => ("C_h", "h"),
        Some("k") => ("C_k", "k"),
        Some("joint") => ("C_h, C_k", "h, k"),
        _ => ("C", "h along the path"),
    };
    let error = format!("{} in {letter}", json["norm"].as_str().unwrap_or_default());
    if let Some(why) = json["not_predicted"].as_str() {
        return format!("{error}: none, {why}");
    }
    let number = |key: &str| json[key].as_f64().map(|value| format!("{value:.4e}"));
    let limit = number("limit").map_or(String::new(), |limit| format!(", tends to {limit}"));
    let constant = number("predicted").unwrap_or_else(|| "-".into());
    let order = json["order"].as_f64().unwrap_or(f64::NAN);
    format!("{error}: {name} = {constant} of order {order} on the finest case{limit}")
}
