"""Cases of inputs that the program refuses with a message and exit code 2, without writing any file."""

from . import samples as s
from .case import Case, change, keep_lines, keep_steps, write

PATH = "t_s,air\n0,1\n0.5,1.1\n1,1.2\n"


def cases():
    return [*usage(), *scenes(), *fk(), *fk_paths(), *fk_resume(), *ik(), *follow(), *workspace(), *walk(), *files()]


def several(name, commands, files):
    """Returns a case of several commands that the program refuses, so that the files do not change."""
    return Case(f"refuses {name}", commands, files, ends=2)


def usage():
    yield several("no command", [""], {})
    for command in ("fk", "ik", "follow", "workspace", "walk", "compare", "calibrate", "calibrate material",
                    "calibrate pressure", "calibrate relaxation",
                    "calibrate dea", "drive", "mesh", "mesh info", "mesh check", "mesh convert", "melt",
                    "fk --frobnicate",
                    "mesh melt", "calibrate oil", "--frobnicate"):
        yield several(f"usage {command}", [command], {})


def scenes():
    """Yields cases in which a text replaces a part of a valid scene."""
    good = s.physical_scene()
    material, mesh_line = "{youngs_modulus: 1, poisson_ratio: 0.3, linear_range: 0.05}", "mesh: {file: block.msh}"
    wrong = {
        "version": ("softkin: 1", "softkin: 2"), "no version": ("softkin: 1\n", ""),
             "unknown key": ("markers:", "markerz:"),
        "no mesh": (mesh_line, ""), "other mesh": ("block.msh", "none.msh"), "mesh form": ("block.msh", "block.obj"),
        "mesh order": ("block.msh", "block.msh, order: 3"), "yaml": ("fixed: [", "fixed: [["),
             "tab": ("fixed:", "\tfixed:"),
        "anchor": ("markers: [", "<<: {void: []}\nmarkers: ["), "tag": ("softkin: 1", "softkin: !!int 1"),
        "control character": ("softkin: 1", "softkin: 1\n# \x04"), "twice": (mesh_line, mesh_line + "\n" + mesh_line),
        "unit": (mesh_line, mesh_line + "\nunits: {length: km}"), "gravity": (mesh_line, mesh_line + "\ngravity: 9.81"),
        "formulation": (mesh_line, mesh_line + "\nformulation: fem"),
        "region twice": (mesh_line, mesh_line + "\nregions: [{name: body, vertices: [1]}]"),
        "empty box": (mesh_line, mesh_line + "\nregions: [{name: a, box: [[90, 90, 90], [91, 91, 91]]}]\nrigid: [a]"),
        "box": (mesh_line, mesh_line + "\nregions: [{name: a, box: [[0, 0, 2], [1, 1, 1]]}]"),
        "sphere": (mesh_line, mesh_line + "\nregions: [{name: a, sphere: {center: [0, 0, 0], radius: 0}}]"),
        "vertices": (mesh_line, mesh_line + "\nregions: [{name: a, vertices: [9999]}]"),
        "sidecar": (mesh_line, mesh_line + "\nregions: [{name: a, sidecar: {file: none.txt}}]"),
        "law": ("youngs_modulus: 1,", "law: neo, youngs_modulus: 1,"),
             "modulus": ("youngs_modulus: 1", "youngs_modulus: 0"),
        "modulus with unit": ("youngs_modulus: 1", "youngs_modulus: 12 MPa"), "no modulus": ("youngs_modulus: 1, ", ""),
        "incompressible": ("poisson_ratio: 0.3", "poisson_ratio: 0.5, law: corotational"),
             "poisson": ("poisson_ratio: 0.3", "poisson_ratio: -1"),
        "constant of another law": ("poisson_ratio: 0.3", "poisson_ratio: 0.3, c10: 1"),
        "two of one": (material, "{law: yeoh, c10: 1, poisson_ratio: 0.3, bulk_modulus: 1}"),
        "no material": (material, ""), "empty material": (material, "{region: body}"),
             "density": ("linear_range: 0.05", "density: -1"),
        "material region": ("{youngs", "{region: boyd, youngs"), "not held": ("fixed: [{region: base}]", ""),
        "held at a point": ("fixed: [{region: base}]", "fixed: [{vertices: [0]}]"),
        "fixed region": ("region: base", "region: bass"), "axes": ("{region: base}", "{region: base, axes: xx}"),
        "rigid": (mesh_line, mesh_line + "\nrigid: [[a]]"), "void": (mesh_line, mesh_line + "\nvoid: body"),
        "actuator twice": ("name: tendon", "name: air"), "actuator name": ("name: air", 'name: "a,b"'),
        "kind": ("kind: cable", "kind: rope"), "control": ("control: length", "control: pressure"),
        "range": ("range: [0.5, 3]", "range: [3, 0.5]"), "range of one": ("range: [0.5, 3]", "range: [3]"),
        "range without rest": ("range: [0.5, 3]", "range: [2, 3]"), "no range": (", range: [0.5, 3]", ""),
        "actuator region": ("region: chamber", "region: chamfer"), "cable outside": ("[20, 6, 12]", "[90, 6, 12]"),
        "cable of a point": ("[[0, 6, 12], [20, 6, 12]]", "[[0, 6, 12]]"),
             "prestretch": ("control: volume", "prestretch: 1"),
        "surface": ("region: chamber", "surface: none.stl"),
             "force region": ("region: tip, force", "region: top, force"),
        "force": ("force: [0, 0, 0]", "force: 3"), "force name": ("name: payload", "name: a=b"),
        "marker outside": ("[20, 12, 12]", "[60, 12, 12]"), "marker twice": ("name: corner", "name: tip"),
        "marker region": ("region: tip}", "region: top}"),
        "feet": (mesh_line, mesh_line + "\nfeet: [{marker: tip, forward: 1, backward: 1}]"),
        "foot marker": (mesh_line, mesh_line +
                        "\nfeet: [{marker: tip, forward: 1, backward: 1}, {marker: toe, forward: 1, backward: 1}]"),
        "friction": (mesh_line, mesh_line +
                     "\nfeet: [{marker: tip, forward: -1, backward: 1}, {marker: corner, forward: 1, backward: 1}]"),
    }
    for name, (part, by) in wrong.items():
        if part not in good:
            raise ValueError(f"the scene of the refusals does not contain {part!r}")
        yield several(f"scene, {name}", ["mesh check block.yaml", "fk block.yaml --set air=1.1 -o new/a.vtu"],
                      {"block.msh": s.block(), "block.yaml": good.replace(part, by, 1)})
    yield several("scene that is missing", ["fk none.yaml"], {})
    yield several("scene that is a folder", ["fk folder"], {"folder/a": ""})
    yield several("empty scene", ["fk a.yaml"], {"a.yaml": ""})
    yield several("scene not UTF-8", ["fk a.yaml"], {"a.yaml": b"softkin: 1\n# \xff\n"})


