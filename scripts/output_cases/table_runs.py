"""Cases of commands that succeed on tables, reports and meshes: compare, calibrate, drive, mesh."""

from . import samples as s
from .case import Case, fixed_seconds, write
from .runs import BOTH


def cases():
    return [*compare(), *calibrate(), *drive(), *mesh()]


def compare():
    there, back = s.turning([0, 70, 130, 200, 300, 380, 250], 2), s.turning([0, -30, -60, -90, -120, -150, -200], 0.5)
    files = {"a.json": there, "b.json": back, "loads.json": s.turning([0, 70, 130, 200, 300, 380, 260], 1,
                                                                      pressure=12.5),
             "stopped.json": s.turning([0, 10, 20, 30, 40, 50, 60], 1.25, broken=5)}
    tracks = {"robot.json": s.linear([(1, 1), (1.2, 1), (1.2, 1.3), (1.5, 1.5)]), "camera.csv": s.camera(),
              "first.json": s.linear([(1, 1), (1.3, 1), (1.6, 1)]),
              "second.json": s.linear([(1, 1), (1, 1.25), (1, 1.6)]),
              "robot.csv": "t_s,x_mm,y_mm\n0,0,0\n1,10,0\n2,10,10\n",
              "film.csv": "t_s,x_mm,y_mm\n0,0,0\n3.25,0,0\n4.25,10,0\n5.25,10,10\n",
              "solid.csv": "alpha,tip_x_mm,tip_y_mm,tip_z_mm,base_x_mm,base_y_mm\n1,0,5,0,9,9\n2,10,5,-4,9,9\n3,20,5,-8,9,9\n",
              "flat.csv": "alpha,x_mm,y_mm\n1,0,0\n1.5,5,2\n3,20,8\n",
              "long.csv": "x_mm,y_mm\n" + "".join(f"{i},{i % 3}\n" for i in range(25))}

    def case(name, command, of):
        return Case(f"compare {name}", [f"compare {command}"], of, clock=False)

    yield case("reports", "a.json b.json", files)
    yield case("turns", "a.json b.json --turn begin end --poses 130 350", files)
    yield case("turns json", "a.json b.json loads.json --turn begin end --poses 130 350 --json", files)
    yield case("marker", "a.json stopped.json --marker end", files)
    yield case("loads", "loads.json a.json stopped.json --turn begin end --plot p.svg", files)
    yield case("json", "loads.json b.json --json", files)
    yield case("camera", "robot.json camera.csv -o e.csv --plot e.svg", tracks)
    yield case("camera json", "robot.json camera.csv --json", tracks)
    yield case("camera aligned", "robot.json camera.csv --align -o e.csv", tracks)
    yield case("camera arc", "robot.json camera.csv --by arc", tracks)
    yield case("start", "robot.csv film.csv --start 3.15 --plot p.svg", tracks)
    yield case("left out", "robot.csv film.csv --start 3.75", tracks)
    yield case("plane", "solid.csv@tip flat.csv --by alpha --plane x-z -o e.csv", tracks)
    yield case("marker of a table", "solid.csv flat.csv --marker tip --by waypoint --plane xz", tracks)
    yield case("sum", "robot.json --sum first.json second.json --json", tracks)
    yield case("sum aligned", "robot.json camera.csv --align --sum first.json second.json -o e.csv --plot e.svg",
               tracks)
    yield case("by a command", "robot.json robot.json --by air2 --json", tracks | {
        "robot.json": s.linear([(1, 1), (1.2, 1.1), (1.2, 1.3), (1.5, 1.5)])})
    yield case("long", "long.csv long.csv", tracks)
    yield Case("compare of fk", ["fk block.yaml --path p.csv --report a.json",
                                 "fk block.yaml --path p.csv --report b.json --force payload=0,0,-0.1",
                                 fixed_seconds("a.json", "b.json"),
                                 "compare a.json b.json --turn tip corner --plot c.svg",
                                 "compare a.json b.json --json"],
               s.physical() | {"p.csv": BOTH})


