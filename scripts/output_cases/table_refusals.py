"""Cases of inputs that compare, calibrate, curves, drive and mesh refuse."""

from . import samples as s
from .case import Case, keep_bytes
from .refusals import several


def cases():
    return [*compare(), *material(), *pressure(), *dea(), *relaxation(), *curves(), *drive(), *mesh()]


def compare():
    files = {"a.json": s.turning([0, 60], 1), "longer.json": s.turning([0, 60, 90], 1), "text.json": "steps",
             "other.json": s.turning([0, 60], 1).replace('"air": 2}', '"air": 2.5}'), "empty.json": s.turning([], 1),
             "unknown.json": s.turning([0, 60], 1).replace('"end": [', '"end": [null, '),
             "good.csv": "t_s,x_mm,y_mm\n0,0,0\n1,1,0\n",
             "solid.csv": "alpha,tip_x_mm,tip_y_mm,base_x_mm,base_y_mm\n1,0,5,9,9\n2,10,5,9,9\n"}
    for option in ("a.json", "a.json absent.json", "a.json longer.json", "a.json other.json", "a.json empty.json",
                   "a.json unknown.json",
                   "a.json text.json", "a.json a.json --marker emd", "a.json a.json --turn end end",
                   "a.json a.json --poses 90",
                   "a.json a.json --turn begin end --poses -90", "a.json a.json --plot a.json",
                   "a.json a.json --plot p.png",
                   "a.json good.csv --turn a b", "good.csv good.csv -o out.txt", "good.csv good.csv -o good.csv",
                   "solid.csv good.csv",
                   "solid.csv@tpi good.csv", "solid.csv@tip good.csv --by beta", "solid.csv@tip good.csv --plane xx",
                   "good.csv solid.csv@tip --start 1", "good.csv good.csv --start 1 --by arc",
                   "good.csv good.csv --start nan",
                   "a.json a.json --start 1", "good.csv --sum a.json a.json"):
        yield several(f"compare {option}", [f"compare {option}"], files)
    robot = {"robot.json": s.linear([(1, 1), (1.2, 1), (1.5, 1.5)]),
             "first.json": s.linear([(1, 1), (1.3, 1), (1.6, 1)]),
             "narrow.json": s.linear([(1, 1), (1.3, 1)]), "second.json": s.linear([(1, 1), (1, 1.25), (1, 1.6)])}
    for option in ("first.json", "first.json first.json", "robot.json", "narrow.json second.json", "absent.json"):
        yield several(f"compare --sum {option}", [f"compare robot.json --sum {option}"], robot)
    for name, text in {"cm": "t_s,x_cm,y_cm\n0,0,0\n", "no unit": "t_s,x,y\n0,0,0\n", "ms": "t_ms,x_mm,y_mm\n0,0,0\n",
                       "time": "t_s,x_mm,y_mm\n0,0,0\n0,1,1\n", "number": "t_s,x_mm,y_mm\n0,0,0\n1,one,1\n",
                       "one axis": "t_s,x_mm\n0,0\n",
                       "later": "t_s,x_mm,y_mm\n5,0,0\n6,1,1\n"}.items():
        yield several(f"compare track, {name}", ["compare good.csv bad.csv"], files | {"bad.csv": text})


def material():
    bar = "examples/two_material_bar"
    specimens, tensile = f"{bar}/specimens.csv", f"--tensile {bar}/tensile.csv"
    for option in ("", f"{specimens} {tensile}", f"{tensile} --twist {bar}/twist.csv", f"{specimens} --up-to 0.3",
                   f"{specimens} --poisson-ratio 0.5", f"{specimens} --width nan", f"{specimens} --stiffer 1.5",
                   f"{specimens} --grip glued",
                   f"{specimens} --law yeo", f"{tensile} --law yeo", f"{specimens} --plot fit.png",
                   f"{specimens} --regions A A",
                   f"{specimens} --regions 'A: 1' B", f"{specimens} --modulus-b 12",
                   f"{specimens} --formulation physical --try 5",
                   f"{bar}/table_2_tpu.csv --formulation physical -o m.yaml", f"{specimens} --residuals {specimens}",
                   "none.csv",
                   f"{specimens} --cells 0", f"{specimens} -o m.txt"):
        yield several(f"material {option.replace(bar + '/', '')}", [f"calibrate material {option}"], {})
    for name, text in {"cm": "l_mm,l1_mm,dl_cm,dl1_mm\n100,50,0.1,0.2\n",
                       "less": "l_mm,l1_mm,dl_mm,dl1_mm\n100,50,1,0.2\n100,50,1,3\n",
                       "empty": ""}.items():
        yield several(f"material table, {name}", ["calibrate material s.csv -o m.yaml"], {"s.csv": text})
    yield several("tensile table that is flat", ["calibrate material --tensile s.csv"],
                  {"s.csv": "strain,stress_mpa\n0,2\n.1,2\n.2,2\n.3,2\n.4,2\n"})