def fk():
    files = s.target()
    sets = ["ait=1.2", "tendon=1.2", "air=2.5", "air=0.9999999", "air", "1.5", "", "=1.5", "air=", "air=1.2mm",
            "air=nan", "air=inf",
            "air=1,2", "air=0x1", "air=1.2kPa"]
    for text in sets:
        yield several(f"fk --set {text}", [["fk", "block.yaml", "--set", text, "-o", "new/a.vtu"]], files)
    options = ["--set air=1.1 --set air=1.1", "--view 1 2 3", "--image i.png --view 0 0 0",
               "--image i.png --view nan 0 1",
               "--image i.png --view 1 2", "--solver-tolerance nan", "--solver-tolerance -1", "--solver-tolerance inf", "--max-iterations 0",
               "--max-iterations 1e5", "--anderson 21 --solver local-global", "--anderson 6", "--solver gauss",
               "--formulation elastic",
               "--formulation physical", "--resume", "other.yaml", "--threads -1", "--threads many",
               "--force payload=0,0,1",
               "--image a.jpg", "-o a.stl", "-o new/", "--plot p.svg", "--report .", "--report /dev/null",
               "--report block.yaml",
               "--report ./block.msh", "-o block.yaml/a.vtu --report new/b.json", "--report a.vtu -o ./a.vtu",
               "--report", "--json extra"]
    for option in options:
        yield several(f"fk {option}", [f"fk block.yaml {option}"], files)
    loads, ratios = s.loaded(), s.physical()
    for text in ("air=30N", "air=kPa", "tendon=3kPa", "air=3001", "air=-100.1kPa", "tendon=-1N", "air=30bar"):
        yield several(f"fk load {text}", [f"fk block.yaml --set {text}"], loads)
    for text in ("paylaod=0,0,1", "payload", "payload=1,2", "payload=1,2,3,4", "payload=a,b,c", "payload=0,0,1N"):
        yield several(f"fk --force {text}", [f"fk block.yaml --force {text}"], ratios)
    yield several("fk forces twice", ["fk block.yaml --force payload=1,0,0 --force payload=1,0,0"], ratios)
    yield several("fk physical local-global", ["fk block.yaml --solver local-global"], ratios)
    yield several("fk loads of target shapes", ["fk block.yaml --formulation target-shape"], loads)