def calibrate():
    bar = "examples/two_material_bar"
    run = f"calibrate material {bar}/table_2_tpu.csv --cells 1"
    yield Case("calibrate material", [run])
    yield Case("calibrate material json", [f"{run} --json"])
    yield Case("calibrate material physical",
               [f"{run} --formulation physical --height 12 --modulus-b 12 -o m.yaml --residuals r.csv"])
    yield Case("calibrate material sliding",
               [f"{run} --grip sliding --width 15 --poisson-ratio 0.4 --law corotational"])
    yield Case("calibrate material target",
               [f"{run} --formulation target-shape --try 7.08 --twist {bar}/table_2_twist.csv --json"])
    yield Case("calibrate material stiffer", [f"{run} --formulation target-shape --stiffer 0.5 --regions hard soft"],
               ends=None)
    yield Case("calibrate material files",
               [f"calibrate material {bar}/specimens.csv --twist {bar}/twist.csv --cells 1 -o m.yaml "
                                            "--plot p.svg --residuals r.csv"])
    yield Case("calibrate material no ratio",
               ["calibrate material s.csv --formulation target-shape --cells 1 -o m.yaml --plot p.svg"],
               {"s.csv": "l_mm,l1_mm,dl_mm,dl1_mm\n100,50,1,0.2\n100,50,1,0.0000001\n"}, ends=1)
    tensile = f"calibrate material --tensile {bar}/tensile.csv"
    yield Case("calibrate tensile", [f"{tensile} -o m.yaml --plot p.svg --residuals r.csv --region all"])
    yield Case("calibrate tensile json", [f"{tensile} --json"])
    yield Case("calibrate tensile part", [f"{tensile} --up-to 1 --linear-tolerance 8 --json"])
    for law in ("linear", "neo-hookean", "mooney-rivlin", "yeoh", "gent", "ogden", "ogden-1"):
        yield Case(f"calibrate tensile {law}", [f"{tensile} --law {law} -o m.yaml"])
    files = s.target() | {"test.csv": s.syringe_test(), "gauge.csv": s.syringe_test("p_gauge_kpa,dv_sy_mm3", 0, 1)}
    volumes = "--syringe-volume 600mm3 --tube-volume 0.02mL"
    yield Case("calibrate pressure",
               [f"calibrate pressure test.csv {volumes} --scene block.yaml -o a.yaml --plot a.svg --table r.csv"],
               files)
    yield Case("calibrate pressure json",
               [f"calibrate pressure test.csv gauge.csv {volumes} --chamber-volume 192mm3 --json"], files)
    yield Case("calibrate pressure atmosphere",
               [f"calibrate pressure gauge.csv {volumes} --chamber-volume 0.192mL --atmosphere 99"], files)
    yield Case("calibrate pressure predicted", [f"calibrate pressure gauge.csv {volumes} --scene block.yaml --predict",
                                                f"calibrate pressure gauge.csv {volumes} --scene block.yaml --predict --json"],
               files | {"block.yaml": s.physical_scene()}, ends=None)
    yield Case("calibrate pressure of a path",
               [f"calibrate pressure p.csv {volumes} --pressure gauge --scene block.yaml -o air.yaml",
                                                write("block.yaml",
                                                      s.target_scene(air="range: [1.0, 2.0], curve: air.yaml")),
                                                "fk block.yaml --set air=40kPa --report r.json"],
               files | {"p.csv": s.syringe_test("p_kpa,dv_sy_mm3", 0, 1)})
    yield Case("calibrate pressure example", [
        "calibrate pressure examples/three_chamber_actuator/measured/syringe.csv --syringe-volume 60mL --tube-volume 1.2mL "
        "--scene examples/three_chamber_actuator/three_chamber_actuator.yaml --actuator air1 -o air1.yaml --plot air1.svg --table t.csv"],
        ends=None)
    strip = "calibrate relaxation examples/acrylic_strip/cycles.csv --law gent"
    yield Case("calibrate relaxation", [f"{strip} -o m.yaml --plot p.svg --residuals r.csv"])
    yield Case("calibrate relaxation json", [f"{strip} --branches 2 --json"])
    yield Case("calibrate relaxation of creep",
               ["calibrate relaxation --creep examples/acrylic_strip/creep.csv --law gent --constants jm=99.67 -o m.yaml"])
    law = "calibrate dea --law neo-hookean --shear-modulus 0.07 --permittivity 4.4 --thickness 0.5"
    yield Case("calibrate dea law", [f"{law} -o s.yaml --plot s.svg"])
    yield Case("calibrate dea law json", [f"{law} --json"])
    yield Case("calibrate dea breakdown", [f"{law} --breakdown-field 20"])
    yield Case("calibrate dea gent",
               ["calibrate dea --law gent --shear-modulus 0.045 --stretch-limit 120 --permittivity 4.7 "
                                      "--thickness 1 --prestretch 2 -o s.yaml --plot s.svg"])
    yield Case("calibrate dea table", ["calibrate dea skin.csv -o s.yaml --plot s.svg"], {"skin.csv": s.voltage_test()})
    yield Case("calibrate dea table json", ["calibrate dea skin.csv --json"], {"skin.csv": s.voltage_test()})
    yield Case("calibrate dea example",
               ["calibrate dea examples/dea_crawler/measured/voltage.csv -o s.yaml --plot s.svg"])


