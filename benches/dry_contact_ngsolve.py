#!/usr/bin/env python3
"""Dry contact of biphasic tissue at finite strain, written for NGSolve: what `validate experiments` is held against.

    pip install ngsolve
    python3 benches/dry_contact_ngsolve.py
    cargo run --release -- validate experiments --row finite-strain

A curved layer, bonded to a curved rigid bone, is pressed onto flat rigid glass by a fifth of its thickness within a hundredth of
t^2/(k H_A), and held. Its surface is drained, so that all load is solid on solid. Plane strain, compressible neo-Hookean solid,
Darcy's law in the deformed tissue, quadratic displacements, linear pressures:

    int (P - p J F^-T) : grad v = int_surface p_a(h) v_y,   int dJ/dt w + k J F^-1 F^-T grad p . grad w = 0,   p = 0 on the surface
    W = G/2 (J^(-2/3) I1 - 3) + K/2 (J - 1)^2,   h = y + u_y above the glass,
    p_a = 20 kPa exp(-2 h/s) + 10 MPa exp(-10 h/s), straight lines below h = 0, s = 3 micron

Nothing is shared with the program: mesh, shape functions, linearisation (automatic), integration in time (BDF2 with steps that are set
beforehand) and linear solver are NGSolve's. Prints time over t^2/(k H_A), load, and the fluid's pressure on the bone in the middle.
"""
import argparse
import math

# Calf's humeral head.
G, K, PERMEABILITY, THICKNESS = 0.31010309278350514e6, 0.2265292096219931e6, 3.62e-16, 1.5e-3
RADIUS, DEPTH, ROUGHNESS = 0.05, 0.3e-3, 3e-6
UNIT = THICKNESS**2 / (PERMEABILITY * (K + 4 * G / 3))
RAMP = 0.01 * UNIT
HALF_WIDTH = 16e-3
CLEARANCE = 5e-6
TIMES = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0]  # of UNIT: compared


def grading(strength, s):
    return math.sinh(strength * s) / math.sinh(strength)


def times(per_decade, ramp_steps):
    """Ends of the steps: equal ones on the ramp, then growing by one ratio from a quarter of those on."""
    ends = [RAMP * (i + 1) / ramp_steps for i in range(ramp_steps)]
    since, last = RAMP / ramp_steps / 4, UNIT * TIMES[-1]
    while ends[-1] < last:
        ends.append(min(RAMP + since, last))
        since *= 10 ** (1 / per_decade)
    marks = [UNIT * t for t in TIMES if t > 0.01]
    return sorted({t for t in ends if all(abs(t / m - 1) > 1e-3 for m in marks)} | set(marks))


