"""Gmsh .msh 4.1 (text, binary) and 2.2 (text) in: tetrahedra, prisms and triangles of order 1, physical groups as regions."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .arrays import Array
from .elements import positive, renumbering
from .errors import InvalidInput
from .surface_files import refuse_lfs_pointer
from .volume_mesh import VolumeMesh

CORNERS = {15: 1, 1: 2, 2: 3, 3: 4, 4: 4, 5: 8, 6: 6, 7: 5}  # by type of Gmsh, order 1; others are refused
TRIANGLE, TETRAHEDRON, PRISM = 2, 4, 6

Cells = dict[int, list[tuple[tuple[int, ...], Array]]]  # by type, of each block its groups and nodes


class Values:
    """The numbers of a section, one after the other."""

    def __init__(self, content: bytes, binary: bool) -> None:
        self.content = content
        self.words = [] if binary else content.split()
        self.binary = binary
        self.at = 0

    def take(self, kind: str, count: int) -> Array:
        dtype = np.dtype(kind)
        length = count * (dtype.itemsize if self.binary else 1)
        if count < 0 or self.at + length > len(self.content if self.binary else self.words):
            raise ValueError
        begin, self.at = self.at, self.at + length
        if self.binary:
            return np.frombuffer(self.content[begin : self.at], dtype=dtype)
        return np.array([float(word) for word in self.words[begin : self.at]]).astype(dtype)

    def ints(self, count: int) -> list[int]:
        return [int(value) for value in self.take("<i4", count)]

    def sizes(self, count: int) -> list[int]:
        return [int(value) for value in self.take("<u8", count)]


def read_msh(path: str | Path) -> VolumeMesh:
    """Reads a mesh; lengths as they are, taken for mm. For other versions and orders: softkin mesh convert.
    Throws InvalidInput."""
    path = Path(path)
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InvalidInput(f"{path}: {error.strerror}") from None
    refuse_lfs_pointer(path, content)
    heading = _section(path, content, "MeshFormat").split(b"\n")[0].split()
    version, binary = heading[0].decode(), heading[1:2] == [b"1"]
    if version not in ("4.1", "2.2") or (binary and version == "2.2"):
        raise InvalidInput(
            f"{path}: version {version}{', binary' if binary else ''}: 4.1 and 2.2 text are read; softkin mesh convert"
            " makes 4.1 of others"
        )
    names = _names(_section(path, content, "PhysicalNames", missing=b"0"))
    read = _read_4 if version == "4.1" else _read_2
    title = ""
    try:
        parts = {}
        for title in ("Entities", "Nodes", "Elements") if version == "4.1" else ("Nodes", "Elements"):
            parts[title] = Values(_section(path, content, title), binary)
        points, tags, cells = read(parts)
    except InvalidInput as error:
        raise InvalidInput(f"{path}: ${title}: {error}") from None
    except (ValueError, IndexError, KeyError):
        raise InvalidInput(f"{path}: ${title}: the file ends early, or its sections do not match") from None
    return _mesh(path, points, tags, cells, names)


def _section(path: Path, content: bytes, title: str, missing: bytes = b"") -> bytes:
    start = content.find(f"${title}\n".encode())
    if start < 0:
        start = content.find(f"${title}\r\n".encode())
    end = content.find(f"$End{title}".encode(), max(start, 0))
    if start < 0 or end < 0:
        if missing:
            return missing
        raise InvalidInput(f"{path}: no section ${title}")
    return content[content.index(b"\n", start) + 1 : end]


def _names(section: bytes) -> dict[tuple[int, int], str]:
    lines = section.decode("utf-8", errors="replace").strip().splitlines()[1:]
    return {
        (int(d), int(t)): name.strip().strip('"')
        for d, t, name in (line.split(maxsplit=2) for line in lines if line.strip())
    }


def _read_4(parts: dict[str, Values]) -> tuple[Array, Array, Cells]:
    groups: dict[tuple[int, int], tuple[int, ...]] = {}
    entities = parts["Entities"]
    for dimension, count in enumerate(entities.sizes(4)):
        for _ in range(count):
            tag = entities.ints(1)[0]
            entities.take("<f8", 3 if dimension == 0 else 6)
            groups[dimension, tag] = tuple(entities.ints(entities.sizes(1)[0]))
            if dimension:
                entities.ints(entities.sizes(1)[0])
    nodes = parts["Nodes"]
    points, tags = [np.empty((0, 3))], [np.empty(0, dtype=np.int64)]
    for _ in range(nodes.sizes(4)[0]):
        _, _, parametric = nodes.ints(3)
        count = nodes.sizes(1)[0]
        if parametric:
            raise ValueError
        tags.append(nodes.take("<u8", count).astype(np.int64))
        points.append(nodes.take("<f8", 3 * count).reshape(-1, 3))
    cells: Cells = {}
    elements = parts["Elements"]
    for _ in range(elements.sizes(4)[0]):
        dimension, tag, kind = elements.ints(3)
        _check_kind(kind)
        count = elements.sizes(1)[0]
        rows = elements.take("<u8", count * (1 + CORNERS[kind])).reshape(count, -1).astype(np.int64)
        cells.setdefault(kind, []).append((groups.get((dimension, tag), ()), rows[:, 1:]))
    return np.concatenate(points), np.concatenate(tags), cells


def _read_2(parts: dict[str, Values]) -> tuple[Array, Array, Cells]:
    nodes = parts["Nodes"]
    table = nodes.take("<f8", 4 * nodes.sizes(1)[0]).reshape(-1, 4)
    elements = parts["Elements"]
    found: dict[tuple[int, int], list[list[int]]] = {}
    for _ in range(elements.sizes(1)[0]):
        _, kind, count = elements.ints(3)
        _check_kind(kind)
        tags = elements.ints(count)
        found.setdefault((kind, tags[0] if tags else 0), []).append(elements.ints(CORNERS[kind]))
    cells: Cells = {}
    for (kind, group), rows in found.items():
        cells.setdefault(kind, []).append(((group,) if group else (), np.array(rows)))
    return table[:, 1:], table[:, 0].astype(np.int64), cells


def _check_kind(kind: int) -> None:
    if kind not in CORNERS:
        raise InvalidInput(f"elements of type {kind}: only those of order 1 are read")


def _mesh(path: Path, points: Array, tags: Array, cells: Cells, names: dict[tuple[int, int], str]) -> VolumeMesh:
    if TETRAHEDRON not in cells and PRISM not in cells:
        raise InvalidInput(f"{path}: no tetrahedra or prisms of order 1")
    order = np.argsort(tags)

    def rows(nodes: Array) -> Array:
        at = np.minimum(np.searchsorted(tags[order], nodes), len(tags) - 1)
        if (tags[order][at] != nodes).any():
            raise InvalidInput(f"{path}: $Elements: a node that is not in $Nodes")
        return order[at]

    def elements(kind: int) -> Array:
        blocks = [block for _, block in cells.get(kind, [])]
        return rows(np.concatenate(blocks)) if blocks else np.empty((0, CORNERS[kind]), dtype=np.int64)

    tetrahedra, prisms = elements(TETRAHEDRON), elements(PRISM)
    volumes: dict[str, list[Array]] = {}
    faces: dict[str, list[Array]] = {}
    start = 0
    for groups, block in cells.get(TETRAHEDRON, []) + cells.get(PRISM, []):
        for group in groups:
            volumes.setdefault(names.get((3, group), f"physical_3_{group}"), []).append(
                np.arange(start, start + len(block))
            )
        start += len(block)
    number = renumbering(len(points), tetrahedra, prisms)
    vertices = points[number >= 0]
    for groups, block in cells.get(TRIANGLE, []):
        for group in groups:
            faces.setdefault(names.get((2, group), f"physical_2_{group}"), []).append(number[rows(block)])
    joined = {name: np.concatenate(blocks) for name, blocks in faces.items()}
    for name, block in joined.items():
        if (block < 0).any():
            raise InvalidInput(f"{path}: region '{name}' has faces with vertices of no element")
    joined = {f"{name}_2d" if name in volumes else name: block for name, block in joined.items()}
    return VolumeMesh(
        vertices,
        positive(vertices, number[tetrahedra]),
        {name: np.concatenate(blocks) for name, blocks in volumes.items()},
        joined,
        prisms=number[prisms],
    )
