"""Pictures and films: the numbers of the command, and pictures in memory."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import softkin
from softkin import measure

PICTURES = Path(__file__).resolve().parents[2] / "docs/images/measure"
LINKED = Path(__file__).resolve().parents[2] / "build/softkin-measure"  # where the C++ program was built with OpenCV
needs_opencv = pytest.mark.skipif(not measure.available(), reason="needs pip install softkin[measure]")
SCALE = ("green", "yellow", 60.0)
GRID = "5x4,tag=12mm,gap=3mm"
CHECKER = "checker,9x6,square=10mm"


def reported(command: str, *arguments: object) -> Any:
    done = subprocess.run([command, "measure", *map(str, arguments), "--json"], check=True, capture_output=True)
    return json.loads(done.stdout)


def test_without_opencv_one_error_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "softkin._opencv", None)
    assert not measure.available()
    for call in (
        lambda: measure.pictures([PICTURES / "rest.png"], dots=["red"], scale=SCALE),
        lambda: measure.film(PICTURES / "track", dots=["red"], scale=SCALE),
        lambda: measure.camera([], CHECKER),
        lambda: measure.Board(GRID),
    ):
        with pytest.raises(ImportError, match=r"softkin.measure needs .* pip install 'softkin\[measure\]'"):
            call()


def test_without_opencv_the_command_says_so_too(tmp_path: Path) -> None:
    (tmp_path / "cv2.py").write_text("raise ImportError('no cv2 here')\n")
    done = subprocess.run(
        [sys.executable, "-m", "softkin._measure_command", "--help"],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr.startswith("softkin: measure needs OpenCV") and done.stderr.count("\n") == 1
    assert "pip install 'softkin[measure]' (no cv2 here)" in done.stderr


@needs_opencv
def test_a_specimen(command: str, tmp_path: Path) -> None:
    files = [PICTURES / "rest.png", PICTURES / "stretched.png"]
    fractions: list[float] = []
    found = measure.pictures(
        files, interface=("red", "blue"), dots=["green", "yellow"], scale=SCALE, progress=fractions.append
    )
    options = ["--interface", "red,blue", "--dots", "green,yellow", "--scale", "green,yellow=60mm"]
    assert found.report == reported(command, *files, *options, "-o", tmp_path / "theirs.csv")
    assert fractions == [0, 0.5, 1]
    found.save(tmp_path / "ours.csv")
    assert (tmp_path / "ours.csv").read_text() == found.csv() == (tmp_path / "theirs.csv").read_text()
    rest, stretched = found
    assert len(found) == 2 and rest.name == str(files[0]) and rest.specimen is not None
    assert rest.specimen.length_mm == pytest.approx(52, abs=0.01) and rest.specimen.length_error_mm < 0.01
    assert rest.specimen.interface_mm == pytest.approx(20, abs=0.01) and rest.specimen.interface_error_mm < 0.01
    assert abs(rest.specimen.interface_deg) < 0.1 and rest.specimen.interface_error_deg < 0.1
    assert rest.specimen.axis_deg == pytest.approx(2, abs=0.05)
    (stretch,) = found.stretches
    assert stretch.elongation_mm == pytest.approx(8.88, abs=0.01) and stretch.elongation_error_mm < 0.01
    assert stretch.shift_mm == pytest.approx(1.2, abs=0.01) and stretch.shift_error_mm < 0.01
    assert stretch.elasticity_ratio == pytest.approx(4, abs=0.05) and stretch.elasticity_ratio_error is not None
    assert found.table.columns == ["l_mm", "l1_mm", "dl_mm", "dl1_mm"] and len(found.table) == 1
    assert found.mm_per_pixel == pytest.approx(1 / 6, rel=1e-3) and found.notes[0].startswith("scale: ")
    assert stretched.markers["green"].place_mm == pytest.approx([0, 0], abs=0.02)
    assert softkin.calibrate.material(tmp_path / "ours.csv", formulation="physical", cells=1, modulus_b_MPa=1).failure == ""


@needs_opencv
def test_outlines(command: str, tmp_path: Path) -> None:
    files = [PICTURES.parent / "outline" / f"finger_{number}.png" for number in (1, 2, 3)]
    found = measure.pictures(files, outline="dark", dots=["red", "green"], scale=("red", "green", 100.0))
    options = ["--outline", "dark", "--dots", "red,green", "--scale", "red,green=100mm"]
    assert found.report == reported(command, *files, *options, "-o", tmp_path / "theirs.csv")
    found.save(tmp_path / "ours.csv")
    assert (tmp_path / "ours.csv").read_text() == (tmp_path / "theirs.csv").read_text()
    assert found.table.columns == ["picture", "x_mm", "y_mm"]
    outline = found[0].outline
    assert outline is not None and outline.cut and len(outline.points_mm) <= 400
    assert outline.points_mm.shape[1] == 2 and outline.area_mm2 == pytest.approx(2262, abs=20)
    assert outline.length_mm == pytest.approx(401, abs=5)


@needs_opencv
def test_a_film(command: str, tmp_path: Path) -> None:
    options = {"dots": {"tip": "red", "green": "green", "yellow": "yellow"}, "angles": [("green", "tip")]}
    fractions: list[float] = []
    found = measure.film(PICTURES / "track", fps=20, scale="green,yellow=30mm", progress=fractions.append, **options)  # type: ignore[arg-type]
    theirs = tmp_path / "theirs.csv"
    dots = ["--dots", "tip=red,green,yellow", "--angle", "green,tip", "--scale", "green,yellow=30mm"]
    expected = reported(command, PICTURES / "track", "--fps", 20, *dots, "-o", theirs)
    assert {**found.report, "output": str(theirs)} == expected
    found.save(tmp_path / "ours.csv")
    assert (tmp_path / "ours.csv").read_text() == theirs.read_text()
    assert found.markers == ["tip", "green", "yellow"] and len(found) == found.frames == 6 and not found.left_out
    assert found.frames_per_second == 20 and found.times == pytest.approx(np.arange(6) / 20)
    assert found.places.shape == (6, 3, 2) and found["tip"].tolist() == found.places[:, 0].tolist()
    assert np.ptp(found["tip"], axis=0).max() > 1 and len(fractions) == 6
    assert found.table.columns[:3] == ["t_s", "tip_x_mm", "tip_y_mm"] and "6 of 6 frames" in repr(found)


@needs_opencv
def test_boards(command: str, tmp_path: Path) -> None:
    board = measure.Board(GRID)
    assert (board.width_mm, board.height_mm) == (72, 57) and "72 x 57 mm" in repr(board)
    for name in ("board.svg", "board.png"):
        ours, theirs = tmp_path / name, tmp_path / f"theirs_{name}"
        board.save(ours, dpi=200)
        subprocess.run([command, "measure", "board", GRID, "-o", theirs, "--dpi", "200"], check=True, capture_output=True)
        assert ours.read_bytes() == theirs.read_bytes()
    assert board.svg() == (tmp_path / "board.svg").read_text()
    picture = board.picture(200)
    assert picture.dtype == np.uint8 and picture.shape[2] == 3 and picture.flags.writeable
    smaller = "5x3,tag=12mm,gap=3mm"
    in_memory = measure.pictures([picture], scale_board=smaller, tags={"corner": 15, "other": 19}, threads=1)
    from_file = measure.pictures([tmp_path / "board.png"], scale_board=smaller, tags="corner=15,other=19")
    places = [found[0].markers["corner"].place_mm.tolist() for found in (in_memory, from_file)]
    assert places[0] == places[1] == pytest.approx([6, -9], abs=0.02) and in_memory[0].name == "pictures[0]"
    assert in_memory[0].markers["corner"].error_mm < 0.01 and in_memory[0].markers["other"].pixel.shape == (2,)
    turned = measure.pictures(
        [picture], scale_board=measure.Board(smaller), tags=True, origin="tag15", x_axis=("tag15", "tag19")
    )
    assert turned[0].markers["tag15"].place_mm == pytest.approx([0, 0], abs=1e-9)
    assert turned[0].markers["tag19"].place_mm == pytest.approx([60, 0], abs=0.02)
    angle = measure.pictures([picture], scale_board=smaller, tags=[15, 19], angles=[("tag15", "tag19")])
    assert angle[0].angles["angle_tag15_tag19"].degrees == pytest.approx(0, abs=0.05)
    assert angle[0].angles["angle_tag15_tag19"].error_deg < 0.05


def seen(board: NDArray[np.uint8], dpi: float, tilt: tuple[float, float], far: float) -> NDArray[np.uint8]:
    """640 x 480 pixels of a pinhole of 900 pixels, above the middle of the board at a distance [mm]."""
    across, along = np.radians(tilt)
    turn_x = np.array([[1, 0, 0], [0, np.cos(across), -np.sin(across)], [0, np.sin(across), np.cos(across)]])
    turn_y = np.array([[np.cos(along), 0, np.sin(along)], [0, 1, 0], [-np.sin(along), 0, np.cos(along)]])
    turn = turn_x @ turn_y
    height, width = board.shape[:2]
    fine = 3  # rays a pixel, along each axis
    u, v = (np.mgrid[0 : 640 * fine, 0 : 480 * fine] + 0.5) / fine - 0.5
    rays = np.stack([(u - 320) / 900, (v - 240) / 900, np.ones_like(u)], axis=-1) @ turn
    eye = np.array([0, 0, -far]) @ turn
    places = eye[:2] - eye[2] / rays[..., 2:] * rays[..., :2]
    columns = np.rint(places[..., 0] * dpi / 25.4 + width / 2 - 0.5).astype(int)
    rows = np.rint(places[..., 1] * dpi / 25.4 + height / 2 - 0.5).astype(int)
    inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
    bright = np.where(inside, board[rows.clip(0, height - 1), columns.clip(0, width - 1), 0], 255)
    pixels = bright.reshape(640, fine, 480, fine).mean(axis=(1, 3)).T
    return np.repeat(np.rint(pixels).astype(np.uint8)[..., None], 3, axis=2)


def assert_same_camera(*files: Path) -> None:
    """The same text, and numbers as two builds of OpenCV find them: its search ends within 1e-8 of itself."""
    number = re.compile(r"-?\d+\.?\d*(?:e[-+]?\d+)?")
    ours, theirs = (file.read_text() for file in files)
    assert number.sub("", ours) == number.sub("", theirs)
    numbers = [[float(each) for each in number.findall(text)] for text in (ours, theirs)]
    assert len(numbers[0]) > 15 and numbers[0] == pytest.approx(numbers[1], rel=1e-5, abs=1e-6)


@needs_opencv
def test_a_camera(command: str, tmp_path: Path) -> None:
    board = measure.Board(CHECKER).picture(600)
    tilts = [(0, 0), (30, 0), (-30, 5), (5, 30), (-5, -30), (20, 25)]
    views = [seen(board, 600, tilt, 200) for tilt in tilts]
    found = measure.camera(views, CHECKER)
    assert (found.width, found.height, found.pictures) == (640, 480, 6)
    assert found.matrix[0, 0] == pytest.approx(900, rel=0.01) and found.focal_error_px < 5
    assert found.matrix[0, 2] == pytest.approx(320, abs=5) and abs(found.distortion[[0, 2, 3]]).max() < 0.05
    assert found.reprojection_error_px < 0.2 and found.picture_errors_px.shape == (6,)
    files = [tmp_path / f"view{i}.ppm" for i in range(6)]
    for file, view in zip(files, views):
        file.write_bytes(b"P6 640 480 255\n" + view.tobytes())
    theirs, ours = tmp_path / "theirs.yaml", tmp_path / "ours.yaml"
    reported(command, "camera", *files, "--board", CHECKER, "-o", theirs)
    measure.camera(files, measure.Board(CHECKER)).save(ours)
    assert_same_camera(ours, theirs)
    read = measure.read_camera(ours)
    assert read.matrix == pytest.approx(found.matrix, rel=1e-9) and read.picture_errors_px.shape == (0,)
    grid = measure.Board(GRID).picture(600)
    view = [seen(grid, 600, (20, 0), 200)]
    by_object = measure.pictures(view, scale_board=GRID, tags=[7], camera=found)
    by_file = measure.pictures(view, scale_board=GRID, tags=[7], camera=ours)
    assert by_object[0].markers["tag7"].place_mm == pytest.approx(by_file[0].markers["tag7"].place_mm, abs=1e-6)
    assert by_file[0].markers["tag7"].place_mm == pytest.approx([36, 36], abs=0.1)


def apart(ours: Any, theirs: Any) -> float:
    """The largest difference of two reports, whose words are the same."""
    if isinstance(ours, dict):
        assert ours.keys() == theirs.keys()
        return max((apart(ours[key], theirs[key]) for key in ours), default=0.0)
    if isinstance(ours, list):
        assert len(ours) == len(theirs)
        return max((apart(a, b) for a, b in zip(ours, theirs)), default=0.0)
    if isinstance(ours, float) or isinstance(theirs, float):
        return abs(ours - theirs)
    assert ours == theirs
    return 0.0


@needs_opencv
@pytest.mark.skipif(not LINKED.exists(), reason="no program with OpenCV linked was built")
def test_pythons_opencv_measures_as_the_linked_one(tmp_path: Path) -> None:
    def both(*arguments: object) -> tuple[Any, Any]:
        """What each of the two says, in JSON."""
        words = [*map(str, arguments), "--json"]
        ours = [sys.executable, "-m", "softkin._measure_command"]
        texts = [subprocess.run([*by, *words], check=True, capture_output=True).stdout for by in (ours, [LINKED])]
        return json.loads(texts[0]), json.loads(texts[1])

    # all that is measured here is softkin's own: the same bits
    bar = [PICTURES / "rest.png", PICTURES / "stretched.png", "--interface", "red,blue", "--dots", "green,yellow"]
    ours, theirs = both(*bar, "--scale", "green,yellow=60mm")
    assert ours == theirs
    board = tmp_path / "board.png"
    measure.Board(GRID).save(board)
    # tags are found by OpenCV, whose versions begin at other corners
    assert apart(*both(board, "--scale-board", "5x3,tag=12mm,gap=3mm", "--tags")) < 1e-3  # [mm, px]
    files = []
    for number, tilt in enumerate([(0.0, 0.0), (30.0, 0.0), (-30.0, 5.0), (5.0, 30.0), (-5.0, -30.0), (20.0, 25.0)]):
        files.append(tmp_path / f"view{number}.ppm")
        view = seen(measure.Board(CHECKER).picture(300), 300, tilt, 200)
        files[-1].write_bytes(b"P6 640 480 255\n" + view.tobytes())
    ours, theirs = both("camera", *files, "--board", CHECKER, "-o", tmp_path / "camera.yaml")
    assert ours["fx_px"] == pytest.approx(theirs["fx_px"], rel=1e-3)
    assert ours["distortion"]["k1"] == pytest.approx(theirs["distortion"]["k1"], abs=5e-3)


@needs_opencv
def test_what_is_refused(tmp_path: Path) -> None:
    rest = PICTURES / "rest.png"
    for keywords, message in (
        ({"dots": ["magenta"], "scale": ((0, 0), (100, 0), 20)}, "rest.png: no dot 'magenta' found"),
        ({"dots": ["red"]}, "give one of the two, a board of known size or a scale"),
        ({"scale": SCALE}, "scale: no marker 'green'"),
        ({"dots": ["green", "yellow"], "scale": SCALE, "x_axis": ("green", "blue")}, "x axis: no marker 'blue'"),
        ({"dots": ["green"], "scale_board": CHECKER}, "scale board: a checker board looks the same upside down"),
        ({"dots": ["red"], "scale": "a"}, "scale 'a': write two markers"),
        ({"dots": [], "scale": SCALE}, "dots is empty"),
        ({"dots": ["red"], "scale": ("a", "b")}, "scale must"),
        ({"dots": ["red"], "scale": SCALE, "angles": "a,b"}, "angles must be a list"),
        ({"dots": ["red"], "scale": SCALE, "threads": -1}, "threads must be from 0 .* to 1024, not -1"),
    ):
        with pytest.raises(ValueError, match=message):
            measure.pictures([rest], **keywords)  # type: ignore[arg-type]
    dots: dict[str, Any] = {"dots": ["green", "yellow"], "scale": SCALE}
    with pytest.raises(ValueError, match="pictures must be a list of one or more"):
        measure.pictures([], **dots)
    with pytest.raises(ValueError, match=r"pictures\[0\] must be \(h, w, 3\) of uint8.* not \(480, 640\) of float64"):
        measure.pictures([np.zeros((480, 640))], **dots)  # type: ignore[list-item]
    with pytest.raises(softkin.InvalidInput, match=r"pictures\[0\]: the picture has 8 x 8 pixels"):
        measure.pictures([np.zeros((8, 8, 3), np.uint8)], **dots)
    with pytest.raises(softkin.InvalidInput, match="pictures have no clock: give the frames per second"):
        measure.film([rest, rest], **dots)
    with pytest.raises(ValueError, match="fps must be frames per second > 0"):
        measure.film(PICTURES / "track", fps=0, **dots)
    with pytest.raises(softkin.InvalidInput, match="a moving camera needs a scale board"):
        measure.film(PICTURES / "track", fps=20, moving_camera=True, **dots)
    with pytest.raises(ValueError, match="path must end in .svg or .png"):
        measure.Board(GRID).save(tmp_path / "board.jpg")
    with pytest.raises(ValueError, match="dpi must be 10 to 4800"):
        measure.Board(GRID).picture(5)
    with pytest.raises(softkin.InvalidInput, match="board.yaml"):
        measure.read_camera(tmp_path / "board.yaml")
