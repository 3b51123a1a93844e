//! Claimed orders of the command line: one for all norms, or one per norm.

use std::str::FromStr;

/// `2` or `L2=2,H1=1`: the order of every norm, or those of named ones, beside which none is judged.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Claims(Vec<(Option<String>, f64)>);

impl Claims {
    pub(super) fn of(&self, norm: Option<&str>) -> Option<f64> {
        let mut claims = self.0.iter();
        let (_, order) = claims.find(|(name, _)| name.is_none() || name.as_deref() == norm)?;
        Some(*order)
    }

    pub(super) fn norms(&self) -> impl Iterator<Item = &str> {
        self.0.iter().filter_map(|(norm, _)| norm.as_deref())
    }
}

impl FromStr for Claims {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if !text.contains('=') {
            return Ok(Self(vec![(None, order(text)?)]));
        }
        let pair = |part: &str| {
            let (norm, value) = part.rsplit_once('=').ok_or_else(|| {
                format!("`{part}` names no norm: L2=2,H1=1 is an order for each of two")
            })?;
            Ok((Some(norm.trim().to_owned()), order(value)?))
        };
        text.split(',').map(pair).collect::<Result<_, String>>().map(Self)
    }
}

/// Refuses non-finite orders.
fn order(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(order) if order.is_finite() => Ok(order),
        _ => Err(format!("`{text}` is no finite order; 1, 1.5 and 2 are")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_claimed_of_all_norms_or_of_each() {
        let all: Claims = "1.5".parse().unwrap();
        assert_eq!([all.of(None), all.of(Some("L2"))], [Some(1.5); 2]);
        let each: Claims = "L2=2, H1=1".parse().unwrap();
        assert_eq!([each.of(Some("L2")), each.of(Some("H1"))], [Some(2.0), Some(1.0)]);
        assert_eq!([each.of(Some("L4")), each.of(None)], [None; 2]);
        assert_eq!(each.norms().collect::<Vec<_>>(), ["L2", "H1"]);
        for wrong in ["nan", "inf", "-inf", "two", "", "L2=nan", "L2=2,1", "L2="] {
            assert!(wrong.parse::<Claims>().is_err(), "{wrong}");
        }
    }
}
