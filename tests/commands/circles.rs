//! Source: the files of each crate and of the program, as their imports tie them.
//! Goal: inside a crate files import one way: there is no circle but those listed here, each with its reason, and a
//! listed circle that is gone leaves the list. The finder itself is shown to see circles.
//! Data: the files under crates/ and src/.

use std::collections::{BTreeMap, BTreeSet};

use crate::house::{flat, sources, without_comments};

/// A circle of files that stays: its crate, one of its files, how many files it has, and why.
const KNOWN: &[(&str, &str, usize, &str)] = &[
    (
        "exact",
        "constitutive",
        5,
        "σ, ζ and friction are formulas in the numbers of an exact solution, which is made of these formulas",
    ),
    (
        "exact",
        "check/loads",
        7,
        "findings and the points where they are sampled stand in the module of the checks",
    ),
    (
        "fem",
        "contact/evolution",
        2,
        "the derivative at the open level is of an evolution, and kept in it",
    ),
    (
        "fem",
        "contact/friction",
        7,
        "laws of contact and friction are parts of a model, and their forces, states and tangents are made for one",
    ),
    (
        "fem",
        "contact/discretization",
        6,
        "a space holds its trace and its factors, which are made for it, and what a march has counted of them",
    ),
    (
        "fem",
        "space/element",
        2,
        "an element names its rules, and a rule for its products asks for its degree",
    ),
    ("fit", "screen", 3, "a level is screened, and a point may be left out because it is no level"),
    (
        "report",
        "document",
        11,
        "the error of a report and the summary of a scene stand in the root that draws all of them",
    ),
    (
        "run",
        "sweep/case",
        5,
        "cases of either kind of problem are planned, sized and measured from a plan",
    ),
    (
        "run",
        "sweep/run",
        2,
        "provenance names the machine of a run, and a resumed run reads provenance",
    ),
    (
        "scene",
        "validated",
        16,
        "each part of a scene is read with the errors and the source of the whole",
    ),
    ("scene", "setup", 10, "a setup is admitted and measured by functions of a setup"),
];

type Path = Vec<String>;

/// The files of a crate by their module paths.
struct Tree {
    files: BTreeMap<Path, File>,
}

struct File {
    /// Code without re-exports and comments.
    code: String,
    /// What `use` brings into the module, by name.
    names: BTreeMap<String, Path>,
}

fn path(text: &str) -> Path {
    text.split("::").map(str::to_owned).collect()
}

/// The words of a text that may be paths: `a::b::C`.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':')).filter(|w| !w.is_empty())
}

/// A `use` statement without its visibility, and whether it re-exports.
fn import(statement: &str) -> Option<(&str, bool)> {
    let at = statement.rfind("use ").filter(|&at| {
        let before = statement[..at].trim_end();
        before.is_empty() || before.ends_with([')', '}', ']']) || before.ends_with("pub")
    })?;
    let public = statement[..at].trim_end();
    Some((statement[at + 4..].trim(), public.ends_with("pub") || public.ends_with(')')))
}

/// The text before its tests, which stand last in a file.
fn without_tests(text: &str) -> &str {
    text.split("#[cfg(test)]\nmod tests {").next().unwrap_or(text)
}

impl Tree {
    fn new(files: &[(Path, String)]) -> Self {
        let mut tree = Self { files: BTreeMap::new() };
        for (module, _) in files {
            tree.files.insert(module.clone(), File { code: String::new(), names: BTreeMap::new() });
        }
        for (module, text) in files {
            let (mut code, mut names) = (String::new(), BTreeMap::new());
            for statement in without_comments(without_tests(text)) {
                let Some((imported, public)) = import(&statement) else {
                    code.push_str(&statement);
                    code.push(';');
                    continue;
                };
                for path in flat(imported) {
                    let Some(full) = tree.full(module, &path) else { continue };
                    if let Some(name) = full.last().filter(|name| *name != "*").cloned() {
                        names.insert(name.clone(), full);
                        if !public {
                            code.push_str(&format!(" {name} "));
                        }
                    }
                }
            }
            tree.files.insert(module.clone(), File { code, names });
        }
        tree
    }

    /// A path in a module from the root of the crate; none where it leads out of the crate.
    fn full(&self, module: &[String], path: &[String]) -> Option<Path> {
        let ups = path.iter().take_while(|part| *part == "super").count();
        let child = [module, &path[..1]].concat();
        Some(match path[0].as_str() {
            "crate" => path[1..].to_vec(),
            "self" => [module, &path[1..]].concat(),
            "super" => [&module[..module.len().checked_sub(ups)?], &path[ups..]].concat(),
            _ if self.files.contains_key(&child) => [module, path].concat(),
            _ => return None,
        })
    }

    /// The file where a path ends, through re-exports.
    fn home(&self, path: &[String], passes: usize) -> Option<Path> {
        let known = (0..=path.len()).rev().find(|&n| self.files.contains_key(&path[..n]))?;
        let (module, rest) = path.split_at(known);
        let named = rest.first().and_then(|name| self.files[module].names.get(name));
        match named {
            Some(further) if passes < 8 && further[..] != path[..known + 1] => {
                self.home(&[further, &rest[1..]].concat(), passes + 1)
            }
            _ => Some(module.to_vec()),
        }
    }

