//! Claimed orders of the command line: one for all norms, or one for each, with its bound and its tolerance.

use std::str::FromStr;

use judge::fit::Claim;
use judge::table::{Group, named};

/// `2`, or `L2=2,H1>=1,energy==1.5:0.3`: the order of every norm, or those of named ones, beside which none is judged.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Claims(Vec<Claimed>);

#[derive(Debug, Clone, PartialEq)]
struct Claimed {
    name: Option<String>,
    order: f64,
    at_least: bool,
    exact: bool,
    tolerance: Option<f64>,
}

impl Claims {
    /// The claim on a table, what it does not say taken from `common`.
    pub(super) fn of(&self, group: &Group, common: Claim) -> Option<Claim> {
        let heading = group.heading();
        let means = |claimed: &&Claimed| match claimed.name.as_deref() {
            None => true,
            name => {
                [&heading, &group.norm, &group.scene].iter().any(|known| known.as_deref() == name)
            }
        };
        let claimed = self.0.iter().find(means)?;
        let (at_least, exact) = match claimed.at_least || claimed.exact {
            true => (claimed.at_least, claimed.exact),
            false => (common.at_least, common.exact),
        };
        let tolerance = claimed.tolerance.unwrap_or(common.tolerance);
        Some(Claim { order: claimed.order, at_least, exact, tolerance, ..common })
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.0.iter().filter_map(|claimed| claimed.name.as_deref())
    }

    /// Each name as the table writes it: `L2` may be `error_L2`.
    pub(super) fn resolve(&mut self, groups: &[Group]) -> Result<(), String> {
        let distinct = |name: &dyn Fn(&Group) -> Option<String>| {
            let mut found: Vec<String> = Vec::new();
            groups.iter().filter_map(name).for_each(|name| {
                if !found.contains(&name) {
                    found.push(name);
                }
            });
            found
        };
        let norms = distinct(&|group| group.norm.clone());
        let others = [distinct(&|group| group.scene.clone()), distinct(&Group::heading)].concat();
        for name in self.0.iter_mut().filter_map(|claimed| claimed.name.as_mut()) {
            if others.contains(name) {
                continue;
            }
            if norms.is_empty() {
                return Err(format!(
                    "there is no norm `{name}` to judge, because the errors of the table have no name: give the order without a name, as in --p 2"
                ));
            }
            let known: Vec<&str> = norms.iter().map(String::as_str).collect();
            let at = named(name, &known).map_err(|what| format!("nothing to judge: {what}"))?;
            norms[at].clone_into(name);
        }
        Ok(())
    }
}

impl FromStr for Claims {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let one = |part: &str| {
            let (name, value) = part.rsplit_once('=').unwrap_or(("", part));
            let (at_least, exact) = (name.ends_with('>'), name.ends_with('='));
            let name = name.trim_end_matches(['>', '=']).trim();
            if name.is_empty() && text.contains(',') {
                return Err(format!(
                    "`{part}` names no norm: L2=2,H1=1 is an order for each of two"
                ));
            }
            let (value, tolerance) = match value.split_once(':') {
                Some((value, tolerance)) => (value, Some(number(tolerance, "tolerance")?)),
                None => (value, None),
            };
            let name = (!name.is_empty()).then(|| name.to_owned());
            Ok(Claimed { name, order: number(value, "order")?, at_least, exact, tolerance })
        };
        text.split(',').map(one).collect::<Result<_, String>>().map(Self)
    }
}

/// Refuses what is not finite.
fn number(text: &str, what: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(format!("`{text}` is no finite {what}; 1, 1.5 and 2 are")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use judge::table::{Reading, read};

    #[test]
    fn orders_are_claimed_of_all_norms_or_of_each() {
        let text = b"h,error_L2,H1\n0.5,1,1\n0.25,1,1\n";
        let groups = read(text, &Reading::default()).unwrap().groups;
        let common = Claim::new(1.0).unwrap();
        let of = |text: &str| {
            let mut claims: Claims = text.parse().unwrap();
            claims.resolve(&groups)?;
            Ok::<_, String>(groups.iter().map(|group| claims.of(group, common)).collect::<Vec<_>>())
        };
        let orders = |text: &str| -> Vec<Option<f64>> {
            of(text).unwrap().iter().map(|claim| claim.map(|claim| claim.order)).collect()
        };
        assert_eq!(orders("1.5"), [Some(1.5); 2]);
        assert_eq!(orders("L2=2, H1=1"), [Some(2.0), Some(1.0)]);
        assert_eq!(orders("H1=1"), [None, Some(1.0)]);
        let each = of("L2>=2:0.3,H1==1").unwrap();
        assert_eq!(each[0], Some(Claim { order: 2.0, at_least: true, tolerance: 0.3, ..common }));
        assert_eq!(each[1], Some(Claim { order: 1.0, exact: true, ..common }));
        assert!(of("L4=1").is_err());
        for wrong in ["nan", "inf", "-inf", "two", "", "L2=nan", "L2=2,1", "L2=", "2:x"] {
            assert!(wrong.parse::<Claims>().is_err(), "{wrong}");
        }
    }
}
