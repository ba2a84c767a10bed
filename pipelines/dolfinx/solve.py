#!/usr/bin/python3
"""Solve a scene with mixed elements, quadratic triangles or tetrahedra with linear pressure, by dolfinx: solve.py SCENE MESH_STREAM > u.dat

MESH_STREAM is what `nodes` writes. Understood of a scene: one neo-Hookean material, displacements by components or along the normal of a
side across an axis. Writes a text stream of nodes.x and u, of all nodes of the elements, and of reactions. Prints on standard error nodes,
Newton iterations, and processor seconds of one thread: of assembly, of the direct solver, MUMPS, and of these with making mesh and spaces. The
forms are compiled, once for each dimension: that is not counted. The load comes in one step, or in as few equal ones as Newton's method needs.
Exit status: 0; 1 no equilibrium; 2 a scene that is not understood.
"""

import configparser
import logging
import os
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../tools/python"))
os.environ["OMP_NUM_THREADS"] = "1"
logging.disable(logging.INFO)  # of what is compiled

try:
    import dolfinx  # noqa: E402
except ImportError:
    sys.exit("solve.py: no dolfinx: run make deps-dolfinx")
import mtled  # noqa: E402
import numpy as np  # noqa: E402
import ufl  # noqa: E402
from dolfinx import fem  # noqa: E402
from mpi4py import MPI  # noqa: E402
from petsc4py import PETSc  # noqa: E402

MOST_ITERATIONS, TOLERANCE, MOST_STEPS, MOST_HALVES = 20, 1e-4, 16, 5


def die(message):
    print("solve.py: " + message, file=sys.stderr)
    sys.exit(2)


def read_scene(path):
    scene = configparser.ConfigParser(inline_comment_prefixes=("#", ";"), interpolation=None)
    scene.optionxform = str
    scene.read(path)
    return scene


def prescribed(scene, stream):
    """A list of (name of the section, facets of a group, component, value in m)."""
    names, of_facet = stream["facets.set"].names, np.asarray(stream["facets.set"]).ravel()
    facets, x = np.asarray(stream["facets"]), np.asarray(stream["nodes.x"])
    rows = []
    for section in scene.sections():
        if not section.startswith("displacement "):
            continue
        given = scene[section]
        for group in given["facets"].split(","):
            chosen = facets[of_facet == names.index(group.strip())]
            if "components" in given:
                values = [(axis, value) for axis, value in enumerate(given["components"].split(",")) if value.strip() != "free"]
            elif "normal" in given:
                axis = int(np.ptp(x[chosen.ravel()], axis=0).argmin())
                outwards = 1.0 if x[chosen[0, 0], axis] > x[:, axis].mean() else -1.0
                values = [(axis, outwards * float(given["normal"]))]
            else:
                die(f"[{section}]: only components, or normal")
            rows += [(section.split()[1], chosen, axis, float(value)) for axis, value in values]
    return rows


class Body:
    """Mesh, spaces and forms of a scene."""

    def __init__(self, scene, stream):
        x, cells = np.asarray(stream["nodes.x"]), np.asarray(stream["cells"]).astype(np.int64)
        material = [scene[name] for name in scene.sections() if name.startswith("material ")]
        if len(material) != 1 or material[0].get("model", "neo-hookean") != "neo-hookean":
            die("only one neo-Hookean material")
        young, poisson = float(material[0]["E"]), float(material[0]["nu"])
        self.dim = x.shape[1]
        started = time.process_time()
        cell = "triangle" if self.dim == 2 else "tetrahedron"
        flat = ufl.Mesh(ufl.VectorElement("Lagrange", cell, 1))
        self.mesh = dolfinx.mesh.create_mesh(MPI.COMM_SELF, cells, x, flat)
        quadratic = ufl.VectorElement("Lagrange", cell, 2)
        self.space = fem.FunctionSpace(self.mesh, ufl.MixedElement(quadratic, ufl.FiniteElement("Lagrange", cell, 1)))
        self.state = fem.Function(self.space)
        self.prepare = time.process_time() - started
        shear = fem.Constant(self.mesh, PETSc.ScalarType(young / (2 * (1 + poisson))))
        bulk = fem.Constant(self.mesh, PETSc.ScalarType(young / (3 * (1 - 2 * poisson))))
        u, p = ufl.split(self.state)
        F = ufl.Identity(self.dim) + ufl.grad(u)
        J = ufl.det(F)
        trace = ufl.inner(F, F) + (3 - self.dim)
        energy = (shear / 2 * (J ** (-2 / 3) * trace - 3) + p * (J - 1) - p * p / (2 * bulk)) * ufl.dx
        residual = ufl.derivative(energy, self.state)
        self.residual = fem.form(residual)
        self.stiffness = fem.form(ufl.derivative(residual, self.state))

    def facet_numbers(self):
        """The number of each boundary facet, by the sorted nodes of the stream."""
        dim = self.dim
        self.mesh.topology.create_connectivity(dim - 1, dim)
        numbers = np.array(dolfinx.mesh.exterior_facet_indices(self.mesh.topology), dtype=np.int32)
        places = dolfinx.cpp.mesh.entities_to_geometry(self.mesh._mesh, dim - 1, numbers, False)
        original = np.asarray(self.mesh.geometry.input_global_indices)
        return {tuple(sorted(original[row])): number for row, number in zip(places, numbers)}

    def conditions(self, rows):
        """Values at share 1 of the load, the constants that hold them, and the conditions themselves."""
        number = self.facet_numbers()
        values, constants, conditions, dofs = [], [], [], []
        for _, facets, axis, value in rows:
            chosen = np.array(sorted(number[tuple(sorted(facet))] for facet in facets), dtype=np.int32)
            part = self.space.sub(0).sub(axis)
            held = fem.locate_dofs_topological(part, self.dim - 1, chosen)
            constant = fem.Constant(self.mesh, PETSc.ScalarType(0.0))
            values.append(value)
            constants.append(constant)
            dofs.append(held)
            conditions.append(fem.dirichletbc(constant, held, part))
        return values, constants, conditions, dofs


