"""From surfaces to meshes by fTetWild: volumes, regions, notes, refusals."""

import warnings

import numpy as np
import pytest
from mesh_shapes import box, check_usable, fine_box, joined, needs_tetwild, sphere, turned

from softkin.mesh import InvalidInput, MeshWarning, Surface, from_surfaces, write_stl

pytestmark = [pytest.mark.deep, needs_tetwild]

BODY = box((0, 0, 0), (20, 10, 10))
CAVITY = box((3, 3, 3), (12, 7, 7))


def volume_of(mesh, name):
    return mesh.element_volumes[mesh.volume_regions[name]].sum()


@pytest.fixture(scope="module")
def finger():
    """A box with a cavity, two parts, one inside the other, and faces of many kinds."""
    return from_surfaces(
        BODY,
        {"air": CAVITY},
        {"core": box((13.5, 2, 2), (18.5, 8, 8)), "pin": box((15, 4, 4), (17, 6, 6))},
        edge_length=3,
        regions={
            "base": "plane x=0",
            "corner": "box 19 0 0 20 10 10",
            "ball": {"sphere": {"center": [20, 5, 5], "radius": 4}},
            "low": {"plane": "0 0 2 = 0", "within": 0.2},
            "like_base": {"near": (BODY.vertices, BODY.triangles[:2])},
        },
    )


def test_volumes_are_those_of_the_boxes(finger):
    tolerance = finger.tolerance_mm
    assert volume_of(finger, "air") == pytest.approx(9 * 16, abs=tolerance * CAVITY.area)
    assert volume_of(finger, "pin") == pytest.approx(8, abs=tolerance * 24)
    assert volume_of(finger, "core") == pytest.approx(180 - 8, abs=tolerance * 250)
    assert volume_of(finger, "body") == pytest.approx(2000 - 144 - 180, abs=tolerance * BODY.area)
    assert finger.volumes["body"].mesh_mm3 == pytest.approx(2000, abs=tolerance * BODY.area)
    assert finger.volumes["body"].surface_mm3 == pytest.approx(2000)


def test_every_tetrahedron_is_in_one_region_and_positive(finger):
    counts = np.zeros(len(finger.tetrahedra), dtype=int)
    for region in finger.volume_regions.values():
        counts[region] += 1
    assert (counts == 1).all()
    assert finger.element_volumes.min() > 0
    assert finger.quality.inverted == 0 and finger.quality.parts == 1
    assert finger.quality.least_angle_deg > 5


def test_the_boundary_stays_within_the_tolerance(finger):
    assert set(finger.deviation_mm) == {"body", "air", "core", "pin"}
    assert max(finger.deviation_mm.values()) <= 1.5 * finger.tolerance_mm
    assert finger.tolerance_mm == pytest.approx(BODY.diagonal / 1000)
    assert "inverted" in finger.summary() and "tolerance" in finger.summary()


def test_the_wall_of_the_chamber_is_its_closed_boundary(finger):
    wall = Surface(finger.vertices, finger.face_regions["air_wall"])
    assert wall.volume == pytest.approx(volume_of(finger, "air"), rel=1e-9)
    ordered = np.sort(finger.boundary("air").triangles, axis=1)
    np.testing.assert_array_equal(np.unique(ordered, axis=0), np.unique(np.sort(wall.triangles, axis=1), axis=0))


def test_faces_are_where_they_were_requested(finger):
    def area(name):
        return Surface(finger.vertices, finger.face_regions[name]).area

    assert area("base") == pytest.approx(100, rel=0.02) and area("low") == pytest.approx(200, rel=0.02)
    assert area("like_base") == pytest.approx(100, rel=0.02)
    assert np.abs(finger.vertices[finger.face_regions["base"], 0]).max() <= 1.5 * finger.tolerance_mm
    assert finger.vertices[finger.face_regions["corner"], 0].min() > 18.9
    assert 0 < area("ball") < 60


def test_softkin_finds_nothing_wrong(finger, tmp_path):
    check_usable(finger, tmp_path)


def test_a_sphere():
    mesh = from_surfaces(sphere(10, rings=12), edge_length=5, tolerance=0.1)
    assert volume_of(mesh, "body") == pytest.approx(sphere(10, rings=12).volume, abs=0.1 * 4 * np.pi * 100)
    assert list(mesh.regions) == ["body"]


def test_a_chamber_left_empty(tmp_path):
    mesh = from_surfaces(BODY, {"air": CAVITY}, edge_length=4, chambers_as="void")
    assert "air" in mesh.face_regions and list(mesh.volume_regions) == ["body"]
    assert mesh.boundary().volume == pytest.approx(2000 - 144, abs=mesh.tolerance_mm * BODY.area)
    assert Surface(mesh.vertices, mesh.face_regions["air"]).volume == pytest.approx(144, rel=0.02)
    assert len(check_usable(mesh, tmp_path)) > 0


