//! Source: the contract of the command line: bad input ends with exit code 2 and one clear message on stderr.
//! Goal: malformed scenes, unknown names and grids that do not fit are refused by every command that would compute,
//!   with file, line and the reason, before anything is written or printed.
//! Data: shipped scenes with one edit each, and a table of inputs of the worst kinds, counted with their exit codes.

use std::collections::BTreeMap;
use std::process::Output;
use std::time::{Duration, Instant};

use crate::program::{Folder, code, stderr, stdout, sweep};
use crate::shipped::{edited, text};

/// What is wrong with a refusal; `place` must stand in the one message, with each of the phrases.
fn faults(output: &Output, place: &str, phrases: &[&str]) -> Vec<String> {
    let message = stderr(output);
    let mut faults = Vec::new();
    let mut expect = |holds: bool, what: String| {
        if !holds {
            faults.push(what);
        }
    };
    expect(code(output) == 2, format!("exit code {}", code(output)));
    expect(output.stdout.is_empty(), format!("on stdout: {}", stdout(output)));
    // codespan begins each message with `error:`, others have one line and a way out.
    let messages = message.matches("error: ").count();
    expect(messages <= 1 && !message.trim().is_empty(), format!("{messages} messages"));
    expect(!message.contains("panicked"), "a panic".into());
    for phrase in phrases.iter().chain([&place]) {
        expect(message.contains(phrase), format!("no `{phrase}` in: {message}"));
    }
    faults
}

fn line_of(text: &str, key: &str) -> usize {
    let at = text.find(key).unwrap_or_else(|| panic!("no `{key}`"));
    1 + text[..at].matches('\n').count()
}

/// A malformed scene, the line at which its message points, and what it says.
struct Malformed {
    name: &'static str,
    text: String,
    line: usize,
    phrases: &'static [&'static str],
}

impl Malformed {
    /// A shipped scene with an edit, at whose first line the message points.
    fn new(
        name: &'static str,
        scene: &str,
        [from, to]: [&str; 2],
        phrases: &'static [&'static str],
    ) -> Self {
        let sound = text(scene);
        let (text, line) = (edited(&sound, from, to), line_of(&sound, from));
        Self { name, text, line, phrases }
    }

    /// The same with a message that points elsewhere.
    fn at(self, key: &str) -> Self {
        Self { line: line_of(&self.text, key), ..self }
    }
}

/// One of each stage of reading; crates/scene/tests/scene/malformed.rs has the messages one by one.
fn malformed() -> Vec<Malformed> {
    let new = Malformed::new;
    let [uniform, slope] =
        ["grid = { kind = \"uniform\" }\n", "slope_before = 0.0, slope_after = 0.0"];
    let time = format!("[time]\nhorizon = 1.0\n{uniform}");
    let predicts =
        "[[predicts]]\nnorm = \"V_max\"\nvariable = \"h\"\norder = 1.0\nwhy = \"(5.26)\"\n";
    let steep = "[0.0, 0.0], [0.04, 0.08], [0.05, -0.02]]";
    // Nothing of a missing part can be underlined: the message points at the end of the file.
    let missing = new("missing-part", "punch", [&time, ""], &["[time] is missing"]);
    let line = missing.text.lines().count();
    vec![
        Malformed { line, ..missing },
        new("unknown-key", "punch", ["gap = ", "gpa = "], &["unknown key `gpa`", "`gap`"]),
        new(
            "negative-lame",
            "punch",
            ["mu_L = 1.0", "mu_L = -1.0"],
            &["mu_L = -1", "not positive"],
        ),
        new(
            "not-small",
            "punch",
            ["[0.0, 0.0], [0.04, 0.08], [0.10, 0.05]]", steep],
            &["(2.9)", "alpha_nu", "m_A"],
        ),
        new(
            "negative-multiplier",
            "affine-locked",
            ["multiplier = \"t\"", "multiplier = \"-t\""],
            &["must not be negative"],
        ),
        new(
            "multiplier-off-contact",
            "affine",
            ["[exact.define]", "multiplier = \"t\"\n[exact.define]"],
            &["multiplier", "below g"],
        ),
        new("beyond-the-gap", "affine", ["a = \"0.08*t", "a = \"0.12*t"], &["u_nu <= g"])
            .at("u = ["),
        new("not-clamped", "affine", ["\"b*(1 - y)\"", "\"b*(1 - 0.9*y)\""], &["clamped side"]),
        new(
            "judged-by-nothing",
            "steady",
            [predicts, ""],
            &["predicts nothing", "add [[predicts]]", "judge = false"],
        )
        .at("[scene]"),
        new(
            "no-number",
            "punch",
            [slope, "slope_before = nan, slope_after = 0.0"],
            &["not finite"],
        ),
    ]
}

