#!/usr/bin/env bash
# Packages: casadi 3.8.2, numpy 2.4.6 (PyPI)
#
# Expected: one lookup table, two `solver` names of casadi.interpolant ("linear" and "bspline").
#   The help text of casadi.interpolant presents both as plugins of one lookup table, with the
#   same constructor, and states no rule for arguments outside the grid. A reader expects one
#   rule for both: hold the last value (as numpy.interp does) or go on from the last interval.
# Seen: "linear" continues the outermost interval. "bspline" returns exactly 0, with slope 0,
#   for any argument outside the grid, on either side and in each dimension on its own: the table
#   drops from its largest value to zero at the first argument above the last point.
# Why it matters: a pressure -> force table made for 0..60 kPa gives "no force" at 60.01 kPa,
#   the hardest grasp. A Newton or optimal-control step that leaves the grid finds a flat zero.
#   Clamp the argument before the call, or give the grid a margin.
set -euo pipefail

dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/env"
"$dir/env/bin/pip" install --quiet --disable-pip-version-check casadi==3.8.2 numpy==2.4.6

"$dir/env/bin/python" - <<'PY'
import sys
import casadi
import numpy as np

kpa = np.linspace(0.0, 60.0, 13)
newton = 0.5 * np.sqrt(kpa)          # a monotone table, 3.873 N at 60 kPa
tables = {s: casadi.interpolant("t", s, [kpa], newton) for s in ("linear", "bspline")}


def slope(table, at):
    x = casadi.MX.sym("x")
    return float(casadi.Function("d", [x], [casadi.jacobian(table(x), x)])(at))


print(f"{'kPa':>8} {'numpy':>8} {'linear':>8} {'bspline':>8} {'slope':>8}")
for p in (-0.01, 30.0, 59.99, 60.0, 60.01, 61.0):
    lin, spl = (float(tables[s](p)) for s in ("linear", "bspline"))
    print(f"{p:8.2f} {np.interp(p, kpa, newton):8.4f} {lin:8.4f} {spl:8.4f} "
          f"{slope(tables['bspline'], p):8.4f}")

# Two axes: z = x + y, an argument outside on one axis alone.
axis = np.linspace(0.0, 1.0, 5)
plane = casadi.interpolant("p", "bspline", [axis, axis], np.add.outer(axis, axis).ravel(order="F"))
print(f"x + y at (0.5, 1.00): {float(plane([0.5, 1.0])):.3f}, "
      f"at (0.5, 1.01): {float(plane([0.5, 1.01])):.3f}")

spl, lin = tables["bspline"], tables["linear"]
inside = abs(float(spl(60.0)) - newton[-1]) < 1e-9 and float(spl(59.99)) > 3.87
continues = float(lin(60.01)) > newton[-1]
zero = all(float(spl(p)) == 0.0 and slope(spl, p) == 0.0 for p in (-0.01, 60.01, 61.0))
corner = abs(float(plane([0.5, 1.0])) - 1.5) < 1e-9 and float(plane([0.5, 1.01])) == 0.0
if inside and continues and zero and corner:
    print("as described: the spline table is zero outside its grid, the linear one goes on")
    sys.exit(0)
print("behaviour changed")
sys.exit(1)
PY
