"""Makes the small meshes, scenes, tables and reports of the cases without the program."""

import json
import math


def gmsh(names, vertices, elements):
    """Returns Gmsh 2.2 text. elements: (type, group, vertices from 0)."""
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat"]
    if names:
        lines += ["$PhysicalNames", str(len(names)), *names, "$EndPhysicalNames"]
    lines += ["$Nodes", str(len(vertices))]
    lines += [f"{i} " + " ".join(f"{x:.17g}" for x in v) for i, v in enumerate(vertices, 1)]
    lines += ["$EndNodes", "$Elements", str(len(elements))]
    lines += [f"{i} {kind} 2 {group} 1 " + " ".join(str(v + 1) for v in of)
              for i, (kind, group, of) in enumerate(elements, 1)]
    return "\n".join(lines + ["$EndElements"]) + "\n"


def tetrahedra(vertices, elements):
    return gmsh([], vertices, [(4, 0, e) for e in elements])


def block_parts(nx, edge=4):
    """Returns nx x 3 x 3 cells of six tetrahedra each; the chamber is the middle row without its end cells."""
    names = ['3 1 "body"', '3 2 "chamber"', '2 3 "base"', '2 4 "tip"']
    vertices = [(edge * i, edge * j, edge * k) for k in range(4) for j in range(4) for i in range(nx + 1)]

    def vertex(i, j, k):
        return i + (nx + 1) * (j + 4 * k)

    elements = []
    for k in range(3):
        for j in range(3):
            for i in range(nx):
                inside = j == 1 and k == 1 and 0 < i < nx - 1
                corners = [vertex(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)) for c in range(8)]
                for a, b in ((1, 3), (3, 2), (2, 6), (6, 4), (4, 5), (5, 1)):
                    elements.append((4, 2 if inside else 1, (corners[0], corners[a], corners[b], corners[7])))
            for i in (0, nx):
                for (j1, k1), (j2, k2) in (((j + 1, k), (j + 1, k + 1)), ((j + 1, k + 1), (j, k + 1))):
                    elements.append((2, 3 if i == 0 else 4, (vertex(i, j, k), vertex(i, j1, k1), vertex(i, j2, k2))))
    return names, vertices, elements


def block(nx=5, edge=4):
    return gmsh(*block_parts(nx, edge))


def cube_parts():
    """Returns the cube [0, 2]^3 with the groups body, chamber, base (z = 0) and corner (the origin)."""
    names = ['3 1 "body"', '3 2 "chamber"', '2 3 "base"', '0 4 "corner"']
    vertices = [(2.0 * (i & 1), 2.0 * (i >> 1 & 1), 2.0 * (i >> 2)) for i in range(8)]
    paths = ((0, 1, 3, 7), (0, 3, 2, 7), (0, 2, 6, 7), (0, 6, 4, 7), (0, 4, 5, 7), (0, 5, 1, 7))
    elements = [(4, 1 if i < 4 else 2, p) for i, p in enumerate(paths)]
    return names, vertices, elements + [(2, 3, (0, 1, 3)), (2, 3, (0, 3, 2)), (15, 4, (0,))]


def cube():
    return gmsh(*cube_parts())


def quadratic(names, vertices, elements, moved=None):
    """Returns the mesh with nodes in the middle of its edges. moved: positions of vertices that are moved."""
    vertices, between, result = list(vertices), {}, []

    def node(a, b):
        key = (min(a, b), max(a, b))
        if key not in between:
            between[key] = len(vertices)
            vertices.append(tuple((p + q) / 2 for p, q in zip(vertices[a], vertices[b])))
        return between[key]

    edges = {2: ((0, 1), (1, 2), (2, 0)), 4: ((0, 1), (1, 2), (2, 0), (3, 0), (2, 3), (1, 3))}
    for kind, group, of in elements:
        more = [node(of[a], of[b]) for a, b in edges.get(kind, ())]
        result.append(({2: 9, 4: 11}.get(kind, kind), group, (*of, *more)))
    for vertex, place in (moved or {}).items():
        vertices[vertex] = place
    return gmsh(names, vertices, result)


def prism():
    return gmsh(['3 1 "skin"', '2 2 "wall"'], [(0, 0, 0), (3, 0, 0), (0, 4, 0), (0, 0, 5), (3, 0, 5), (0, 4, 5)],
                [(6, 1, (0, 1, 2, 3, 4, 5)), (3, 2, (0, 1, 4, 3))])


MARKERS = "markers: [{name: tip, region: tip}, {name: corner, point: [20, 12, 12]}]\n"


