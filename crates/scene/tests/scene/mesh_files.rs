//! Meshes as gmsh, meshio and others write them: read, or refused with a reason and a way out that leads to a mesh that is
//! read.

use std::fmt::Write;

use scene::{Scene, SceneError, Source};

/// A square of four triangles around its middle, on sides `bottom`, `right`, `top` and `left`, and what is odd about it.
#[derive(Clone)]
struct Square {
    nodes: Vec<(u64, [f64; 3])>,
    /// Type, group, nodes.
    elements: Vec<(u32, i64, Vec<u64>)>,
    /// Dimension, tag, name.
    names: Vec<(u32, i64, &'static str)>,
    /// Entity of version 4.1 (dimension, tag) with further groups.
    further: Vec<(u32, i64, i64)>,
    header: &'static str,
}

fn square() -> Square {
    let at = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]];
    let line = |(i, ends): (i64, [u64; 2])| (1, i, ends.to_vec());
    let lines = (1..).zip([[1, 2], [2, 3], [3, 4], [4, 1]]).map(line);
    let triangles =
        [[1, 2, 5], [2, 3, 5], [3, 4, 5], [4, 1, 5]].map(|corners| (2, 9, corners.to_vec()));
    Square {
        nodes: (1..).zip(at.map(|[x, y]| [x, y, 0.0])).collect(),
        elements: lines.chain(triangles).collect(),
        names: vec![
            (1, 1, "bottom"),
            (1, 2, "right"),
            (1, 3, "top"),
            (1, 4, "left"),
            (2, 9, "plate"),
        ],
        further: Vec::new(),
        header: "2.2 0 8",
    }
}

fn dimension_of(kind: u32) -> u32 {
    match kind {
        15 => 0,
        1 | 8 => 1,
        _ => 2,
    }
}

impl Square {
    fn with(&self, change: impl Fn(&mut Self)) -> Self {
        let mut square = self.clone();
        change(&mut square);
        square
    }

    fn head(&self, header: &str) -> String {
        let mut text = format!("$MeshFormat\n{header}\n$EndMeshFormat\n");
        let _ = writeln!(text, "$PhysicalNames\n{}", self.names.len());
        self.names.iter().for_each(|(d, tag, name)| _ = writeln!(text, "{d} {tag} \"{name}\""));
        text + "$EndPhysicalNames\n"
    }

    fn two(&self) -> String {
        let mut text = self.head(self.header);
        let _ = writeln!(text, "$Nodes\n{}", self.nodes.len());
        self.nodes.iter().for_each(|(tag, [x, y, z])| _ = writeln!(text, "{tag} {x} {y} {z}"));
        let _ = writeln!(text, "$EndNodes\n$Elements\n{}", self.elements.len());
        for (i, (kind, group, nodes)) in self.elements.iter().enumerate() {
            let nodes: Vec<String> = nodes.iter().map(u64::to_string).collect();
            let _ = writeln!(text, "{} {kind} 2 {group} {group} {}", i + 1, nodes.join(" "));
        }
        text + "$EndElements\n"
    }

