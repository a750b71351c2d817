#!/usr/bin/env python3
"""The membrane's states by direct collocation in CasADi: exact sparse derivatives, the whole Newton loop as C. For development only.

    pip install casadi numpy
    python3 host-tests/scripts/casadi_peer.py SWEEP.csv --design paper

`SWEEP.csv` has the columns `indentation_mm` and `force_n` (and, if it is there, `pressure_pa`) of the states to solve, as
`host-tests/scripts/peers.py` writes it. For each setting one row: elements, degree, largest and median error of the force, and
microseconds of CPU a state.

Stretches and tangent angle are the states, height and volume go with them, pressure and contact parameter are unknown; both zones are
cut into elements with Gauss points. CasADi writes residual, Jacobian, its sparse QR factors and Newton's loop as C
(`rootfinder` with `fast_newton`), and the sweep itself is C too. Of two ways one is what a user writes first, the other was tuned to this
sweep: it knows beforehand which elements the design needs, where `model_tables` finds them by itself.
"""

import argparse
import csv
import ctypes
import math
import pathlib
import subprocess
import tempfile

import casadi as ca
import numpy as np

from solve_bvp_reference import DESIGNS, Membrane

# Elements under the plate and beyond, Gauss points an element, exponent of the grading.
SETTINGS = {
    # Equal elements, each state from the one before: what a user writes first.
    "plain": [(2, 8, 4, 1.0), (2, 12, 4, 1.0), (2, 16, 4, 1.0), (2, 16, 5, 1.0), (2, 24, 5, 1.0)],
    # Elements that shrink towards the contact's edge, each state from the parabola through three: the fastest of some forty settings.
    "tuned": [
        (1, 5, 3, 2.0), (1, 3, 5, 2.0), (1, 5, 4, 2.0), (1, 4, 5, 3.0), (1, 5, 5, 3.0), (1, 6, 5, 2.5), (2, 8, 5, 2.0), (1, 6, 6, 3.0),
    ],
}  # fmt: skip
# Where Newton's method stops: largest residual, dimensionless.
RESIDUAL = 1e-9
ITERATIONS = 20
REPEATS = 7
# Of the C compiler; the processor it runs on.
FLAGS = ["-O3", "-march=native", "-ffast-math"]

SWEEP_IN_C = """
#include <string.h>
#include <time.h>
/* One sweep: every state from the one before, or from the parabola through the three before it. CPU seconds, or a negative number where Newton's method failed. */
double sweep(int states, int parabola, const double *indentations, const double *start, double *solutions) {
  enum { N = %(unknowns)d };
  static casadi_real work[%(work)d];
  static casadi_int iwork[%(iwork)d];
  const casadi_real *arguments[%(arguments)d];
  casadi_real *results[%(results)d];
  casadi_real guess[N];
  struct timespec from, to;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &from);
  for (int k = 0; k < states; ++k) {
    double h = indentations[k];
    if (k < 3 || !parabola) {
      memcpy(guess, k ? solutions + (k - 1) * N : start, sizeof guess);
    } else {
      double a = indentations[k - 3], b = indentations[k - 2], c = indentations[k - 1];
      double u = (h - b) * (h - c) / ((a - b) * (a - c));
      double v = (h - a) * (h - c) / ((b - a) * (b - c));
      double w = (h - a) * (h - b) / ((c - a) * (c - b));
      const double *x = solutions + (k - 3) * N, *y = x + N, *z = y + N;
      for (int i = 0; i < N; ++i) guess[i] = u * x[i] + v * y[i] + w * z[i];
    }
    arguments[0] = guess;
    arguments[1] = &h;
    results[0] = solutions + k * N;
    if (solve(arguments, results, iwork, work, 0)) return -1 - k;
  }
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &to);
  return (to.tv_sec - from.tv_sec) + 1e-9 * (to.tv_nsec - from.tv_nsec);
}
"""


class Collocation:
    """Nodes of Gauss's method on [0, 1], its differentiation matrix and its weights."""

    def __init__(self, degree):
        points = np.array([0.0, *ca.collocation_points(degree, "legendre")])
        self.nodes = points[1:]
        self.slopes = np.zeros((degree + 1, degree))
        self.end = np.zeros(degree + 1)
        for i in range(degree + 1):
            others = np.delete(points, i)
            basis = np.poly1d(np.poly(others)) / np.prod(points[i] - others)
            self.slopes[i] = np.polyder(basis)(self.nodes)
            self.end[i] = basis(1.0)
        legendre = np.polynomial.legendre.leggauss(degree)
        self.weights = 0.5 * legendre[1][np.argsort(legendre[0])]


