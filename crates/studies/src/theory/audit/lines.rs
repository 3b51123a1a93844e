//! The lines of the proofs of Theorems 10 and 11, each with both sides as numbers.

use super::constants::AuditConstants;
use super::integrals::Sum;
use super::level::LevelIntegrals;

/// Rounding of a sum, relative to the sum of its absolute terms: up to 10⁶ terms round to 1e-13 of it
/// at worst, and the solver's residual, 16 units of rounding of its forces, is of that size too.
const ROUNDING: f64 = 1e-12;
/// Where v^h - u is rounding itself (u affine in space), its powers are rounding of ‖σ‖‖ε‖: the residual with which a level
/// is accepted, 3.6e-15 of its forces, and some ten times that in strains of meshes of 8 cells a side.
const NATURAL: f64 = 4e-14;
/// The quadrature error of a kink inside cells, in units of the sum of absolute differences between 4
/// and 16 parts per cell: where f0 jumps across a curve the error falls by 2 or more with each halving of
/// the parts, so the difference bounds what is left, but irregularly; hence twice.
const QUADRATURE: f64 = 2.0;

/// How the two sides are related.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Relation {
    /// left ≤ right.
    #[default]
    AtMost,
    /// left = right.
    Equal,
}

impl Relation {
    /// Its sign in files.
    pub(super) fn sign(self) -> &'static str {
        match self {
            Self::AtMost => "<=",
            Self::Equal => "=",
        }
    }
}

/// How a line stands; over several levels or runs the last of these outweighs the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum LineStanding {
    /// It holds to its accuracy.
    Holds,
    /// Its bound is infinite: the constant in it is not defined, so it says nothing.
    Undefined,
    /// It does not, or a side is no number.
    Violated,
}

/// A line of a proof.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Statement {
    /// Its number in the paper, with a word where one number has several.
    pub name: &'static str,
    /// What it says.
    pub says: &'static str,
    /// How the sides are related.
    pub relation: Relation,
}

/// A line at one level.
#[derive(Debug, Clone, Copy)]
pub struct Line {
    /// The line of the proof.
    pub statement: Statement,
    /// Left side.
    pub left: f64,
    /// Right side.
    pub right: f64,
    /// By how much it may fail: rounding and measured quadrature error.
    pub accuracy: f64,
    /// Rounding alone, which is the accuracy of a side without a volume integral across kinks.
    pub rounding: f64,
}

impl Line {
    /// Whether the line holds to its accuracy; never with a NaN, nor because its bound is infinite.
    pub fn standing(&self) -> LineStanding {
        if self.statement.relation == Relation::AtMost && self.right == f64::INFINITY {
            return LineStanding::Undefined;
        }
        if self.excess() <= self.accuracy { LineStanding::Holds } else { LineStanding::Violated }
    }

    /// By how much its sides fail it.
    pub(super) fn excess(&self) -> f64 {
        match self.statement.relation {
            Relation::AtMost => self.left - self.right,
            Relation::Equal => (self.left - self.right).abs(),
        }
    }

    /// How near the line comes to failing, 1 where it just holds: left/right of an inequality, of an identity the
    /// difference over the accuracy. `None` as of `ratio` for an inequality; where nothing may differ and nothing
    /// does.
    pub fn tightness(&self) -> Option<f64> {
        match self.statement.relation {
            Relation::AtMost => self.ratio(),
            Relation::Equal => {
                let share = self.excess() / self.accuracy;
                let silent = self.left == self.right && self.accuracy == 0.0;
                (!silent).then_some(share)
            }
        }
    }

    /// left/right of an inequality, of an identity the difference over the larger side; `None` where both sides are below
    /// the accuracy and the ratio would be noise, and where the bound is not defined.
    pub(crate) fn ratio(&self) -> Option<f64> {
        let larger_side = self.left.abs().max(self.right.abs());
        let seen = larger_side > self.accuracy || self.left.is_nan() || self.right.is_nan();
        (seen && self.standing() != LineStanding::Undefined).then(|| {
            match self.statement.relation {
                Relation::AtMost => self.left / self.right,
                Relation::Equal => self.excess() / larger_side,
            }
        })
    }
}

