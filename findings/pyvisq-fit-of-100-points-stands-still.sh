#!/usr/bin/env bash
# Packages: pyvisq 1.2.2, pymittagleffler 0.3.0, numpy 2.4.6, scipy 1.17.1, mpmath 1.4.1 (PyPI)
#
# Expected: a pyvisq model has a property `params` that can be assigned and checks what it gets, and
#   G(t), the relaxation modulus. A fit assigns trial parameters, evaluates G at the times of the
#   data and hands the values to scipy's curve_fit. How many times there are should not matter.
# Seen: with 100 times or fewer the fit returns its start values; with 101 it is exact. G keeps its
#   last 100 results by time alone, and an assignment to `params` does not clear them. From 101 on
#   each result is dropped before its time comes round again, so nothing old is ever found.
#   curve_fit sees a residual that no parameter moves, and stops: a covariance warning is the only
#   sign. J(t), the creep compliance of the Maxwell model, never follows an assignment: it belongs
#   to the parameters of the constructor, so G and J of one object describe two materials.
# Why it matters: resampling a hold from 101 to 100 points turns a fitted relaxation time into the
#   guess, and a guess near the truth hides it. Make a new model for each set of parameters.
set -euo pipefail

dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/env"
"$dir/env/bin/pip" install --quiet --disable-pip-version-check \
  pyvisq==1.2.2 pymittagleffler==0.3.0 numpy==2.4.6 scipy==1.17.1 mpmath==1.4.1

"$dir/env/bin/python" - <<'PY'
import sys
import warnings
import numpy as np
from pyvisq.models.elements import DashpotParams, SpringParams
from pyvisq.models.maxwell import Maxwell, MaxwellParams
from scipy.optimize import OptimizeWarning, curve_fit

warnings.simplefilter("ignore", OptimizeWarning)
START, TRUE = (1.0, 1.0), (2.0, 5.0)  # kPa, kPa s: relaxation times of 1 and 2.5 s


def maxwell(k, c):
    return MaxwellParams(DashpotParams(c), SpringParams(k))


def fit(points, renew):
    """Spring and dashpot of an exact relaxation; one model assigned to, or a new one each time."""
    model = Maxwell(maxwell(*START))
    t = np.linspace(0.0, 10.0, points)

    def modulus(times, k, c):
        nonlocal model
        if renew:
            model = Maxwell(maxwell(k, c))
        else:
            model.params = maxwell(k, c)
        return np.array([model.G(at) for at in times])

    return curve_fit(modulus, t, TRUE[0] * np.exp(-t * TRUE[0] / TRUE[1]), p0=START)[0]


ok = True
print(f"true {TRUE}, start {START}")
for points in (50, 100, 101, 200):
    kept, new = fit(points, renew=False), fit(points, renew=True)
    print(f"{points:4} points: params assigned {np.round(kept, 6)}, new model {np.round(new, 6)}")
    ok &= np.allclose(new, TRUE) and np.allclose(kept, START if points <= 100 else TRUE)

model = Maxwell(maxwell(1.0, 1.0))
model.params = maxwell(10.0, 10.0)
g, j = model.G(2.0), model.J(2.0)
print(f"assigned k = 10, c = 10: G(2) = {g:.4f} (10 exp(-2) = {10 * np.exp(-2):.4f}), "
      f"J(2) = {j:.4f} (1/10 + 2/10 = 0.3)")
ok &= np.isclose(g, 10 * np.exp(-2)) and np.isclose(j, 3.0)
print("as described: up to 100 points keep the old parameters" if ok else "behaviour changed")
sys.exit(0 if ok else 1)
PY
