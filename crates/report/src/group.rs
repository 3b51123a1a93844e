//! Groups of the scenes in a report.

use crate::Terms;

/// In the order of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Group {
    /// The problem of the paper with every term.
    Whole,
    /// Contact with some of the terms.
    Contact,
    /// Beyond the paper: friction, elements of higher degree.
    Beyond,
    /// No contact.
    #[default]
    Materials,
    /// No body.
    Abstract,
    /// A hypothesis is broken on purpose, or at its limit.
    Broken,
    /// Solved by another program.
    External,
}

impl Group {
    pub(crate) const ALL: [Self; 7] = [
        Self::Whole,
        Self::Contact,
        Self::Beyond,
        Self::Materials,
        Self::Abstract,
        Self::Broken,
        Self::External,
    ];

    /// The group of a scene with these terms.
    pub fn of(terms: Terms, breaks: bool) -> Self {
        let Terms { is_abstract, projection, memory, contact, gap, law, friction, quadratic } =
            terms;
        if breaks {
            Self::Broken
        } else if is_abstract {
            Self::Abstract
        } else if friction || quadratic {
            Self::Beyond
        } else if projection && memory && gap && law {
            Self::Whole
        } else if contact {
            Self::Contact
        } else {
            Self::Materials
        }
    }

    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Whole => "Every term of the paper",
            Self::Contact => "Laws, states, gaps",
            Self::Beyond => "Elements and friction",
            Self::Materials => "Materials and memory",
            Self::Abstract => "Abstract inequality",
            Self::Broken => "Broken, or at the limit",
            Self::External => "Another solver",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_term_leaves_the_whole_problem() {
        let contact = Terms { contact: true, gap: true, law: true, ..Terms::default() };
        let whole = Terms { projection: true, memory: true, ..contact };
        assert_eq!(Group::of(whole, false), Group::Whole);
        assert_eq!(Group::of(whole, true), Group::Broken);
        assert_eq!(Group::of(contact, false), Group::Contact);
        // Friction is beyond the paper, whatever else a scene has.
        assert_eq!(Group::of(Terms { friction: true, ..whole }, false), Group::Beyond);
        assert_eq!(Group::of(Terms { quadratic: true, ..whole }, false), Group::Beyond);
        assert_eq!(
            Group::of(Terms { contact: false, gap: false, ..whole }, false),
            Group::Materials
        );
        assert_eq!(Group::of(Terms { is_abstract: true, ..whole }, false), Group::Abstract);
        assert!(Group::ALL.is_sorted());
    }
}