def test_a_hollow_body_takes_its_chamber_too():
    hollow = joined(BODY, turned(CAVITY), name="hollow")
    mesh = from_surfaces(hollow, {"air": CAVITY}, edge_length=4)
    assert volume_of(mesh, "air") == pytest.approx(144, rel=0.02)
    assert volume_of(mesh, "body") == pytest.approx(1856, rel=0.01)
    assert mesh.boundary().volume == pytest.approx(2000, rel=0.01)


def test_metres_warn_and_with_the_unit_it_is_the_same_body(tmp_path):
    write_stl(tmp_path / "body.stl", BODY.scaled(0.001))
    write_stl(tmp_path / "air.stl", CAVITY.scaled(0.001))
    files = (tmp_path / "body.stl", {"air": tmp_path / "air.stl"})
    with pytest.warns(
        MeshWarning, match=r"body.stl measures 0.02 x 0.01 x 0.01 mm: are these metres\? Then say unit='m'"
    ):
        small = from_surfaces(*files, edge_length=0.004)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh = from_surfaces(*files, edge_length=4, unit="m")
    for name, exact in (("air", 144), ("body", 1856)):
        assert volume_of(mesh, name) == pytest.approx(exact, abs=mesh.tolerance_mm * 1000)
        assert volume_of(small, name) == pytest.approx(exact * 1e-9, abs=small.tolerance_mm * 1000e-6)


def test_metres_with_an_edge_length_in_mm_are_an_error():
    with (
        pytest.warns(MeshWarning, match="metres"),
        pytest.raises(InvalidInput, match="edge_length=4 mm is longer than the body, which measures 0.02 x"),
    ):
        from_surfaces(BODY.scaled(0.001), edge_length=4)


def test_holes_flipped_faces_and_self_intersections_still_give_a_mesh(tmp_path):
    random = np.random.default_rng(5)
    body = joined(
        fine_box((0, 0, 0), (14, 10, 10), 5), fine_box((9.7, 0.3, 0.3), (20, 9.7, 9.7), 5)
    )  # two boxes that cross
    triangles = body.triangles[random.random(len(body.triangles)) > 0.02]
    body = turned(Surface(body.vertices, triangles, "bad body"), random.random(len(triangles)) < 0.2)
    mesh = from_surfaces(body, {"air": turned(CAVITY)}, edge_length=4, tolerance=0.1)
    exact = 14 * 100 + 6 * 9.4**2
    assert mesh.volumes["body"].mesh_mm3 == pytest.approx(exact, abs=0.1 * 900)
    assert volume_of(mesh, "air") == pytest.approx(144, abs=0.1 * CAVITY.area)
    assert any("holes closed" in note for note in mesh.notes) and any("turned" in note for note in mesh.notes)
    assert mesh.deviation_mm["body"] < 0.5
    check_usable(mesh, tmp_path)


def test_a_soup_without_inside_is_one_clear_error():
    random = np.random.default_rng(2)
    soup = Surface(random.random((300, 3)) * 20, np.arange(300).reshape(100, 3), "soup.stl")
    with (
        warnings.catch_warnings(),
        pytest.raises(InvalidInput, match=r"body: soup.stl (encloses nothing|has no clear inside)") as raised,
    ):
        warnings.simplefilter("ignore", MeshWarning)
        from_surfaces(soup, edge_length=5)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("chamber", "reported"),
    [
        (
            box((30, 3, 3), (35, 7, 7), "cavity.stl"),
            r"chamber air \(cavity.stl\) lies outside of the body, around \(32.5, 5, 5\) mm",
        ),
        (
            box((15, 3, 3), (25, 7, 7), "cavity.stl"),
            r"chamber air \(.*\) sticks out of the body by 80 mm\^3, around \(22.5",
        ),
        (
            box((0, 3, 3), (9, 7, 7), "cavity.stl"),
            r"chamber air touches the outside of the body at \(.*\) mm, over 16 mm\^2",
        ),
    ],
)
def test_chambers_outside_are_refused(chamber, reported):
    with pytest.raises(InvalidInput, match=reported):
        from_surfaces(BODY, {"air": chamber}, edge_length=5)


def test_a_chamber_that_a_plate_closes():
    mesh = from_surfaces(BODY, {"air": box((0, 3, 3), (9, 7, 7))}, edge_length=5, open_chambers=True)
    assert volume_of(mesh, "air") == pytest.approx(144, rel=0.02)
    mesh = from_surfaces(
        BODY,
        {"air": box((0, 3, 3), (9, 7, 7))},
        edge_length=5,
        open_chambers=True,
        chambers_as="void",
        regions={"base": "plane x=0"},
    )
    assert Surface(mesh.vertices, mesh.face_regions["base"]).area == pytest.approx(100 - 16, rel=0.01)