    /// An entity a group.
    fn four(&self) -> String {
        let mut entities: Vec<(u32, i64)> = Vec::new();
        for (kind, group, _) in &self.elements {
            let entity = (dimension_of(*kind), *group);
            if !entities.contains(&entity) {
                entities.push(entity);
            }
        }
        entities.sort_unstable();
        let mut text = self.head("4.1 0 8");
        let of = |d: u32| entities.iter().filter(|(of, _)| *of == d).count();
        let _ = writeln!(text, "$Entities\n{} {} {} {}", of(0), of(1), of(2), of(3));
        for (d, tag) in &entities {
            let further: Vec<String> = self
                .further
                .iter()
                .filter(|(of, entity, _)| (of, entity) == (d, tag))
                .map(|(_, _, group)| format!(" {group}"))
                .collect();
            let groups = if *tag == 0 {
                "0".into()
            } else {
                format!("{} {tag}{}", 1 + further.len(), further.join(""))
            };
            let place = if *d == 0 { "0 0 0" } else { "0 0 0 1 1 0" };
            let bounds = if *d == 0 { "" } else { " 0" };
            let _ = writeln!(text, "{tag} {place} {groups}{bounds}");
        }
        let last = self.nodes.iter().map(|(tag, _)| *tag).max().unwrap_or(0);
        let _ = writeln!(text, "$EndEntities\n$Nodes\n1 {0} 1 {last}\n2 9 0 {0}", self.nodes.len());
        self.nodes.iter().for_each(|(tag, _)| _ = writeln!(text, "{tag}"));
        self.nodes.iter().for_each(|(_, [x, y, z])| _ = writeln!(text, "{x} {y} {z}"));
        let count = self.elements.len();
        let _ = writeln!(text, "$EndNodes\n$Elements\n{count} {count} 1 {count}");
        for (i, (kind, group, nodes)) in self.elements.iter().enumerate() {
            let nodes: Vec<String> = nodes.iter().map(u64::to_string).collect();
            let _ = writeln!(
                text,
                "{} {group} {kind} 1\n{} {}",
                dimension_of(*kind),
                i + 1,
                nodes.join(" ")
            );
        }
        text + "$EndElements\n"
    }
}

const SIDES: &str = "clamped = [\"top\"]\ntraction = [\"left\", \"right\", \"bottom\"]";

fn read(sides: &str, mesh: &str) -> Result<Scene, SceneError> {
    let text = format!(
        "[scene]\nname = \"square\"\nquestion = \"Is the mesh read?\"\ndimension = 2\njudge = false\n[domain]\nshape = \"mesh\"\nfile = \"square.msh\"\n{sides}\n[time]\nhorizon = 1.0\n[material]\nlambda = 1.0\nmu_L = 1.0\n[loads]\nbody = [\"0\", \"-t\"]\n"
    );
    Scene::from_source(Source::from_text("square.toml", text).with_mesh(mesh.to_owned()))
}

#[track_caller]
fn taken(sides: &str, mesh: &str) -> Scene {
    let scene = read(sides, mesh).unwrap_or_else(|error| panic!("{error}\n{mesh}"));
    let domain = &scene.as_contact().expect("a body").domain;
    assert!((domain.measure() - 1.0).abs() < 1e-9 && domain.mesh(2).cell_count() == 16, "{mesh}");
    scene
}

/// Refused with these words; what the hint says leads to a mesh that is read.
#[track_caller]
fn refused(sides: &str, mesh: &str, said: &[&str], mended: (&str, &str)) {
    let error = read(sides, mesh).err().unwrap_or_else(|| panic!("taken:\n{mesh}")).to_string();
    said.iter().for_each(|said| assert!(error.contains(said), "`{said}` is not said:\n{error}"));
    taken(mended.0, mended.1);
}

