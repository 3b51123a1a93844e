//! Seeded damage to texts, and the loop that shows damaged texts to a reader.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::{Duration, Instant};

use algebra::linalg::signed_unit;

/// Nothing that is read takes a person's patience: a guard against hanging, which decides nothing else.
const PATIENCE: Duration = Duration::from_secs(60);

/// What replaces a number.
const NUMBERS: [&str; 20] = [
    "0",
    "-0.0",
    "1e308",
    "-1e308",
    "1e-308",
    "5e-324",
    "1e400",
    "nan",
    "inf",
    "-inf",
    "1e",
    "0x10",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551616",
    "4294967296",
    "1_000",
    "0.1.2",
    "00",
    "-1",
];

/// What is put in anywhere.
const WORDS: [&str; 30] = [
    "(", ")", "[", "]", "{", "}", "\"", "'", "\"\"\"", "=", ",", "\n", "\r", "\0", "#", "$End",
    "d(", "if(", "relax(", "sin", "zeta", "x^", "^-1", "/0", "ζ", "\u{202e}", "\u{feff}", "e", "-",
    "[[a]]",
];

/// Seeded damage.
struct Damage<'a> {
    corpus: &'a [String],
    state: u64,
}

impl Damage<'_> {
    /// A number below `bound`, 0 for none.
    fn below(&mut self, bound: usize) -> usize {
        let unit = 0.5 * (1.0 + signed_unit(&mut self.state));
        ((unit * bound as f64) as usize).min(bound.saturating_sub(1))
    }

    fn part(&mut self, length: usize) -> std::ops::Range<usize> {
        let start = self.below(length + 1);
        // Mostly short parts.
        let most = [4, 40, length][self.below(3)];
        start..(start + self.below(most + 1)).min(length)
    }

    fn text(&mut self) -> String {
        let seed_text = self.below(self.corpus.len());
        let mut bytes = self.corpus[seed_text].clone().into_bytes();
        let times = [0, 0, 1, 5][self.below(4)];
        for _ in 0..=self.below(times + 1) {
            let part = self.part(bytes.len());
            match self.below(8) {
                0 if !bytes.is_empty() => {
                    let at = self.below(bytes.len());
                    bytes[at] ^= 1 << self.below(8);
                }
                1 => drop(bytes.drain(part)),
                2 => {
                    let copy = bytes[part.clone()].to_vec();
                    let times = [1, 3, 300][self.below(3)].min(1 + 40_000 / (copy.len() + 1));
                    bytes.splice(part.end..part.end, copy.repeat(times));
                }
                3 => {
                    let other = self.below(self.corpus.len());
                    let from = self.part(self.corpus[other].len());
                    bytes.splice(part, self.corpus[other].as_bytes()[from].to_vec());
                }
                4 | 5 => {
                    let digit = |at: &usize| bytes[*at].is_ascii_digit();
                    let Some(at) = (part.start..bytes.len()).find(digit) else { continue };
                    let ends = |byte: &u8| !(byte.is_ascii_alphanumeric() || b".+-".contains(byte));
                    let length = bytes[at..].iter().position(ends).unwrap_or(bytes.len() - at);
                    let number = NUMBERS[self.below(NUMBERS.len())];
                    bytes.splice(at..at + length, number.bytes());
                }
                6 => {
                    let open = ["(", "[", "-", "sin(", "{a=", "if(x<", "d("][self.below(7)];
                    let deep = open.repeat([1, 30, 5000][self.below(3)]);
                    bytes.splice(part, deep.into_bytes());
                }
                _ => {
                    let word = WORDS[self.below(WORDS.len())];
                    bytes.splice(part.start..part.start, word.bytes());
                }
            }
        }
        String::from_utf8_lossy(&bytes).into_owned()
    }
}

/// How many texts a target is given.
fn runs(few: u64) -> u64 {
    std::env::var("RUNS").map_or(few, |runs| runs.parse().expect("RUNS: a number"))
}

fn seed() -> u64 {
    std::env::var("SEED").map_or(1, |seed| seed.parse().expect("SEED: a number"))
}

/// A target ends after so long, even if texts are left.
fn time() -> Duration {
    let minutes = std::env::var("MINUTES").map(|text| text.parse().expect("MINUTES: a number"));
    Duration::from_secs(minutes.map_or(u64::MAX, |minutes: u64| 60 * minutes))
}

/// What one worker reads, and since when.
type Current = Mutex<Option<(Instant, String)>>;

/// Gives `read` many damaged texts of `corpus`. It answers whether it took the text.
///
/// # Panics
/// With the text that made it panic, or that it did not come to an end with.
pub fn fuzz(target: &str, corpus: &[String], few: u64, read: impl Fn(&str) -> bool + Sync) {
    let (total, time, begun) = (runs(few), time(), Instant::now());
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let current: Vec<Current> = (0..workers).map(|_| Mutex::new(None)).collect();
    let (next, ended) = (AtomicU64::new(0), AtomicU64::new(0));
    let (taken, read_through) = (AtomicU64::new(0), AtomicU64::new(0));
    let found: Mutex<Option<String>> = Mutex::new(None);
    let found_one = || found.lock().expect("the finding").is_some();
    std::thread::scope(|scope| {
        for running in &current {
            let work = || {
                while let Some(run) = Some(next.fetch_add(1, Relaxed)).filter(|&run| run < total) {
                    if found_one() || begun.elapsed() > time {
                        break;
                    }
                    let state = (seed() << 40) ^ run.wrapping_mul(0x9e37_79b9_7f4a_7c15);
                    let text = Damage { corpus, state }.text();
                    *running.lock().expect("the text") = Some((Instant::now(), text.clone()));
                    match catch_unwind(AssertUnwindSafe(|| read(&text))) {
                        Ok(good) => {
                            taken.fetch_add(u64::from(good), Relaxed);
                            read_through.fetch_add(1, Relaxed);
                        }
                        Err(_) => *found.lock().expect("the finding") = Some(text),
                    }
                    *running.lock().expect("the text") = None;
                }
                ended.fetch_add(1, Relaxed);
            };
            // Deep nesting must be refused, not survived by a large stack: that of a second thread, 2 MB.
            scope.spawn(work);
        }
        while ended.load(Relaxed) < workers as u64 {
            std::thread::sleep(Duration::from_millis(20));
            for running in &current {
                if let Some((since, text)) = &*running.lock().expect("the text")
                    && since.elapsed() > PATIENCE
                {
                    eprintln!("{target}: {}", kept(target, text).display());
                    // A thread that hangs cannot be ended in another way.
                    std::process::abort();
                }
            }
        }
    });
    if let Some(text) = found.into_inner().expect("the finding") {
        panic!("{target}: a panic, text in {}", kept(target, &text).display());
    }
    let (taken, total) = (taken.into_inner(), read_through.into_inner());
    println!("{target}: {total} texts, {taken} taken, {:.0} s", begun.elapsed().as_secs_f64());
    // Texts that are all refused, or all taken, test nothing.
    assert!(taken > total / 1000 && taken < total - total / 20, "{target}: {taken} of {total}");
}

/// Where the text of a finding is kept.
fn kept(target: &str, text: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("fuzz-{target}.txt"));
    std::fs::write(&path, text).expect("the text is kept");
    path
}
