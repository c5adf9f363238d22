"""python -m softkin mesh generate: surfaces in, .msh and a scene out."""

from __future__ import annotations

import argparse
import os
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .child import ProgressFunction
from .elements import boundary_faces, check_name
from .errors import InvalidInput, MeshWarning
from .face_regions import choose_faces
from .generate import from_surfaces
from .gmsh_program import CAD, mesh_geo
from .msh_write import MARK
from .scene import scene_text
from .surface import MM_PER_UNIT
from .volume_mesh import VolumeMesh

WIDTH = 100
BETWEEN_LINES_S = 10.0
EPILOG = """\
Lengths on the command line are in mm; --unit is that of the surfaces. Faces for --region:
  "plane z=0"   "plane 0 0 1 = 0"   "box 0 0 0 10 10 1"   "sphere 0 0 0 5"
each followed by " within 0.1" if you like: how far corners may be off [mm].
Exit code: 0 done, 1 interrupted, 2 bad usage or bad input.
Example:
  python -m softkin mesh generate --body finger.stl --chamber air=cavity.stl --edge-length 2 \\
      --region "base=plane x=0" -o finger.msh --scene finger.yaml"""


def main(argv: Sequence[str]) -> int:
    """Runs `generate ...`; argv without the name of the program. Returns the exit code: 0, or after one line on the
    standard error 1 where it was interrupted, 2 where something is wrong."""
    try:
        arguments = _parser().parse_args(list(argv))
    except SystemExit as leaving:
        return int(leaving.code or 0)
    with warnings.catch_warnings():
        warnings.simplefilter("always", MeshWarning)
        warnings.showwarning = _show
        line = ProgressLine()
        try:
            summary = _generate(arguments, line.show)
        except (InvalidInput, ImportError) as error:
            line.clear()
            print(f"error: {error}", file=sys.stderr)
            return 2
        except KeyboardInterrupt:
            line.clear()
            print("interrupted: nothing was written", file=sys.stderr)
            return 1
        line.clear()
        print(summary)
    return 0


class ProgressLine:
    """Shows the current operation on the terminal; elsewhere prints a line every ten seconds."""

    def __init__(self) -> None:
        self._terminal = sys.stderr.isatty()
        self._shown = False
        self._next = 0.0 if self._terminal else BETWEEN_LINES_S

    def show(self, what: str, seconds: float) -> None:
        if self._terminal:
            print(f"\r\033[K{what}: {seconds:.0f} s; Ctrl-C stops", end="", file=sys.stderr, flush=True)
            self._shown = True
        elif seconds >= self._next:
            print(f"{what}: {seconds:.0f} s", file=sys.stderr, flush=True)
            self._next = seconds + BETWEEN_LINES_S

    def clear(self) -> None:
        if self._shown:
            print("\r\033[K", end="", file=sys.stderr, flush=True)
        self._shown = False


def _show(message: Any, category: Any, filename: str, lineno: int, file: Any = None, line: Any = None) -> None:
    print(f"warning: {message}", file=sys.stderr)


def _generate(arguments: argparse.Namespace, progress: ProgressFunction) -> str:
    if Path(arguments.output).suffix.lower() != ".msh":
        raise InvalidInput(
            f"-o {arguments.output}: meshes are written as .msh; softkin mesh convert makes other forms of it"
        )
    if not arguments.force_overwrite:
        _check_outputs(arguments)
    parts, regions = _pairs("part", arguments.part), _pairs("region", arguments.region)
    form = Path(arguments.body).suffix.lower()
    if form == ".geo" or (form in CAD and not arguments.chamber and not parts):
        mesh, driven = _from_geo(arguments, parts, regions, progress), arguments.chamber
    else:
        chambers = _pairs("chamber", arguments.chamber)
        mesh = from_surfaces(
            arguments.body, chambers, parts, edge_length=arguments.edge_length, unit=arguments.unit, regions=regions,
            tolerance=arguments.tolerance, backend=arguments.backend, chambers_as=arguments.chambers_as,
            open_chambers=arguments.open_chambers, coarsen=arguments.coarsen, progress=progress,
        )  # fmt: skip
        driven = list(chambers)
    scene = ""
    if arguments.scene:
        relative = os.path.relpath(Path(arguments.output).resolve(), Path(arguments.scene).resolve().parent)
        scene = scene_text(mesh, Path(relative).as_posix(), driven, arguments.fixed)
    mesh.write(arguments.output)
    if scene:
        try:
            Path(arguments.scene).write_text(scene, encoding="utf-8")
        except OSError as error:
            raise InvalidInput(f"{arguments.scene}: {error.strerror}") from None
    written = f"{arguments.output} and {arguments.scene}" if scene else str(arguments.output)
    return f"{mesh.summary()}\nwritten: {written}"