def target_scene(more="", materials="{region: body, shape_ratio: 1.0, linear_range: 0.05}", air="range: [1.0, 2.0]"):
    return ("softkin: 1\nmesh: {file: block.msh}\n"
            f"materials: [{materials}]\n"
            "fixed: [{region: base}]\n"
            f"actuators: [{{name: air, kind: pneumatic, region: chamber, {air}}}]\n" + MARKERS + more)


def physical_scene(more="", materials="{youngs_modulus: 1, poisson_ratio: 0.3, linear_range: 0.05}",
                   air="control: volume, range: [0.5, 3]", tendon="control: length, range: [0.5, 1.2]", order=""):
    return (f"softkin: 1\nmesh: {{file: block.msh{order}}}\n"
            f"materials: [{materials}]\n"
            "fixed: [{region: base}]\n"
            "actuators:\n"
            f"  - {{name: air, kind: pneumatic, region: chamber, {air}}}\n"
            f"  - {{name: tendon, kind: cable, points: [[0, 6, 12], [20, 6, 12]], {tendon}}}\n"
            "forces: [{name: payload, region: tip, force: [0, 0, 0]}]\n" + MARKERS + more)


def loaded_scene(more="", low=-100):
    return physical_scene(more, air=f"control: pressure, range: [{low}, 3000]",
                          tendon="control: tension, range: [0, 100]")


def narrow_scene():
    return physical_scene(air="control: volume, range: [1, 1.6]", tendon="control: length, range: [0.85, 1]")


def walking_scene(feet="feet: [{marker: heel, forward: 0.02, backward: 9}, {marker: toe, forward: 0.02, backward: 9}]\n",
                  front="yz"):
    return ("softkin: 1\nmesh: {file: block.msh}\n"
            "materials: [{youngs_modulus: 1, poisson_ratio: 0.3, shape_ratio: 1}]\n"
            f"fixed: [{{region: base}}, {{region: tip, axes: {front}}}]\n"
            "actuators: [{name: tendon, kind: cable, points: [[0, 6, 6], [20, 6, 6]], control: tension, range: [0, 5]}]\n"
            "markers: [{name: heel, region: base}, {name: toe, region: tip}]\n" + feet)


GAIT = "t_s,tendon_N\n0,0\n0.5,1\n1,2\n1.5,1\n2,0\n"
CURVE = ("softkin_curve: 1\ninput: gauge_pressure_kPa\nloading:\n  - [0, 1]\n  - [20, 1.1]\n  - [40, 1.25]\n"
         "  - [80, 1.6]\nunloading:\n  - [0, 1]\n  - [20, 1.15]\n  - [40, 1.32]\n  - [80, 1.6]\n")
HARDWARE = ("softkin_hardware: 1\nboard: {approach_speed_mm_per_s: 4}\ntendons:\n"
            "  - {actuator: tendon, axis: X, backlash_mm: 0.5, max_speed_mm_per_s: 8}\n")
COMMANDS = "t_s,tendon\n0,1\n1,0.9\n2,0.8\n3.5,0.8\n4.5,0.9\n"


def target(more="", **options):
    return {"block.msh": block(), "block.yaml": target_scene(more, **options)}


def physical(more="", **options):
    return {"block.msh": block(), "block.yaml": physical_scene(more, **options)}


def loaded(**options):
    return {"block.msh": block(), "block.yaml": loaded_scene(**options)}


def curved(curve="curve: air.yaml", text=CURVE):
    files = target(air="range: [1.0, 2.0], " + curve)
    return files | ({"air.yaml": text} if text is not None else {})


def narrow():
    return {"block.msh": block(), "block.yaml": narrow_scene()}


def walker(gait=GAIT, **options):
    return {"block.msh": block(), "block.yaml": walking_scene(**options), "gait.csv": gait}


def driven(hardware=HARDWARE, commands=COMMANDS, **more):
    return physical() | {"block.hardware.yaml": hardware, "commands.csv": commands} | more


def turning(angles, seconds, pressure=None, broken=None):
    """Returns the report of a bar of 10 mm rotated by angles [degrees]. broken: a step that ends at a limit point."""
    steps = []
    for x, angle in enumerate(angles):
        a = math.radians(angle)
        air = {"requested": 1 + x, "achieved": 1 + x} | ({} if pressure is None else {"pressure_kPa": pressure})
        steps.append({"actuation": {"air": 1 + x}, "status": "limit" if x == broken else "converged",
                      "seconds": seconds, "markers": {"begin": [x, 0, 0],
                                                      "end": [x + round(10 * math.cos(a), 9), 0,
                                                              round(10 * math.sin(a), 9)]},
                      "actuators": {"air": air}})
    formulation = "target-shape" if pressure is None else "physical"
    return json.dumps({"formulation": formulation, "solver": {"name": "newton"}, "steps": steps})


