"""The other mesher: the program gmsh, started as one. It is GPL: never imported, never needed."""

from __future__ import annotations

import math
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np

from .arrays import Array
from .child import ProgressFunction, run
from .errors import InvalidInput
from .msh_read import read_msh
from .repair import components, open_edges
from .surface import Surface, SurfaceLike, as_surface
from .surface_files import refuse_lfs_pointer
from .volume_mesh import VolumeMesh
from .winding import winding_numbers

INSTALL = "backend='gmsh' needs the program gmsh: apt-get install gmsh, or pip install gmsh, or https://gmsh.info"
CAD = (".step", ".stp", ".brep", ".iges", ".igs")
FEATURE_DEG = 15  # edges of a surface that are sharper than this stay edges


def find_gmsh() -> list[str] | None:
    """How to start gmsh: the program on PATH, or that of the pip package beside this Python; None: there is none."""
    beside = Path(sys.executable).parent / "gmsh"
    found = Path(shutil.which("gmsh") or beside)
    if not found.is_file():
        return None
    with found.open("rb") as file:
        script = file.read(2) == b"#!"
    if not script:
        return [str(found)]
    python = found.parent / "python"  # that of the pip package names just any python in its first line
    return [str(python) if python.exists() else sys.executable, str(found)]


def read_surface(given: SurfaceLike, name: str) -> Surface:
    """As `as_surface`, and the surface of a CAD model (.step, .brep, .iges), triangulated by gmsh."""
    if not isinstance(given, (str, Path)) or Path(given).suffix.lower() not in CAD:
        return as_surface(given, name)
    if not Path(given).is_file():
        raise InvalidInput(f"{given}: no such file")
    refuse_lfs_pointer(Path(given))
    with tempfile.TemporaryDirectory() as folder:
        script = (
            f'SetFactory("OpenCASCADE");\nMerge "{Path(given).resolve()}";\nMesh.MeshSizeFromCurvature ='
            " 36;\nMesh.CharacteristicLengthFromCurvature = 1;\n"
        )
        _run(Path(folder), script, 2, str(given), "stl")
        surface = as_surface(Path(folder) / "out.stl", name)
    return Surface(surface.vertices, surface.triangles, str(given))


def mesh_geo(path: str | Path, edge_length: float, progress: ProgressFunction | None = None) -> VolumeMesh:
    """Meshes a .geo, whose physical groups become the regions, or a CAD model, all of which becomes region body.
    edge_length: upper bound, in the unit of the file. progress: as of from_surfaces. Throws InvalidInput."""
    path = Path(path)
    if not path.is_file():
        raise InvalidInput(f"{path}: no such file")
    refuse_lfs_pointer(path)
    heading = 'SetFactory("OpenCASCADE");\n' if path.suffix.lower() in CAD else ""
    bound = _size(0, edge_length) + "Mesh.MshFileVersion = 2.2;\nMesh.Binary = 0;\nMesh.ElementOrder = 1;\n"
    with tempfile.TemporaryDirectory() as folder:
        mesh = _run(Path(folder), f'{heading}Merge "{path.resolve()}";\n{bound}', 3, str(path), "msh", progress)
    if mesh is None or len(mesh.tetrahedra) == 0:
        raise InvalidInput(f"{path}: gmsh made no tetrahedra of it")
    if not mesh.volume_regions:
        return VolumeMesh(mesh.vertices, mesh.tetrahedra, {"body": np.arange(len(mesh.tetrahedra))}, mesh.face_regions)
    return mesh


def background(
    surfaces: list[Surface], edge_length: float, what: str, progress: ProgressFunction | None
) -> tuple[Array, Array]:
    """Tetrahedra inside closed surfaces that neither touch nor cross, with faces along each. The surfaces are divided
    into faces at edges of more than 15 degrees and triangulated anew. edge_length: mm. what: is done, for progress.
    Returns (n, 3), (m, 4). Throws InvalidInput, ImportError."""
    shells = [shell for surface in surfaces for shell in _shells(surface)]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        remeshed = [_remeshed(folder, shell, edge_length, progress) for shell in shells]
        _write_shells(folder / "shells.msh", remeshed)
        script = 'Merge "shells.msh";\n' + "".join(f"Surface Loop({k}) = {{{k}}};\n" for k in range(1, len(shells) + 1))
        script += _volumes(remeshed) + _size(edge_length, edge_length) + "Mesh.Optimize = 1;\n"
        names = ", ".join(surface.name for surface in surfaces)
        mesh = _run(folder, script, 3, names, "msh", progress, what)
    if mesh is None or len(mesh.tetrahedra) == 0:
        raise InvalidInput(
            f"gmsh made no tetrahedra of {', '.join(surface.name for surface in surfaces)}; backend='tetwild' bears bad"
            " surfaces"
        )
    return mesh.vertices, mesh.tetrahedra