/// The lines of a level: Theorem 10, and those of Theorem 11 where K = X.
pub(crate) fn lines(
    level: &LevelIntegrals,
    constants: &AuditConstants,
    unconstrained: bool,
) -> Vec<Line> {
    let mut sheet = Sheet { level, constants, lines: Vec::new() };
    sheet.estimates();
    sheet.residual();
    sheet.sum();
    if unconstrained {
        sheet.without_constraint();
    }
    sheet.lines
}

struct Sheet<'a> {
    level: &'a LevelIntegrals,
    constants: &'a AuditConstants,
    lines: Vec<Line>,
}

impl Sheet<'_> {
    fn push(
        &mut self,
        relation: Relation,
        [name, says]: [&'static str; 2],
        [left, right]: [Sum; 2],
        quadrature: f64,
    ) {
        let rounding = ROUNDING * (left.size + right.size) + NATURAL * self.level.cells.natural;
        self.lines.push(Line {
            statement: Statement { name, says, relation },
            left: left.value,
            right: right.value,
            accuracy: rounding + QUADRATURE * quadrature,
            rounding,
        });
    }

    fn at_most(&mut self, text: [&'static str; 2], left: Sum, right: f64) {
        self.push(Relation::AtMost, text, [left, number(right)], 0.0);
    }

    /// (4.7), (4.14)-(4.17), (4.19) and the trace constant of (2.9).
    fn estimates(&mut self) {
        let (c, level) = (self.constants, self.level);
        let (cells, contact) = (&level.cells, &level.contact);
        let (e, d, y) = (cells.e.sqrt(), cells.d.sqrt(), level.history);
        let says = ["(4.7)", "m_A e^2 <= <Au - Au_h, u - u_h>"];
        self.push(Relation::AtMost, says, [number(c.m_a * cells.e), cells.monotone], 0.0);
        let right = c.alpha_phi * e * e + c.beta_phi * y * e;
        self.at_most(["(4.14)", "E_phi1 <= alpha_phi e^2 + beta_phi Y e"], cells.phi1, right);
        let right = c.alpha_phi * e * d + c.beta_phi * y * d;
        self.at_most(["(4.15)", "E_phi2 <= alpha_phi e d + beta_phi Y d"], cells.phi2, right);
        let says =
            ["(4.16)", "E_j <= (2 c0 + c1 |u_nu| + c1 |u_h,nu|) delta + alpha_j |u_nu - u_h,nu|^2"];
        self.at_most(
            says,
            level.e_j(),
            c.growth(level) * contact.delta.sqrt() + c.alpha_j * contact.trace,
        );
        let says = ["(2.9)", "|u_nu - u_h,nu|^2 <= c_j^2 e^2"];
        self.at_most(says, number(contact.trace), c.c_j_squared * cells.e);
        self.at_most(["(4.17)", "E_A <= L_A e d"], cells.operator, c.l_a * e * d);
        let right = level.truncation + c.history * level.k * level.errors;
        self.at_most(["(4.19)", "Y <= g_n + |R||q| k sum_j e_j"], number(y), right);
    }

    /// E_n: its two forms, its sign, (5.23).
    fn residual(&mut self) {
        let (c, level) = (self.constants, self.level);
        let contact = &level.contact;
        let (volume, boundary) = (level.e_n(), contact.slack[0].plus(contact.selection[0]));
        let error = level.quadrature[0];
        let says = ["(4.5) forms", "E_n over the body = E_n on the contact side"];
        self.push(Relation::Equal, says, [volume, boundary], error);
        let (least, says) = match level.outside {
            None => (0.0, "0 <= E_n"),
            Some([of_v, _]) => (-of_v, "-int lambda (v^h_nu - g)_+ <= E_n"),
        };
        self.push(Relation::AtMost, ["(4.5) sign", says], [number(least), volume], error);
        let norm = contact.pressure.sqrt() + c.c0 + c.c1 * contact.arguments[0].sqrt();
        let says = ["(5.23)", "|E_n| <= (|xi + lambda| + c0 + c1 |u_nu|) delta"];
        // The form on the contact side is the sharper number of the two.
        let left = Sum { value: boundary.value.abs(), size: boundary.size };
        self.at_most(says, left, norm * contact.delta.sqrt());
    }

    /// (4.3) and (4.6) with what they leave over, (4.9), (4.18), (4.20).
    fn sum(&mut self) {
        let (level, c) = (self.level, self.constants);
        let [scheme_j, slack_h, selection_h] = level.scheme_contact;
        let discrete = level.scheme_stress.minus(level.scheme_load).plus(scheme_j);
        let left_over_h = slack_h.plus(selection_h);
        let says = ["(4.3)", "(4.3) at v = v^h leaves sum w lambda_h (g - v^h)"];
        self.push(Relation::Equal, says, [discrete, left_over_h], 0.0);
        let contact = &level.contact;
        let continuous = level.cells.stress[1].minus(level.load[1]).plus(contact.j_u_h);
        let left_over = contact.slack[1].plus(contact.selection[1]);
        let says = ["(4.6)", "(2.2) at v = u_h leaves int lambda (g - u_h)"];
        self.push(Relation::Equal, says, [continuous, left_over], level.quadrature[1]);
        let error = level.quadrature[0] + level.quadrature[1];
        let monotone = level.cells.monotone;
        let right = level.terms().plus(level.e_n()).plus(level.e_q());
        let (most, says) = match level.outside {
            None => (right, "<Au - Au_h, u - u_h> <= E_phi1 + E_phi2 + E_j + E_A + E_n + E_q"),
            Some([_, of_u_h]) => (
                right.plus(number(of_u_h)),
                "<Au - Au_h, u - u_h> <= E_phi1 + E_phi2 + E_j + E_A + E_n + E_q + int lambda (u_h - g)_+",
            ),
        };
        self.push(Relation::AtMost, ["(4.9)", says], [monotone, most], error);
        let says = [
            "(4.9) slack",
            "right - left of (4.9) = int lambda (g - u_h) + sum w lambda_h (g - v^h)",
        ];
        self.push(
            Relation::Equal,
            says,
            [right.minus(monotone), left_over.plus(left_over_h)],
            error,
        );
        let e = number(level.cells.e.sqrt());
        let outside = level.outside.map_or(0.0, |[_, of_u_h]| of_u_h);
        let residual = level.e_n().value.abs() + level.e_q().value.abs() + outside;
        let says = ["(4.18)", "e <= C (d + sqrt(delta) + sqrt|E_n|) + C Y, constants written out"];
        self.at_most(says, e, c.bound(level, level.history, residual));
        let history = level.truncation + c.history * level.k * level.errors;
        let says = ["(4.20)", "(4.18) with (4.19) in place of Y"];
        self.at_most(says, e, c.bound(level, history, residual));
    }

    /// (4.26)-(4.31) of Theorem 11.
    fn without_constraint(&mut self) {
        let (level, c) = (self.level, self.constants);
        let error = level.quadrature[0] + level.quadrature[1];
        let contact = &level.contact;
        let tilde = contact.j_v_u.plus(contact.j_u_h).plus(contact.j_h_v);
        let terms = level.cells.phi1.plus(level.cells.phi2).plus(level.cells.phi3);
        let right = terms.plus(tilde).plus(level.cells.operator).plus(level.e_q());
        let monotone = level.cells.monotone;
        let says =
            ["(4.26)", "<Au - Au_h, u - u_h> <= E_phi1 + E_phi2 + E_phi3 + E_j~ + E_A + E_q"];
        self.push(Relation::AtMost, says, [monotone, right], error);
        let left_over =
            contact.selection[1].plus(contact.selection[2]).plus(level.scheme_contact[2]);
        let says =
            ["(4.26) slack", "right = left of (4.26), but for the selections of a set-valued law"];
        self.push(Relation::Equal, says, [right.minus(monotone), left_over], error);
        let says = ["(4.29)", "|E_phi3| <= c_phi d^2, phi is linear: 0"];
        let phi3 = level.cells.phi3;
        let left = Sum { value: phi3.value.abs(), size: phi3.size };
        self.at_most(says, left, c.c_phi * level.cells.d);
        let says = ["(4.30)", "E_j~ <= C delta + alpha_j c_j^2 e^2"];
        let right =
            c.growth(level) * contact.delta.sqrt() + c.alpha_j * c.c_j_squared * level.cells.e;
        self.at_most(says, tilde, right);
        let says = ["(4.31)", "e <= C (d + sqrt(delta)) + C Y, constants written out"];
        let e = number(level.cells.e.sqrt());
        self.at_most(says, e, c.bound(level, level.history, level.e_q().value.abs()));
    }
}

impl LevelIntegrals {
    /// E_j of (4.12).
    fn e_j(&self) -> Sum {
        let contact = &self.contact;
        contact.j_u_h.plus(contact.j_h_v).minus(contact.j_u_v)
    }

    /// E_n of (4.5), the form over the body.
    fn e_n(&self) -> Sum {
        self.cells.stress[0].minus(self.load[0]).plus(self.contact.j_u_v)
    }

    /// E_φ1 + E_φ2 + E_j + E_A.
    fn terms(&self) -> Sum {
        self.cells.phi1.plus(self.cells.phi2).plus(self.e_j()).plus(self.cells.operator)
    }

    /// What the scheme's quadrature adds to (4.9): its j_ν⁰ and its F at v^h - u^{kh} less the true ones, and of strains
    /// that vary in a cell its stresses.
    fn e_q(&self) -> Sum {
        let load = self.load[0].minus(self.load[1]);
        let loads =
            self.scheme_contact[0].minus(self.contact.j_h_v).plus(load).minus(self.scheme_load);
        match self.cells.at_h.size > 0.0 {
            true => loads.plus(self.scheme_stress).minus(self.cells.at_h),
            false => loads,
        }
    }
}

impl AuditConstants {
    /// 2 c0 + c1‖u_ν‖ + c1‖u^{kh}_ν‖ of (4.16).
    fn growth(&self, level: &LevelIntegrals) -> f64 {
        let [u, u_h] = level.contact.arguments;
        2.0 * self.c0 + self.c1 * (u.sqrt() + u_h.sqrt())
    }

    /// (4.18) solved for e = ‖u - u^{kh}‖: m0 e² ≤ b e + c gives e ≤ b/m0 + √(c/m0), where
    /// b = β_φ Y + (α_φ + L_A) d and c = β_φ Y d + C_j δ + |E_n|, and √(β_φ Y d/m0) ≤ (β_φ Y/m0 + d)/2.
    /// Infinite where m0 ≤ 0: then the proof says nothing, see [`LineStanding::Undefined`].
    fn bound(&self, level: &LevelIntegrals, history: f64, residual: f64) -> f64 {
        let m0 = self.m0();
        if m0 <= 0.0 {
            return f64::INFINITY;
        }
        let (d, delta) = (level.cells.d.sqrt(), level.contact.delta.sqrt());
        let space = ((self.alpha_phi + self.l_a) / m0 + 0.5) * d;
        let traces = (self.growth(level) * delta / m0).sqrt();
        space + traces + (residual / m0).sqrt() + 1.5 * self.beta_phi * history / m0
    }
}

fn number(value: f64) -> Sum {
    Sum { value, size: 0.0 }
}
