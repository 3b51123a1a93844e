//! `[[predicts]]`: the orders that the theory promises, with their theorems.

use super::diagnostic::Result;
use super::heading::name_in;
use super::reading::Reading;
use super::spans::join;
use fem::norms::ContactState;

/// A quantity in which errors are measured; names as in `cases.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Norm {
    /// max over n of ‖ε(u_n - u_n^{kh})‖, the paper's.
    VMax,
    L2Max,
    TraceL2Max,
    PressureL2Max,
    StressL2Max,
    ContactSetMax,
    VTimeMax,
    VProjectionMax,
    /// u_ν on the part of Γ3 where the exact solution is in a state.
    TraceMax(ContactState),
    /// ξ + λ on that part.
    PressureMax(ContactState),
    /// Measure of the symmetric difference of the locked sets.
    ContactMeasureMax,
}

impl serde::Serialize for Norm {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl Norm {
    /// Whether it needs pressures.
    pub fn wants_pressure(self) -> bool {
        matches!(self, Norm::PressureL2Max | Norm::PressureMax(_))
    }

    /// Every norm with its name.
    const NAMES: [(&str, Norm); 19] = [
        ("V_max", Norm::VMax),
        ("L2_max", Norm::L2Max),
        ("trace_L2_max", Norm::TraceL2Max),
        ("pressure_L2_max", Norm::PressureL2Max),
        ("stress_L2_max", Norm::StressL2Max),
        ("contact_set_max", Norm::ContactSetMax),
        ("V_time_max", Norm::VTimeMax),
        ("V_projection_max", Norm::VProjectionMax),
        ("trace_open_max", Norm::TraceMax(ContactState::Open)),
        ("trace_rising_max", Norm::TraceMax(ContactState::Rising)),
        ("trace_falling_max", Norm::TraceMax(ContactState::Falling)),
        ("trace_jump_max", Norm::TraceMax(ContactState::AtJump)),
        ("trace_locked_max", Norm::TraceMax(ContactState::Locked)),
        ("pressure_open_max", Norm::PressureMax(ContactState::Open)),
        ("pressure_rising_max", Norm::PressureMax(ContactState::Rising)),
        ("pressure_falling_max", Norm::PressureMax(ContactState::Falling)),
        ("pressure_jump_max", Norm::PressureMax(ContactState::AtJump)),
        ("pressure_locked_max", Norm::PressureMax(ContactState::Locked)),
        ("contact_measure_max", Norm::ContactMeasureMax),
    ];

    /// Every norm.
    pub fn all() -> impl Iterator<Item = Norm> {
        Self::NAMES.into_iter().map(|(_, norm)| norm)
    }

    /// Its name in scene files and in `cases.csv`.
    pub fn name(self) -> &'static str {
        name_in(&Self::NAMES, self)
    }

    /// Whether the norm is on Γ3 and needs contact.
    pub fn needs_contact(self) -> bool {
        matches!(self, Norm::TraceL2Max | Norm::PressureL2Max | Norm::ContactSetMax)
            || self.by_state()
    }

    /// Whether the norm needs the contact state of the exact solution.
    pub fn by_state(self) -> bool {
        matches!(self, Norm::TraceMax(_) | Norm::PressureMax(_) | Norm::ContactMeasureMax)
    }

    pub(super) fn validate(reading: &Reading, key: &str, has_contact: bool) -> Result<Norm> {
        let norm = reading.choice(key, &Norm::NAMES)?;
        let message = format!("`{}` is measured on Γ3, and the scene has no contact", norm.name());
        let hint = "choose V_max, L2_max or stress_L2_max, or add contact";
        reading.refuse_if(norm.needs_contact() && !has_contact, key, message, hint)?;
        Ok(norm)
    }
}

/// The direction of refinement; joint is C_h h^order + C_k k^order_k over the grid of cases, path h → 0 along the pairs of
/// the sweep.
pub use judge::verdict::Variable as Direction;

/// One promised order.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    pub norm: Norm,
    pub variable: Direction,
    /// In h if `variable` is joint. Positive.
    pub order: f64,
    /// Order in k, present exactly if `variable` is joint. Positive.
    pub order_k: Option<f64>,
    pub at_least: bool,
    /// A higher order is a failure too.
    pub exact: bool,
    /// Compares the constant with its prediction, if there is one.
    pub constant: bool,
    /// Allowed relative difference of the constant from its prediction, if not the default.
    pub constant_within: Option<f64>,
    /// The theorem or equation that promises it.
    pub why: String,
    pub window_n: Option<[u32; 2]>,
    pub window_steps: Option<[u32; 2]>,
}

