#!/usr/bin/env bash
# Packages: matadi 0.5.0, casadi 3.8.2, numpy 2.4.6, scipy 1.17.1, matplotlib 3.11.2 (PyPI)
#
# Expected: matadi offers mooney_rivlin(C10, C01), W = C10 (I1-3) + C01 (I2-3), and the material
#   ViscoelasticMooneyRivlin(c10, c01, eta, dtime). The viscous one, so slow that nothing relaxes,
#   should answer a first step with the stress of the elastic one for the same two numbers, and
#   relax with eta over the shear modulus 2 (c10 + c01) that Mooney-Rivlin constants imply.
# Seen: half the stress at every stretch (to 1e-4), and twice that relaxation time. The viscous
#   model keeps the notation of the paper it cites (doi 10.1002/nme.5724), with c/2 before each
#   invariant: its c10 + c01 is the shear modulus itself. The docstrings do not say so.
# Why it matters: a Maxwell branch added to a fitted Mooney-Rivlin membrane with its own constants
#   carries half the overstress, for twice as long. Pass 2 C10 and 2 C01, and check the first step
#   and the decay separately.
set -euo pipefail

dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/env"
"$dir/env/bin/pip" install --quiet --disable-pip-version-check \
  matadi==0.5.0 casadi==3.8.2 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2

MPLBACKEND=Agg MPLCONFIGDIR="$dir" "$dir/env/bin/python" - <<'PY'
import math
import sys
import numpy as np
from matadi import MaterialHyperelastic
from matadi.models import ViscoelasticMooneyRivlin, mooney_rivlin

C10, C01 = 0.160, 0.047  # MPa


def grad(stretch):
    return np.diag([stretch, stretch**-0.5, stretch**-0.5]).reshape(3, 3, 1, 1)


def uniaxial(p, stretch):
    p = np.squeeze(p)
    return float(p[0, 0] - p[1, 1] * stretch**-1.5)  # sides free, incompressible


def elastic(stretch):
    material = MaterialHyperelastic(mooney_rivlin, C10=C10, C01=C01, bulk=0.0)
    return uniaxial(material.gradient([grad(stretch)])[0], stretch)


def hold(stretch, c10, c01, eta, dtime, steps):
    material = ViscoelasticMooneyRivlin(c10=c10, c01=c01, eta=eta, dtime=dtime)
    state = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]).reshape(6, 1, 1, 1)
    stress = []
    for _ in range(steps):
        p, state = material.function([grad(stretch), state])
        stress.append(uniaxial(p, stretch))
    return stress


ok = True
print("first step, nothing relaxed:  stretch  closed form  mooney_rivlin  viscous  viscous, doubled")
for stretch in (1.01, 1.5, 2.0):
    want = 2 * (stretch - stretch**-2) * (C10 + C01 / stretch)
    plain = elastic(stretch)
    visc = hold(stretch, C10, C01, 1e9, 1.0, 1)[0]
    twice = hold(stretch, 2 * C10, 2 * C01, 1e9, 1.0, 1)[0]
    print(f"{stretch:36.2f} {want:12.6f} {plain:14.6f} {visc:8.6f} {twice:17.6f}")
    ok &= abs(plain / want - 1) < 1e-6
    ok &= abs(visc / want - 0.5) < 1e-3 and abs(twice / want - 1) < 1e-3

stress = hold(1.001, C10, C01, eta=1.0, dtime=0.002, steps=501)
tau = -1.0 / math.log(stress[500] / stress[0])
print(f"held strain: relaxation time {tau:.3f} s, eta / 2 (C10 + C01) = {0.5 / (C10 + C01):.3f} s, "
      f"eta / (C10 + C01) = {1 / (C10 + C01):.3f} s")
ok &= abs(tau * (C10 + C01) - 1) < 0.01
if ok:
    print("as described: the same two constants mean half the stiffness in the viscous model")
    sys.exit(0)
print("behaviour changed")
sys.exit(1)
PY
