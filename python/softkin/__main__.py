"""`python -m softkin ...`: the command, and `mesh generate`, which the package alone has."""

from __future__ import annotations

import os
import shutil
import sys
import sysconfig


def main() -> int:
    arguments = sys.argv[1:]
    if arguments[:2] == ["mesh", "generate"]:
        from .mesh.command import main as mesh_main

        return mesh_main(arguments[1:])
    program = shutil.which("softkin", path=sysconfig.get_path("scripts"))
    if program is None:
        print("softkin: the command is not installed beside this package", file=sys.stderr)
        return 2
    os.execv(program, ["softkin", *arguments])


if __name__ == "__main__":
    sys.exit(main())
