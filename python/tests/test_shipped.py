"""The examples that come with the package, by function and by command."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import softkin


def test_scene_by_name(examples: Path) -> None:
    scene = softkin.example("chambers")
    assert scene.name == "three_chamber_actuator.yaml"
    here = softkin.load(examples / "three_chamber_actuator" / scene.name)
    assert softkin.load(scene).fingerprint == here.fingerprint
    assert softkin.example("three_ch") == scene and softkin.example("finger").name == "pneumatic_finger.yaml"


def test_names_that_are_none() -> None:
    with pytest.raises(softkin.InvalidInput, match="none named 'fingr'; did you mean 'finger'"):
        softkin.example("fingr")
    with pytest.raises(softkin.InvalidInput, match="may be three_chamber_actuator or three_tendon_finger"):
        softkin.example("three")
    with pytest.raises(softkin.InvalidInput, match="acrylic_strip has no scene"):
        softkin.example("strip")


def test_command_of_the_package(command: str, tmp_path: Path) -> None:
    for program in ([command], [sys.executable, "-m", "softkin"]):
        if program[0] == sys.executable and Path(command).parent != Path(sys.executable).parent:
            continue  # of a build folder, beside which there is no command
        reported = subprocess.run([*program, "examples", "copy", "bar"], cwd=tmp_path, capture_output=True, text=True)
        assert reported.returncode == 0 and "softkin fk two_material_bar/two_material_bar.yaml" in reported.stdout, reported.stderr
    assert softkin.load(tmp_path / "two_material_bar/two_material_bar.yaml").name