def _shells(surface: Surface) -> list[Surface]:
    if len(open_edges(surface)):
        raise InvalidInput(
            f"{surface.name} is not closed ({len(open_edges(surface))} open edges), as gmsh needs it; backend='tetwild'"
            " bears that"
        )
    shell = components(surface.triangles, len(surface.vertices))
    return [surface.with_triangles(surface.triangles[shell == number]).merged() for number in range(shell.max() + 1)]


def _remeshed(folder: Path, shell: Surface, edge_length: float, progress: ProgressFunction | None) -> Surface:
    _write_shells(folder / "one.msh", [shell])
    script = (
        f'Merge "one.msh";\nClassifySurfaces{{{math.radians(FEATURE_DEG)!r}, 1, 1, Pi}};\nCreateGeometry;\n'
        + _size(edge_length, edge_length)
    )
    _run(folder, script, 2, shell.name, "stl", progress)
    surface = as_surface(folder / "out.stl", shell.name)
    if len(open_edges(surface)):
        raise InvalidInput(f"{shell.name}: gmsh could not triangulate it anew; backend='tetwild' bears bad surfaces")
    return surface


def _size(least: float, greatest: float) -> str:
    """Bounds of the edges' lengths; by the names that every version knows."""
    return f"Mesh.CharacteristicLengthMin = {float(least)!r};\nMesh.CharacteristicLengthMax = {float(greatest)!r};\n"


def _volumes(shells: list[Surface]) -> str:
    """A volume in every shell, without the shells directly inside it."""
    holds = np.zeros((len(shells), len(shells)), dtype=bool)
    for outer, shell in enumerate(shells):
        points = np.array([other.vertices[0] for other in shells])
        holds[outer] = np.abs(winding_numbers(shell, points)) > 0.5
        holds[outer, outer] = False
    lines = []
    for outer in range(len(shells)):
        between = holds[outer] @ holds  # shells inside another one that is inside this
        direct = np.flatnonzero(holds[outer] & ~between) + 1
        lines.append(f"Volume({outer + 1}) = {{{', '.join(map(str, [outer + 1, *direct.tolist()]))}}};\n")
    return "".join(lines)


def _write_shells(path: Path, shells: list[Surface]) -> None:
    """.msh 2.2 text with each shell as one entity, so that gmsh keeps them apart."""
    nodes: list[str] = []
    elements: list[str] = []
    offset = 1
    for tag, shell in enumerate(shells, 1):
        nodes += [f"{offset + k} {x!r} {y!r} {z!r}" for k, (x, y, z) in enumerate(shell.vertices.tolist())]
        elements += [
            f"{len(elements) + k} 2 2 0 {tag} {a} {b} {c}"
            for k, (a, b, c) in enumerate((shell.triangles + offset).tolist(), 1)
        ]
        offset += len(shell.vertices)
    lines = [
        "$MeshFormat",
        "2.2 0 8",
        "$EndMeshFormat",
        "$Nodes",
        str(len(nodes)),
        *nodes,
        "$EndNodes",
        "$Elements",
        str(len(elements)),
        *elements,
    ]
    path.write_text("\n".join([*lines, "$EndElements", ""]))


def _run(
    folder: Path,
    script: str,
    dimension: int,
    what: str,
    form: str,
    progress: ProgressFunction | None = None,
    doing: str = "",
) -> VolumeMesh | None:
    program = find_gmsh()
    if program is None:
        raise ImportError(INSTALL)
    (folder / "script.geo").write_text(script)
    out = folder / f"out.{form}"
    out.unlink(missing_ok=True)
    arguments = [
        "script.geo",
        f"-{dimension}",
        "-format",
        "stl" if form == "stl" else "msh2",
        "-o",
        out.name,
        "-v",
        "2",
    ]
    done = run([*program, *arguments], folder, doing or f"gmsh at {what}", progress)
    said = [
        line.split(":", 1)[1].strip()
        for line in (done.stdout + done.stderr).splitlines()
        if line.startswith("Error") and ":" in line
    ]
    if done.returncode != 0 or said or not out.is_file():
        reason = said[0] if said else f"it ended with code {done.returncode} and no mesh"
        raise InvalidInput(f"{what}: gmsh: {reason}; backend='tetwild' bears bad surfaces")
    return read_msh(out) if form == "msh" else None