def test_chambers_that_touch_are_refused():
    with pytest.raises(InvalidInput, match=r"chambers (left|right) and (left|right) touch at \(10, .*no wall between"):
        from_surfaces(BODY, {"left": box((3, 3, 3), (10, 7, 7)), "right": box((10, 3, 3), (17, 7, 7))}, edge_length=5)


def test_a_mesher_that_fails_is_one_clear_error(monkeypatch):
    from softkin.mesh import tetwild

    for script, reported in (
        ("raise RuntimeError('bad day')", "bad day"),
        ("import os; os.abort()", "ended by signal 6"),
        ("", "code 0"),
    ):
        monkeypatch.setattr(tetwild, "SCRIPT", script)
        with pytest.raises(InvalidInput, match=rf"fTetWild made no mesh of box: .*{reported}; try another tolerance"):
            from_surfaces(BODY, edge_length=5)


def test_ctrl_c_ends_the_mesher(tmp_path, patience):
    import os
    import signal
    import subprocess
    import sys
    import time

    script = "import time; open('started', 'w').close(); time.sleep(100)"
    # Where pytest runs in the background its children ignore the signal.
    code = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    code += f"from pathlib import Path\nfrom softkin.mesh import tetwild\ntetwild.SCRIPT = {script!r}\n"
    code += "tetwild._run(Path('.'), {})\n"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    running = subprocess.Popen(
        [sys.executable, "-c", code], cwd=tmp_path, env=environment, stderr=subprocess.PIPE, text=True
    )
    for _ in range(600):
        if (tmp_path / "started").exists():
            break
        time.sleep(0.1)
    running.send_signal(signal.SIGINT)
    start = time.monotonic()
    said = running.communicate(timeout=30 * patience)[1]
    assert "KeyboardInterrupt" in said and time.monotonic() - start < 20 * patience


def test_parts_that_stick_out_add_to_the_body():
    mesh = from_surfaces(BODY, parts={"plug": box((18, 2, 2), (24, 8, 8))}, edge_length=5)
    assert volume_of(mesh, "plug") == pytest.approx(216, rel=0.01)
    assert volume_of(mesh, "body") == pytest.approx(2000 - 72, rel=0.01)
    assert any("144 mm^3 of it stick out" in note for note in mesh.notes)


@pytest.mark.parametrize(
    ("given", "reported"),
    [
        ({"edge_length": 0}, "edge_length=0: give a length in mm, > 0"),
        ({"edge_length": 3, "tolerance": float("nan")}, "tolerance must be a finite number, not nan"),
        ({"edge_length": 3, "unit": "parsec"}, "unit='parsec': it is one of mm, cm, m, um, in"),
        ({"edge_length": 3, "backend": "magic"}, "backend='magic': it is one of tetwild, gmsh"),
        ({"edge_length": 3, "chambers": {"body": CAVITY}}, "'body' names two surfaces"),
        ({"edge_length": 3, "chambers": {"a b": CAVITY}}, "'a b' is no name of a region"),
        (
            {"edge_length": 3, "chambers": {"air": CAVITY.scaled(1000)}},
            "air: .* times as large as the body; are both in mm",
        ),
        ({"edge_length": 3, "chambers": {"air": 3}}, "air: a surface is a file"),
    ],
)
def test_bad_arguments(given, reported):
    with pytest.raises(InvalidInput, match=reported):
        from_surfaces(BODY, **given)


@pytest.mark.parametrize(
    ("chosen_by", "reported"),
    [
        (
            "plane x=-3",
            (
                r"no face of the boundary lies within 0.0367 mm of 'plane x=-3'; the nearest, .* is 3 mm away. The body"
                r" reaches from"
            ),
        ),
        ("plane w=0", "'w' are not 3 numbers"),
        ("cone 1 2", "'cone 1 2' chooses no faces; give 'plane z=0'"),
        ("box 1 1 1 0 0 0", "the low corner comes first"),
        ("plane z=0 within x", "within 'x': give a length"),
        ({"plane": "z=0", "box": 3}, "chooses no faces"),
    ],
)
def test_regions_that_choose_nothing(chosen_by, reported):
    from softkin.mesh.face_regions import choose_faces

    with pytest.raises(InvalidInput, match=reported):
        choose_faces("base", chosen_by, BODY.vertices, BODY.triangles, BODY.diagonal / 1000)


def test_without_pytetwild_the_error_says_how_to_install_it(monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "pytetwild", None)
    with pytest.raises(ImportError, match=r"pip install 'softkin\[mesh\]'"):
        from_surfaces(BODY, edge_length=5)
