"""From surfaces (STL, OBJ, PLY) to volume meshes with named regions. See docs/python_mesh.md."""

import sys as _sys

from .._checks import guard as _guard
from .errors import InvalidInput, MeshWarning
from .files import check, convert, info
from .generate import from_surfaces
from .gmsh_program import mesh_geo
from .msh_read import read_msh
from .quality import Quality
from .scene import scene_text
from .sheets import stacked
from .surface import Surface
from .surface_files import read_surface, write_stl
from .volume_mesh import Volume, VolumeMesh

__all__ = [
    "InvalidInput",
    "MeshWarning",
    "Quality",
    "Surface",
    "Volume",
    "VolumeMesh",
    "check",
    "convert",
    "from_surfaces",
    "info",
    "mesh_geo",
    "read_msh",
    "read_surface",
    "scene_text",
    "stacked",
    "write_stl",
]

_guard(__all__, _sys.modules[__name__])
