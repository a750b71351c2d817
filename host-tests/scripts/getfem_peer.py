#!/usr/bin/env python3
"""The solid's states by GetFEM, on the same elements: what a general finite element library gives. For development only.

    apt-get install --no-install-recommends python3-getfem
    OMP_NUM_THREADS=1 /usr/bin/python3 host-tests/scripts/getfem_peer.py --through 2 --along 60

The printed fingertip, 9 x 7 mm outside, wall 1 mm, Agilus30, unstretched, pressed by a rigid plate in 25 states 0.1 mm apart. Biquadratic
displacements, a pressure linear and discontinuous in each element, the fluid's pressure as one more unknown, the plate as a penalty as
stiff as in `model_tables::solid`, smoothed over a twenty-thousandth of the wall because GetFEM's Gauss points do not move with the contact's
edge. Each state starts from the parabola through the three before it. One row: settings, microseconds of CPU a state, Newton iterations
a state, and, separated by spaces, pressures in pascals and forces in newtons.
"""

import argparse
import math
import time

import getfem as gf
import numpy as np

RADIAL, AXIAL, THICKNESS = 9e-3, 7e-3, 1e-3
C1, C2 = 160355.0, 46559.0
MODULUS = 2.0 * (C1 + C2)
STATES, DEEPEST = 25, 2.5e-3
# As in `model_tables::solid`: contact pressure over penetration, in moduli over wall thicknesses; elements shorter at pole and rim.
STIFFNESS = 200.0
GRADING, FEW = 0.25, 24.0
# Width over which the plate's contact is smoothed, in wall thicknesses.
SMOOTH = 5e-5
RESIDUAL = 1e-9
ITERATIONS = 60


def mesh_of(height, thickness, through, along):
    """Elements of nine nodes, as `model_tables::solid::mesh`."""
    grading = GRADING * min((FEW / along) ** 2, 1.0) if through > 1 else 0.0
    part = np.arange(2 * along + 1) / (2 * along)
    t = 0.5 * math.pi * part - 0.25 * grading * np.sin(2.0 * math.pi * part)
    sin, cos = np.sin(t), np.cos(t)
    sin[0], cos[0], sin[-1], cos[-1] = 0.0, 1.0, 1.0, 0.0
    mesh = gf.Mesh("empty", 2)
    transformation = gf.GeoTrans("GT_QK(2,2)")
    for column in range(along):
        for layer in range(through):
            points = []
            # The first coordinate runs along the meridian.
            for i in range(3):
                for j in range(3):
                    line = 2 * column + j
                    inset = thickness * (1.0 - (2 * layer + i) / (2 * through))
                    points.append([(1.0 - inset) * sin[line], (height - inset) * cos[line]])
            mesh.add_convex(transformation, np.array(points).T)
    return mesh


def edges(mesh, through, along, face, layer=None, column=None):
    """Element and face numbers of a row or of a column of elements, whose numbers follow one another through the wall."""
    columns = range(along) if column is None else [column]
    layers = range(through) if layer is None else [layer]
    numbers = [c * through + l for c in columns for l in layers]
    return np.array([numbers, [face] * len(numbers)])