#[test]
fn malformed_scenes_are_refused_with_their_place() {
    let folder = Folder::new("bad-input");
    let mut wrong = Vec::new();
    for Malformed { name, text, line, phrases } in malformed() {
        let file = format!("{name}.toml");
        let path = folder.file(&file, &text);
        let place = format!("{file}:{line}:");
        let (out, vtu) = (folder.argument("out"), folder.argument("vtu"));
        let commands: [&[&str]; 4] = [
            &["run", &path, "--out", &out],
            &["gate", &path, "--out", &out],
            &["solve", &path, "--n", "4", "--steps", "4", "--vtu", &vtu],
            &["check", &path],
        ];
        for arguments in commands {
            let found = faults(&sweep(arguments), &place, phrases);
            wrong.extend(found.into_iter().map(|what| format!("{} {name}: {what}", arguments[0])));
        }
        assert!(!folder.at("out").exists() && !folder.at("vtu").exists(), "{name} left files");
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The judge of refusals above refuses what is none.
#[test]
fn a_sound_scene_is_no_refusal() {
    let folder = Folder::new("sound");
    let path = folder
        .file("sound.toml", &edited(&text("affine"), "name = \"affine\"", "name = \"sound\""));
    let output = sweep(&["solve", &path, "--n", "4", "--steps", "4"]);
    let found = faults(&output, "sound.toml:1:", &["unknown key"]);
    // Exit code, stdout, no message, no place, no phrase.
    assert_eq!(found.len(), 5, "{found:?}");
}

#[test]
fn files_and_names_that_are_no_scene() {
    let folder = Folder::new("no-scene");
    let empty = folder.file("empty.toml", "");
    let remark = folder.file("remark.toml", "# nothing but a remark\n\n");
    let broken = folder.file("broken.toml", "[scene\nname = \"x\"\n");
    let missing = folder.argument("missing.toml");
    let out = folder.argument("out");
    let cases: [(&str, &str, &[&str]); 6] = [
        (&empty, "empty.toml", &["is empty"]),
        (&remark, "remark.toml", &["is empty"]),
        (&broken, "broken.toml:1:", &["not TOML"]),
        (&missing, "missing.toml", &["cannot read"]),
        ("pure-mld", "pure-mld", &["no scene is called", "`pure-mild`"]),
        ("zzzzzz", "zzzzzz", &["no scene is called", "known: "]),
    ];
    for (scene, place, phrases) in cases {
        for arguments in [
            vec!["run", scene, "--out", &out],
            vec!["run", "affine", scene, "--out", &out],
            vec!["solve", scene, "--n", "4", "--steps", "4"],
            vec!["check", scene],
        ] {
            let found = faults(&sweep(&arguments), place, phrases);
            assert!(found.is_empty(), "{arguments:?}: {found:?}");
        }
    }
    assert!(!folder.at("out").exists());
}

#[test]
fn grids_that_do_not_fit() {
    let folder = Folder::new("grids");
    let half = edited(&text("viscoelastic"), "size = [1.0, 1.0]", "size = [1.0, 0.5]");
    let half = half.replace("(1 - y)", "(1 - 2*y)").replace("(1 - y^2)", "(1 - 4*y^2)");
    let half = folder.file("half.toml", &half);
    let out = folder.argument("out");
    let cases: [(&str, &[&str], &str, &[&str]); 5] = [
        (&half, &["--n", "3"], "half.toml:", &["n = 3 does not divide side 0.5"]),
        ("punch", &["--n", "24"], "punch.toml:", &["128", "n = 24"]),
        ("punch", &["--steps", "24"], "punch.toml:", &["64", "steps = 24"]),
        ("affine", &["--n", "0"], "--n", &["0"]),
        ("affine", &["--steps", "-4"], "-4", &[]),
    ];
    for (scene, grid, place, phrases) in cases {
        let mut arguments = vec!["run", scene, "--out", &out];
        arguments.extend(grid);
        let found = faults(&sweep(&arguments), place, phrases);
        assert!(found.is_empty(), "{arguments:?}: {found:?}");
    }
    let found =
        faults(&sweep(&["solve", &half, "--n", "5", "--steps", "4"]), "half.toml:", &["n = 5"]);
    assert!(found.is_empty(), "{found:?}");
    // One step of prony is too long for (3.4) and beyond: what `run` refuses is neither sound nor a fault of a solver.
    let verify = ["verify", "prony", "--solver", "true", "--out", &out, "--steps", "1"];
    for arguments in [
        &["run", "prony", "--steps", "1", "--out", &out][..],
        &["check", "prony", "--steps", "1"],
        &verify,
    ] {
        let found =
            faults(&sweep(arguments), "N = 1", &["one solution per step is guaranteed only"]);
        assert!(found.is_empty(), "{arguments:?}: {found:?}");
    }
    let same = sweep(&["run", "affine", "affine", "--out", &out]);
    let found = faults(&same, "affine", &["two scenes are called", "rename one"]);
    assert!(found.is_empty(), "{found:?}");
    let nowhere =
        sweep(&["verify", "prony", "--results", &folder.argument("nowhere"), "--out", &out]);
    let found = faults(&nowhere, "nowhere", &["no such directory"]);
    assert!(found.is_empty(), "{found:?}");
    assert!(!folder.at("out").exists());
}

#[test]
fn tables_that_cannot_be_fitted() {
    let folder = Folder::new("tables");
    let cases = [
        ("no-error.csv", "h,k\n0.1,0.2\n", "no column of errors"),
        ("no-steps.csv", "error\n0.1\n", "--ratio 2"),
        ("no-rows.csv", "h,error\n", "no table"),
        (
            "no-number.csv",
            "h,error\n0.1,0.2\n0.05,much\n",
            "no-number.csv:3: error = `much` is not a number",
        ),
        ("one-h.csv", "h,error\n0.1,0.2\n", "nothing to fit"),
        (
            "twice.csv",
            "h,error\n0.1,0.2\n0.1,0.3\n",
            "twice.csv:3: the level of line 2 comes again: --runs",
        ),
        ("logs.csv", "h,log10_error\n0.1,-2\n0.05,-2.6\n", "holds logarithms"),
        ("torn.csv", "h,error\n0.1,0.2\n0.05\n", "torn.csv:3: 1 field"),
        ("commas.txt", "h error\n1,234 1\n", "commas.txt:2: `1,234` may be 1234 or 1.234"),
        ("time.csv", "dt,error\n0.1,1\n0.05,0.5\n", "write --q"),
    ];
    for (name, table, phrase) in cases {
        let path = folder.file(name, table);
        let aim: &[&str] = if name == "time.csv" { &["--p", "1"] } else { &[] };
        let found = faults(&sweep(&[&["fit", &path], aim].concat()), name, &[phrase]);
        assert!(found.is_empty(), "{name}: {found:?}");
    }
    let sound = "h,error\n0.1,1\n0.05,0.5\n0.025,0.25\n";
    let table = folder.file("itself.csv", sound);
    for option in ["--svg", "--junit"] {
        let over = sweep(&["fit", &table, "--p", "1", option, &table]);
        let found = faults(&over, "itself.csv", &[option, "overwritten"]);
        assert!(found.is_empty() && folder.read("itself.csv") == sound, "{found:?}");
    }
    let missing = folder.argument("missing.csv");
    let found = faults(&sweep(&["fit", &missing]), "missing.csv", &[]);
    assert!(found.is_empty(), "{found:?}");
    let found = faults(&sweep(&["report", &folder.argument("nowhere")]), "nowhere", &[]);
    assert!(found.is_empty(), "{found:?}");
}

/// The worst a scene file may hold. What a formula may not be: crates/formula/src/tests/language.rs.
fn worst() -> Vec<Malformed> {
    let new = Malformed::new;
    let affine = |name, to: &str, phrases| {
        Malformed::new(name, "affine", ["b = \"0.3*sin(2*t)\"", to], phrases)
    };
    let punch = |name, edit: [&str; 2], phrases| Malformed::new(name, "punch", edit, phrases);
    let lists = format!("gap = {}{}", "[".repeat(5000), "]".repeat(5000));
    let also = |line: &str| format!("{line}\nb = \"0.3*sin(2*t)\"");
    let modulus = |name, number: &str, phrases| {
        punch(name, ["mu_L = 1.0", &format!("mu_L = {number}")], phrases)
    };
    let mut all = vec![
        // Deep nesting.
        punch("deep-lists", ["gap = \"0.10\"", &lists], &["not TOML"]),
        // Huge numbers, and what is no number.
        modulus("huge-modulus", "1e400", &["overflow"]),
        modulus("huge-whole", "99999999999999999999", &["99999999999999999999"]),
        modulus("stiff", "1e300", &["1e-152 to 1e152"]).at("[material]"),
        modulus("nan", "nan", &["NaN", "not finite"]),
        punch("infinite-time", ["horizon = 1.0", "horizon = inf"], &["inf", "not finite"]),
        // Unicode.
        affine("greek-key", &also("β = \"3\""), &["not TOML"]),
        affine("right-to-left", "b = \"t\u{202e}\"", &["has no meaning"]),
        affine("cyrillic-t", "b = \"0.3*т\"", &["unknown name `т`"]),
        affine("nul", "b = \"0.3\\u0000\"", &["has no meaning"]),
        affine("full-width", "b = \"０.３*t\"", &["has no meaning"]),
        // Singular at a point of a rule: point and time are named.
        affine("singular-in-time", "b = \"0.3/(t - 0.5)\"", &["NaN at (0, 1)", "t = 0.5"])
            .at("u = ["),
        punch(
            "singular-at-corner",
            ["\"-3*t*x\"", "\"-3*log(x - 0.3)\""],
            &["the load is NaN at x = 0, y = 0, t = 0"],
        ),
    ];
    let grids: [(&str, &str, &str, &[&str]); 4] = [
        ("n-huge", "n", "[99999999]", &["n = 99999999 makes 2.0e16 cells"]),
        ("n-beyond", "n", "[99999999999]", &["not a whole number from 1 to"]),
        ("steps-huge", "steps", "[2000000000]", &["2000000000 is not", "the most time steps"]),
        ("steps-beyond", "steps", "[4294967296]", &["not a whole number from 1 to"]),
    ];
    for (name, key, list, phrases) in grids {
        // `traction = [` ends like `n = [`: the break makes the line one of a kind.
        let scene = text("affine");
        let start = scene.find(&format!("\n{key} = [")).expect("a grid") + 1;
        let old = scene[start..].lines().next().expect("a line");
        let edit = [format!("\n{old}\n"), format!("\n{key} = {list} # {name}\n")];
        all.push(new(name, "affine", edit.each_ref().map(String::as_str), phrases).at(name));
    }
    // `NAME-gronwall-printed-k.svg` would be no name of a file: said before anything is run.
    let long = "a".repeat(250);
    for (name, to, phrases) in [
        ("name-path", "../../etc/passwd", &["cannot name a scene"][..]),
        ("name-empty", "", &["cannot name a scene"]),
        ("name-line", "a\\nb", &["cannot name a scene"]),
        ("name-long", &*long, &["250 characters, cannot name a scene", "at most 200"]),
    ] {
        let named = format!("name = \"{to}\"");
        all.push(new(name, "affine", ["name = \"affine\"", &named], phrases));
    }
    all
}

#[test]
fn the_worst_inputs_are_counted_with_their_exit_codes() {
    let folder = Folder::new("worst");
    let (mut codes, mut wrong) = (BTreeMap::<i32, usize>::new(), Vec::new());
    let mut see = |name: &str, output: Output, place: &str, phrases: &[&str]| {
        *codes.entry(code(&output)).or_default() += 1;
        let found = faults(&output, place, phrases);
        wrong.extend(found.into_iter().map(|what| format!("{name}: {what}")));
    };
    let start = Instant::now();
    for Malformed { name, text, line, phrases } in worst() {
        let file = format!("{name}.toml");
        let path = folder.file(&file, &text);
        see(name, sweep(&["check", &path]), &format!("{file}:{line}:"), phrases);
    }
    // Files that are no scene: 100 MB of nothing, bytes that are no text, a folder.
    let large = std::fs::File::create(folder.at("large.toml")).expect("a file");
    large.set_len(100 << 20).expect("100 MB");
    std::fs::write(folder.at("bytes.toml"), [0xff_u8, 0xfe, 0x00, 0x80]).expect("a file");
    std::fs::create_dir(folder.at("folder.toml")).expect("a folder");
    for (name, phrases) in [
        ("large.toml", ["large", "1 MiB"]),
        ("bytes.toml", ["UTF-8", "byte"]),
        ("folder.toml", ["cannot read", "folder.toml"]),
    ] {
        see(name, sweep(&["check", &folder.argument(name)]), name, &phrases);
        see(name, sweep(&["solve", &folder.argument(name), "--n", "4", "--steps", "4"]), name, &[]);
    }
    // Not finite between the points at which a scene is sampled: only a point of the quadrature meets it.
    let narrow = edited(&text("punch"), "\"-3*t*x\"", "\"-3*t*sqrt((x - 0.29)^2 - 1.6e-5)\"");
    let path = folder.file("narrow.toml", &narrow);
    let output = sweep(&["solve", &path, "--n", "32", "--steps", "4"]);
    see("narrow", output, "punch n = 32", &["NaN", "at (0.2", "t = "]);
    let taken = start.elapsed();
    let tried: usize = codes.values().sum();
    println!("{tried} bad inputs; exit codes {codes:?}; {taken:.1?}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert_eq!(codes.keys().copied().collect::<Vec<_>>(), [2]);
    assert!(tried >= 25, "{tried}");
    // None of them takes a person's patience.
    assert!(taken < Duration::from_secs(300), "{taken:?}");
}
