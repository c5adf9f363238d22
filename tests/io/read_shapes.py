"""Reads every .vtu of a folder with another program and prints a hash of each of its arrays.

read_shapes.py meshio|pyvista FOLDER
"""
import sys
from pathlib import Path

import numpy as np


def hashed(values):
    """FNV-1a over the 8-byte words of an array of real numbers or indices."""
    values = np.ascontiguousarray(values)
    code = 14695981039346656037
    for word in values.astype("<f8" if values.dtype.kind == "f" else "<i8").view("<u8").ravel().tolist():
        code = (code ^ word) * 1099511628211 % 2**64
    return f"{code:016x}"


def from_meshio(path):
    import meshio

    mesh = meshio.read(path)
    cells = [row for block in mesh.cells for row in block.data.tolist() if block.type in ("tetra", "tetra10")]
    fields = {name: np.concatenate(blocks) for name, blocks in mesh.cell_data.items()}
    return mesh.points, cells, {**mesh.point_data, **fields}


def from_pyvista(path):
    import pyvista

    mesh = pyvista.read(path)
    cells = [mesh.get_cell(i).point_ids for i, kind in enumerate(mesh.celltypes) if kind in (10, 24)]
    return mesh.points, cells, {**mesh.point_data, **mesh.cell_data}


def main():
    read = {"meshio": from_meshio, "pyvista": from_pyvista}[sys.argv[1]]
    for file in sorted(Path(sys.argv[2]).glob("*.vtu")):
        points, cells, fields = read(str(file))
        print(file.name, "mesh", hashed(points), hashed(np.array(cells, dtype="<i8")))
        for name in sorted(fields):
            print(file.name, name, hashed(fields[name]))


main()
