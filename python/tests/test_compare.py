from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

import softkin


def test_reports(robot: softkin.Robot, command: str, tmp_path: Path) -> None:
    for name, tolerance in (("fine", None), ("coarse", 1e-3)):
        list(robot.path([[1.1, 1, 1], [1.2, 1, 1]], solver=softkin.Solver(tolerance_mm=tolerance), store=tmp_path / name))
    files = [tmp_path / name / "report.json" for name in ("fine", "coarse")]
    found = softkin.compare.reports(files, marker="tip")
    assert found.marker == "tip" and found.distances.shape == (2, 2) and found.turns.size == 0
    assert (found.distances[0] == 0).all() and (found.distances[1] < 1e-2).all()
    assert len(found.steps) == 2 and len(found.times) == 2
    reported = subprocess.run([command, "compare", *map(str, files), "--json"], check=True, capture_output=True, text=True)
    assert found.report == json.loads(reported.stdout)
    found.save_plot(tmp_path / "c.svg")
    assert (tmp_path / "c.svg").read_text().startswith("<")
    assert repr(found) and "<table>" in found._repr_html_()


def test_paths(examples: Path, command: str, tmp_path: Path) -> None:
    measured = examples / "three_chamber_actuator/measured"
    files = [str(measured / "camera.csv"), str(measured / "camera.csv")]
    found = softkin.compare.paths(files, plane="x-y", by="waypoint")
    options = ["--plane", "x-y", "--by", "waypoint", "--json"]
    reported = subprocess.run([command, "compare", *files, *options], check=True, capture_output=True, text=True)
    assert found.report == json.loads(reported.stdout)
    assert len(found.heads) >= 2 and len(found.waypoints) > 0 and len(found.errors) >= len(found.waypoints)
    assert np.nanmax(np.abs(found.summary["largest"])) < 1e-12
    found.save_plot(tmp_path / "p.svg")
    assert repr(found) and "<table>" in found._repr_html_()


def test_wrong_arguments(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="files must be a list, not 'one.json'"):
        softkin.compare.reports("one.json")
    with pytest.raises(ValueError, match="poses need turn"):
        softkin.compare.reports(["a.json", "b.json"], poses=[90])
    with pytest.raises(softkin.InvalidInput, match="a.json"):
        softkin.compare.reports([tmp_path / "a.json", tmp_path / "b.json"])