def peer(columns, rows, per_decade, ramp_steps):
    import ngsolve as ng
    from ngsolve import H1, BilinearForm, Det, Grad, GridFunction, Id, IfPos, InnerProduct, Integrate, Inv, VectorH1, dx, ds, exp, grad, x, y
    from ngsolve.meshes import MakeStructured2DMesh

    ng.SetNumThreads(1)
    angle = math.asin(HALF_WIDTH / RADIUS)
    # Half of the layer: the other is its mirror image. Angle and depth, then onto the arc.
    mesh = MakeStructured2DMesh(
        quads=True, nx=columns, ny=rows, mapping=lambda a, b: (angle * grading(1.5, a), THICKNESS * grading(2.5, b))
    )
    onto = GridFunction(VectorH1(mesh, order=2))
    onto.Set(ng.CF(((RADIUS - y) * ng.sin(x) - x, RADIUS - (RADIUS - y) * ng.cos(x) - y)), dual=True)
    mesh.SetDeformation(onto)
    length, pressure = 1e-6, 1e4  # of the unknowns
    space = VectorH1(mesh, order=2, dirichletx="left|top", dirichlety="top") * H1(mesh, order=1, dirichlet="bottom")
    (u, p), (v, w) = space.TnT()
    state, before, earlier = GridFunction(space), GridFunction(space), GridFunction(space)
    c = [ng.Parameter(0.0) for _ in range(3)]

    def volume(gradient):
        return Det(Id(2) + length * gradient)

    def asperities(h):
        value = 0
        for size, decay in ((20e3, ROUGHNESS / 2), (10e6, ROUGHNESS / 10)):
            value += IfPos(h, size * exp(-IfPos(h, h, 0) / decay), size * (1 - h / decay))
        return value

    F = Id(2) + length * Grad(u)
    J, inverse = Det(F), Inv(F)
    first = InnerProduct(F, F) + 1
    stress = G * J ** (-2 / 3) * (F - first / 3 * inverse.trans) + K * (J - 1) * J * inverse.trans
    rate = c[0] * J + c[1] * volume(Grad(before.components[0])) + c[2] * volume(Grad(earlier.components[0]))
    flow = PERMEABILITY * J * (inverse * inverse.trans) * (pressure * grad(p))
    form = BilinearForm(space)
    form += (InnerProduct(stress - pressure * p * J * inverse.trans, Grad(v)) + (rate * w + flow * grad(w)) * UNIT * 1e4).Compile() * dx(bonus_intorder=2)
    simpson = ng.IntegrationRule([(0,), (0.5,), (1,)], [1 / 6, 4 / 6, 1 / 6])
    # Of the deformed surface: dx = (1 + du_x/dx) dX.
    tangent = ng.CF(((RADIUS - y) / RADIUS, x / RADIUS))
    stretch = tangent[0] + length * (Grad(u).Trace() * tangent)[0]
    form += (-asperities(y + length * u[1]) * stretch * v[1]).Compile() * ds("bottom", intrules={ng.SEGM: simpson})

    bone = [i for i, free in enumerate(VectorH1(mesh, order=2, dirichlety="top").FreeDofs()) if not free]
    unknowns, residual, update = state.vec.FV().NumPy(), state.vec.CreateVector(), state.vec.CreateVector()
    lowered = GridFunction(space.components[0])

    def newton(depth):
        lowered.Set(ng.CF((0, -depth / length)), definedon=mesh.Boundaries("top"))
        unknowns[bone] = lowered.vec.FV().NumPy()[bone]
        for iteration in range(40):
            form.Apply(state.vec, residual)
            form.AssembleLinearization(state.vec)
            update.data = form.mat.Inverse(space.FreeDofs(), inverse="umfpack") * residual
            size = abs(update.FV().NumPy()).max()
            state.vec.data -= min(1.0, 100.0 / size) * update
            if size < 1e-4:
                return iteration + 1
        raise SystemExit("no convergence: more steps")

    # At rest, from a clearance.
    state.components[0].Set(ng.CF((0, CLEARANCE / length)))
    done, steps, iterations, results = 0.0, [], 0, []
    for vector in (before.vec, earlier.vec):
        vector.data = state.vec
    for end in times(per_decade, ramp_steps):
        step = end - done
        if not steps:
            factors = (1 / step, -1 / step, 0.0)
        else:
            ratio = step / steps[-1]
            factors = ((1 + 2 * ratio) / (1 + ratio) / step, -(1 + ratio) / step, ratio * ratio / (1 + ratio) / step)
        if abs(done - RAMP) < 1e-9 * RAMP:
            factors = (1 / step, -1 / step, 0.0)  # the motion has a kink there
        for parameter, value in zip(c, factors):
            parameter.Set(value)
        iterations += newton(-CLEARANCE + (DEPTH + CLEARANCE) * min(end / RAMP, 1.0))
        earlier.vec.data, before.vec.data = before.vec, state.vec
        steps.append(step)
        done = end
        displacement, pore = state.components
        bottom = ds("bottom", intrules={ng.SEGM: simpson})
        grown = tangent[0] + length * (Grad(displacement).Trace() * tangent)[0]
        load = 2 * Integrate(asperities(y + length * displacement[1]) * grown * bottom, mesh)
        # On the bone in the middle.
        deep = pressure * pore(mesh(0.0, THICKNESS * (1 - 1e-9)))
        results.append((end, load, deep))
    print(f"# NGSolve {ng.__version__}: {columns} x {rows} elements of one half, {len(steps)} steps, {iterations} Newton iterations")
    return results


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--columns", type=int, default=48)
    parser.add_argument("--rows", type=int, default=10)
    parser.add_argument("--per-decade", type=int, default=16, help="steps while it is held")
    parser.add_argument("--ramp-steps", type=int, default=16)
    arguments = parser.parse_args()
    print(f"# t^2/(k H_A) = {UNIT:.1f} s")
    results = peer(arguments.columns, arguments.rows, arguments.per_decade, arguments.ramp_steps)
    for end, load, deep in results:
        if any(abs(end / UNIT / t - 1) < 1e-6 for t in TIMES):
            print(f"{end / UNIT:8.3f} {load:12.3f} {deep:12.1f}")


if __name__ == "__main__":
    main()