class Peer:
    """Residual of a pressed membrane as CasADi's expressions, and a guess for its unknowns."""

    def __init__(self, membrane, contact, free, degree, grading, rest):
        self.membrane = membrane
        pressure, edge, height, volume, inflated = rest
        method = Collocation(degree)
        self.pressure, self.angle = ca.SX.sym("P"), ca.SX.sym("tc")
        depth = ca.SX.sym("H")
        unknowns, equations, guess = [], [], []
        half = 0.5 * math.pi
        contact_guess = 0.1

        def unknown(name, value):
            symbol = ca.SX.sym(name)
            unknowns.append(symbol)
            guess.append(value)
            return symbol

        def shape(t):
            u, l1, angle = inflated.sol(t / half)[:3]
            return float(u), float(l1), float(angle)

        # Under the plate: u and l1. The stretches of the pole are equal.
        fractions = np.linspace(0.0, 1.0, contact + 1)
        stretch = unknown("l0", shape(0.0)[0])
        node = [stretch, stretch]
        for left, right in zip(fractions, fractions[1:]):
            length = self.angle * (right - left)
            stages = []
            for c in method.nodes:
                u, l1, _ = shape(contact_guess * (left + c * (right - left)))
                stages.append([unknown("u", u), unknown("l1", l1)])
            for j, c in enumerate(method.nodes):
                t = self.angle * (left + c * (right - left))
                rates = self.rates(t, stages[j][0], stages[j][1], None)
                for i in range(2):
                    slope = method.slopes[0, j] * node[i]
                    slope += sum(method.slopes[k + 1, j] * stages[k][i] for k in range(degree))
                    equations.append(slope - length * rates[i])
            u, l1, _ = shape(contact_guess * right)
            after = [unknown("u", u), unknown("l1", l1)]
            for i in range(2):
                end = method.end[0] * node[i] + sum(method.end[k + 1] * stages[k][i] for k in range(degree))
                equations.append(end - after[i])
            node = after
        # Beyond: the tangent angle too, from 0 on; height and volume only from node to node.
        fractions = np.linspace(0.0, 1.0, free + 1) ** grading
        node = [*node, 0.0]
        descended, enclosed = 0.0, 0.0
        span, span_guess = half - self.angle, half - contact_guess
        for k_element, (left, right) in enumerate(zip(fractions, fractions[1:])):
            length = span * (right - left)
            stages, sums = [], [0.0, 0.0]

            def place(part):
                return contact_guess + span_guess * (left + part * (right - left))

            for c in method.nodes:
                u, l1, angle = shape(place(c))
                stages.append([unknown("u", u), unknown("l1", l1), unknown("phi", angle)])
            for j, c in enumerate(method.nodes):
                t = self.angle + span * (left + c * (right - left))
                rates = self.rates(t, *stages[j])
                for i in range(3):
                    slope = method.slopes[0, j] * node[i]
                    slope += sum(method.slopes[k + 1, j] * stages[k][i] for k in range(degree))
                    equations.append(slope - length * rates[i])
                for i in range(2):
                    sums[i] += method.weights[j] * length * rates[3 + i]
            u, l1, angle = shape(place(1.0))
            after = [unknown("u", u), unknown("l1", l1), unknown("phi", angle)]
            for i in range(3):
                end = method.end[0] * node[i] + sum(method.end[k + 1] * stages[k][i] for k in range(degree))
                equations.append(end - after[i])
            node = after
            if k_element == 0:
                first = [after, right]
            last = k_element + 1 == free
            down = height - depth if last else unknown("eta", float(inflated.sol(place(1.0) / half)[3]))
            inside = volume if last else unknown("V", float(inflated.sol(place(1.0) / half)[4]))
            equations += [down - descended - sums[0], inside - enclosed - sums[1]]
            descended, enclosed = down, inside
        equations.append(node[0] - edge)
        unknowns += [self.pressure, self.angle]
        guess += [pressure, contact_guess]
        self.unknowns = ca.vertcat(*unknowns)
        self.guess = np.array(guess)
        self.residual = ca.Function("residual", [self.unknowns, depth], [ca.vertcat(*equations)])
        # Where the contact ends: its hoop stretch is the last of the contact's unknowns.
        self.edge_index = 1 + contact * (2 * degree + 2) - 2

    def rates(self, t, u, l1, angle):
        """As `Membrane.rates`, away from the pole."""
        membrane = self.membrane
        x, x_rate = ca.sin(t), ca.cos(t)
        g = ca.sqrt(x_rate**2 + (membrane.aspect * x) ** 2)
        w_1, w_2, w_11, w_12 = membrane.law(l1, u)
        cos = 1.0 if angle is None else ca.cos(angle)
        u_rate = (g * l1 * cos - x_rate * u) / x
        l1_rate = ((g * cos * w_2 - x_rate * w_1) / x - w_12 * u_rate) / w_11
        if angle is None:
            return u_rate, l1_rate
        sin = ca.sin(angle)
        turn = (self.pressure * l1 - w_2 * sin / (u * x)) * g * u / w_1
        descent = g * l1 * sin
        return u_rate, l1_rate, turn, descent, math.pi * (u * x) ** 2 * descent

    def library(self, folder):
        """The sweep as a shared library."""
        options = {"abstol": RESIDUAL, "max_iter": ITERATIONS, "error_on_fail": False}
        solve = ca.rootfinder("solve", "fast_newton", self.residual, options)
        code = ca.CodeGenerator("solve.c", {"with_header": False})
        code.add(solve)
        code.generate(f"{folder}/")
        sizes = {
            "unknowns": len(self.guess),
            "arguments": solve.sz_arg(),
            "results": solve.sz_res(),
            "iwork": max(1, solve.sz_iw()),
            "work": max(1, solve.sz_w()),
        }
        source = pathlib.Path(folder) / "solve.c"
        source.write_text(source.read_text() + SWEEP_IN_C % sizes)
        shared = source.with_suffix(".so")
        subprocess.run(["cc", *FLAGS, "-shared", "-fPIC", source, "-o", shared, "-lm"], check=True)
        sweep = ctypes.CDLL(str(shared)).sweep
        sweep.restype = ctypes.c_double
        return sweep


