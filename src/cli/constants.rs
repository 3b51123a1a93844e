//! The predicted constants of a plan, for `sweep check`.

use files::counted;
use judge::verdict::{Foreseen, ForeseenConstant, Variable};
use run::sweep::{ScenePlan, foresee_plan};

/// One line and one JSON object per prediction.
pub(crate) fn predicted_constants(plan: &ScenePlan) -> Vec<(String, serde_json::Value)> {
    let orders = plan.scene().predicts.iter().map(|prediction| prediction.order);
    foresee_plan(plan).iter().zip(orders).map(|(known, order)| one(known, order)).collect()
}

fn one(known: &ForeseenConstant, order: f64) -> (String, serde_json::Value) {
    let ForeseenConstant { norm, variable, foreseen, .. } = known;
    let (name, letter) = match variable {
        Variable::H => ("C_h", "h"),
        Variable::K => ("C_k", "k"),
        Variable::Joint => ("C_h, C_k", "h, k"),
        Variable::Path => ("C", "h along the path"),
    };
    let mut json = serde_json::json!({
        "norm": norm, "variable": variable, "order": order,
        "predicted": null, "limit": null, "not_predicted": null,
    });
    let line = match foreseen {
        Foreseen::Nothing { not_predicted } => {
            json["not_predicted"] = serde_json::json!(not_predicted);
            format!("{norm} in {letter}: none, {not_predicted}")
        }
        Foreseen::Leading(line) => {
            let step = |p: &judge::verdict::LeadingPoint| match variable {
                Variable::H => p.h.unwrap_or(f64::NAN),
                _ => p.k,
            };
            let finest = line.points.iter().min_by(|a, b| step(a).total_cmp(&step(b)));
            let constant = finest.map(|point| point.error / step(point).powf(order));
            json["predicted"] = serde_json::json!(constant);
            json["limit"] = serde_json::json!(line.limit);
            let limit = line.limit.map_or(String::new(), |limit| format!(", tends to {limit:.4e}"));
            let constant = constant.map_or("-".into(), |constant| format!("{constant:.4e}"));
            let points = counted(line.points.len(), "case");
            format!(
                "{norm} in {letter}: {name} = {constant} of order {order} on the finest of {points}{limit}"
            )
        }
    };
    (line, json)
}