def linear(commands):
    """Returns the report of a robot whose marker tip moves linearly with two actuators, at the times 0, 1, 2 ..."""
    steps = [{"actuation": {"air1": a, "air2": b}, "status": "converged", "seconds": 1, "time_s": i,
              "markers": {"tip": [round(10 * (a - 1), 9), round(20 * (b - 1), 9), 100]},
              "actuators": {"air1": {}, "air2": {}}} for i, (a, b) in enumerate(commands)]
    return json.dumps({"formulation": "physical", "solver": {"name": "newton"}, "steps": steps})


def camera():
    """Returns the camera track of linear([(1, 1), (1.2, 1), (1.2, 1.3), (1.5, 1.5)]) with an offset of 0.5 mm in x."""
    corners, rows = [(0, 0), (2, 0), (2, 6), (5, 10)], ["t_s,x_mm,y_mm"]
    for i in range(31):
        k = min(2, i // 10)
        fraction = i / 10 - k
        x, y = (p + fraction * (q - p) for p, q in zip(corners[k], corners[k + 1]))
        rows.append(f"{i / 10:.1f},{x + 0.5:.6f},{y:.6f}")
    return "\n".join(rows) + "\n"


def syringe_test(header="p_abs_kPa,dv_sy_mL", offset=100, factor=0.001):
    """Returns a test of a chamber of 192 mm^3 up to 80 kPa and back, with a syringe of 600 and a tube of 20 mm^3."""
    rows = [header]
    for i in range(33):
        gauge = 5 * (i if i <= 16 else 32 - i)
        s = gauge / 80
        ratio = 1 + 0.5 * (0.3 * s + 0.7 * s * s) + (0.16 * s * (1 - s) if i > 16 else 0)
        volume = ratio * 192 + 620 - 100 * 812 / (100 + gauge)
        rows.append(f"{gauge + offset:.6f},{volume * factor:.6f}")
    return "\n".join(rows) + "\n"


def voltage_test():
    rows = ["run,voltage_v,stretch"]
    for run in (1, 2):
        for i in range(21):
            s = (i if i <= 10 else 20 - i) / 10
            area = 2 * (1 + 0.4 * s * s + (0.2 * s * (1 - s) if i > 10 else 0))
            rows.append(f"{run},{4000 * s:.6f},{math.sqrt(area):.6f}")
    return "\n".join(rows) + "\n"


MEDIT = ("MeshVersionFormatted 2\nDimension\n3\nVertices\n9\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 -1 0\n-1 0 0 5\n"
         "-1 0 1 5  # a comment\n-1 1 0 5\n0 1 1 5\nCorners\n2\n1\n2\nTetrahedra\n2\n1 2 3 4 7\n1 3 2 5 -2\nPrisms\n1\n"
         "1 3 6 4 9 7 7\nTriangles\n2\n1 2 3 1\n1 2 4 2\nQuadrilaterals\n1\n1 3 9 4 2\nEnd\n")
TETGEN = {"a.node": "5 3 1 1\n1 0 0 0 0.5 1\n2 1 0 0 0.5 1\n3 0 1 0 0.5 0\n4 0 0 1 0.5 1\n5 0 0 -1 0.5 1\n",
          "a.ele": "2 4 1\n1 1 2 3 4 3\n2 1 3 2 5 1e1\n",
          "a.face": "3 1\n1 1 2 3 0\n2 1 2 4 -1\n3 1 3 5 -1\n"}
ABAQUS = ("*Heading\na mesh\n** a comment\n*NODE , nset = all\n10, 0., 0., 0.\n20, 1., 0., 0.\n30, 0., 1.,0.\n"
          "40, 0., 0., 1.\n50, 0., 0., -1.\n*Element, type=c3d4, elset=Body\n100, 10, 20, 30, 40\n"
          "*ELEMENT, TYPE=C3D4H, ELSET=low\n7, 10, 30, 20, 50\n*Nset, nset=feet, generate\n10, 50, 20\n")
VTK = ("# vtk DataFile Version 3.0\na mesh\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0 1 0 0 0 1 0 0 0 1 0 0 -1\n"
       "CELLS 2 10\n4 0 1 2 3\n4 0 2 1 4\nCELL_TYPES 2\n10 10\nCELL_DATA 2\nSCALARS part int 1\nLOOKUP_TABLE default\n3 4\n")
TET = {"a.tet": "5 vertices\n2 tets\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 -1\n4 0 1 2 3\n4 0 2 1 4\n"}
