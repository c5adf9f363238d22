"""Gmsh .msh 4.1 out."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .arrays import Array
from .elements import MeshData
from .errors import InvalidInput

MARK = b"$Comments\nmade by softkin\n$EndComments\n"  # by which softkin knows the file again
KINDS = {3: 2, 4: 4, 6: 6}  # of Gmsh, by corners: triangle, tetrahedron, prism


def write_msh(path: str | Path, mesh: MeshData) -> None:
    """Writes .msh 4.1, binary. Elements of the same regions make one entity, whose physical groups these are."""
    blocks = _face_blocks(mesh) + _element_blocks(mesh)
    names = [(2, name) for name in mesh.face_regions] + [(3, name) for name in mesh.volume_regions]
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    entities = [np.array([0, 0, sum(d == 2 for d, _, _ in blocks), sum(d == 3 for d, _, _ in blocks)], "<u8").tobytes()]
    elements, total, tag = [], sum(len(cells) for _, _, cells in blocks), 0
    for number, (dimension, groups, cells) in enumerate(blocks, 1):
        entities += [np.array([number], "<i4").tobytes(), np.concatenate([low, high]).astype("<f8").tobytes()]
        entities += [
            np.array([len(groups)], "<u8").tobytes(),
            np.array(groups, "<i4").tobytes(),
            np.array([0], "<u8").tobytes(),
        ]
        kind = KINDS[cells.shape[1]]
        tags = np.arange(tag + 1, tag + 1 + len(cells))
        tag += len(cells)
        elements += [np.array([dimension, number, kind], "<i4").tobytes(), np.array([len(cells)], "<u8").tobytes()]
        elements.append(np.column_stack([tags, cells + 1]).astype("<u8").tobytes())
    count = len(mesh.vertices)
    nodes = [np.array([1, count, 1, count], "<u8").tobytes(), np.array([3, len(blocks), 0], "<i4").tobytes()]
    nodes += [
        np.array([count], "<u8").tobytes(),
        np.arange(1, count + 1).astype("<u8").tobytes(),
        mesh.vertices.astype("<f8").tobytes(),
    ]
    heading = [np.array([len(blocks), total, 1, total], "<u8").tobytes()]
    labels = "".join(f'{dimension} {number} "{name}"\n' for number, (dimension, name) in enumerate(names, 1))
    sections = [
        ("MeshFormat", b"4.1 1 8\n" + np.array([1], "<i4").tobytes()),
        ("PhysicalNames", f"{len(names)}\n{labels}".encode().rstrip(b"\n")),
        ("Entities", b"".join(entities)),
        ("Nodes", b"".join(nodes)),
        ("Elements", b"".join(heading + elements)),
    ]
    content = MARK + b"".join(b"$%s\n%s\n$End%s\n" % (title.encode(), body, title.encode()) for title, body in sections)
    try:
        Path(path).write_bytes(content)
    except OSError as error:
        raise InvalidInput(f"{path}: {error.strerror}") from None


Block = tuple[int, list[int], Array]  # dimension, numbers of physical groups, elements


def _element_blocks(mesh: MeshData) -> list[Block]:
    volumes = list(mesh.volume_regions.values())
    member = np.zeros((len(mesh.tetrahedra) + len(mesh.prisms), len(volumes)), dtype=bool)
    for column, region in enumerate(volumes):
        member[region, column] = True
    first = len(mesh.tetrahedra)
    blocks: list[Block] = []
    for cells, members in ((mesh.tetrahedra, member[:first]), (mesh.prisms, member[first:])):
        if len(cells):
            blocks += _blocks(3, cells, members, len(mesh.face_regions))
    return blocks


def _face_blocks(mesh: MeshData) -> list[Block]:
    faces = list(mesh.face_regions.values())
    if not faces:
        return []
    every = np.concatenate(faces)
    _, first, which = np.unique(np.sort(every, axis=1), axis=0, return_index=True, return_inverse=True)
    member = np.zeros((len(first), len(faces)), dtype=bool)
    member[which.reshape(-1), np.repeat(np.arange(len(faces)), [len(region) for region in faces])] = True
    return _blocks(2, every[first], member, 0)


def _blocks(dimension: int, cells: Array, member: Array, offset: int) -> list[Block]:
    """One for every set of regions that elements are in."""
    if member.shape[1] == 0:
        return [(dimension, [], cells)]
    others, which = np.unique(~member, axis=0, return_inverse=True)  # ~: those of the first region come first
    which = which.reshape(-1)
    return [
        (dimension, (np.flatnonzero(~other) + 1 + offset).tolist(), cells[which == k]) for k, other in enumerate(others)
    ]