#[test]
fn meshes_with_the_traits_of_their_writers_are_read() {
    let plain = square();
    for text in [plain.two(), plain.four()] {
        let scene = taken(SIDES, &text);
        let domain = &scene.as_contact().unwrap().domain;
        assert_eq!(domain.sides, ["bottom", "right", "top", "left"].map(String::from));
        // Words on any lines, any white space, marks and comments of editors.
        taken(SIDES, &text.replace('\n', "\r\n"));
        taken(SIDES, &format!("\u{feff}{text}"));
        taken(SIDES, &format!("$Comments\nmade $by hand\n$EndComments\n{text}"));
    }
    // A group inside, points with groups, nodes that no cell uses, off the plane too.
    let seam = plain.with(|s| {
        s.elements.insert(0, (1, 6, vec![1, 5]));
        s.elements.insert(0, (15, 7, vec![1]));
        s.names.extend([(1, 6, "seam"), (0, 7, "corner")]);
        s.nodes.push((99, [0.3, 0.3, 4.0]));
    });
    for text in [seam.two(), seam.four()] {
        let scene = taken(SIDES, &text);
        let domain = &scene.as_contact().unwrap().domain;
        assert_eq!((domain.inner_groups(), domain.sides.len()), (&["seam".to_owned()][..], 4));
    }
    // One name for a curve and a surface, with a blank.
    let same = plain.with(|s| {
        (s.names[2].2, s.names[4].2) = ("the top", "the top");
    });
    taken(&SIDES.replace("\"top\"", "\"the top\""), &same.two());
    // Clockwise cells, edges in any sense, large numbers, groups without names.
    let odd = plain.with(|s| {
        s.elements.iter_mut().for_each(|(_, _, nodes)| nodes.reverse());
        s.nodes.iter_mut().for_each(|(tag, _)| *tag += 1_000_000_000_000);
        s.elements.iter_mut().for_each(|(_, group, nodes)| {
            *group += 9_000_000;
            nodes.iter_mut().for_each(|node| *node += 1_000_000_000_000);
        });
        s.names.clear();
    });
    let numbered = "clamped = [\"9000003\"]\nrest = \"traction\"";
    taken(numbered, &odd.two());
    taken(numbered, &odd.four());
    // A plane z = const, to the digits of a file; version 2 of old writers.
    let lifted = plain.with(|s| {
        (0..)
            .zip(&mut s.nodes)
            .for_each(|(i, (_, at))| at[2] = -0.25 + f64::from(i % 3 - 1) * 1e-11);
        s.header = "2 0 8";
    });
    taken(SIDES, &lifted.two());
}

#[test]
fn edges_without_a_group_are_the_rest() {
    let open = square().with(|s| drop(s.elements.remove(1)));
    let sides = "clamped = [\"top\"]\ntraction = [\"left\", \"bottom\"]";
    let by_name = sides.replace("\"bottom\"", "\"bottom\", \"rest\"");
    let said = ["no condition on the side rest", "without a group", "rest = \"traction\""];
    let by_key = "clamped = [\"top\"]\nrest = \"traction\"";
    for text in [open.two(), open.four()] {
        refused(sides, &text, &said, (&by_name, &text));
        let scene = taken(by_key, &text);
        assert_eq!(scene.as_contact().unwrap().domain.traction.len(), 3);
    }
    // A group of that name is one like others.
    let named = open.with(|s| s.names[0].2 = "rest");
    let sides = "clamped = [\"top\"]\ntraction = [\"left\", \"rest\"]";
    let whole = square().with(|s| s.names[0].2 = "rest").two();
    let all = sides.replace("\"rest\"", "\"rest\", \"right\"");
    refused(sides, &named.two(), &["belongs to no side", "physical group"], (&all, &whole));
    let error =
        read("clamped = [\"top\"]\nrest = \"contact\"", &open.two()).unwrap_err().to_string();
    assert!(error.contains("traction"), "{error}");
}

