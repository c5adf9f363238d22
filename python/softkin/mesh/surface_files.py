"""Surfaces from STL, OBJ, PLY and OFF files; STL out."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from .._files import write
from .arrays import Array
from .errors import InvalidInput
from .triangles import Surface

PLY_TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4",
    "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4",
    "float": "f4", "double": "f8", "float32": "f4", "float64": "f8",
}  # fmt: skip

Properties = list[tuple[str, str, str | None]]  # name, type, type of the counter of a list
Elements = list[tuple[str, int, Properties]]  # name, how many, properties
Polygons = list[tuple[str, list[int]]]  # place in the file, vertices


LFS = b"version https://git-lfs.github.com/spec/"


def refuse_lfs_pointer(path: Path, content: bytes | None = None) -> None:
    """Throws InvalidInput where Git LFS left a pointer in place of the file, whose content is read where not given."""
    if content is None:
        with path.open("rb") as file:
            content = file.read(len(LFS))
    if content.startswith(LFS):
        raise InvalidInput(f"{path}: is a Git LFS pointer, not the file itself; run `git lfs pull`")


def read_surface(path: str | Path) -> Surface:
    """Reads STL (text, binary), OBJ, PLY (text, binary) or OFF (text), recognised by the content, else by the extension;
    polygons become fans of triangles, points at the same place are merged. Lengths as they are in the file. Throws
    InvalidInput with file and line or byte."""
    path = Path(path)
    readers: dict[str, Callable[[Path, bytes], Surface]] = {".stl": _stl, ".obj": _obj, ".ply": _ply, ".off": _off}
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InvalidInput(f"{path}: {error.strerror}") from None
    if not content.strip():
        raise InvalidInput(f"{path}: the file is empty")
    refuse_lfs_pointer(path, content)
    reader = readers.get(_form(content) or path.suffix.lower())
    if reader is None:
        raise InvalidInput(f"{path}: surfaces are STL, OBJ, PLY or OFF; backend 'gmsh' reads CAD models too")
    return reader(path, content).merged()


def _form(content: bytes) -> str:
    """The extension of the form that the content shows, or ""."""
    if len(content) >= 134 and len(content) == 84 + 50 * struct.unpack("<I", content[80:84])[0]:
        return ".stl"
    lines = (line.split(b"#")[0].split() for line in content[:4096].splitlines())
    first = next((words[0] for words in lines if words), b"")
    if first == b"ply" or (first.lower() == b"solid" and b"facet" in content[:2000].lower()):
        return ".ply" if first == b"ply" else ".stl"
    if _OFF.fullmatch(first):
        return ".off"
    return ".obj" if first in (b"v", b"vn", b"vt", b"f", b"o", b"g", b"s", b"mtllib", b"usemtl") else ""


_OFF = re.compile(rb"(ST)?C?N?4?n?OFF")


def write_stl(path: str | Path, surface: Surface) -> None:
    """Writes binary STL, in single precision, lengths in mm."""
    normals = surface.normals
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    facets = np.zeros(len(surface.triangles), dtype=_FACET)
    facets["normal"] = normals / np.where(lengths > 0, lengths, 1)
    facets["corners"] = surface.corners
    write(path, b"softkin, lengths in mm".ljust(80) + struct.pack("<I", len(facets)) + facets.tobytes())


_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def _stl(path: Path, content: bytes) -> Surface:
    count = struct.unpack("<I", content[80:84])[0] if len(content) >= 84 else -1
    if len(content) == 84 + 50 * count:  # some binary files begin with "solid" too
        return _stl_binary(path, content, count)
    if content[:5].lower() == b"solid" and b"facet" in content[:2000].lower():
        return _stl_text(path, content)
    if count < 0:
        raise InvalidInput(
            f"{path}: {len(content)} bytes are neither a text STL, which begins with 'solid', nor a binary one, of 84"
            " or more"
        )
    raise InvalidInput(
        f"{path}: byte 80: the header announces {count} facets, which take {84 + 50 * count} bytes, but the file has"
        f" {len(content)}"
    )


def _stl_binary(path: Path, content: bytes, count: int) -> Surface:
    corners = np.frombuffer(content, dtype=_FACET, offset=84, count=count)["corners"].astype(np.float64)
    bad = np.flatnonzero(~np.isfinite(corners).all(axis=(1, 2)))
    if len(bad):
        raise InvalidInput(f"{path}: byte {84 + 50 * int(bad[0])}: facet {bad[0]} has a coordinate that is not finite")
    return _soup(path, corners)


def _stl_text(path: Path, content: bytes) -> Surface:
    points: list[list[float]] = []
    loop_start = 0
    line = 0
    for line, text in enumerate(_lines(content), 1):
        words = text.lower().split()
        if not words:
            continue
        if words[0] == "vertex":
            points.append(_numbers(path, line, words[1:], 3))
        elif words[0] == "outer":
            loop_start = len(points)
        elif words[0] == "endloop" and len(points) - loop_start != 3:
            raise InvalidInput(f"{path}:{line}: a facet of {len(points) - loop_start} vertices; STL has three")
        elif words[0] not in ("solid", "facet", "endloop", "endfacet", "endsolid"):
            raise InvalidInput(f"{path}:{line}: '{words[0]}' is no word of STL")
    if len(points) % 3:
        raise InvalidInput(f"{path}:{line}: the file ends within a facet")
    return _soup(path, np.reshape(points, (-1, 3, 3)))


def _soup(path: Path, corners: Array) -> Surface:
    if len(corners) == 0:
        raise InvalidInput(f"{path}: no facets")
    return Surface(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), str(path))


def _obj(path: Path, content: bytes) -> Surface:
    points: list[list[float]] = []
    triangles: list[tuple[int, int, int]] = []
    for line, text in enumerate(_lines(content), 1):
        words = text.split("#")[0].split()
        if not words:
            continue
        if words[0] == "v":
            points.append(_numbers(path, line, words[1:4], 3))
        elif words[0] == "f":
            polygon = [_obj_index(path, line, word, len(points)) for word in words[1:]]
            if len(polygon) < 3:
                raise InvalidInput(f"{path}:{line}: a face of {len(polygon)} vertices")
            triangles += [(polygon[0], polygon[k], polygon[k + 1]) for k in range(1, len(polygon) - 1)]
    if not triangles:
        raise InvalidInput(f"{path}: no faces")
    return Surface(np.array(points), np.array(triangles), str(path))


def _obj_index(path: Path, line: int, word: str, count: int) -> int:
    try:
        index = int(word.split("/")[0])
    except ValueError:
        raise InvalidInput(f"{path}:{line}: '{word}' is no index of a vertex") from None
    index = index - 1 if index > 0 else count + index
    if not 0 <= index < count or word.startswith("0"):
        raise InvalidInput(f"{path}:{line}: '{word}' names no vertex; there are {count} before this line")
    return index


def _ply(path: Path, content: bytes) -> Surface:
    form, elements, start, line = _ply_header(path, content)
    if form == "ascii":
        found = _ply_text(path, content, start, line, elements)
    else:
        found = _ply_binary(path, content, start, form, elements)
    if "vertex" not in found or "face" not in found or not len(found["face"]):
        raise InvalidInput(f"{path}: no faces")
    return Surface(found["vertex"], np.array(found["face"]), str(path))


def _ply_header(path: Path, content: bytes) -> tuple[str, Elements, int, int]:
    end = content.find(b"end_header")
    if not content.startswith(b"ply") or end < 0:
        raise InvalidInput(f"{path}:1: no PLY header from 'ply' to 'end_header'")
    form = ""
    elements: Elements = []
    line = 0
    for line, text in enumerate(_lines(content[:end]), 1):
        words = text.split()
        try:
            if words[:1] == ["format"]:
                form = words[1]
            elif words[:1] == ["element"]:
                elements.append((words[1], int(words[2]), []))
            elif words[:2] == ["property", "list"]:
                elements[-1][2].append((words[4], PLY_TYPES[words[3]], PLY_TYPES[words[2]]))
            elif words[:1] == ["property"]:
                elements[-1][2].append((words[2], PLY_TYPES[words[1]], None))
        except (IndexError, KeyError, ValueError):
            raise InvalidInput(f"{path}:{line}: '{text.strip()}' is no line of a PLY header") from None
    if form not in ("ascii", "binary_little_endian", "binary_big_endian"):
        raise InvalidInput(f"{path}: format '{form}'; PLY has ascii, binary_little_endian and binary_big_endian")
    return form, elements, content.index(b"\n", end) + 1, line


def _ply_text(path: Path, content: bytes, start: int, line: int, elements: Elements) -> dict[str, Any]:
    found: dict[str, Any] = {}
    rows = [(line + 1 + number, text.split()) for number, text in enumerate(_lines(content[start:]), 1) if text.strip()]
    at = 0
    for name, count, properties in elements:
        if at + count > len(rows):
            raise InvalidInput(f"{path}: ends after {len(rows) - at} of {count} elements '{name}'")
        block = rows[at : at + count]
        at += count
        if name == "vertex":
            columns = [[p[0] for p in properties].index(axis) for axis in "xyz"] if _has_xyz(path, properties) else []
            values = [_numbers(path, number, words, len(properties)) for number, words in block]
            found[name] = np.array(values).reshape(-1, len(properties))[:, columns]
        elif name == "face":
            found[name] = _fans(
                path, [(f"line {number}", _polygon(path, number, words, properties)) for number, words in block]
            )
    return found


def _polygon(path: Path, line: int, words: list[str], properties: Properties) -> list[int]:
    position = 0
    for name, _, counted in properties:
        if counted is None:
            position += 1
            continue
        try:
            length = int(words[position])
            values = (
                [int(word) for word in words[position + 1 : position + 1 + length]] if name.startswith("vert") else []
            )
        except (IndexError, ValueError):
            raise InvalidInput(f"{path}:{line}: no list of indices") from None
        if name.startswith("vert"):
            if len(values) != length:
                raise InvalidInput(f"{path}:{line}: {length} indices are announced and {len(values)} are present")
            return values
        position += 1 + length
    raise InvalidInput(f"{path}: faces have no list vertex_indices")


def _ply_binary(path: Path, content: bytes, start: int, form: str, elements: Elements) -> dict[str, Any]:
    order = "<" if form == "binary_little_endian" else ">"
    found: dict[str, Any] = {}
    at = start
    for name, count, properties in elements:
        if any(counted for _, _, counted in properties):
            polygons, at = _binary_lists(path, content, at, order, name, count, properties)
            if name == "face":
                found[name] = _fans(path, polygons)
            continue
        row = np.dtype([(label, order + kind) for label, kind, _ in properties])
        if at + count * row.itemsize > len(content):
            raise InvalidInput(
                f"{path}: byte {at}: {count} elements '{name}' take {count * row.itemsize} bytes, {len(content) - at}"
                " are left"
            )
        values = np.frombuffer(content, dtype=row, count=count, offset=at)
        at += count * row.itemsize
        if name == "vertex" and _has_xyz(path, properties):
            found[name] = np.stack([values[axis].astype(np.float64) for axis in "xyz"], axis=1)
    return found


def _binary_lists(
    path: Path, content: bytes, at: int, order: str, name: str, count: int, properties: Properties
) -> tuple[Polygons, int]:
    polygons = []
    for number in range(count):
        polygon: list[int] = []
        begin = at
        for label, kind, counted in properties:
            length = 1
            if counted:
                counter = np.dtype(order + counted)
                if at + counter.itemsize > len(content):
                    raise InvalidInput(f"{path}: byte {begin}: the file ends at element {number} of {count} '{name}'")
                length = int(np.frombuffer(content, dtype=counter, count=1, offset=at)[0])
                at += counter.itemsize
            value = np.dtype(order + kind)
            if length < 0 or at + length * value.itemsize > len(content):
                raise InvalidInput(f"{path}: byte {begin}: the file ends at element {number} of {count} '{name}'")
            if counted and label.startswith("vert"):
                polygon = np.frombuffer(content, dtype=value, count=length, offset=at).astype(np.int64).tolist()
            at += length * value.itemsize
        polygons.append((f"byte {begin}", polygon))
    return polygons, at


def _off(path: Path, content: bytes) -> Surface:
    rows = ((line, text.split("#")[0].split()) for line, text in enumerate(_lines(content), 1))
    lines = [(line, words) for line, words in rows if words]
    keyword = lines[0][1][0] if lines else ""
    if _OFF.fullmatch(keyword.encode()):
        if "4" in keyword or "n" in keyword or "BINARY" in lines[0][1]:
            raise InvalidInput(f"{path}:{lines[0][0]}: '{' '.join(lines[0][1])}': text of three coordinates is read")
        lines[0] = (lines[0][0], lines[0][1][1:])
        lines = lines if lines[0][1] else lines[1:]
    if not lines:
        raise InvalidInput(f"{path}: no numbers of vertices and faces")
    line, words = lines[0]
    vertices, faces = (_whole(path, line, word) for word in (words[:2] if len(words) > 1 else ["", ""]))
    if len(lines) != 1 + vertices + faces:
        raise InvalidInput(f"{path}:{line}: {vertices} vertices and {faces} faces are announced, {len(lines) - 1} lines follow")
    points = [_numbers(path, line, words, 3) for line, words in lines[1 : 1 + vertices]]
    polygons: Polygons = []
    for line, words in lines[1 + vertices :]:
        corners = [_whole(path, line, word) for word in words[1 : 1 + _whole(path, line, words[0])]]
        if len(corners) != int(words[0]) or max(corners, default=0) >= vertices:
            raise InvalidInput(f"{path}:{line}: a face needs {words[0]} vertices from 0 to {vertices - 1}")
        polygons.append((f"line {line}", corners))
    if not polygons:
        raise InvalidInput(f"{path}: no faces")
    return Surface(np.array(points), np.array(_fans(path, polygons)), str(path))


def _whole(path: Path, line: int, word: str) -> int:
    if not word.isdecimal():
        raise InvalidInput(f"{path}:{line}: '{word}' is no whole number")
    return int(word)


def _fans(path: Path, polygons: Polygons) -> list[tuple[int, int, int]]:
    triangles = []
    for place, polygon in polygons:
        if len(polygon) < 3:
            raise InvalidInput(f"{path}: {place}: a face of {len(polygon)} vertices")
        triangles += [(polygon[0], polygon[k], polygon[k + 1]) for k in range(1, len(polygon) - 1)]
    return triangles


def _has_xyz(path: Path, properties: Properties) -> bool:
    if not {"x", "y", "z"} <= {name for name, _, _ in properties}:
        raise InvalidInput(f"{path}: vertices have no properties x, y and z")
    return True


def _lines(content: bytes) -> list[str]:
    return content.decode("utf-8", errors="replace").splitlines()


def _numbers(path: Path, line: int, words: list[str], count: int) -> list[float]:
    if len(words) < count:
        raise InvalidInput(f"{path}:{line}: {len(words)} numbers where {count} are needed")
    try:
        values = [float(word) for word in words[:count]]
    except ValueError:
        raise InvalidInput(f"{path}:{line}: '{' '.join(words)}' are no numbers") from None
    if not np.isfinite(values).all():
        raise InvalidInput(f"{path}:{line}: '{' '.join(words)}' are not finite")
    return values
