"""Surfaces: files in and out, and how bad ones are mended."""

import struct

import numpy as np
import pytest
from mesh_shapes import box, fine_box, joined, sphere, turned

from softkin.mesh import InvalidInput, MeshWarning, Surface, read_surface, write_stl
from softkin.mesh.repair import open_edges, repaired

CUBE = box((0, 0, 0), (1, 1, 1))
CUT_STL = b"x" * 80 + struct.pack("<I", 3) + b"y" * 100
ASCII_STL = """solid a
facet normal 0 0 1
 outer loop
  vertex 0 0 0
  vertex 1 0 0
  vertex 0 1 0
 endloop
endfacet
endsolid a
"""


def ascii_stl(surface):
    lines = []
    for corners in surface.corners:
        vertices = "\n".join("vertex " + " ".join(map(repr, p)) for p in corners.tolist())
        lines.append(f"facet normal 0 0 0\nouter loop\n{vertices}\nendloop\nendfacet")
    return (
        "solid one\n" + "\n".join(lines[:6]) + "\nendsolid one\nsolid two\n" + "\n".join(lines[6:]) + "\nendsolid two\n"
    )


def obj(surface):
    lines = (
        ["# quads and triangles", "o thing"]
        + ["v " + " ".join(map(repr, p)) for p in surface.vertices.tolist()]
        + ["vn 0 0 1"]
    )
    return "\n".join(lines + [f"f {a + 1}//1 {b + 1}/ {c - 8}" for a, b, c in surface.triangles.tolist()]) + "\n"


def ply(surface, form, list_name="vertex_indices"):
    header = (
        f"ply\nformat {form} 1.0\ncomment made by a test\nelement vertex {len(surface.vertices)}\nproperty uchar"
        " red\nproperty double x\nproperty double y\nproperty double z\nelement face"
        f" {len(surface.triangles)}\nproperty list uchar int {list_name}\nend_header\n"
    )
    if form == "ascii":
        rows = [f"7 {x!r} {y!r} {z!r}" for x, y, z in surface.vertices.tolist()] + [
            f"3 {a} {b} {c}" for a, b, c in surface.triangles.tolist()
        ]
        return (header + "\n".join(rows) + "\n").encode()
    order = "<" if form == "binary_little_endian" else ">"
    body = b"".join(struct.pack(order + "B3d", 7, *p) for p in surface.vertices.tolist())
    return header.encode() + body + b"".join(struct.pack(order + "B3i", 3, *t) for t in surface.triangles.tolist())


@pytest.mark.parametrize("form", ["stl", "binary.stl", "obj", "ascii", "binary_little_endian", "binary_big_endian"])
def test_every_form_gives_the_box(tmp_path, form):
    shape = box((0, 0, 0), (3, 2, 1))
    path = tmp_path / ("shape.ply" if "." not in form and form not in ("stl", "obj") else f"shape.{form}")
    if form == "binary.stl":
        write_stl(path, shape)
    else:
        content = {"stl": ascii_stl, "obj": obj}.get(form, lambda s: ply(s, form))(shape)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    read = read_surface(path)
    assert len(read.vertices) == 8 and len(read.triangles) == 12
    assert read.volume == pytest.approx(6, rel=1e-12) and read.area == pytest.approx(22, rel=1e-12)
    assert len(open_edges(read)) == 0


def test_polygons_become_fans(tmp_path):
    path = tmp_path / "pentagon.obj"
    path.write_text("v 0 0 0\nv 2 0 0\nv 3 1 0\nv 1 3 0\nv 0 2 0\nf 1 2 3 4 5\n")
    assert len(read_surface(path).triangles) == 3