class Solver:
    """Newton's method with a direct solver."""

    def __init__(self, body, conditions):
        self.body, self.held = body, conditions
        self.matrix = fem.petsc.create_matrix(body.stiffness)
        self.vector = fem.petsc.create_vector(body.residual)
        self.step = self.vector.duplicate()
        self.direct = PETSc.KSP().create(MPI.COMM_SELF)
        self.direct.setType("preonly")
        self.direct.getPC().setType("lu")
        self.direct.getPC().setFactorSolverType("mumps")
        self.direct.setOperators(self.matrix)
        self.iterations, self.seconds = 0, 0.0

    def unbalanced(self):
        self.vector.zeroEntries()
        fem.petsc.assemble_vector(self.vector, self.body.residual)

    def go(self):
        """Take the step, or as much of it as turns no part of the body inside out; False where none is that small."""
        state, part = self.body.state.vector, 1.0
        state.axpy(-1.0, self.step)
        for _ in range(MOST_HALVES):
            self.unbalanced()
            if np.isfinite(self.vector.norm()):
                return True
            part *= 0.5
            state.axpy(part, self.step)
        return False

    def solve(self):
        """From the state to equilibrium at the conditions' values; False where it is not found."""
        state, moved = self.body.state.vector, False
        for _ in range(MOST_ITERATIONS):
            self.matrix.zeroEntries()
            fem.petsc.assemble_matrix(self.matrix, self.body.stiffness, bcs=self.held)
            self.matrix.assemble()
            self.unbalanced()
            fem.petsc.apply_lifting(self.vector, [self.body.stiffness], [self.held], x0=[state], scale=-1.0)
            fem.petsc.set_bc(self.vector, self.held, state, -1.0)
            started = time.process_time()
            self.direct.setUp()
            self.direct.solve(self.vector, self.step)
            self.seconds += time.process_time() - started
            self.iterations += 1
            if not np.isfinite(self.step.norm()) or not self.go():
                return False
            step, whole = self.largest_moves()
            if moved and step <= TOLERANCE * whole:
                return True
            moved = whole > 0
        return False

    def largest_moves(self):
        """The largest displacement in the last step, and that of the state."""
        place = self.body.place
        return np.abs(self.step.array[place]).max(), np.abs(self.body.state.vector.array[place]).max()


def main():
    if len(sys.argv) != 3:
        print("usage: solve.py SCENE MESH_STREAM > u.dat", file=sys.stderr)
        sys.exit(2)
    scene, stream = read_scene(sys.argv[1]), mtled.read(sys.argv[2])
    rows = prescribed(scene, stream)
    body = Body(scene, stream)
    started = time.process_time()
    collapsed, body.place = body.space.sub(0).collapse()
    values, constants, conditions, dofs = body.conditions(rows)
    body.prepare += time.process_time() - started
    steps, found = 1, False
    while not found and steps <= MOST_STEPS:
        started = time.process_time()
        solver = Solver(body, conditions)
        body.state.x.array[:] = 0.0
        found = True
        for step in range(1, steps + 1):
            for value, constant in zip(values, constants):
                constant.value = value * step / steps
            found = found and solver.solve()
        seconds = time.process_time() - started
        steps *= 2
    if not found:
        print("solve.py: no equilibrium found", file=sys.stderr)
        sys.exit(1)
    solver.unbalanced()
    reactions, dim = {}, body.dim
    for (name, _, axis, _), held in zip(rows, dofs):
        reactions.setdefault(name, np.zeros(dim))[axis] += solver.vector.array[held].sum()
    axes = "x,y,z"[: 2 * dim - 1]
    places = collapsed.tabulate_dof_coordinates()[:, :dim]
    field = body.state.x.array[np.array(body.place)].reshape(-1, dim)
    mtled.write(
        {
            "nodes.x": mtled.Array(places, unit="m", cols=axes),
            "reactions": mtled.Array(np.array(list(reactions.values())), unit="N" if dim == 3 else "N/m", rows=",".join(reactions)),
            "u": mtled.Array(field, unit="m", cols=axes),
        },
        sys.stdout.buffer,
    )
    print(
        f"nodes\t{len(places)}\niterations\t{solver.iterations}\nassembly seconds\t{seconds - solver.seconds:.4f}\n"
        f"solver seconds\t{solver.seconds:.4f}\nprocessor seconds\t{body.prepare + seconds:.4f}",
        file=sys.stderr,
    )


if __name__ == "__main__":
    main()
