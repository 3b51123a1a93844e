//! Compresses the output of the drawing library, and sets scripts low and high.
//!
//! The library writes one element per line, and a text on three. Consecutive lines of one style become one path: a
//! dashed line has as many elements as strokes.

pub(super) fn compact(svg: &str) -> String {
    let mut out = String::with_capacity(svg.len() / 2);
    let mut path: Option<(String, String)> = None;
    let mut lines = svg.lines();
    while let Some(line) = lines.next() {
        if let Some((style, points)) = polyline(line) {
            match &mut path {
                Some((open_style, data)) if open_style == style => data.push_str(&moves(points)),
                _ => {
                    finish(&mut out, path.take());
                    path = Some((style.to_owned(), moves(points)));
                }
            }
            continue;
        }
        finish(&mut out, path.take());
        if line.starts_with("<text ") {
            let words = lines.next().unwrap_or_default();
            // Its end tag.
            lines.next();
            out += &format!("{}{}</text>\n", plain(line), scripted(words, size(line)));
        } else if line.starts_with("<svg ") {
            out += &line.replacen("<svg ", "<svg font-family=\"sans-serif\" ", 1);
            out.push('\n');
        } else {
            out += &plain(line);
            out.push('\n');
        }
    }
    finish(&mut out, path);
    out
}

fn finish(out: &mut String, path: Option<(String, String)>) {
    if let Some((style, data)) = path {
        *out += &format!("<path fill=\"none\" {style}d=\"{data}\"/>\n");
    }
}

/// Style and points of an opaque line.
fn polyline(line: &str) -> Option<(&str, &str)> {
    let rest = line.strip_prefix("<polyline fill=\"none\" opacity=\"1\" ")?;
    let (style, points) = rest.split_once("points=\"")?;
    Some((style, points.strip_suffix(" \"/>")?))
}

/// `M1 2L3 4`: from the first point through the others.
fn moves(points: &str) -> String {
    let mut letter = 'M';
    let mut data = String::new();
    for point in points.split(' ') {
        data.push(letter);
        data += &point.replacen(',', " ", 1);
        letter = 'L';
    }
    data
}

/// Drops attributes with default values.
fn plain(line: &str) -> String {
    let said_for_nothing = [
        " opacity=\"1\"",
        " stroke=\"none\"",
        " font-family=\"sans-serif\"",
        " text-anchor=\"start\"",
    ];
    said_for_nothing.into_iter().fold(line.to_owned(), |text, part| text.replacen(part, "", 1))
}

fn size(line: &str) -> f64 {
    let from = |rest: &str| rest.split('"').next().and_then(|text| text.parse().ok());
    line.split_once("font-size=\"").and_then(|(_, rest)| from(rest)).unwrap_or(0.0)
}

/// Scripts are this much smaller, and this much lower or higher.
const SMALLER: f64 = 0.72;
const APART: f64 = 0.3;

/// Sets `x_ab` and `x^ab` as scripts: after a single letter (longer words are names), a bar or a bracket. `Γ3` is Γ
/// with a low 3.
fn scripted(words: &str, size: f64) -> String {
    let characters: Vec<char> = words.chars().collect();
    let (mut out, mut at) = (String::new(), 0);
    while at < characters.len() {
        match script(&characters, at) {
            Some(Script { from, to, end, down }) => {
                let inside: String = characters[from..to].iter().collect();
                let (sign, shift) = (if down { 1.0 } else { -1.0 }, (APART * size).round());
                let there = sign * shift;
                let back = if end == characters.len() {
                    String::new()
                } else {
                    // The rest of the words returns to the baseline; an entity is one sign.
                    let entity = characters[end..].iter().position(|c| *c == ';');
                    let length = entity.filter(|_| characters[end] == '&').map_or(1, |at| at + 1);
                    at = end + length;
                    let next: String = characters[end..at].iter().collect();
                    format!("<tspan dy=\"{}\">{next}</tspan>", -there)
                };
                out += &format!(
                    "<tspan dy=\"{there}\" font-size=\"{}\">{inside}</tspan>{back}",
                    (SMALLER * size).round()
                );
                at = at.max(end);
            }
            None => {
                out.push(characters[at]);
                at += 1;
            }
        }
    }
    out
}

/// A script: its signs, and the position after it.
struct Script {
    from: usize,
    to: usize,
    end: usize,
    down: bool,
}