def drive():
    run = "drive block.yaml commands.csv"

    def case(name, options, of, ends=0):
        return Case(f"drive {name}", [f"{run} {options}"], of, ends, clock=False)

    yield case("dry run", "--dry-run", s.driven())
    yield case("gcode", "--gcode out/a.gcode", s.driven())
    yield case("json", "--gcode a.gcode --return --json", s.driven())
    yield case("without times", "--dry-run --return", s.driven(commands="tendon\n1\n0.9\n0.95\n"))
    yield case("drum", "--dry-run --gcode a.gcode", s.driven(
        "softkin_hardware: 1\nboard: {configure: false}\ntendons:\n  - {actuator: tendon, axis: Y, drum_radius_mm: 6, "
        "steps_per_mm: 400, direction: -1, slack_offset_mm: 2, length_limits_mm: [10, 24], max_speed_mm_per_s: 12}\n"))
    yield case("syringe", "--dry-run --gcode a.gcode --return", s.driven(
        "softkin_hardware: 1\natmosphere_kPa: 101.3\nsyringes:\n  - {actuator: air, axis: X, syringe_mL: 2, dead_volume_mL: "
        "0.25, plunger_area_mm2: 40, lead_mm: 8, backlash_mm: 0.1, max_speed_mm_per_s: 20}\n",
        "t_s,air,air_pressure_kPa\n0,1,0\n2,1.2,35\n4,1.1,20\n"))
    yield case("other hardware", "--dry-run --hardware h.yaml",
               s.driven(**{"h.yaml": s.HARDWARE.replace("axis: X", "axis: A")}))
    pump = "softkin_hardware: 1\nchambers: [{actuator: air, channel: pump, limits_kPa: [0, 500]}]\n"
    yield case("schedule", "--schedule out/p.csv --json", s.driven(
        pump, "t_s,air_kPa\n0,0\n0.5,120\n2,80.25\n", **{"block.yaml": s.loaded_scene()}))
    both = s.HARDWARE + "chambers: [{actuator: air, limits_kPa: [0, 5000]}]\n"
    yield case("column of pressures", "--dry-run", s.driven(both, "t_s,air,air_pressure_kPa\n0,1,0\n1,1.2,33\n"))
    yield Case("drive pressures of fk", ["fk block.yaml --path commands.csv --report r.json",
                                         f"{run} --pressures r.json --schedule p.csv"],
               s.driven(both, "t_s,air\n0,1\n1,1.2\n"))


