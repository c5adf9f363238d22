#!/usr/bin/env python3
"""Makes the pictures of README.md: the animation, and one for each row of its gallery by the command of that row.

    scripts/gallery.py [NAME ...]     NAME: moving, or the name of a picture of the gallery; default: all

The script needs build/softkin, Pillow (pip install pillow), and for the animation npm, Node.js and Chromium, as the
tests of the page do. Exit codes: 0 all pictures were made, 1 a command failed, 2 an unknown name.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image, ImageChops

ROOT = Path(__file__).resolve().parent.parent
IMAGES = ROOT / "docs" / "images"
ROW = re.compile(r"^\| !\[\]\((docs/images/gallery/(\w+)\.png)\) \|.*\| `([^`]+)` \|$", re.M)
FROM_THE_SIDE = "0.4 -1 0.3"
VIEWS = {"three_chamber_actuator": "1 0.4 0.3", "dea_crawler": "0.3 -1 0.3", "two_material_bar": "0.3 -1 0.5"}
PICTURE = (20, 62, 1120, 690)  # part of a picture of 1280 x 800 pixels without title, bars and axes
THUMBNAIL = (240, 150)
FRAMES = 36
MOVING = (800, 450)
COLOURS = 128


def run(command: list[str], folder: Path = ROOT, **environment: str) -> None:
    """Runs a command; exits with its output if it fails."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=os.environ | environment)
    if done.returncode != 0:
        sys.exit(f"gallery: {shlex.join(command)} failed:\n{done.stdout}{done.stderr}")


def thumbnail(picture: Path, to: Path) -> None:
    """Crops a picture to the robot, reduces it and writes it to a file."""
    image = Image.open(picture).convert("RGB").crop(PICTURE)
    box = ImageChops.difference(image, Image.new("RGB", image.size, "white")).getbbox()
    image = image.crop(box)
    image.thumbnail(THUMBNAIL, Image.Resampling.LANCZOS)
    framed = Image.new("RGB", THUMBNAIL, "white")
    framed.paste(image, tuple((full - part) // 2 for full, part in zip(THUMBNAIL, image.size)))
    to.parent.mkdir(exist_ok=True)
    framed.quantize(COLOURS).save(to, optimize=True)


def still(name: str, command: str) -> None:
    """Makes a picture of the gallery."""
    with tempfile.TemporaryDirectory() as folder:
        picture = Path(folder) / "picture.png"
        view = VIEWS.get(name, FROM_THE_SIDE).split()
        run([*shlex.split(command), "--view", *view, "--image", str(picture)])
        thumbnail(picture, IMAGES / "gallery" / f"{name}.png")


def moving() -> None:
    """Makes the animation: the page of the finger while its slider moves from end to end and back."""
    scene = "examples/pneumatic_finger/pneumatic_finger.yaml"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run(["build/softkin", "map", scene, "-o", f"{folder}/finger.skmap", "--check", "10", "--html", f"{folder}/finger.html"])
        for file in ("package.json", "package-lock.json", "browser.mjs"):
            shutil.copy(ROOT / "tests" / "browser" / file, folder)
        shutil.copy(ROOT / "scripts" / "record_page.mjs", folder)
        run(["npm", "ci", "--no-audit", "--no-fund", "--loglevel=error"], folder)
        run(["node", "record_page.mjs", f"{folder}/finger.html", str(folder), "0", "1", "2.2", str(FRAMES)], folder)
        frames = [Image.open(file).convert("RGB").resize(MOVING, Image.Resampling.LANCZOS)
                  for file in sorted(folder.glob("frame_*.png"))]
        palette = frames[len(frames) // 2].quantize(COLOURS)
        reduced = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
        loop = reduced + reduced[-2:0:-1]
        loop[0].save(IMAGES / "moving.gif", save_all=True, append_images=loop[1:], duration=60, loop=0, optimize=True)


def main() -> None:
    rows = {name: command for _, name, command in ROW.findall((ROOT / "README.md").read_text(encoding="utf-8"))}
    names = sys.argv[1:] or ["moving", *rows]
    unknown = [name for name in names if name != "moving" and name not in rows]
    if unknown:
        print(f"gallery: unknown picture {unknown[0]}; the pictures are moving, {', '.join(rows)}", file=sys.stderr)
        sys.exit(2)
    for name in names:
        print(name, flush=True)
        moving() if name == "moving" else still(name, rows[name])


if __name__ == "__main__":
    main()