def fk_paths():
    tables = {"empty": "", "no row": "air\n", "other actuator": "air,tendon\n1,1\n", "t": "t,air\n1,1\n",
              "range": "# r\nair\n1.5\n\n2.5\n",
              "unit in a cell": "air\n1\n1.2mm\n", "no actuator": "t_s\n1\n", "time back": "t_s,air\n0,1\n2,1\n1,1\n",
              "time stands": "t_s,air\n0,1\n0,1\n", "short row": "t_s,air\n0,1\n1\n", "quotes": '"air"\n1\n',
              "column twice": "air,air\n1,1\n",
              "empty cell": "t_s,air\n0,\n", "not a number": "air\nnan\n", "unit of a ratio": "air_kPa\n1\n"}
    for name, text in tables.items():
        yield several(f"fk path, {name}", ["fk block.yaml --path p.csv -o new/a.pvd"], s.target() | {"p.csv": text})
    for name, text in {"unit": "air_N\n1\n", "twice": "air,air_kPa\n1,1\n", "range": "air_kPa\n10\n3001\n",
                       "cell": "air_kPa\n10kPa\n"}.items():
        yield several(f"fk path of loads, {name}", ["fk block.yaml --path p.csv"], s.loaded() | {"p.csv": text})
    files = s.target() | {"p.csv": PATH}
    for option in ("--set air=1.5", "--plot p.png", "--plot a.svg --report a.svg", "--plot block.yaml/a.svg",
                   "--report p.csv"):
        yield several(f"fk path and {option}", [f"fk block.yaml --path p.csv {option}"], files)
    yield several("fk path that is missing", ["fk block.yaml --path none.csv"], files)
    yield several("fk shapes over a path", ["fk block.yaml --path a_0001.vtu -o a.pvd"], files | {"a_0001.vtu": PATH})


def fk_resume():
    run = "fk block.yaml --path p.csv --report o/r.json -o o/s.pvd"
    files = s.target() | {"p.csv": PATH}

    def case(name, edit, more=""):
        return Case(f"refuses fk --resume, {name}", [run, edit, f"{run} {more} --resume"], files, ends=2)

    yield case("other row", write("p.csv", PATH.replace("0,1\n", "0,1.001\n")))
    yield case("shorter path", write("p.csv", "t_s,air\n0,1\n0.5,1.1\n"))
    yield case("other time", write("p.csv", PATH.replace("0.5,", "0.6,")))
    yield case("other solver options", write("note", ""), "--max-iterations 7")
    yield case("other robot", write("block.yaml", s.target_scene(materials="{region: body, shape_ratio: 0.9}")))
    yield case("other mesh", change("block.msh", r"\n2 4 0 0\n", "\n2 4.000001 0 0\n"))
    for name, text in {"empty": "", "torn": "{", "list": "[]", "null": "null", "no keys": "{}",
                       "other": '{"softkin": 1}'}.items():
        yield case(f"report is {name}", write("o/r.json", text))
    yield case("report ends early", keep_lines("o/r.json", 13))
    yield case("newer program", change("o/r.json", r'"softkin": "[^"]*"', '"softkin": "99.0"'))
    for key in ("robot_fingerprint", "solver", "steps"):
        yield case(f"report without {key}", change("o/r.json", f'"{key}"', f'"no_{key}"'))
    for key in ("actuation", "status", "shape_fingerprint", "markers", "actuators", "strain", "history"):
        yield Case(f"refuses fk --resume, steps without {key}",
                   [run, change("o/r.json", f'"{key}"', f'"no_{key}"'), f"{run} --plot o/p.svg --resume"], files,
                   ends=None)
    for options in ("--path p.csv -o o/s.pvd", "--path p.csv --report o/r.json", "-o o/s.pvd --report o/r.json",
                    "--path p.csv --report o/r.json -o o/a.vtu"):
        yield several(f"fk --resume with {options}", [f"fk block.yaml {options} --resume"], files)


