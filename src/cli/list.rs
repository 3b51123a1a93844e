//! `sweep list`: the scenes with their terms and predicted orders.

use std::path::PathBuf;

use clap::Args;

use super::{CliError, Scenes, print_beside, print_json, print_text};
use files::{counted, make_directory, replace_file};
use scene::{Body, Contact, Data, Scene};
use studies::portrait::scene_picture;

/// `sweep list`.
#[derive(Args)]
#[command(after_help = "Keys of --json: docs/JSON.md.")]
pub(crate) struct List {
    /// Names of scenes, or paths of TOML files [default: all]
    scene: Vec<String>,
    /// Print the file of one scene, to copy and to change: `sweep list affine --text > mine.toml`
    #[arg(long, requires = "scene", conflicts_with_all = ["json", "markdown", "pictures"])]
    text: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Print the page docs/SCENES.md: a table in Markdown
    #[arg(long, conflicts_with = "json")]
    markdown: bool,
    /// Write a picture of each scene, NAME.svg, into this directory
    #[arg(long, value_name = "DIR", conflicts_with_all = ["json", "markdown"])]
    pictures: Option<PathBuf>,
}

const PAGE: &str = "# All scenes\n\nFor readers who look for a scene. Printed by `sweep list --markdown` (`make scenes`) from the files under [manufactured](../manufactured); a test compares.\n[manufactured/REFERENCES.md](../manufactured/REFERENCES.md) says where the formulas come from. *long*: runs with `--all` or by name.\n\nThe pictures show the body with its boundary parts and, for an exact solution, the body moved by u(T) times the factor named; of an\nabstract scene the components of u over t.\n\n| | scene | question | terms | truth | predicted |\n|---|---|---|---|---|---|";

impl List {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        if self.text {
            let [name] = &self.scene[..] else {
                let message = "--text prints one scene, so that what it prints is a scene file";
                return Err(CliError::other(format!("{message}; {} are named", self.scene.len())));
            };
            let text = scenes.scene(name)?.source.text;
            print_text(text.strip_suffix('\n').unwrap_or(&text));
            return Ok(0);
        }
        let all = scenes.select(&self.scene)?;
        if let Some(folder) = &self.pictures {
            // Foreign files in the folder stay.
            make_directory(folder)?;
            for scene in &all {
                let file = folder.join(format!("{}.svg", scene.name));
                replace_file(&file, scene_picture(scene).as_bytes())?;
            }
            print_text(&format!("{} in {}", counted(all.len(), "picture"), folder.display()));
            return Ok(0);
        }
        if self.json {
            print_json(&all.iter().map(row).collect::<Vec<_>>())?;
            return Ok(0);
        }
        if self.markdown {
            print_text(PAGE);
            all.iter().for_each(|scene| print_text(&line_of_page(scene)));
            return Ok(0);
        }
        for scene in &all {
            let orders = predictions(scene);
            let orders =
                if orders.is_empty() { "nothing judged".into() } else { orders.join("; ") };
            print_beside(&format!("{:<16} ", scene.name), 17, &scene.question);
            let terms = format!("terms: {}; {}", terms(scene).join(", "), truth(scene));
            print_beside("", 17, &terms);
            print_beside("", 17, &orders);
        }
        print_text(&format!("{} {}", counted(all.len(), "scene"), scenes.place()));
        Ok(0)
    }
}

fn line_of_page(scene: &Scene) -> String {
    let Scene { name, question, .. } = scene;
    let mark = if scene.long { " *long*" } else { "" };
    let orders = match (predictions(scene), scene.judge) {
        (_, false) => "nothing judged".to_owned(),
        (orders, true) => orders.join("; "),
    };
    // A bar would end the cell.
    let cell = |text: &str| text.replace('|', "\\|");
    let (question, orders, terms) = (cell(question), cell(&orders), terms(scene).join(", "));
    let link = format!("[`{name}`](../manufactured/{name}.toml)");
    let picture = format!("<img src=\"scenes/{name}.svg\" width=\"240\" alt=\"{name}\">");
    format!("| {picture} | {link}{mark} | {question} | {terms} | {} | {orders} |", truth(scene))
}

fn row(scene: &Scene) -> serde_json::Value {
    serde_json::json!({
        "name": scene.name,
        "question": scene.question,
        "terms": terms(scene),
        "truth": truth(scene),
        "predicts": predictions(scene),
        "long": scene.long,
        "judge": scene.judge,
        "file": scene.source.path.exists().then(|| scene.source.path.display().to_string()),
    })
}

/// The terms of (5.1)-(5.5) in a scene, or those of Problem 1 in an abstract one.
pub(crate) fn terms(scene: &Scene) -> Vec<&'static str> {
    let present = match &scene.body {
        Body::Contact(body) => {
            let any = |part: fn(&Contact) -> bool| body.contact.iter().any(part);
            vec![
                (true, "elasticity"),
                (!body.material.regions.is_empty(), "regions"),
                (body.material.is_anisotropic(), "anisotropy"),
                (!body.material.memory.is_empty(), "memory"),
                (body.material.memory.len() > 1, "several kernels"),
                (
                    body.material.memory.iter().any(|term| term.inner.is_some()),
                    "history of a history",
                ),
                (body.material.projection.is_some(), "projection"),
                (any(|c| c.law.is_some()), "compliance"),
                (any(|c| c.gap.is_some()), "gap"),
                (any(|c| c.shift.is_some()), "shift"),
                (body.domain.bilateral, "bilateral contact"),
                (any(|c| c.friction.is_some()), "friction"),
            ]
        }
        Body::Abstract(problem) => vec![
            (problem.nonlinear.is_none(), "linear operator"),
            (problem.nonlinear.is_some(), "nonlinear operator"),
            (!problem.kernels.is_empty(), "history"),
            (problem.kernels.iter().any(|kernel| kernel.inner.is_some()), "history of a history"),
            (problem.force.is_some(), "nonlinear phi"),
            (problem.traces.iter().any(|trace| trace.law.is_some()), "j"),
            (problem.traces.iter().any(|trace| trace.is_bounded()), "constraint"),
        ],
    };
    present.into_iter().filter(|(has, _)| *has).map(|(_, name)| name).collect()
}

/// What errors are measured against.
pub(crate) fn truth(scene: &Scene) -> &'static str {
    let Some(body) = scene.as_contact() else { return "exact solution" };
    match &body.data {
        Data::Exact { interpolated: true, .. } => "exact solution in V^h",
        Data::Exact { .. } => "exact solution",
        Data::Loads { .. } => "given loads, reference run",
    }
}

fn predictions(scene: &Scene) -> Vec<String> {
    let line = |p: &scene::Prediction| {
        let variable = match p.variable {
            scene::Direction::H => "h",
            scene::Direction::K => "k",
            scene::Direction::Joint => "h and k",
            scene::Direction::Path => "h on the path",
        };
        let says = match p.at_least {
            true if p.tends_to_zero() => "tends to zero".to_owned(),
            true => format!("order at least {}", p.order),
            false => format!("order {}", p.order),
        };
        format!("{} in {variable}: {says}, by {}", p.norm.name(), p.why)
    };
    scene.predicts.iter().map(line).collect()
}