    /// The files that a file needs.
    fn needs(&self, module: &Path) -> BTreeSet<Path> {
        let File { code, names } = &self.files[module];
        let of = |word: &str| {
            let parts = path(word);
            let full = match names.get(&parts[0]) {
                Some(imported) => Some([imported, &parts[1..]].concat()),
                None => self.full(module, &parts).filter(|_| parts.len() > 1),
            };
            // A module around this one that is named alone, as in pub(in crate::m), gives nothing.
            let full = full.filter(|full| !module.starts_with(full))?;
            self.home(&full, 0).filter(|home| home != module)
        };
        words(code).filter_map(of).collect()
    }

    /// The sets of files that need each other, by the files that each can reach.
    fn circles(&self) -> Vec<Vec<Path>> {
        let needs: BTreeMap<&Path, BTreeSet<Path>> =
            self.files.keys().map(|module| (module, self.needs(module))).collect();
        let reached = |from: &Path| {
            let (mut seen, mut open) = (BTreeSet::new(), vec![from.clone()]);
            while let Some(next) = open.pop() {
                for further in &needs[&next] {
                    if seen.insert(further.clone()) {
                        open.push(further.clone());
                    }
                }
            }
            seen
        };
        let reach: BTreeMap<&Path, BTreeSet<Path>> =
            self.files.keys().map(|module| (module, reached(module))).collect();
        let mut circles: Vec<Vec<Path>> = Vec::new();
        for (module, seen) in &reach {
            if seen.contains(*module) && !circles.iter().flatten().any(|known| known == *module) {
                let members = seen.iter().filter(|other| reach[other].contains(*module));
                circles.push(members.cloned().collect());
            }
        }
        circles
    }
}

/// The files of each crate, tests left out.
fn trees() -> BTreeMap<String, Tree> {
    let mut files: BTreeMap<String, Vec<(Path, String)>> = BTreeMap::new();
    for source in sources() {
        let inside = source.path.split("src/").last().unwrap_or_default().trim_end_matches(".rs");
        let mut module: Path = inside.split('/').map(str::to_owned).collect();
        if module.last().is_some_and(|last| ["mod", "lib", "main"].contains(&last.as_str())) {
            module.pop();
        }
        if !module.iter().any(|part| part == "tests") {
            files.entry(source.of).or_default().push((module, source.text));
        }
    }
    files.into_iter().map(|(of, files)| (of, Tree::new(&files))).collect()
}

#[test]
fn files_import_one_way() {
    let mut found = Vec::new();
    for (of, tree) in trees() {
        for circle in tree.circles() {
            let names: Vec<String> = circle.iter().map(|module| module.join("/")).collect();
            found.push((of.clone(), names));
        }
    }
    let known = |of: &str, names: &[String]| {
        KNOWN.iter().any(|(crate_, file, count, _)| {
            *crate_ == of && names.len() == *count && names.iter().any(|name| name == file)
        })
    };
    let new: Vec<String> = found
        .iter()
        .filter(|(of, names)| !known(of, names))
        .map(|(of, names)| format!("{of}: {} files: {}", names.len(), names.join(", ")))
        .collect();
    assert!(new.is_empty(), "circles of files that no line of KNOWN explains:\n{}", new.join("\n"));
    let gone = KNOWN.iter().filter(|(of, file, ..)| {
        !found.iter().any(|(crate_, names)| crate_ == of && names.iter().any(|name| name == file))
    });
    let gone: Vec<_> = gone.map(|(of, file, ..)| format!("{of} {file}")).collect();
    assert!(gone.is_empty(), "circles of KNOWN are gone, take their lines out: {gone:?}");
}

#[test]
fn circles_are_seen() {
    let of = |files: &[(&str, &str)]| {
        let files: Vec<(Path, String)> = files
            .iter()
            .map(|(module, text)| {
                let module = if module.is_empty() { Vec::new() } else { path(module) };
                (module, (*text).to_owned())
            })
            .collect();
        Tree::new(&files).circles().iter().map(Vec::len).collect::<Vec<_>>()
    };
    let root = ("", "mod a;\nmod b;\npub use a::A;\npub use b::B;");
    assert_eq!(of(&[root, ("a", "use super::b::B;"), ("b", "use crate::a::A;")]), [2]);
    // Through a re-export, a path in the code, and a module that was imported.
    assert_eq!(of(&[root, ("a", "use super::B;"), ("b", "fn f() -> super::A { todo!() }")]), [2]);
    assert_eq!(of(&[root, ("a", "use crate::b; fn f() { b::g() }"), ("b", "use super::A;")]), [2]);
    // A root that uses what needs it is part of the circle; one that hands on alone is not.
    let user = ("", "mod a;\nuse a::A;\npub struct Root(A);");
    assert_eq!(of(&[user, ("a", "use super::Root;")]), [2]);
    assert_eq!(of(&[root, ("a", "use super::B;"), ("b", "pub struct B;")]), [0; 0]);
    // Tests and comments tie nothing.
    let tested = "pub struct B; // super::A\n#[cfg(test)]\nmod tests {\n use crate::A;\n}";
    assert_eq!(of(&[root, ("a", "use super::B;"), ("b", tested)]), [0; 0]);
}