def _check_outputs(arguments: argparse.Namespace) -> None:
    """Refuses to replace what softkin did not write. A scene is there to be edited, so it is the user's."""
    cure = "name another file, or add --force-overwrite to replace it"
    output = Path(arguments.output)
    if output.is_file():
        with output.open("rb") as file:
            if file.read(len(MARK)) not in (b"", MARK):
                raise InvalidInput(f"-o {output}: is there already, and not by softkin: {cure}")
    if arguments.scene and Path(arguments.scene).is_file() and Path(arguments.scene).stat().st_size > 0:
        raise InvalidInput(f"--scene {arguments.scene}: is there already, and may have been edited: {cure}")


def _from_geo(
    arguments: argparse.Namespace, parts: dict[str, str], regions: dict[str, str], progress: ProgressFunction
) -> VolumeMesh:
    if arguments.backend != "gmsh":
        raise InvalidInput(f"{arguments.body}: only --backend gmsh reads that")
    if parts:
        raise InvalidInput(
            f"{arguments.body}: its physical groups are the regions; --part goes with .stl, .obj, .ply, .off or CAD models"
        )
    scale = MM_PER_UNIT[arguments.unit]
    mesh = mesh_geo(Path(arguments.body), arguments.edge_length / scale, progress)
    for name in arguments.chamber:
        if name not in mesh.regions:
            raise InvalidInput(
                f"--chamber {name}: of a .geo give the name of a physical group: {', '.join(mesh.regions)}"
            )
    vertices = mesh.vertices * scale
    faces = dict(mesh.face_regions)
    for name, chosen_by in regions.items():
        check_name(name)
        if name in mesh.regions:
            raise InvalidInput(f"--region {name}: the file has a region of that name")
        faces[name] = choose_faces(
            name, chosen_by, vertices, boundary_faces(mesh.tetrahedra), 1e-6 * arguments.edge_length
        )
    return VolumeMesh(vertices, mesh.tetrahedra, mesh.volume_regions, faces)


def _pairs(option: str, given: Sequence[str]) -> dict[str, str]:
    pairs: dict[str, str] = {}
    for text in given:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise InvalidInput(f"--{option} {text}: give NAME={'FACES' if option == 'region' else 'FILE'}")
        if name in pairs:
            raise InvalidInput(f"--{option} {name}: given twice")
        pairs[name] = value
    return pairs


def _parser() -> argparse.ArgumentParser:
    def formatter(prog: str) -> argparse.HelpFormatter:
        return argparse.RawDescriptionHelpFormatter(prog, max_help_position=28, width=WIDTH)

    parser = argparse.ArgumentParser(prog="python -m softkin mesh", formatter_class=formatter)
    commands = parser.add_subparsers(dest="command", required=True, metavar="generate")
    one = commands.add_parser(
        "generate", help="A mesh and a scene from surfaces", formatter_class=formatter, epilog=EPILOG,
        description="A volume mesh with named regions from the surface of a body and those of its chambers and parts.",
    )  # fmt: skip
    one.add_argument(
        "--body",
        metavar="F",
        required=True,
        help=".stl, .obj, .ply or .off; with --backend gmsh also .step, .brep, .iges and .geo",
    )
    one.add_argument(
        "--chamber",
        metavar="NAME=F",
        action="append",
        default=[],
        help="Surface of a chamber; repeatable; of a .geo: NAME of a physical group",
    )
    one.add_argument(
        "--part",
        metavar="NAME=F",
        action="append",
        default=[],
        help="Surface of a part of another material; repeatable",
    )
    one.add_argument(
        "--region",
        metavar="NAME=FACES",
        action="append",
        default=[],
        help="Faces of the boundary, see below; repeatable",
    )
    one.add_argument(
        "--edge-length",
        metavar="MM",
        type=float,
        required=True,
        help="Of the tetrahedra, where nothing asks for smaller ones [mm]",
    )
    one.add_argument(
        "--tolerance",
        metavar="MM",
        type=float,
        help=(
            "How far the mesh may be from the surfaces [mm]; default: a 20th of the edge length, at most a 1000th of"
            " the body's diagonal"
        ),
    )
    one.add_argument("--unit", choices=tuple(MM_PER_UNIT), default="mm", help="Unit of the surfaces (default: mm)")
    one.add_argument(
        "--backend",
        choices=("tetwild", "gmsh"),
        default="tetwild",
        help="tetwild bears bad surfaces; gmsh is the program of that name (default: tetwild)",
    )
    one.add_argument(
        "--chambers-as",
        choices=("region", "void"),
        default="region",
        help="region: meshed, a region of elements each; void: left empty, a region of faces each (default: region)",
    )
    one.add_argument(
        "--open-chambers", action="store_true", help="A chamber may reach the outside, where a plate closes it"
    )
    one.add_argument(
        "--coarsen", action="store_true", help="tetwild: as few tetrahedra as their shapes allow, of any length"
    )
    one.add_argument("-o", "--output", metavar="F.msh", required=True, help="The mesh, in mm")
    one.add_argument("--scene", metavar="F.yaml", help="A scene to start from, with comments on what to edit")
    one.add_argument(
        "--force-overwrite", action="store_true", help="Replace the scene, and a mesh that softkin did not write"
    )
    one.add_argument(
        "--fixed",
        metavar="NAME",
        default="",
        help="Region that the scene holds (default: base, or else the low end of the longest side)",
    )
    return parser
