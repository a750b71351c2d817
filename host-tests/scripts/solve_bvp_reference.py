#!/usr/bin/env python3
"""The same states by scipy's solve_bvp: what a user could reach for instead. For development only.

    pip install numpy scipy
    python3 host-tests/scripts/solve_bvp_reference.py            # both, in turns, and the ratio of their times
    python3 host-tests/scripts/solve_bvp_reference.py --help

Runs `cargo designer chart` for one design, reads the sweep's indentations and forces from its CSV, solves the same
states with solve_bvp (each from the one before), runs the chart again, and prints how much longer solve_bvp takes
than the fastest setting of ours whose worst error is not larger than solve_bvp's.

The formulation is one that suits a general solver: stretches and tangent angle as states, so that nothing has to
be inverted at a point, height and volume beside them, pressure and contact parameter unknown, both zones on [0, 1].
"""

import argparse
import csv
import pathlib
import subprocess
import tempfile
import time

import numpy as np
from scipy.integrate import solve_bvp

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Lengths in metres, stresses in pascals: the designs of `cargo designer chart`.
DESIGNS = {
    "paper": dict(a0=4.5e-3, b0=2.7e-3, h0=1e-3, c1=160355.0, c2=46559.0, stretch=2.3),
    "finger": dict(a0=9e-3, b0=7e-3, h0=1e-3, c1=160355.0, c2=46559.0, stretch=1.02),
    "skin": dict(a0=9e-3, b0=7e-3, h0=1e-3, c1=13400.0, c2=29500.0, stretch=1.1),
}
NODES = 11
# A mesh that has grown beyond this is thinned before the next state.
MOST_KEPT = 400
MOST_NODES = 20000


class Membrane:
    """Lengths over a0, stresses over the shear modulus, pressures over modulus times h0 / a0."""

    def __init__(self, a0, b0, h0, c1, c2, stretch):
        self.aspect = b0 / a0
        modulus = 2.0 * (c1 + c2)
        self.c1, self.c2 = c1 / modulus, c2 / modulus
        self.stretch = stretch
        self.length = a0
        self.force = modulus * h0 * a0

    def law(self, l1, l2):
        """W_1, W_2, W_11, W_12 of the Mooney-Rivlin law."""
        a, b = l1 * l1, l2 * l2
        c = 1.0 / (a * b)
        first, second = self.c1 + self.c2 * b, self.c1 + self.c2 * a
        return (
            2.0 * (l1 - c / l1) * first,
            2.0 * (l2 - c / l2) * second,
            2.0 * (1.0 + 3.0 * c / a) * first,
            4.0 * (self.c1 * c / (l1 * l2) + self.c2 * l1 * l2),
        )

    def rates(self, t, u, l1, angle, pressure):
        """Rates of u = rho / x, l1, angle, height and volume over the meridian's parameter; no angle: contact."""
        x, x_rate = np.sin(t), np.cos(t)
        g = np.sqrt(x_rate**2 + (self.aspect * x) ** 2)
        pole = x < 1e-12
        x = np.where(pole, 1.0, x)
        w_1, w_2, w_11, w_12 = self.law(l1, u)
        cos = 1.0 if angle is None else np.cos(angle)
        u_rate = np.where(pole, 0.0, (g * l1 * cos - x_rate * u) / x)
        # (rho T1)' = rho' T2 with rho T1 = x W_1, T2 = W_2 / l1.
        w_1_rate = np.where(pole, 0.0, (g * cos * w_2 - x_rate * w_1) / x)
        l1_rate = (w_1_rate - w_12 * u_rate) / w_11
        if angle is None:
            return u_rate, l1_rate
        sin = np.sin(angle)
        # phi' = l1 g (P - T2 sin(phi) / rho) / T1; at the pole half of l1 g P / T1.
        turn = np.where(pole, 0.5 * pressure * l1, pressure * l1 - w_2 * sin / (u * x)) * g * u / w_1
        descent = g * l1 * sin
        return u_rate, l1_rate, turn, descent, np.pi * (u * x) ** 2 * descent

    def rest(self, tolerance):
        """Inflated to the pole stretch: pressure, edge stretch, height, volume, and the solution."""

        def rates(z, y, p):
            return 0.5 * np.pi * np.vstack(self.rates(0.5 * np.pi * z, y[0], y[1], y[2], p[0]))

        def ends(ya, yb, p):
            stretch = self.stretch
            return np.array([ya[0] - stretch, ya[1] - stretch, ya[2], ya[3], ya[4], yb[2] - 0.5 * np.pi])

        # From the sphere, whose state is known, to the design's shape.
        z = np.linspace(0.0, 1.0, 2 * NODES)
        angle = 0.5 * np.pi * z
        radius = self.stretch
        guess = np.vstack([self.stretch + 0 * z, self.stretch + 0 * z, angle, radius * (1 - np.cos(angle)),
                           np.pi * radius**3 * (2 / 3 - np.cos(angle) + np.cos(angle) ** 3 / 3)])
        parameters = [2.0 * self.law(self.stretch, self.stretch)[0] / self.stretch**2]
        aspect = self.aspect
        for part in np.linspace(0.0, 1.0, 9):
            self.aspect = aspect**part
            limit = tolerance if part == 1.0 else 1e-3
            solution = solve_bvp(rates, ends, z, guess, p=parameters, tol=limit, max_nodes=MOST_NODES)
            if not solution.success:
                raise RuntimeError(f"rest state: {solution.message}")
            z, guess, parameters = solution.x, solution.y, solution.p
        return solution.p[0], solution.y[0, -1], solution.y[3, -1], solution.y[4, -1], solution