def test_triangles_without_area_and_doubled_ones_go(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv 0 0 0\nf 1 2 3\nf 5 2 3\nf 1 2 4\nf 1 5 3\n")
    assert len(read_surface(path).triangles) == 1


@pytest.mark.parametrize(
    ("name", "content", "reported"),
    [
        ("a.stl", b"", "the file is empty"),
        ("a.stl", b"solid a\nfacet\nouter loop\nvertex 0 0\n", "a.stl:4: 2 numbers where 3 are needed"),
        ("a.stl", ASCII_STL.replace("1 0 0", "1 x 0").encode(), "a.stl:5: '1 x 0' are no numbers"),
        ("a.stl", ASCII_STL.replace("1 0 0", "nan 0 0").encode(), "a.stl:5: 'nan 0 0' are not finite"),
        ("a.stl", ASCII_STL.replace("  vertex 0 1 0\n", "").encode(), "a.stl:6: a facet of 2 vertices"),
        ("a.stl", ASCII_STL.replace("endfacet", "endfacte").encode(), "a.stl:8: 'endfacte' is no word of STL"),
        ("a.stl", CUT_STL, "byte 80: the header announces 3 facets, which take 234 bytes, but the file has 184"),
        ("a.stl", b"hello", "5 bytes are neither"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nf 1 2 3\n", "a.obj:3: '3' names no vertex; there are 2"),
        ("a.obj", b"v 0 0 0\nf a b c\n", "a.obj:2: 'a' is no index"),
        ("a.obj", b"v 0 0 0\n", "no faces"),
        ("a.ply", b"plx", "a.ply:1: no PLY header"),
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex x\nend_header\n", "a.ply:3: 'element vertex x' is no line"),
        ("a.ply", ply(CUBE, "ascii").replace(b"\n3 0 1 3", b"\n3 0 1"), "a.ply:20: 3 indices are announced and 2 are"),
        ("a.ply", ply(CUBE, "binary_little_endian")[:-5], "the file ends at element 11 of 12 'face'"),
        ("a.off", b"OFF", "a.off: no numbers of vertices and faces"),
        ("a.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n", "a.off:2: 3 vertices and 1 faces are announced, 2 lines follow"),
        ("a.off", b"OFF\n2 1 0\n0 0 0\n1 0 0\n3 0 1 2\n", "a.off:5: a face needs 3 vertices from 0 to 1"),
        ("a.off", b"OFF\n2 x\n", "a.off:2: 'x' is no whole number"),
        ("a.off", b"OFF BINARY\n", "a.off:1: 'OFF BINARY': text of three coordinates is read"),
        ("a.txt", b"hello", "surfaces are STL, OBJ, PLY or OFF"),
        ("a.stl", b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n", "Git LFS pointer"),
    ],
)  # fmt: skip
def test_bad_files_are_one_clear_error(tmp_path, name, content, reported):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InvalidInput) as raised:
        read_surface(path)
    assert reported in str(raised.value) and "\n" not in str(raised.value)


def test_the_content_determines_the_form(tmp_path):
    shape = box((0, 0, 0), (3, 2, 1))
    corners = "".join("{!r} {!r} {!r} 9 9 9 1\n".format(*p) for p in shape.vertices.tolist())
    faces = "".join("3 {} {} {} 0.5 0.5 0.5\n".format(*t) for t in shape.triangles.tolist())
    off = f"# by hand\nCOFF\n{len(shape.vertices)} {len(shape.triangles)} 0\n{corners}{faces}"
    for content in (off.encode(), obj(shape).encode(), ply(shape, "binary_big_endian"), ascii_stl(shape).encode()):
        path = tmp_path / "shape.stl"
        path.write_bytes(content)
        read = read_surface(path)
        assert len(read.triangles) == 12 and read.volume == pytest.approx(6, rel=1e-12)


def test_a_missing_file_and_bad_arrays():
    with pytest.raises(ValueError, match="nowhere.stl: No such file"):
        read_surface("nowhere.stl")
    with pytest.raises(ValueError, match=r"triangle 1 is \[0, 1, 9\], but vertices go from 0 to 2"):
        Surface(np.eye(3), np.array([[0, 1, 2], [0, 1, 9]]))
    with pytest.raises(ValueError, match=r"vertices have shape \(3, 2\)"):
        Surface(np.zeros((3, 2)), np.array([[0, 1, 2]]))
    with pytest.raises(ValueError, match="vertex 1 is not finite"):
        Surface(np.array([[0, 0, 0], [np.nan, 0, 0], [1, 1, 1]]), np.array([[0, 1, 2]]))


def test_flipped_faces_turn_back():
    shape = sphere(5)
    some = np.random.default_rng(1).random(len(shape.triangles)) < 0.3
    mended = repaired(turned(shape, some))
    assert mended.volume == pytest.approx(shape.volume, rel=1e-12)
    assert f"{some.sum()} faces turned" in mended.notes[0]


def test_shells_keep_or_get_their_sides():
    outer, cavity, beside = box((0, 0, 0), (10, 10, 10)), box((2, 2, 2), (4, 4, 4)), box((20, 0, 0), (21, 1, 1))
    assert repaired(turned(outer)).volume == pytest.approx(1000)
    assert repaired(joined(outer, turned(cavity))).volume == pytest.approx(992)
    assert repaired(turned(joined(outer, turned(cavity)))).volume == pytest.approx(992)
    assert repaired(joined(outer, turned(beside))).volume == pytest.approx(1001)


def test_holes_are_closed_and_noted():
    shape = fine_box((0, 0, 0), (4, 4, 4), 8)
    keep = np.ones(len(shape.triangles), dtype=bool)
    keep[[3, 300, 301, 500]] = False
    mended = repaired(Surface(shape.vertices, shape.triangles[keep], "holed"))
    assert len(open_edges(mended)) == 0 and mended.volume == pytest.approx(64, rel=1e-9)
    assert "holes closed" in mended.notes[0]


def test_a_missing_side_is_a_warning():
    shape = box((0, 0, 0), (4, 4, 4))
    with pytest.warns(MeshWarning, match="20 % of its area: is a part of the surface missing"):
        mended = repaired(Surface(shape.vertices, shape.triangles[2:], "open"))
    assert mended.volume == pytest.approx(64)


def test_gaps_of_rounding_are_joined():
    shape = fine_box((0, 0, 0), (4, 4, 4), 6)
    corners = shape.corners + np.random.default_rng(0).uniform(-1, 1, shape.corners.shape) * 1e-6
    soup = Surface(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), "gappy")
    some = np.random.default_rng(1).random(len(corners)) < 0.3
    mended = repaired(turned(soup, some))
    assert len(open_edges(mended)) == 0 and len(mended.vertices) == len(shape.vertices)
    assert mended.volume == pytest.approx(64, rel=1e-5)
    assert "points joined to others within" in mended.notes[0]