def pressure():
    files = s.target() | {"good.csv": s.syringe_test(), "wrong.csv": s.syringe_test("p_abs_kpa,dv_sy_mm3", 0, 1),
                          "turned.csv": s.syringe_test("p_gauge_kpa,dv_sy_mm3", 100, 1)}
    run = "calibrate pressure {} --syringe-volume 600mm3 --tube-volume 0.02mL"
    for name, text in {"bar": "p_abs_bar,dv_sy_ml\n1,0\n", "litre": "p_abs_kpa,dv_sy_l\n100,0\n",
                       "scale": "p_kpa,dv_sy_ml\n100,0\n",
                       "both": "p_abs_kpa,p_gauge_kpa,dv_sy_ml\n100,0,0\n",
                       "number": "p_abs_kpa,dv_sy_mm3\n100,0\n120,abc\n",
                       "nan": "p_abs_kpa,dv_sy_mm3\n100,0\n120,nan\n",
                       "run": "p_abs_kpa,dv_sy_mm3,run\n100,0,1\n120,100,1.5\n",
                       "time": "p_abs_kpa,dv_sy_mm3,t_s\n100,0,1\n120,100,1\n",
                       "too much": "p_abs_kpa,dv_sy_mm3\n100,0\n120,700\n",
                       "column": "p_abs_kpa,dv_sy_mm3,temperature\n100,0,20\n"}.items():
        yield several(f"pressure table, {name}", [run.format("bad.csv") + " --scene block.yaml -o air.yaml"],
                      files | {"bad.csv": text})
    for option in ("good.csv -o air.yaml", "good.csv --chamber-volume 192",
                   "good.csv --chamber-volume 192mm3 --predict",
                   "good.csv --scene block.yaml --actuator ari", "good.csv --scene block.yaml --atmosphere -3",
                   "good.csv --scene block.yaml -o air.txt", "good.csv wrong.csv --scene block.yaml",
                   "turned.csv --scene block.yaml",
                   "good.csv --scene block.yaml --pressure gauge", "none.csv --scene block.yaml",
                   "good.csv --scene none.yaml"):
        yield several(f"pressure {option}", [run.format(option)], files)
    yield several("pressure without a syringe", ["calibrate pressure good.csv --scene block.yaml"], files)


def dea():
    for name, text in {"unit": "voltage_mv,area_ratio\n0,1\n", "percent": "voltage_kv,stretch_percent\n0,1\n",
                       "zero": "voltage_kv,area_ratio\n0,1\n1,0\n", "negative": "voltage_kv,area_ratio\n0,1\n-1,1.1\n",
                       "never off": "voltage_kv,area_ratio\n1,1\n2,1.1\n"}.items():
        yield several(f"dea table, {name}", ["calibrate dea bad.csv"], {"bad.csv": text})
    law = "--law neo-hookean --shear-modulus 0.07 --permittivity 4.4 --thickness "
    for option in ("--law gent", f"{law}0.5 --stretch-limit 10", f"{law}0.5 --prestretch 0.5", f"{law}-1",
                   f"{law}0.5 -o skin.txt", "--law silicone",
                   f"{law}0.5 none.csv", "none.csv"):
        yield several(f"dea {option}", [f"calibrate dea {option}"], {})