#[test]
fn what_is_refused_has_a_way_out_that_works() {
    let (plain, sound) = (square(), square().two());
    let mended = (SIDES, sound.as_str());
    let seam = plain.with(|s| {
        s.elements.push((1, 6, vec![1, 5]));
        s.names.push((1, 6, "seam"));
    });
    let listed = SIDES.replace("\"left\"", "\"left\", \"seam\"");
    refused(
        &listed,
        &seam.two(),
        &["the group `seam`", "take it out of the list"],
        (SIDES, &seam.two()),
    );
    let mixed = plain.with(|s| s.elements.push((1, 1, vec![1, 5])));
    refused(
        SIDES,
        &mixed.two(),
        &["`bottom`", "does not bound the domain", "out of the group"],
        mended,
    );
    let twice = plain.with(|s| {
        s.names.push((1, 8, "lid"));
        s.further.push((1, 3, 8));
    });
    let said = ["the curve 3", "`top` and `lid`", "leave it in one group"];
    refused(SIDES, &twice.four(), &said, (SIDES, &plain.four()));
    let twice = twice.with(|s| s.elements.push((1, 8, vec![3, 4])));
    refused(
        SIDES,
        &twice.two(),
        &["named twice", "`top` and by `lid`", "leave it in one group"],
        mended,
    );
    let again = plain.with(|s| s.elements.push((2, 10, vec![1, 2, 5])));
    refused(SIDES, &again.two(), &["the same side", "stands there twice"], mended);
    let quads = plain.with(|s| {
        s.elements.truncate(4);
        s.elements.push((3, 9, vec![1, 2, 3, 4]));
    });
    refused(SIDES, &quads.two(), &["quadrangle", "without Recombine"], mended);
    refused(SIDES, &quads.four(), &["quadrangle", "without Recombine"], mended);
    let curved = plain.with(|s| s.elements.insert(0, (8, 1, vec![1, 2, 5])));
    refused(SIDES, &curved.two(), &["line of order 2", "-order 1"], mended);
    let tilted = plain.with(|s| s.nodes[2].1[2] = 0.5);
    refused(SIDES, &tilted.two(), &["node 3 has z = 0.5", "plane z = const"], mended);
    let alone = plain.with(|s| s.elements.truncate(4));
    refused(SIDES, &alone.two(), &["neither triangles nor tetrahedra", "give the surface"], mended);
    // The upper half with nodes of its own on the line between: a crack, and a part for itself.
    let cracked = plain.with(|s| {
        s.nodes.push((6, [0.5, 0.5, 0.0]));
        s.elements[6].2 = vec![3, 4, 6];
    });
    refused(SIDES, &cracked.two(), &["hangs on the edge", "remove duplicate nodes"], mended);
    let header = |header: &str| sound.replace("2.2 0 8", header);
    refused(SIDES, &header("2.2 1 8"), &["the file is binary", "binary=False"], mended);
    refused(SIDES, &header("4 0 8"), &["version 4", "-format msh41"], mended);
    let bare = plain.four();
    let (from, to) = (bare.find("$Entities").unwrap(), bare.find("$Nodes").unwrap());
    let bare = format!("{}{}", &bare[..from], &bare[to..]);
    refused(SIDES, &bare, &["no part $Entities", "gmsh22"], mended);
    let parts = sound.replace("$Nodes", "$PartitionedEntities\n0\n$EndPartitionedEntities\n$Nodes");
    refused(SIDES, &parts, &["partitions"], mended);
    let same = plain.with(|s| s.names[1].2 = "top");
    refused(SIDES, &same.two(), &["the name `top` stands for two groups, 2 and 3"], mended);
    refused(SIDES, &sound[..sound.len() / 2], &["the file ends", "export it again"], mended);
}

/// Bytes as gmsh writes them with `-bin`.
#[test]
fn a_binary_file_is_told_from_other_bytes() {
    let folder = std::env::temp_dir().join(format!("gronwall-mesh-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let scene = folder.join("square.toml");
    std::fs::write(&scene, "[scene]\nname = \"square\"\nquestion = \"?\"\ndimension = 2\n[domain]\nshape = \"mesh\"\nfile = \"square.msh\"\n").unwrap();
    let mut said = Vec::new();
    for head in [&b"$MeshFormat\n4.1 1 8\n\x01\x00\x00\x00\xff"[..], b"$MeshFormat\n2.2 0 8\n\xe9"]
    {
        std::fs::write(folder.join("square.msh"), head).unwrap();
        said.push(Scene::read(&scene).unwrap_err().to_string());
    }
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(
        said[0].contains("the file is binary") && said[0].contains("save as ASCII"),
        "{}",
        said[0]
    );
    assert!(said[1].contains("byte 20 is not text") && said[1].contains("UTF-8"), "{}", said[1]);
}