class Wall:
    """The wall, its fluid and the plate as a model of GetFEM. Lengths in outer radial semi-axes, stresses in shear moduli."""

    def __init__(self, through, along):
        self.height, self.thickness = AXIAL / RADIAL, THICKNESS / RADIAL
        mesh = mesh_of(self.height, self.thickness, through, along)
        pole, rim, inner, outer = 1, 2, 3, 4
        # Faces of the square: 0 and 1 across the first coordinate, from its end 1 and 0; 2 and 3 across the second.
        faces = self.faces(mesh)
        mesh.set_region(pole, edges(mesh, through, along, faces["start"], column=0))
        mesh.set_region(rim, edges(mesh, through, along, faces["end"], column=along - 1))
        mesh.set_region(inner, edges(mesh, through, along, faces["inside"], layer=0))
        mesh.set_region(outer, edges(mesh, through, along, faces["outside"], layer=through - 1))
        displacement = gf.MeshFem(mesh, 1)
        displacement.set_fem(gf.Fem("FEM_QK(2,2)"))
        constant = gf.MeshFem(mesh, 1)
        constant.set_fem(gf.Fem("FEM_QK(2,0)"))
        corners = gf.MeshFem(mesh, 1)
        corners.set_fem(gf.Fem("FEM_QK_DISCONTINUOUS(2,1)"))
        integration = gf.MeshIm(mesh, gf.Integ("IM_GAUSS_PARALLELEPIPED(2,5)"))
        contact = gf.MeshIm(mesh, gf.Integ("IM_GAUSS_PARALLELEPIPED(2,11)"))
        model = gf.Model("real")
        for name in ("r", "z"):
            model.add_fem_variable(name, displacement)
        for name in ("p0", "p1", "p2"):
            model.add_fem_variable(name, constant)
        model.add_fem_data("xi", corners)
        model.add_fem_data("eta", corners)
        elements = through * along
        model.set_variable("xi", np.tile([-1.0, 1.0, -1.0, 1.0], elements))
        model.set_variable("eta", np.tile([-1.0, -1.0, 1.0, 1.0], elements))
        model.add_variable("fluid", 1)
        model.add_initialized_data("plate", [self.height])
        c1, c2 = C1 / MODULUS, C2 / MODULUS
        model.set_variable("p0", np.full(constant.nbdof(), -(2.0 * c1 + 4.0 * c2)))
        ring = f"({2.0 * math.pi!r}*X(1))"
        a, b, c, d, hoop = "(1+Grad_r(1))", "Grad_r(2)", "Grad_z(1)", "(1+Grad_z(2))", "(1+r/X(1))"
        squares, area = f"({a}*{a}+{b}*{b}+{c}*{c}+{d}*{d})", f"({a}*{d}-{b}*{c})"
        energy = f"{c1!r}*({squares}+{hoop}*{hoop}-3)+{c2!r}*({area}*{area}+{hoop}*{hoop}*{squares}-3)"
        model.add_nonlinear_term(
            integration, f"{ring}*({energy}+(p0+p1*xi+p2*eta)*({area}*{hoop}-1))"
        )
        # The fluid's volume is -pi times the integral of r^2 n_r over the inner surface; Nanson's formula for the normal.
        swept = f"(X(1)+r)*(X(1)+r)*({d}*Normal(1)-{c}*Normal(2))-X(1)*X(1)*Normal(1)"
        model.add_nonlinear_term(integration, f"{math.pi!r}*fluid*({swept})", inner)
        width = SMOOTH * self.thickness
        stiffness = STIFFNESS / self.thickness
        depth = "(X(2)+z-plate)"
        self.push = (
            f"{stiffness!r}*{ring}*(pow(pos_part({depth}+{width!r}),2)-pow(pos_part({depth}-{width!r}),2))"
            f"/{4.0 * width!r}"
        )
        model.add_nonlinear_term(contact, f"{self.push}*Test_z", outer)
        model.add_Dirichlet_condition_with_simplification("r", pole)
        for name in ("r", "z"):
            model.add_Dirichlet_condition_with_simplification(name, rim)
        self.model, self.contact, self.outer = model, contact, outer
        self.iterations = 0

    @staticmethod
    def faces(mesh):
        """Which face of the first element is which, by the places of its points."""
        points = mesh.pts_from_cvid(0)[0]
        names = {}
        for face in range(4):
            on_face = mesh.pts()[:, mesh.pid_in_faces(np.array([[0], [face]]))]
            middle = on_face.mean(axis=1)
            start, end = points[:, [0, 3, 6]].mean(axis=1), points[:, [2, 5, 8]].mean(axis=1)
            inside, outside = points[:, :3].mean(axis=1), points[:, 6:].mean(axis=1)
            places = {"start": start, "end": end, "inside": inside, "outside": outside}
            names[min(places, key=lambda name: np.abs(places[name] - middle).sum())] = face
        return names

    def unknowns(self):
        return self.model.from_variables()

    def press(self, indentation, guess):
        """Newton's method from a guess; pressure and force in moduli."""
        model = self.model
        model.to_variables(guess)
        model.set_variable("plate", [self.height - indentation / RADIAL])
        done, _ = model.solve("lsolver", "mumps", "max_iter", ITERATIONS, "max_res", RESIDUAL)
        self.iterations += done
        force = gf.asm_generic(self.contact, 0, self.push, self.outer, model)
        return model.variable("fluid")[0] * MODULUS, force * MODULUS * RADIAL**2


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--through", type=int, default=2)
    words.add_argument("--along", type=int, default=60)
    words.add_argument("--states", type=int, default=STATES)
    arguments = words.parse_args()
    gf.util_trace_level(0)
    gf.util_warning_level(0)
    wall = Wall(arguments.through, arguments.along)
    depths = DEEPEST * np.arange(1, arguments.states + 1) / STATES
    pressures, forces, kept = [], [], [wall.unknowns()]
    start = time.process_time()
    for k, depth in enumerate(depths):
        guess = kept[-1] if k < 3 else 3.0 * kept[-1] - 3.0 * kept[-2] + kept[-3]
        pressure, force = wall.press(depth, guess)
        kept = [*kept[-2:], wall.unknowns()]
        pressures.append(pressure)
        forces.append(force)
    spent = time.process_time() - start
    count = len(depths)
    numbers = [" ".join(f"{x:.9e}" for x in values) for values in (pressures, forces)]
    print("model,settings,us_per_state,iterations,pressure_pa,force_n")
    print(
        f"getfem,{arguments.through} x {arguments.along},{spent * 1e6 / count:.0f},{wall.iterations / count:.2f},"
        + ",".join(numbers)
    )


if __name__ == "__main__":
    main()