def mesh():
    flat = s.tetrahedra([(0, 0, 0), (4, 0, 0), (0, 4, 0), (0, 0, 4), (8, 8, 0)], [(0, 1, 2, 3), (0, 1, 4, 2)])
    over = s.tetrahedra([(0, 0, 0), (4, 0, 0), (0, 4, 0), (0, 0, 4), (0, 0, 8)], [(0, 1, 2, 3), (0, 1, 2, 4)])
    hinge = s.tetrahedra([(0, 0, 0), (0, 0, 4), (4, 0, 0), (0, 4, 0), (-4, 0, 0), (0, -4, 0)],
                         [(0, 2, 3, 1), (0, 4, 5, 1)])
    three = s.tetrahedra([(0, 0, 0), (6, 0, 0), (0, 6, 0), (0, 0, 4), (0, 0, 8), (0, 0, -4)],
                         [(0, 1, 2, 3), (0, 1, 2, 4), (0, 2, 1, 5)])
    twice = s.tetrahedra([(0, 0, 0), (4, 0, 0), (0, 4, 0), (0, 0, 4), (0, 0, 0), (4, 0, 0), (0, 4, 0), (0, 0, -8)],
                         [(0, 1, 2, 3), (4, 6, 5, 7)])
    names, vertices, elements = s.cube_parts()
    loose = s.gmsh(names, vertices + [(3.0 + i, 0, 0) for i in range(7)], elements)
    # file, its content, exit codes of check
    meshes = {"cube.msh": (s.cube(), 0), "prism.msh": (s.prism(), 0), "block.msh": (s.block(), 0),
              "cube2.msh": (s.quadratic(names, vertices, elements), 0),
              "curved.msh": (s.quadratic(names, vertices, elements, {8: (1, -0.2, 0)}), None),
              "far.msh": (s.quadratic(names, vertices, elements, {8: (0.3, 0, 0)}), None), "flat.msh": (flat, 1),
              "over.msh": (over, 1),
              "hinge.msh": (hinge, 0), "three.msh": (three, 1), "twice.msh": (twice, 0), "loose.msh": (loose, 0),
              "a.mesh": (s.MEDIT, None), "a.ele": (s.TETGEN["a.ele"], None), "a.inp": (s.ABAQUS, None),
              "a.vtk": (s.VTK, None),
              "a.tet": (s.TET["a.tet"], None)}
    for file, (content, ends) in meshes.items():
        files = {file: content} | (s.TETGEN if file == "a.ele" else {})
        yield Case(f"mesh info {file}", [f"mesh info {file} --unit cm", f"mesh info {file} --json"], files)
        yield Case(f"mesh check {file}", [f"mesh check {file} --json", f"mesh check {file}"], files, ends)
        yield Case(f"mesh convert {file}", [f"mesh convert {file} a.vtu", f"mesh convert {file} b.msh --json",
                                            "mesh info b.msh",
                                            f"mesh convert {file} c.msh --ascii", "mesh convert a.vtu d.msh",
                                            f"mesh convert {file} e.stl"],
                   files, ends=None)
    cube = {"cube.msh": s.cube()}
    scene = "softkin: 1\nunits: {length: cm}\nmesh: {file: cube.msh}\nmaterials: [{shape_ratio: 1}]\nfixed: [{region: %s}]\n"
    yield Case("mesh check scene", ["mesh check a.yaml --json", "mesh check --scene a.yaml"],
               cube | {"a.yaml": scene % "base"})
    yield Case("mesh check loose scene", ["mesh check a.yaml --json", "mesh check a.yaml"],
               cube | {"a.yaml": scene % "corner"}, ends=1)
    yield Case("mesh check wrong scene", ["mesh check a.yaml"], cube | {"a.yaml": scene % "nowhere"}, ends=None)
