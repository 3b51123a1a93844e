"""Orders of convergence as verdicts: pass, fail or unresolved.

Examples
--------
>>> import gronwall
>>> gronwall.fit([1/8, 1/16, 1/32], [0.1000, 0.0251, 0.00629], order=2).decision
'pass'
"""

from ._fit import Unresolved, assert_order, fit
from ._mesh import convert_mesh
from ._native import __version__
from ._read import Table, read
from ._study import Results, Study, study
from ._verdict import Verdict
from ._verify import Case, scenes, verify
from ._vtu import read_vtu

__all__ = [
    "Case",
    "Results",
    "Study",
    "Table",
    "Unresolved",
    "Verdict",
    "__version__",
    "assert_order",
    "convert_mesh",
    "fit",
    "read",
    "read_vtu",
    "scenes",
    "study",
    "verify",
]
