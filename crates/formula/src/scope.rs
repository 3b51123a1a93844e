use std::collections::BTreeMap;

use super::graph::{Node, Variable};

/// The variables a formula may use, and the parameters and quantities defined before it.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    variables: Vec<Variable>,
    names: BTreeMap<String, Node>,
}

impl Scope {
    /// A scope with these variables and no names.
    pub fn new(variables: &[Variable]) -> Self {
        let mut variables = variables.to_vec();
        variables.sort_unstable();
        variables.dedup();
        Self { variables, names: BTreeMap::new() }
    }

    /// Gives `name` the value `node`; a later definition replaces an earlier. Reserved names (see
    /// [`Graph::is_reserved`](super::Graph::is_reserved)) keep their meaning whatever is defined here.
    pub fn define(&mut self, name: &str, node: Node) {
        self.names.insert(name.to_owned(), node);
    }

    /// The node of a defined name.
    pub fn get(&self, name: &str) -> Option<Node> {
        self.names.get(name).copied()
    }

    pub(crate) fn allows(&self, variable: Variable) -> bool {
        self.variables.contains(&variable)
    }

    /// Everything that may be named besides functions: variables, pi, names.
    pub(super) fn allowed_names(&self) -> Vec<&str> {
        let variables = self.variables.iter().map(|v| v.name());
        let names = self.names.keys().map(String::as_str);
        variables.chain(["pi"]).chain(names).collect()
    }
}
