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
ng="$python docs/solvers/ngsolve_p1.py"
beside NGSolve "$ng" viscoelastic
beside NGSolve "$ng" prony
beside NGSolve "$ng" layered
if command -v FreeFem++ >/dev/null; then
    # Debian keeps plugins and include files where its FreeFem++ does not look.
    export FF_LOADPATH=${FF_LOADPATH:-/usr/lib/freefem++} FF_INCLUDEPATH=${FF_INCLUDEPATH:-/usr/include/freefem++/idp}
    material="-lambda 1 -mu 1 -memory-lambda 0.25 -memory-mu 0.25"
    beside FreeFEM "FreeFem++ -nw -v 0 docs/solvers/freefem.edp $material" viscoelastic
else
    echo "FreeFem++ is not installed: its example was not run"
fi

# caught TEXT: the last run, in $out.log, ended with $status 1, or 2 where the answer was refused, and says TEXT.
caught() {
    grep "^cause:" "$out.log" || true
    [ "$status" != 0 ] && grep -q -- "$1" "$out.log" || {
        cat "$out.log"
        echo "verify: exit code $status, or no word of: $1" >&2
        exit 1
    }
}

echo "prony, memory integrals by the rectangle rule"
status=0
"$sweep" verify prony --solver "$solver --rule rectangle" --out "$out/wrong" >"$out.log" 2>&1 || status=$?
caught "the memory is summed by the left-hand rectangle rule"

# named TEXT SCENE EDIT OPTIONS...: what is said of the solver $of with a mistake, made by sed.
of=scikit_fem
named() {
    local text=$1 scene=$2 edit=$3
    shift 3
    echo "$of, $scene, with a mistake: $edit"
    sed "$edit" "docs/solvers/$of.py" >"$out/wrong.py"
    ! cmp -s "$out/wrong.py" "docs/solvers/$of.py"
    status=0
    "$sweep" verify "$scene" --solver "$python $out/wrong.py" --out "$out/wrong" "$@" >"$out.log" 2>&1 || status=$?
    caught "$text"
}
# The mistakes of the matrix in docs/EXTERNAL.md that this solver can make, on the scenes recommended there.
space=(--n 8,16,32)
tensors="cause: the tensors of elasticity and memory"
named "$tensors" viscoelastic 's/return 2 \* law/return law/' "${space[@]}"
named "$tensors" viscoelastic 's/ + law\["lambda"\].*//' "${space[@]}"
named "$tensors" viscoelastic 's/law\["lambda"\] \*/2 * law["mu"] * law["lambda"] \/ (law["lambda"] + 2 * law["mu"]) */' "${space[@]}"
for freed in 1 4; do
    named "which is clamped" viscoelastic \
        's/vertices\["clamped"\] == 0, 2/vertices["clamped"] * (np.cumsum(vertices["clamped"]) != '$freed') == 0, 2/' "${space[@]}"
done
named "which is clamped" viscoelastic 's/np.repeat(vertices\["clamped"\] == 0, 2)/& | (np.arange(2 * len(vertices)) % 2 == 0)/' "${space[@]}"
named "cause: the loads are those of the level before" viscoelastic 's/self.loads\[n\]/self.loads[max(n - 1, 0)]/' "${space[@]}"
named "cause: the loads are late by 0.0100 of a step" prony 's/self.loads\[n\].copy()/0.99 * self.loads[n] + 0.01 * self.loads[max(n - 1, 0)]/'
named "cause: the memory is left out" prony 's/\[matrix(term\[0\]) for .*\]$/[]/'
named "cause: the memory has the other sign" prony 's/lags = weights/lags = -weights/'
named "cause: the memory is summed by the right-hand rectangle rule" prony \
    's/= k if rule == "rectangle" else k \/ 2/= 0/; s/0 if rule == "rectangle" else k \/ 2/k/'