/// The script that begins here, if any.
fn script(characters: &[char], at: usize) -> Option<Script> {
    let before = |back: usize| at.checked_sub(back).map(|i| characters[i]);
    let base = before(1)?;
    let alone = before(2).is_none_or(|c| !c.is_alphanumeric() && !"_-.".contains(c));
    let opens = characters[at];
    let skip = match opens {
        '_' | '^' if base.is_alphabetic() && alone || "‖|)]".contains(base) => 1,
        '1'..='4' if base == 'Γ' => 0,
        _ => return None,
    };
    let down = opens != '^';
    if characters.get(at + 1) == Some(&'{') {
        let to = at + characters[at..].iter().position(|c| *c == '}')?;
        return Some(Script { from: at + 2, to, end: to + 1, down });
    }
    let from = at + skip;
    // A power behind an index is not part of it.
    let belongs = |c: &&char| c.is_alphanumeric() && **c != '²';
    let end = from + characters[from..].iter().take_while(belongs).count();
    // A name of several parts is not a symbol.
    let named = characters.get(end).is_some_and(|c| *c == '_');
    (end > from && !named).then_some(Script { from, to: end, end, down })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_one_style_are_one_path() {
        let line = |ink: &str, points: &str| {
            format!(
                "<polyline fill=\"none\" opacity=\"1\" stroke=\"{ink}\" points=\"{points} \"/>\n"
            )
        };
        let svg =
            [line("#A", "1,2 3,4"), line("#A", "5,6 7,8 9,9"), line("#B", "0,0 1,1")].concat();
        assert_eq!(
            compact(&svg),
            "<path fill=\"none\" stroke=\"#A\" d=\"M1 2L3 4M5 6L7 8L9 9\"/>\n\
             <path fill=\"none\" stroke=\"#B\" d=\"M0 0L1 1\"/>\n"
        );
        // Elements between two lines keep their order, and transparent lines stay.
        let between = [line("#A", "1,2 3,4"), "<circle cx=\"1\" opacity=\"1\"/>\n".into()].concat();
        let text = compact(&format!("{between}{}", line("#A", "5,6 7,8")));
        assert_eq!(text.matches("<path").count(), 2);
        assert!(text.contains("/>\n<circle cx=\"1\"/>\n<path"));
        let seen_through = line("#A", "1,2 3,4").replace("opacity=\"1\"", "opacity=\"0.3\"");
        assert_eq!(compact(&seen_through), seen_through);
    }

    #[test]
    fn symbols_have_scripts_and_names_have_none() {
        let set = |words: &str| scripted(words, 100.0);
        assert_eq!(set("u_ν"), "u<tspan dy=\"30\" font-size=\"72\">ν</tspan>");
        assert_eq!(
            set("max ‖u_ν−u_hν‖ on Γ3"),
            "max ‖u<tspan dy=\"30\" font-size=\"72\">ν</tspan><tspan dy=\"-30\">−</tspan>\
             u<tspan dy=\"30\" font-size=\"72\">hν</tspan><tspan dy=\"-30\">‖</tspan> on \
             Γ<tspan dy=\"30\" font-size=\"72\">3</tspan>"
        );
        assert!(
            set("E_{φ1}² ≤").starts_with("E<tspan dy=\"30\" font-size=\"72\">φ1</tspan><tspan")
        );
        assert_eq!(set("c_j²").matches('j').count(), 1);
        assert!(set("c_j²").contains(">j</tspan>"));
        // Entities stay whole.
        assert!(set("u_ν&lt;g").ends_with("<tspan dy=\"-30\">&lt;</tspan>g"));
        assert!(set("σ^D and h").starts_with("σ<tspan dy=\"-30\" font-size=\"72\">D</tspan>"));
        for name in ["trace_L2_max", "V_projection_max", "a-b_c", "10⁻³", "u_", "_a", "Γ", "m0"]
        {
            assert_eq!(set(name), name);
        }
        let text =
            "<text x=\"1\" text-anchor=\"start\" font-size=\"33\" opacity=\"1\">\nu_h\n</text>\n";
        assert_eq!(
            compact(text),
            "<text x=\"1\" font-size=\"33\">u<tspan dy=\"10\" font-size=\"24\">h</tspan></text>\n"
        );
    }
}