def sweep(membrane, indentations, tolerance):
    """Forces at the indentations (metres), seconds spent on them, and what stopped it if anything did."""
    pressure, edge, height, volume, inflated = membrane.rest(max(1e-7, 1e-2 * tolerance))

    def pressed(target):
        def rates(z, y, p):
            pressure, contact = p
            under = membrane.rates(contact * z, y[0], y[1], None, pressure)
            length = 0.5 * np.pi - contact
            free = membrane.rates(contact + length * z, y[2], y[3], y[4], pressure)
            return np.vstack([contact * np.vstack(under), length * np.vstack(free)])

        def ends(ya, yb, p):
            return np.array(
                [
                    ya[1] - ya[0],
                    yb[0] - ya[2],
                    yb[1] - ya[3],
                    ya[4],
                    yb[2] - edge,
                    ya[5],
                    yb[5] - (height - target),
                    ya[6],
                    yb[6] - volume,
                ]
            )

        return rates, ends

    forces, spent = [], 0.0
    z = np.linspace(0.0, 1.0, NODES)
    contact = 0.1
    half = 0.5 * np.pi
    under, free = inflated.sol(contact / half * z), inflated.sol((contact + (half - contact) * z) / half)
    guess = np.vstack([under[:2], free])
    guess[4:] -= guess[4:, :1]
    parameters = np.array([pressure, contact])
    before = None
    for indentation in indentations:
        rates, ends = pressed(indentation / membrane.length)
        start = time.perf_counter()
        solution = solve_bvp(rates, ends, z, guess, p=parameters, tol=tolerance, max_nodes=MOST_NODES)
        spent += time.perf_counter() - start
        if not solution.success:
            return forces, spent, f"at {indentation * 1e3:.3f} mm: {solution.message}"
        pressure, contact = solution.p
        radius = solution.y[2, 0] * np.sin(contact)
        forces.append(pressure * np.pi * radius**2 * membrane.force)
        # From the state before on its mesh; the parameters go on along their last step.
        z, guess = solution.x, solution.y
        parameters = solution.p if before is None else 2.0 * solution.p - before
        before = solution.p
        if len(z) > MOST_KEPT:
            z, guess = z[::2], solution.y[:, ::2]
            if z[-1] != 1.0:
                z, guess = np.append(z, 1.0), np.column_stack([guess, solution.y[:, -1]])
    return forces, spent, None


def chart(design):
    """Ours: rows of the benchmark, and the sweep's indentations and forces."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["cargo", "designer", "chart", design, "--out", folder], cwd=ROOT, check=True,
                       stdout=subprocess.DEVNULL)
        def rows(name):
            return list(csv.DictReader(open(pathlib.Path(folder) / name, newline="")))

        return rows("speed-accuracy.csv"), rows("sweeps.csv")


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--design", choices=DESIGNS, default="paper")
    words.add_argument("--tolerances", default="1e-4,1e-6", help="of solve_bvp, separated by commas")
    words.add_argument("--repetitions", type=int, default=3)
    arguments = words.parse_args()
    tolerances = [float(text) for text in arguments.tolerances.split(",")]

    benchmark, states = chart(arguments.design)
    contests = [benchmark]
    indentations = [float(row["indentation_mm"]) * 1e-3 for row in states]
    truth = np.array([float(row["force_n"]) for row in states])
    membrane = Membrane(**DESIGNS[arguments.design])
    theirs = {tolerance: [] for tolerance in tolerances}
    for _ in range(arguments.repetitions):
        for tolerance in tolerances:
            theirs[tolerance].append(sweep(membrane, indentations, tolerance))
    contests.append(chart(arguments.design)[0])

    print("method,worst_force_error,median_force_error,us_per_state,ratio")
    for tolerance, runs in theirs.items():
        forces, _, stopped = runs[0]
        if stopped:
            print(f"solve_bvp tol {tolerance:g}: {stopped}")
            continue
        errors = np.abs(np.array(forces) / truth - 1.0)
        seconds = np.median([spent for _, spent, _ in runs]) / len(forces)
        best = None
        for row, again in zip(*contests):
            ours = row["method"] == "collocation" and row["outcome"] == "ok"
            if ours and float(row["worst_force_error"]) <= errors.max():
                # The slower of the run before and the run after.
                micro = max(float(row["us_per_state"]), float(again["us_per_state"]))
                if best is None or micro < best[0]:
                    best = micro, row
        print(f"solve_bvp tol {tolerance:g},{errors.max():.2e},{np.median(errors):.2e},{seconds * 1e6:.1f},")
        if best is None:
            print("  no setting of ours is that accurate")
            continue
        micro, row = best
        print(
            f"collocation {row['settings']},{float(row['worst_force_error']):.2e},"
            f"{float(row['median_force_error']):.2e},{micro:.1f},{seconds * 1e6 / micro:.0f}"
        )


if __name__ == "__main__":
    main()
