"""Prints a mesh as another program reads it, and has that program write it again.

other_readers.py meshio|pyvista IN OUT
"""
import contextlib
import sys

NAMES = {1: "vertex", 5: "triangle", 9: "quad", 10: "tetra", 13: "wedge", 24: "tetra10"}


def from_meshio(path, out):
    import meshio

    mesh = meshio.read(path)
    mesh.write(out, **({"file_format": "gmsh22"} if out.endswith(".msh") else {}))
    cells = [(block.type.replace("triangle6", "triangle"), row) for block in mesh.cells for row in block.data.tolist()]
    if path.endswith(".vtu"):  # meshio turns the triangles of VTK's wedges over
        cells = [(kind, [row[i] for i in (0, 2, 1, 3, 5, 4)] if kind == "wedge" else row) for kind, row in cells]
    first = [sum(len(block) for block in mesh.cells[:i]) for i in range(len(mesh.cells))]
    regions = {}
    for name, value in mesh.field_data.items():
        if name in mesh.cell_sets:  # .msh
            sets = mesh.cell_sets[name]
            regions[name] = [start + int(cell) for start, chosen in zip(first, sets) for cell in chosen]
        else:
            label = [number for block in mesh.cell_data["region"] for number in block]
            regions[name] = [cell for cell, number in enumerate(label) if number == value[0]]
    return mesh.points, cells, regions


def from_pyvista(path, out):
    import pyvista

    mesh = pyvista.read(path)
    mesh.save(out)
    cells = [(NAMES[int(kind)], mesh.get_cell(i).point_ids) for i, kind in enumerate(mesh.celltypes)]
    regions = {}
    for name in mesh.field_data.keys():
        number = mesh.field_data[name][0]
        regions[name] = [cell for cell, label in enumerate(mesh.cell_data["region"]) if label == number]
    return mesh.points, cells, regions


def main():
    reader, path, out = sys.argv[1:]
    with contextlib.redirect_stdout(sys.stderr):  # meshio prints blank lines
        points, cells, regions = {"meshio": from_meshio, "pyvista": from_pyvista}[reader](path, out)
    for point in points:
        print("point", *("%.17g" % value for value in point))
    place, counts = [], {}
    for kind, nodes in cells:
        place.append((kind, counts.get(kind, 0)))
        counts[kind] = place[-1][1] + 1
        print(kind, *(nodes[:3] if kind == "triangle" else nodes))
    for name in sorted(regions):
        print("region", name.removeprefix("region_"), *("%s:%d" % place[cell] for cell in regions[name]))


main()
