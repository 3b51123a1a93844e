//! Numbers in, verdicts out: records of cases, fitted orders, predictions judged. Knows no solver.

pub mod claim;
pub mod fit;
pub mod record;
pub mod table;
pub mod verdict;