impl Prediction {
    /// Validates the prediction at position `index` of the file.
    pub(super) fn validate(
        reading: &Reading,
        index: usize,
        has_contact: bool,
    ) -> Result<Prediction> {
        let table = format!("predicts.{index}");
        let key = |name: &str| join(&table, name);
        let flag = |name: &str| reading.optional::<bool>(&key(name));
        let known = [Direction::H, Direction::K, Direction::Joint, Direction::Path];
        let known = known.map(|variable| (variable.name(), variable));
        let variable = reading.choice(&key("variable"), &known)?;
        let at_least = flag("at_least")?.unwrap_or(false);
        let exact = flag("exact")?.unwrap_or(false);
        if at_least && exact {
            let message = "both at_least and exact: an order is a lower bound or it is sharp";
            return Err(reading.key_error(&key("exact"), message, "keep one of the two"));
        }
        let why: String = reading.required(&key("why"))?;
        let hint = "name the theorem or equation that promises the order: why = \"(5.26)\"";
        reading.refuse_if(why.trim().is_empty(), &key("why"), "`why` is empty", hint)?;
        let constant = flag("constant")?.unwrap_or(true);
        Ok(Prediction {
            norm: Norm::validate(reading, &key("norm"), has_contact)?,
            variable,
            order: reading.positive(&key("order"))?,
            order_k: order_in_k(reading, &key("order_k"), variable)?,
            at_least,
            exact,
            constant,
            constant_within: constant_within(reading, &key, constant)?,
            why,
            window_n: reading.window(&key("window_n"))?,
            window_steps: reading.window(&key("window_steps"))?,
        })
    }
}

impl Prediction {
    /// An abstract scene has no mesh: its errors are ‖u_n - u_n^k‖_X and that of the pressures, in k only.
    pub(super) fn only_in_time(&self, reading: &Reading, index: usize) -> Result<()> {
        let key = |name: &str| format!("predicts.{index}.{name}");
        let message = format!("`{}` needs a body", self.norm.name());
        let hint = "the errors of an abstract scene are V_max, the largest norm in X, and with functionals pressure_L2_max";
        let known = matches!(self.norm, Norm::VMax | Norm::PressureL2Max);
        reading.refuse_if(!known, &key("norm"), message, hint)?;
        let (message, hint) =
            ("an abstract scene has no mesh, so no order in h", "write variable = \"k\"");
        reading.refuse_if(self.variable != Direction::K, &key("variable"), message, hint)
    }
}

/// Allowed relative difference of a constant from its prediction: in (0, 1), and only with a reason.
fn constant_within(
    reading: &Reading,
    key: &dyn Fn(&str) -> String,
    constant: bool,
) -> Result<Option<f64>> {
    let (within, why) = (key("constant_within"), key("constant_why"));
    let reason: Option<String> = reading.optional(&why)?;
    let explained = reason.is_some_and(|reason| !reason.trim().is_empty());
    let (key, message, hint) = match (reading.has(&within), explained) {
        (false, false) if reading.has(&why) => {
            (&why, "`constant_why` is empty", "state the reason, or remove it")
        }
        (false, false) => return Ok(None),
        (false, true) => (
            &why,
            "`constant_why` has no `constant_within` to explain",
            "add it: constant_within = 0.03, or remove constant_why",
        ),
        (true, _) if !constant => (
            &within,
            "`constant_within` beside constant = false: nothing is compared",
            "keep one of the two",
        ),
        (true, false) => (
            &within,
            "`constant_within` without a reason",
            "say why the usual tolerance is not enough: constant_why = \"n = 6 is the finest mesh\"",
        ),
        (true, true) => {
            let hint = "give the relative distance that is allowed, such as 0.03";
            return reading.share(&within, hint).map(Some);
        }
    };
    Err(reading.key_error(key, message, hint))
}

fn order_in_k(reading: &Reading, key: &str, variable: Direction) -> Result<Option<f64>> {
    match (variable, reading.has(key)) {
        (Direction::Joint, true) => reading.positive(key).map(Some),
        (Direction::Joint, false) => Err(reading.error(
            key,
            "a joint prediction needs two orders",
            "add the one in k: order_k = 2.0",
        )),
        (_, false) => Ok(None),
        (_, true) => Err(reading.key_error(
            key,
            "`order_k` belongs to joint predictions",
            "write variable = \"joint\", or remove order_k",
        )),
    }
}
