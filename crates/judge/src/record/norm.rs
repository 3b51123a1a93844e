//! Norms of errors: names (a contract), order in tables, labels in plots.

/// max over n of ‖ε(u_n − u_n^{kh})‖, the paper's norm.
pub const V_MAX: &str = "V_max";
/// max over n of ‖u_n − u_n^{kh}‖ in L²(Ω).
pub const L2_MAX: &str = "L2_max";
/// max over n of ‖u_ν − u_ν^{kh}‖ in L²(Γ3).
pub const TRACE_L2_MAX: &str = "trace_L2_max";
/// max over n of the error of ξ + λ in L²(Γ3).
pub const PRESSURE_L2_MAX: &str = "pressure_L2_max";
/// max over n of ‖σ − σ^{kh}‖ in L²(Ω).
pub const STRESS_L2_MAX: &str = "stress_L2_max";
/// max over n of the Hausdorff distance of the exact and discrete locked sets on Γ3.
pub const CONTACT_SET_MAX: &str = "contact_set_max";
/// V norm against a reference on the same mesh with 8N steps: the time error.
pub const V_TIME_MAX: &str = "V_time_max";
/// max over n of ‖U(t_n) − U_n‖ in X, U = start + ∫ u by the scene's rule: of a velocity the displacement.
pub const DISPLACEMENT_MAX: &str = "displacement_max";
/// V norm against the A-projection of u.
pub const V_PROJECTION_MAX: &str = "V_projection_max";
/// max over n of the measure of the points of Γ3 locked in only one of exact and discrete solution.
pub const CONTACT_MEASURE_MAX: &str = "contact_measure_max";

/// A norm of the contract.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Norm {
    pub name: &'static str,
    /// In plots.
    pub label: &'static str,
    /// Where a label has no room.
    pub symbol: &'static str,
}

/// All norms of the contract in table order, which also numbers their colours and markers. Those of a contact state are
/// errors on the part of Γ3 where the exact solution is in that state.
pub const NORMS: [Norm; 20] = [
    norm(V_MAX, "max ‖ε(u−u_h)‖", "V"),
    norm(L2_MAX, "max ‖u−u_h‖", "L²"),
    norm(TRACE_L2_MAX, "max ‖u_ν−u_hν‖ on Γ3", "u_ν"),
    norm(PRESSURE_L2_MAX, "max ‖p−p_h‖ on Γ3, p = ξ+λ", "ξ+λ"),
    norm(STRESS_L2_MAX, "max ‖σ−σ_h‖", "σ"),
    norm(CONTACT_SET_MAX, "max dist(locked sets)", "Γ3"),
    norm(V_TIME_MAX, "max ‖ε(u_h−u_kh)‖, time only", "V in t"),
    norm(DISPLACEMENT_MAX, "max ‖U−U_k‖ in X, U = ∫u", "U"),
    norm(V_PROJECTION_MAX, "max ‖ε(P_h u−u_h)‖", "P_h"),
    norm("trace_open_max", "max ‖u_ν−u_hν‖ where open", "u_ν open"),
    norm("trace_rising_max", "max ‖u_ν−u_hν‖ where rising", "u_ν rising"),
    norm("trace_falling_max", "max ‖u_ν−u_hν‖ where falling", "u_ν falling"),
    norm("trace_jump_max", "max ‖u_ν−u_hν‖ where at a jump", "u_ν jump"),
    norm("trace_locked_max", "max ‖u_ν−u_hν‖ where locked", "u_ν locked"),
    norm("pressure_open_max", "max ‖p−p_h‖ where open", "ξ+λ open"),
    norm("pressure_rising_max", "max ‖p−p_h‖ where rising", "ξ+λ rising"),
    norm("pressure_falling_max", "max ‖p−p_h‖ where falling", "ξ+λ falling"),
    norm("pressure_jump_max", "max ‖p−p_h‖ where at a jump", "ξ+λ jump"),
    norm("pressure_locked_max", "max ‖p−p_h‖ where locked", "ξ+λ locked"),
    norm(CONTACT_MEASURE_MAX, "max |locked sets differ|", "|Γ3|"),
];

const fn norm(name: &'static str, label: &'static str, symbol: &'static str) -> Norm {
    Norm { name, label, symbol }
}

fn known(norm: &str) -> Option<&'static Norm> {
    NORMS.iter().find(|known| known.name == norm)
}

/// Position of a norm in tables; names outside the contract come after those within.
pub fn norm_rank(norm: &str) -> usize {
    NORMS.iter().position(|known| known.name == norm).unwrap_or(NORMS.len())
}

/// Whether a norm is split by contact state; plots leave these out.
pub fn is_by_state(norm: &str) -> bool {
    norm_rank(norm) > norm_rank(V_PROJECTION_MAX) && norm_rank(norm) < NORMS.len()
}

/// Label of a norm in plots; a name outside the contract stands for itself.
pub fn norm_label(norm: &str) -> &str {
    known(norm).map_or(norm, |known| known.label)
}

/// Symbol of a norm; a name outside the contract stands for itself.
pub fn norm_symbol(norm: &str) -> &str {
    known(norm).map_or(norm, |known| known.symbol)
}

/// Plot label for records without a mesh, where the V norm is that of X.
pub fn norm_label_in_time(norm: &str) -> &str {
    if norm == V_MAX { "max ‖u−u_k‖ in X" } else { norm_label(norm) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn foreign_norms_follow_and_label_themselves() {
        assert_eq!(norm_rank(V_MAX), 0);
        assert_eq!(norm_rank("mine"), NORMS.len());
        let split = NORMS.iter().filter(|norm| is_by_state(norm.name)).count();
        assert!(split == 11 && !is_by_state(V_TIME_MAX) && !is_by_state("mine"));
        assert!(is_by_state("trace_open_max") && is_by_state(CONTACT_MEASURE_MAX));
        assert_eq!(norm_label("mine"), "mine");
        assert_eq!(norm_label(L2_MAX), "max ‖u−u_h‖");
        assert_ne!(norm_label_in_time(V_MAX), norm_label(V_MAX));
        assert_eq!(norm_label_in_time("mine"), "mine");
    }
}
