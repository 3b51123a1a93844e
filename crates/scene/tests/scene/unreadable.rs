//! Positions of messages inside formulas; files that hold no scene; randomly damaged texts.

use std::path::Path;

use super::good::{EXACT, LOADED, refused};
use scene::{Scene, Source};

#[test]
fn formulas_are_pointed_into() {
    let basic = refused(&EXACT.replace("'-a*(1 - y)'", r#""-a*(1 - w)""#));
    assert_eq!(&basic.text[basic.span.clone()], "w");
    let escaped = refused(&EXACT.replace("'-a*(1 - y)'", r#""-a*(1 \u002d w)""#));
    assert_eq!(&escaped.text[escaped.span.clone()], r#""-a*(1 \u002d w)""#);
    let long = refused(&EXACT.replace("'-a*(1 - y)'", "'''\n-a*(1\n  - w)'''"));
    assert_eq!((long.line(), long.column()), (21, 5));
}

#[test]
fn files_that_hold_no_scene() {
    let folder = std::env::temp_dir().join(format!("gronwall-malformed-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let read = |name: &str, bytes: &[u8]| {
        std::fs::write(folder.join(name), bytes).unwrap();
        Scene::read(&folder.join(name)).unwrap_err().to_string()
    };
    let empty = read("empty.toml", b"# only a remark\n\n");
    let latin = read("latin.toml", b"[scene]\nname = \"caf\xe9\"\n");
    let large = read("large.toml", &vec![b'#'; (1 << 20) + 1]);
    let missing = Scene::read(Path::new("/nowhere/scene.toml")).unwrap_err().to_string();
    let directory = Scene::read(&folder).unwrap_err().to_string();
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(empty.contains("is empty") && empty.contains("sweep list affine --text"), "{empty}");
    assert!(
        latin.contains("byte 0xe9 is not UTF-8") && latin.contains("latin.toml:2:12"),
        "{latin}"
    );
    assert!(large.contains("larger than 1 MiB"), "{large}");
    assert!(missing.contains("cannot read /nowhere/scene.toml"), "{missing}");
    assert!(directory.contains("cannot read"), "{directory}");
}

/// No prefix of a valid scene, and no scene with one byte replaced, makes the reader panic.
#[test]
fn nothing_panics() {
    for good in [LOADED, EXACT] {
        for end in (0..good.len()).step_by(7) {
            drop(Scene::from_source(Source::from_text("prefix.toml", &good[..end])));
        }
        for (at, wrong) in (0..good.len()).step_by(11).zip("\"'[]{}=.,#\n-9x".chars().cycle()) {
            let edited = format!("{}{wrong}{}", &good[..at], &good[at + 1..]);
            if let Err(error) = Scene::from_source(Source::from_text("edited.toml", edited)) {
                assert!(!error.to_string().is_empty());
            }
        }
    }
}