named "cause: the memory has twice the last weight" prony 's/lags\[n\] \* memory/2 * &/'
named "cause: the memory has its kernel at t_n - t_j + k" prony 's/kernel\[n::-1\]/np.append(kernel[1:], kernel[-1] ** 2 \/ kernel[-2])[n::-1]/'
named "cause: the memory leaves out the level t = 0" prony 's/^        return weights$/        weights[0] = 0\n&/'
named "cause: the memory keeps its last term alone" prony 's/lags\[:n\] @/0 * &/'
named "cause: the memory is of u_(j-1) in place of u_j" prony 's/lags\[:n\] @ u\[:n\]/lags[1 : n + 1] @ u[:n]/; s/operator = operator + .*/pass/'
named "cause: the memory is of u_(j-1) in place of u_j, and u_0 before it" prony \
    's/lags\[:n\] @ u\[:n\]/lags[1 : n + 1] @ u[:n] + lags[0] * u[0]/; s/operator = operator + .*/pass/'
named "cause: the memory has the weight k at both ends" prony 's/^        return weights$/        weights[[0, -1]] *= 2\n&/'
named "in place of u_j, but for the level itself" prony 's/lags\[:n\] @ u\[:n\]/lags[:n] @ u[np.maximum(np.arange(n) - 1, 0)]/'
named "cause: the memory has twice the first weight" state-instant 's/^        return weights$/        weights[0] *= 2\n&/' --pressure
obstacle() {
    named "$1" state-instant "$2" --pressure
}
obstacle "cause: contact" 's/penetrates = .*/penetrates = np.zeros(len(self.gap), bool)/'
obstacle "cause: contact" 's/self.sign = normal/self.sign = -normal/'
obstacle "cause: contact" 's/np.isfinite(rows\["gap"\])/& \& (np.arange(len(rows)) % 2 == 0)/'
obstacle "cause: contact" 's/if (now == active).all():/if True:/'
for factor in 0 0.95 1.01 1.05; do
    obstacle "cause: contact: $(printf %.4f "$factor") times the gap" 's/self.gap, self.weight = /&'$factor' * /'
done
for stiffness in 30 100 1e4; do
    soft="soft, reach = np.zeros_like(force), np.zeros_like(force)"
    held="soft[held], reach[self.unknown], held = $stiffness * self.weight[active], self.sign * self.gap, held[:0]"
    sum="rigid, load, operator, force = operator, force, (operator + diags(soft)).tocsc(), force + soft * reach"
    obstacle "cause: contact: a penalty" "s/^\( *\)u\[held\] = .*/\1$soft\n\1$held\n\1$sum/
        s/^\( *\)residual = /\1operator, force = rigid, load\n&/; s/^from scipy.sparse.linalg/from scipy.sparse import diags\n&/"
done
for pressure in "3 - 7 *" "-1 *" "0.75 *"; do
    obstacle "cause: pressures" "s/self.inside\\] = reaction/self.inside] = $pressure reaction/"
done
obstacle "cause: pressures: forces of the vertices" 's,residual / self.weight,residual,'
of=numpy_p1
for entry in 0.5 2; do
    named "cause: the tensors have other shear entries" viscoelastic "s/diag(\[2, 2, 1\])/diag([2, 2, $entry])/" "${space[@]}"
done
named "cause: all regions have the elasticity and memory of region 0" layered 's/(laws)\[region\]/(laws)[0 * region]/' --n 4,8,16
of=ngsolve_p1
named "$tensors" viscoelastic 's/2 \* law/law/' "${space[@]}"
named "cause: the memory has the other sign" prony 's/np.load("kernels/-&/'

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

echo "friction that follows pressure or slip, and vectors of it in space, vertex after vertex: the values that the tests compare with"
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

echo "histories of histories by double sums: likewise"
"$python" tests/independent/nested.py tests/fixtures/nested.json

echo "quadratic elements by scikit-fem: the values that the tests compare with"
"$python" tests/independent/quadratic.py 4 6 tests/fixtures/quadratic.json
