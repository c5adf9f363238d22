"""python3 exported_map.py NPZ COMMANDS.json: what the reader of examples/python answers, as JSON; None: outside."""

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "examples" / "python"))
sys.dont_write_bytecode = True

import numpy as np
from map_numpy import NumpyMap

robot = NumpyMap(sys.argv[1])
commands = np.array(json.loads(Path(sys.argv[2]).read_text()), float)
outputs, cells = robot.fk(commands)
shapes = robot.shape(commands, cells) if "shape_mean" in robot.a else np.zeros((len(commands), 0, 3))
answers = [
    {"outputs": None if np.isnan(row).any() else row.tolist(), "shape": shape.ravel().tolist() if cell >= 0 else None}
    for row, cell, shape in zip(outputs, cells, shapes)
]
names = {key: robot.a[key].tolist() for key in ("robot", "inputs", "input_units", "outputs", "output_units")}
print(json.dumps({"answers": answers, "names": names, "checked": robot.a["checked"].tolist()}))