def relaxation():
    for name, text in {"unit": "t_s,strain,stress_pa\n0,0.1,1\n", "time": "strain,stress_mpa\n0.1,1\n",
                       "order": "t_s,strain,stress_mpa\n1,0.1,1\n0,0.1,1\n",
                       "force": "t_s,strain,force_n\n0,0.1,1\n1,0.1,1\n",
                       "rest": "t_s,strain,stress_mpa\n0,0,1\n1,0,1\n"}.items():
        yield several(f"relaxation table, {name}", ["calibrate relaxation bad.csv"], {"bad.csv": text})
    cycles = "examples/acrylic_strip/cycles.csv"
    for option in (f"{cycles} --law hookean", f"{cycles} --constants jm=3", f"{cycles} --constants c10",
                   f"{cycles} --poisson-ratio 0.5", f"{cycles} -o m.txt", f"{cycles} --branches -1", "none.csv"):
        yield several(f"relaxation {option.replace(cycles, 'cycles')}", [f"calibrate relaxation {option}"], {})


def curves():
    head = "softkin_curve: 1\ninput: gauge_pressure_kPa\n"
    for name, text in {"falls": head + "loading:\n  - [0, 1]\n  - [10, 1]\n",
                       "one point": head + "loading:\n  - [0, 1]\n",
                       "some spread": head + "loading:\n  - [0, 1, 0.1]\n  - [10, 1.1]\n",
                       "bar": "softkin_curve: 1\ninput: pressure_bar\nloading: [[0, 1], [1, 2]]\n",
                       "voltage": "softkin_curve: 1\ninput: voltage_kV\nloading: [[0, 1], [1, 2]]\n",
                       "newer": "softkin_curve: 2\n",
                       "no version": "loading: []\n", "key": head + "loading: [[0, 1], [1, 2]]\nlaoding: 3\n"}.items():
        yield several(f"curve, {name}", ["fk block.yaml --set air=1.2 -o new/a.vtu"], s.curved(text=text))
    yield several("curve that is missing", ["fk block.yaml --set air=1.2"], s.curved(text=None))
    yield several("branch that is missing", ["fk block.yaml --set air=1.2"],
                  s.curved("curve: {file: air.yaml, branch: unloading}", head + "loading: [[0, 1], [1, 2]]\n"))
    for setting in ("95kPa", "40bar", "40kPa:up", "-1kPa", "5kV"):
        yield several(f"curve at {setting}", [f"fk block.yaml --set air={setting}"], s.curved())
    yield several("curve on a path", ["fk block.yaml --path p.csv"], s.curved() | {"p.csv": "air_kPa\n10\n200\n"})
    yield several("pressure without a curve", ["fk block.yaml --set air=40kPa"], s.target())


def drive():
    run = "drive block.yaml commands.csv"
    for name, text in {"empty": "", "range": "t_s,tendon\n0,1\n1,1.21\n", "nan": "t_s,tendon\n0,1\n1,nan\n",
                       "short": "t_s,tendon\n0,1\n1\n",
                       "time": "t_s,tendon\n1,1\n1,1\n", "column": "t_ms,tendon\n0,1\n",
                       "unit": "t_s,tendon_mm\n0,20\n",
                       "pressure": "t_s,tendon,tendon_pressure_kPa\n0,1,3\n", "speed": "t_s,tendon\n0,1\n1,0.5\n",
                       "acceleration": "t_s,tendon\n0,1\n0.008,0.999\n", "chamber": "t_s,air\n0,1\n"}.items():
        yield several(f"drive rows, {name}", [f"{run} --dry-run --gcode a.gcode"], s.driven(commands=text))
    head = "softkin_hardware: 1\ntendons:\n"
    for name, text in {"key": head + "  - {actuator: tendon, axis: X, backlash_um: 500}\n",
                       "actuator": head + "  - {actuator: tendom, axis: X}\n",
                       "kind": head + "  - {actuator: air, axis: X}\n", "nothing": "softkin_hardware: 1\n",
                       "newer": "softkin_hardware: 2\n",
                       "axis": head + "  - {actuator: tendon, axis: Q}\n",
                       "limits": head + "  - {actuator: tendon, axis: X, length_limits_mm: [17, 21]}\n"}.items():
        yield several(f"drive hardware, {name}", [f"{run} --gcode new/a.gcode"], s.driven(text))
    for option in ("", "--dry-run --port /dev/null", "--dry-run --log log", "--port /dev/null --gcode a.gcode",
                   "--port no --log log",
                   "--dry-run --baud 0", "--dry-run --boot-wait -1", "--schedule a.csv", "--gcode commands.csv",
                   "--gcode block.hardware.yaml",
                   "--dry-run --hardware no.yaml", "--dry-run --pressures block.yaml",
                   "--dry-run --pressures none.json"):
        yield several(f"drive {option}", [f"{run} {option}"], s.driven())
    yield several("drive without hardware", [f"{run} --dry-run"], s.physical() | {"commands.csv": s.COMMANDS})
    pump = "softkin_hardware: 1\nchambers: [{actuator: air, channel: pump, limits_kPa: [0, 500]}]\n"
    for name, text in {"limit": "t_s,air\n0,0\n0.5,501\n", "no time": "air\n0\n", "psi": "t_s,air_psi\n0,0\n",
                       "tension": "t_s,tendon_N\n0,3\n"}.items():
        yield several(f"drive chambers, {name}", [f"{run} --dry-run"],
                      s.driven(pump, text, **{"block.yaml": s.loaded_scene()}))