def ik():
    files = s.physical()
    for text in ("tpi=1,2,3", "tip=nan,2,3", "tip=1,inf,3", "tip=1,2", "tip=1,2,3,4", "tip=1,2,3mm", "tip=,,", "tip",
                 "=1,2,3"):
        yield several(f"ik --target {text}", [f"ik block.yaml --target {text} -o new/a.vtu"], files)
    for option in ("", "--plane tip=1,2,3", "--plane tip=1,2,3/0,0,0", "--plane tip=1,,3/0,0,1",
                   "--direction tip=1,2,3",
                   "--direction tip:cornre=1,2,3", "--direction tip:tip=1,2,3", "--direction tip:corner=0,0,0"):
        yield several(f"ik {option}", [f"ik block.yaml {option}"], files)
    for option in ("--weight corner=2", "--weight tip=0", "--weight tip=-1", "--start air=4", "--prefer air=0.1",
                   "--fix ari=1",
                   "--fix air=1 --start air=1", "--fix air=1 --prefer air=1", "--start air=1 --workspace w.csv",
                   "--workspace none.csv",
                   "--lever 3", "--descents 3", "--tolerance 0", "--method bfgs", "--max-equilibria 0",
                   "--other-starts -1", "-o shape.pvd",
                   "--plot p.png", "--image p.svg", "--view 1 0 0", "--report block.yaml", "--solver local-global",
                   "--anderson 3"):
        yield several(f"ik also {option}", [f"ik block.yaml --target tip=20,6,6 {option}"], files)
    yield several("ik without markers", ["ik block.yaml --target tip=20,6,6"], files | {
        "block.yaml": s.physical_scene().replace(s.MARKERS, "")})
    yield Case("ik with everything fixed", ["ik block.yaml --target tip=20,6,6 --fix air=1 --fix tendon=1"], files)


def follow():
    files = s.physical()
    for name, text in {"not a number": "tip_x_mm,tip_z_mm\n20,6\n20,nan\n", "metres": "tip_x_m,tip_z_m\n0.02,0.006\n",
                       "marker": "tpi_x_mm\n20\n",
                       "no marker": "x_mm\n20\n", "empty": "", "no row": "tip_x_mm\n",
                       "time": "t_s,tip_x_mm\n1,20\n1,20\n"}.items():
        yield several(f"follow path, {name}", ["follow block.yaml path.csv -o out"], files | {"path.csv": text})
    good = files | {"path.csv": "x_mm\n20\n", "file": "a file"}
    for option in ("--marker edge", "--marker tip --max-step 0", "--marker tip --max-step 1e-9 --tolerance -1",
                   "--marker tip --plot a.png",
                   "--marker tip --solver local-global", "--marker tip --descents 9",
                   "--marker tip --workspace none.csv",
                   "--marker tip --method bfgs"):
        yield several(f"follow {option}", [f"follow block.yaml path.csv -o out {option}"], good)
    yield several("follow into a file", ["follow block.yaml path.csv --marker tip -o file"], good)
    yield several("follow without a folder", ["follow block.yaml path.csv --marker tip",
                                              "follow block.yaml path.csv --marker tip -o ''"], good)
    run = "follow block.yaml path.csv --marker tip -o out"
    done = files | {"path.csv": "x_mm\n20.02\n20.04\n20.06\n"}
    for name, edit, more in (("other options", write("note", ""), "--tolerance 0.01"),
                             ("other waypoint", write("path.csv", "x_mm\n20.01\n20.04\n20.06\n"), ""),
                             ("shorter", write("path.csv", "x_mm\n20.02\n20.04\n"), ""),
                             ("torn", keep_lines("out/report.json", 9), ""),
                             ("other robot", change("block.yaml", "youngs_modulus: 1,", "youngs_modulus: 2,"), ""),
                             ("not of follow", change("out/report.json", '"waypoint"', '"no_waypoint"'), "")):
        yield Case(f"refuses follow --resume, {name}", [run, edit, f"{run} {more} --resume"], done, ends=2)
    yield Case("refuses follow, workspace of another robot", ["workspace block.yaml --samples 4 -o w.csv",
                                                              change("block.yaml", "youngs_modulus: 1,",
                                                                     "youngs_modulus: 2,"),
                                                              f"{run} --workspace w.csv"],
               s.narrow() | {"path.csv": "x_mm\n20.02\n"}, ends=2)


