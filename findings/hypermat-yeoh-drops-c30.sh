#!/usr/bin/env bash
# Packages: hypermat 0.1.2, numpy 2.4.6, tensortrax 0.29.0, lmfit 1.3.4 (PyPI)
#
# Expected: hypermat.Yeoh(C10, C20, C30) is W = C10 (I1-3) + C20 (I1-3)^2 + C30 (I1-3)^3. The
#   package's description shows exactly this call, with C30 = 0.2, and prints a fitted C30.
#   Isihara(C10, C20, C01) should be the two-term Yeoh model when C01 = 0.
# Seen: Yeoh never reads its last coefficient. Stress is the same, bit for bit, for any C30, and
#   equals the closed form with C30 = 0; a fit returns the start value of C30. With the published
#   Yeoh constants of a silicone (Dragon Skin 10 Medium: 20.4, 4.47, -0.534 kPa) the uniaxial
#   stress is 20 % too high at stretch 2 and nine times too high at stretch 3.
#   Isihara multiplies its C20 and C01 terms: with C01 = 0 the C20 term is gone, and C01 adds
#   nothing to the stiffness at rest.
# Why it matters: the cubic term is why one picks Yeoh for a membrane beyond stretch 2. A check of
#   one's own model against this package fails, or worse, a fit of the first two terms looks fine.
#   Compare any Yeoh implementation with 2 (l - l^-2) (C10 + 2 C20 (I1-3) + 3 C30 (I1-3)^2).
set -euo pipefail

dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/env"
"$dir/env/bin/pip" install --quiet --disable-pip-version-check \
  hypermat==0.1.2 numpy==2.4.6 tensortrax==0.29.0 lmfit==1.3.4

MPLBACKEND=Agg MPLCONFIGDIR="$dir" "$dir/env/bin/python" - <<'PY'
import sys
import hypermat
import numpy as np


def uniaxial(material, stretch):
    """Engineering stress with free sides, material incompressible."""
    side = stretch**-0.5
    grad = np.zeros((1, 1, 3, 3))
    grad[0, 0] = np.diag([stretch, side, side])
    p = np.squeeze(material.jacobian(grad.T))
    return p[0, 0] - p[1, 1] * side / stretch


def closed_form(stretch, c10, c20, c30):
    k = stretch**2 + 2 / stretch - 3
    return 2 * (stretch - stretch**-2) * (c10 + 2 * c20 * k + 3 * c30 * k**2)


c10, c20, c30 = 20.4, 4.47, -0.534  # kPa
ok = True
print("Yeoh, kPa:  stretch   hypermat  C30 = 99   closed form  closed form without C30")
for stretch in (1.5, 2.0, 3.0):
    got = uniaxial(hypermat.Yeoh(C10=c10, C20=c20, C30=c30), stretch)
    other = uniaxial(hypermat.Yeoh(C10=c10, C20=c20, C30=99.0), stretch)
    want, two = closed_form(stretch, c10, c20, c30), closed_form(stretch, c10, c20, 0.0)
    print(f"{stretch:18.1f} {got:10.3f} {other:9.3f} {want:13.3f} {two:13.3f}")
    ok &= got == other and abs(got / two - 1) < 1e-9 and abs(got / want - 1) > 0.02
# The same with a bulk modulus, as in the package's example: K does not take the last place.
ok &= (uniaxial(hypermat.Yeoh(C10=c10, C20=c20, C30=c30, K=2000.0), 2.0)
       == uniaxial(hypermat.Yeoh(C10=c10, C20=c20, C30=99.0, K=2000.0), 2.0))

isihara = uniaxial(hypermat.Isihara(C10=c10, C20=c20, C01=0.0), 2.0)
print(f"Isihara with C01 = 0, stretch 2: {isihara:.3f}, two-term closed form "
      f"{closed_form(2.0, c10, c20, 0.0):.3f}, C10 alone {closed_form(2.0, c10, 0.0, 0.0):.3f}")
ok &= abs(isihara / closed_form(2.0, c10, 0.0, 0.0) - 1) < 1e-9
soft = uniaxial(hypermat.Isihara(C10=c10, C20=c20, C01=10.0), 1.001) / 0.001
print(f"Isihara with C01 = 10, modulus at rest: {soft:.1f}, 6 (C10 + C01) = {6 * (c10 + 10):.1f}, "
      f"6 C10 = {6 * c10:.1f}")
ok &= abs(soft / (6 * c10) - 1) < 0.01

# Control: the neo-Hookean model of the same package agrees with the closed form.
neo = uniaxial(hypermat.NeoHooke(C10=c10), 2.0)
control = abs(neo / closed_form(2.0, c10, 0.0, 0.0) - 1) < 1e-9
print(f"control, NeoHooke at stretch 2: {neo:.3f}, closed form {closed_form(2.0, c10, 0, 0):.3f}")
if ok and control:
    print("as described: the last Yeoh coefficient has no effect")
    sys.exit(0)
print("behaviour changed")
sys.exit(1)
PY