def measure(membrane, rest, setting, parabola, indentations):
    """Forces, pressures and seconds of CPU a state, or what failed."""
    peer = Peer(membrane, *setting, rest)
    depths = np.array(indentations) / membrane.length
    solutions = np.zeros((len(depths), len(peer.guess)))
    pointer = ctypes.POINTER(ctypes.c_double)
    with tempfile.TemporaryDirectory() as folder:
        sweep = peer.library(folder)
        # To the first state by way of smaller contacts, so that a poor guess is no question of the sweep.
        start = np.ascontiguousarray(peer.guess)
        way = np.ascontiguousarray(depths[0] * np.array([0.9, 0.95, 1.0]))
        found = np.zeros((3, len(peer.guess)))

        def run(depths, start, into):
            seconds = sweep(
                len(depths), int(parabola), depths.ctypes.data_as(pointer), start.ctypes.data_as(pointer), into.ctypes.data_as(pointer)
            )
            return seconds

        if run(way, start, found) < 0:
            return None
        start = np.ascontiguousarray(found[-1])
        seconds = [run(depths, start, solutions) for _ in range(REPEATS)]
    if min(seconds) < 0 or not np.isfinite(solutions).all():
        return None
    residuals = [np.abs(np.array(peer.residual(x, h))).max() for x, h in zip(solutions, depths)]
    if max(residuals) > 1e-6:
        return None
    pressure, angle = solutions[:, -2], solutions[:, -1]
    radius = solutions[:, peer.edge_index] * np.sin(angle)
    forces = pressure * math.pi * radius**2 * membrane.force
    return forces, pressure * membrane.force / membrane.length**2, min(seconds) / len(depths)


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("sweep", help="CSV of the states")
    words.add_argument("--design", choices=DESIGNS, default="paper")
    arguments = words.parse_args()
    rows = list(csv.DictReader(open(arguments.sweep, newline="")))
    indentations = [float(row["indentation_mm"]) * 1e-3 for row in rows]
    truth = np.array([float(row["force_n"]) for row in rows])
    membrane = Membrane(**DESIGNS[arguments.design])
    rest = membrane.rest(1e-9)
    print("way,settings,worst_force_error,median_force_error,worst_pressure_error,us_per_state")
    for way, setting in [(way, setting) for way, settings in SETTINGS.items() for setting in settings]:
        found = measure(membrane, rest, setting, way == "tuned", indentations)
        name = f"{way}," + "{} + {} elements degree {} grading {}".format(*setting)
        if found is None:
            print(f"{name},,,,")
            continue
        forces, pressures, seconds = found
        errors = np.abs(forces / truth - 1.0)
        pressure_error = ""
        if "pressure_pa" in rows[0]:
            known = np.array([float(row["pressure_pa"]) for row in rows])
            pressure_error = f"{np.abs(pressures / known - 1.0).max():.2e}"
        print(f"{name},{errors.max():.2e},{np.median(errors):.2e},{pressure_error},{seconds * 1e6:.1f}", flush=True)


if __name__ == "__main__":
    main()