def workspace():
    files = s.narrow()
    run = "workspace block.yaml -o w.csv"
    for option in ("--samples 0", "--samples many", "", "--samples 4 --sampling halton", "--samples 4 --seed 3",
                   "--samples 4 --marker tpi",
                   "--samples 4 --cloud c.csv", "--samples 4 --hull h.obj", "--samples 4 --plot p.png",
                   "--samples 4 --cloud a.vtu --hull a.vtu",
                   "--samples 4 --solver local-global", "--samples 4 --threads -2", "--samples 4 --force payload=1"):
        yield several(f"workspace {option}", [f"{run} {option}"], files)
    yield several("workspace without a table", ["workspace block.yaml --samples 4",
                                                "workspace block.yaml --samples 4 -o w.txt"], files)
    yield several("workspace over its scene", ["workspace block.yaml --samples 4 -o block.yaml",
                                               "workspace block.yaml --samples 4 -o block.msh/w.csv"], files)
    yield several("workspace without markers", [f"{run} --samples 4"],
                  files | {"block.yaml": s.narrow_scene().replace(s.MARKERS, "")})
    again = f"{run} --samples 9"
    cut = keep_lines("w.csv", 12)
    for name, edit, command in (("unfinished", write("note", ""), again),
                                ("samples", write("note", ""), f"{run} --samples 16 --resume"),
                                ("sampling", write("note", ""), f"{again} --sampling random --resume"),
                                ("robot", change("block.yaml", "youngs_modulus: 1,", "youngs_modulus: 2,"),
                                 f"{again} --resume"),
                                ("columns", change("block.yaml", "name: tendon", "name: cable"), f"{again} --resume"),
                                ("ranges", change("block.yaml", r"\[0.85, 1\]", "[0.8, 1]"), f"{again} --resume"),
                                ("no workspace", write("w.csv", "a,b\n1,2\n"), f"{again} --resume"),
                                ("bad row", change("w.csv", "converged", "conversed"), f"{again} --resume")):
        yield Case(f"refuses workspace --resume, {name}", [again, cut, edit, command], files, ends=2)


def walk():
    good = "t_s,tendon_N\n0,0\n1,2\n2,0\n"
    feet = "feet: [{marker: heel, forward: 1, backward: 1}, {marker: toe, forward: 1, backward: 1}]\n"
    run = "walk block.yaml gait.csv -o out"
    yield several("walk without feet", [run], s.walker(good, feet=""))
    yield several("walk on one foot", [run], s.walker(good, feet="feet: [{marker: heel, forward: 1, backward: 1}]\n"))
    yield several("walk held", [run], s.walker(good, feet=feet, front="xyz"))
    for name, text in {"not closed": "t_s,tendon_N\n0,0\n1,2\n", "one row": "t_s,tendon_N\n0,0\n",
                       "range": "t_s,tendon_N\n0,0\n1,9\n2,0\n",
                       "actuator": "t_s,air\n0,0\n1,1\n2,0\n", "number": "t_s,tendon_N\n0,0\n1,two\n2,0\n"}.items():
        yield several(f"walk gait, {name}", [run], s.walker(text, feet=feet))
    for option in ("--cycles 0", "--solver local-global", "--cycles many"):
        yield several(f"walk {option}", [f"{run} {option}"], s.walker(good, feet=feet))
    done = f"{run} --cycles 1"
    for name, edit in (("other gait", change("gait.csv", "1,2", "1,2.5")),
                       ("other feet", change("block.yaml", "forward: 0.02", "forward: 0.03")),
                       ("torn", keep_lines("out/report.json", 9)),
                       ("not of walk", change("out/report.json", '"walk"', '"no_walk"'))):
        yield Case(f"refuses walk --resume, {name}", [done, edit, f"{done} --resume"], s.walker(), ends=2)


def files():
    """Yields cases of outputs that cannot be written."""
    scene = s.physical() | {"file": "a file", "path.csv": "x_mm\n20.02\n"}
    for command in ("fk block.yaml -o file/a.vtu", "fk block.yaml --report file/a.json",
                    "fk block.yaml --image file/a.png",
                    "ik block.yaml --target tip=20,, --report file/a.json",
                    "workspace block.yaml --samples 4 -o file/w.csv",
                    "follow block.yaml path.csv --marker tip -o file/out", "mesh convert block.msh file/a.vtu",
                    "calibrate material --tensile examples/two_material_bar/tensile.csv -o file/m.yaml",
                    "calibrate dea --law neo-hookean --shear-modulus 0.07 --permittivity 4.4 --thickness 0.5 -o file/s.yaml"):
        yield several(f"unwritable, {command.split(' ', 2)[0]} {command.split(' ', 1)[1][-28:]}", [command], scene)