def mesh():
    cube = s.cube()
    files = {"cube.msh": cube, "bad.msh": cube.replace("2.2 0 8", "3.1 0 8"), "a.yaml": "softkin: 1\n"}
    for option in ("convert bad.msh out.vtu", "convert absent.msh out.vtu", "convert cube.msh out.obj",
                   "convert cube.msh no/out.msh",
                   "info cube.msh --unit parsec", "info cube.msh --unit", "info cube.msh --bogus",
                   "info cube.msh other.msh", "convert cube.msh",
                   "convert cube.msh a.vtu --ascii", "check cube.msh --scene a.yaml", "check --scene cube.msh",
                   "check a.yaml --unit cm",
                   "check a.yaml", "info a.yaml", "info folder"):
        yield several(f"mesh {option}", [f"mesh {option}"], files)
    lines = cube.splitlines(keepends=True)
    torn = {"ends early": "".join(lines[:20]), "empty": "", "no end": cube.replace("$EndElements\n", ""),
            "count": cube.replace("$Nodes\n8", "$Nodes\n9"),
            "nan": cube.replace("2 2 0 0\n", "2 nan 0 0\n"), "vertex": cube.replace(" 8\n", " 99\n"),
            "type": cube.replace("1 4 2 1 1", "1 5 2 1 1"),
            "no tetrahedra": "".join(line for line in lines), "nodes twice": cube + cube[cube.index("$Nodes"):]}
    torn["no tetrahedra"] = s.gmsh([], [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(2, 1, (0, 1, 2))])
    for name, text in torn.items():
        yield several(f"mesh, {name}", ["mesh info a.msh", "mesh check a.msh", "mesh convert a.msh a.vtu"],
                      {"a.msh": text})
    for file, text in {"a.mesh": s.MEDIT.replace("Tetrahedra\n2", "Tetrahedra\n3"),
                       "b.mesh": s.MEDIT.replace("Corners", "Korners"),
                       "a.inp": s.ABAQUS.replace("c3d4", "c3d8"), "b.inp": s.ABAQUS + "*INCLUDE, INPUT=x.inp\n",
                       "a.vtk": s.VTK.replace("UNSTRUCTURED_GRID", "POLYDATA"), "b.vtk": s.VTK[:120],
                       "a.vtu": "<VTKFile>", "a.ele": s.TETGEN["a.ele"],
                       "a.tet": s.TET["a.tet"].replace("4 0 2 1 4", "4 0 2 1 9")}.items():
        yield several(f"mesh, {file}", [f"mesh info {file}", f"mesh convert {file} o.msh"], {file: text})
    made = ["mesh convert cube.msh a.vtu", keep_bytes("a.vtu", 900), "mesh info a.vtu"]
    yield Case("refuses mesh, torn vtu", made, {"cube.msh": cube}, ends=2)
    yield Case("refuses mesh, torn binary msh", ["mesh convert cube.msh a.msh", keep_bytes("a.msh", 400),
                                                 "mesh info a.msh"], {"cube.msh": cube}, ends=2)
