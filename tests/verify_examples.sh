#!/usr/bin/env bash
# The example solver under `sweep verify`: it passes, with the errors of the built-in solver; with its deliberate
# mistake it fails. usage: tests/verify_examples.sh SWEEP PYTHON
set -euo pipefail
cd "$(dirname "$0")/.."
sweep=$1 python=$2
solver="$python docs/solvers/scikit_fem.py"
out=target/verify-examples
rm -rf "$out"

# Both solve the same discrete problem to rounding, 1e-13 of the field with the conditions of these meshes. Errors in V are
# 1e-2 of the field, those in L2 down to 1e-5.
agree='
import json, sys
rows = json.load(sys.stdin)["beside"]
most = lambda rows: max(row["difference"] for row in rows)
in_v = most([row for row in rows if row["norm"] == "V_max"])
print(f"  {len(rows)} errors, largest relative difference {most(rows):.1e}, of V_max {in_v:.1e}")
sys.exit(not (in_v <= 1e-9 and most(rows) <= 1e-8))
'
# beside NAME COMMAND SCENE OPTIONS...: passes, with the errors of the built-in solver.
beside() {
    local name=$1 command=$2 scene=$3
    shift 3
    echo "$scene, $name beside the built-in solver"
    "$sweep" verify "$scene" --solver "$command" --beside --json --out "$out/$(basename "$scene" .toml)" "$@" 2>"$out.log" >"$out.json" || {
        status=$?
        cat "$out.log" "$out.json"
        exit "$status"
    }
    "$python" -c "$agree" <"$out.json"
}
beside scikit-fem "$solver" prony
beside scikit-fem "$solver" viscoelastic
beside scikit-fem "$solver" signorini --pressure
beside scikit-fem "$solver" quadratic-elastic
beside scikit-fem "$solver" tests/independent/quadratic-signorini.toml --pressure
beside "scikit-fem, loads of its own," "$solver --assemble" viscoelastic --loads density
beside "scikit-fem, loads of its own," "$solver --assemble" state-grazing --pressure --loads density
begin="$python docs/solvers/numpy_p1.py"
beside "numpy alone" "$begin" viscoelastic
beside "numpy alone" "$begin" prony
beside "numpy alone" "$begin" signorini --pressure
beside "numpy alone" "$begin" moving-obstacle --pressure
beside "numpy alone" "$begin" state-instant --pressure
if command -v FreeFem++ >/dev/null; then
    # Debian keeps plugins and include files where its FreeFem++ does not look.
    export FF_LOADPATH=${FF_LOADPATH:-/usr/lib/freefem++} FF_INCLUDEPATH=${FF_INCLUDEPATH:-/usr/include/freefem++/idp}
    material="-lambda 1 -mu 1 -memory-lambda 0.25 -memory-mu 0.25"
    beside FreeFEM "FreeFem++ -nw -v 0 docs/solvers/freefem.edp $material" viscoelastic
else
    echo "FreeFem++ is not installed: its example was not run"
fi

# caught CAUSE: the last run, in $out.log, ended with $status 1 and named the cause.
caught() {
    grep "^cause:" "$out.log" || true
    [ "$status" = 1 ] && grep -q "^cause: $1" "$out.log" || {
        cat "$out.log"
        echo "verify: exit code $status where 1 is wanted, with the cause: $1" >&2
        exit 1
    }
}
echo "prony, memory integrals by the rectangle rule"
status=0
"$sweep" verify prony --solver "$solver --rule rectangle" --out "$out/wrong" >"$out.log" 2>&1 || status=$?
caught "the memory is summed by the left-hand rectangle rule"

# named CAUSE SCENE EDIT OPTIONS...: the same of the solver with a mistake, made by sed.
named() {
    local cause=$1 scene=$2 edit=$3
    shift 3
    echo "$scene, with a mistake: $edit"
    sed "$edit" docs/solvers/scikit_fem.py >"$out/wrong.py"
    ! cmp -s "$out/wrong.py" docs/solvers/scikit_fem.py
    status=0
    "$sweep" verify "$scene" --solver "$python $out/wrong.py" --out "$out/wrong" "$@" >"$out.log" 2>&1 || status=$?
    caught "$cause"
}
named "the memory has the other sign" prony 's/lags = weights/lags = -weights/'
named "the loads are those of the level before" prony 's/self.loads\[n\]/self.loads[max(n - 1, 0)]/'
named "the tensors of elasticity and memory" viscoelastic 's/return 2 \* law/return law/' --n 8,16,32
named "contact: 1.0500 times the gap" state-instant 's/self.gap, self.weight = /&1.05 * /' --pressure
named "pressures: forces of the vertices" state-instant 's,residual / self.weight,residual,' --pressure

# assembled CAUSE SCENE EDIT: the same of loads that it assembles; orders may pass, but the cause is named.
assembled() {
    local cause=$1 scene=$2 edit=$3
    echo "$scene, loads assembled with a mistake: $edit"
    sed "$edit" docs/solvers/scikit_fem.py >"$out/wrong.py"
    ! cmp -s "$out/wrong.py" docs/solvers/scikit_fem.py
    status=0
    "$sweep" verify "$scene" --loads density --solver "$python $out/wrong.py --assemble" --out "$out/wrong" >"$out.log" 2>&1 || status=$?
    echo "  exit code $status"
    grep "^cause: the loads.*$cause" "$out.log" || {
        cat "$out.log"
        echo "verify: no cause: $cause" >&2
        exit 1
    }
}
for scene in viscoelastic state-grazing; do
    assembled "all other rows balance" "$scene" 's/^    for name, nodes, measure in/    length[3] = 0\n&/'
    assembled "are lumped: cells and facets" "$scene" 's/rule\[:, :-1\], values/np.full_like(rule[:, :-1], 1 \/ nodes.shape[1]), values/'
    assembled "facets take point 2 of their rule alone" "$scene" 's/^        # Barycentric/        if name == "facet":\n            rule[:, -1] = np.arange(len(rule)) == 2\n&/'
done

echo "friction by coordinate descent: the values that the tests compare with"
"$python" tests/independent/tresca.py 8 6 tests/fixtures/tresca.json

echo "friction that follows pressure or slip, and vectors of it in space, vertex after vertex: likewise"
"$python" tests/independent/friction.py tests/fixtures/friction.json
for coefficient in coulomb box-coulomb; do
    halved="import friction; friction.CASES['$coefficient'].coefficient /= 2; friction.main()"
    ! PYTHONPATH=tests/independent "$python" -B -c "$halved" tests/fixtures/friction.json >"$out.log" 2>&1 || {
        echo "friction.py: half of the coefficient of $coefficient was not caught" >&2
        exit 1
    }
    # It must fail by its numbers, and by those of this scene.
    grep "  $coefficient, u: [1-9].* off the fixture" "$out.log"
done

echo "quadratic elements by scikit-fem: the values that the tests compare with"
"$python" tests/independent/quadratic.py 4 6 tests/fixtures/quadratic.json
