"""Pages: what is in them, against the shapes themselves; what they refuse."""

from __future__ import annotations

import base64
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from beams import beam

import softkin


@pytest.fixture(scope="module")
def robot() -> softkin.Robot:
    chambers: list[dict[str, Any]] = [{"name": "air", "kind": "pneumatic", "region": "chamber1", "range": (1, 1.5)}]
    robot = beam(4, 5, actuators=chambers)
    try:
        robot.to_html()
    except softkin.InvalidInput as error:
        assert "built without its page" in str(error)
        pytest.skip("built without the page")
    return robot


def shown(html: str) -> dict[str, Any]:
    found = re.findall(r'<script type="application/json" id="softkin-page">(.*?)</script>', html, re.DOTALL)
    assert len(found) == 1
    page: dict[str, Any] = json.loads(found[0])
    return page


def numbers(packed: dict[str, Any]) -> Any:
    if "f32" in packed:
        return np.frombuffer(base64.b64decode(packed["f32"]), "<f4").reshape(-1, 3)
    levels = np.frombuffer(base64.b64decode(packed["u16"]), "<u2").reshape(-1, len(packed["low"]))
    return np.array(packed["low"]) + np.array(packed["step"]) * levels


def test_shapes_are_its_steps(robot: softkin.Robot, tmp_path: Path) -> None:
    shapes = list(robot.path([[1.1], [1.4]]))
    file = tmp_path / "page.html"
    html = robot.to_html(file, shapes)
    assert file.read_text(encoding="utf-8") == html
    page = shown(html)
    assert page["robot"] == robot.name and page["map"] is None and len(page["steps"]) == 2
    rest = numbers(page["surface"]["rest"])
    places = [int(np.argmin(np.linalg.norm(robot.rest - place, axis=1))) for place in rest]
    for step, shape in zip(page["steps"], shapes):
        assert step["commands"] == shape.actuation.tolist()
        assert step["loads"] == [shape.actuators["air"].pressure_kPa]
        assert np.array(step["markers"]) == pytest.approx(np.array([shape[name] for name in robot.markers]))
        assert np.abs(numbers(step["positions"]) - shape.positions[places]).max() < 0.002


def test_one_shape_and_none(robot: softkin.Robot) -> None:
    assert len(shown(robot.to_html(shapes=robot.solve(air=1.2)))["steps"]) == 1
    assert shown(robot.to_html())["steps"] == []


def test_map_is_inside(robot: softkin.Robot) -> None:
    by = robot.map(accuracy_mm=0.05, checks=5)
    assert [each["name"] for each in shown(robot.to_html(map=by))["map"]["inputs"]] == ["air"]
    flat = robot.map(accuracy_mm=0.05, checks=5, shape_accuracy_mm=None)
    with pytest.raises(softkin.InvalidInput, match="has no shape to bend"):
        robot.to_html(map=flat)
    other = beam(4, 5, actuators=[{"name": "air", "kind": "pneumatic", "region": "chamber2", "range": (1, 1.5)}])
    with pytest.raises(softkin.InvalidInput):
        other.to_html(map=by)


def test_refusals(robot: softkin.Robot, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"must end in \.html"):
        robot.to_html(tmp_path / "page.htm")
    with pytest.raises(softkin.InvalidInput, match="another robot"):
        robot.to_html(shapes=beam(4, 5).solve())
    with pytest.raises(TypeError, match=r"shapes\[0\] must be a softkin.Shape, not 1.0"):
        robot.to_html(shapes=[1.0])  # type: ignore[list-item]
    assert list(tmp_path.iterdir()) == []


def test_view_is_the_page_in_a_frame(robot: softkin.Robot) -> None:
    import html

    view = robot.view(robot.solve(air=1.2), height=400)
    frame = view._repr_html_()
    found = re.search(r'srcdoc="([^"]*)"', frame)
    assert found is not None and html.unescape(found.group(1)) == view.html
    assert view.height == 400 and 'height="400"' in frame and 'sandbox="allow-scripts allow-downloads"' in frame
    assert "PageView" in repr(view)
