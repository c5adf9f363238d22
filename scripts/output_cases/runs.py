"""Cases of commands that succeed on small meshes: every command, its outputs, options and resumed runs."""

from . import samples as s
from .case import Case, keep_bytes, keep_lines, keep_steps, marker_path, remove, write

PATH = "t_s,air\n0,1\n0.5,1.1\n1.25,1.2\n2,1.3\n"
BOTH = "t_s,air,tendon\n0,1,1\n1,1.1,0.98\n3,1.2,0.96\n4,1.3,0.93\n"
COMMANDS = ("fk", "ik", "follow", "workspace", "walk", "compare", "calibrate", "calibrate material",
            "calibrate pressure", "calibrate relaxation",
            "calibrate dea", "drive", "mesh", "mesh info", "mesh check", "mesh convert", "measure")


def cases():
    return [*helps(), *fk_target(), *fk_physical(), *fk_scenes(), *fk_resumed(), *ik(), *follow(), *workspace(),
            *walk()]


def helps():
    yield Case("help", ["--help"])
    yield Case("version", ["--version"])
    for command in COMMANDS:
        yield Case(f"help {command}", [f"{command} --help"], ends=None if command == "measure" else 0)


def fk_target():
    files = s.target()
    everything = "--report out/r.json -o out/s.pvd --plot out/p.svg --image out/i.png"
    for solver in ("newton", "local-global"):
        run = f"fk block.yaml --solver {solver}"
        yield Case(f"fk target {solver} text", [f"{run} --set air=1.4"], files)
        yield Case(f"fk target {solver} json", [f"{run} --set air=1.4 --json"], files)
        yield Case(f"fk target {solver} files",
                   [f"{run} --set air=1.4 -o out/s.vtu --report out/r.json --image out/i.png"], files)
        yield Case(f"fk target {solver} path", [f"{run} --path path.csv {everything}"], files | {"path.csv": PATH})
        yield Case(f"fk target {solver} path json", [f"{run} --path path.csv --json"], files | {"path.csv": PATH})
        yield Case(f"fk target {solver} order 2", [f"{run} --set air=1.3 -o s.vtu"],
                   files | {"block.yaml": s.target_scene().replace("block.msh", "block.msh, order: 2")})
        yield Case(f"fk target {solver} uniform", [f"{run} --set air=1.3 --report r.json"],
                   s.target(air="range: [1, 2], distribution: uniform, weight: 2"))
        yield Case(f"fk target {solver} tolerance", [f"{run} --set air=1.4 --solver-tolerance 0.01 --report r.json"], files)
        yield Case(f"fk target {solver} not converged",
                   [f"{run} --set air=1.9 --max-iterations 2 -o s.vtu --report r.json"],
                   files, ends=1)
    for anderson in (0, 1, 10):
        yield Case(f"fk anderson {anderson}",
                   [f"fk block.yaml --solver local-global --anderson {anderson} --set air=1.4 --report r.json"], files)
    yield Case("fk at rest", ["fk block.yaml"], files)
    yield Case("fk view", ["fk block.yaml --set air=1.6 --image i.png --view 1 -2 0.5"], files)
    yield Case("fk two threads", ["fk block.yaml --set air=1.6 --report r.json --threads 2"], files)
    yield Case("fk back and forth", ["fk block.yaml --path p.csv --plot p.svg"], files | {"p.csv": "air\n1\n1.1\n1\n"})
    yield Case("fk windows table", ["fk block.yaml --path p.csv --json"],
               files | {"p.csv": "\ufeff# made by hand\r\n air \r\n\r\n1\r\n 1.1 \r\n"})
    yield Case("fk small shape ratio", ["fk block.yaml --set air=1.3 --report r.json"],
               s.target(materials="{region: body, shape_ratio: 0.2, weight: 3}"))
    yield Case("fk long names", ["fk block.yaml --set a_very_long_actuator_name_that_goes_on_17=1.1"],
               files | {"block.yaml": s.target_scene().replace("name: air",
                                                               "name: a_very_long_actuator_name_that_goes_on_17")
                        .replace("name: corner", "name: \u00c4rmel\u00fcmschlag_mit_langem_Namen")})


def fk_physical():
    files = s.physical()
    run = "fk block.yaml"
    yield Case("fk physical text", [f"{run} --set air=1.4 --set tendon=0.95"], files)
    yield Case("fk physical json", [f"{run} --set air=1.4 --json"], files)
    yield Case("fk physical files", [f"{run} --set tendon=0.9 -o o/s.vtu --report o/r.json --image o/i.png"], files)
    yield Case("fk physical path", [f"{run} --path p.csv --report o/r.json -o o/s.pvd --plot o/p.svg --image o/i.png"],
               files | {"p.csv": BOTH})
    yield Case("fk physical one column", [f"{run} --path p.csv --set tendon=0.95 --plot p.svg"],
               files | {"p.csv": PATH})
    yield Case("fk slack", [f"{run} --set tendon=1.15 --report r.json"], files)
    yield Case("fk force", [f"{run} --set air=1.2 --force payload=0,0,-0.3 --report r.json"], files)
    yield Case("fk large force", [f"{run} --force payload=0,0,-50 --report r.json -o s.vtu"], files, ends=None)
    yield Case("fk far", [f"{run} --set air=3 --report r.json -o s.vtu"], files, ends=None)
    yield Case("fk short cable", [f"{run} --set tendon=0.5 --report r.json -o s.vtu"], files, ends=None)
    yield Case("fk few iterations", [f"{run} --set air=2 --max-iterations 2 --report r.json -o s.vtu"], files,
               ends=None)
    yield Case("fk as target shape", [f"{run} --set air=1.2 --formulation target-shape --report r.json"],
               s.physical(materials="{youngs_modulus: 1, poisson_ratio: 0.3, shape_ratio: 0.8}"))
    loads = s.loaded()
    yield Case("fk loads", [f"{run} --set air=30kPa --set tendon=2N"], loads)
    yield Case("fk loads without units", [f"{run} --set air=-20 --set tendon=1 --report r.json"], loads)
    yield Case("fk loads path", [f"{run} --path p.csv --report r.json --plot p.svg"],
               loads | {"p.csv": "t_s,air_kPa,tendon_N\n0,0,0\n1,20,1\n2,40,2\n"})
    yield Case("fk limit of pressure", [f"{run} --set air=3000kPa --report r.json -o s.vtu --image i.png"], loads,
               ends=1)
    yield Case("fk limit on a path", [f"{run} --path p.csv --report r.json -o s.pvd --plot p.svg"],
               loads | {"p.csv": "air\n50\n2900\n100\n"}, ends=1)
    for name, law in (("st-venant-kirchhoff", "youngs_modulus: 1, poisson_ratio: 0.3"),
                      ("corotational", "youngs_modulus: 1, poisson_ratio: 0.3"),
                      ("neo-hookean", "youngs_modulus: 1, poisson_ratio: 0.49"),
                      ("mooney-rivlin", "c10: 0.15, c01: 0.03, bulk_modulus: 10"),
                      ("yeoh", "c10: 0.2, c20: -0.01, c30: 0.002, poisson_ratio: 0.45"),
                      ("ogden", "mu1: 0.15, alpha1: 2.5, mu2: -0.01, alpha2: -2, poisson_ratio: 0.45")):
        yield Case(f"fk {name}", [f"{run} --set air=1.3 --set tendon=0.95 --report r.json -o s.vtu"],
                   s.physical(materials=f"{{law: {name}, {law}}}"))
        yield Case(f"fk {name} order 2", [f"{run} --set air=1.2 --report r.json -o s.vtu"],
                   s.physical(materials=f"{{law: {name}, {law}}}", order=", order: 2"))
    yield Case("fk yeoh turns over", [f"{run} --set air=0.5 --set tendon=0.5 --report r.json"],
               s.physical(materials="{law: yeoh, c10: 0.2, bulk_modulus: 10}"), ends=None)
    yield Case("fk gravity", [f"{run} --set air=1.1 --report r.json"], s.physical(
        "gravity: [0, 0, -9.81]\n", materials="{youngs_modulus: 0.1, poisson_ratio: 0.3, density: 1100}"))


def fk_scenes():
    extra = ("regions:\n  - {name: box, box: [[12, 0, 0], [20, 12, 4]]}\n"
             "  - {name: ball, sphere: {center: [20, 6, 6], radius: 5}}\n"
             "  - {name: rod, cylinder: {start: [0, 0, 0], end: [20, 0, 0], radius: 1}}\n"
             "  - {name: half, halfspace: {point: [10, 0, 0], normal: [1, 0, 0]}}\n"
             "  - {name: some, vertices: [0, 6, 12]}\n  - {name: few, elements: [0, 1, 2]}\n"
             "  - {name: listed, sidecar: {file: rows.txt, column: 2}}\n")
    rows = "".join(f"{i}:0:{int(i % 7 == 0)}\n" for i in range(270))
    yield Case("fk regions", ["fk block.yaml --set air=1.1 --report r.json -o s.vtu"], {
        "block.msh": s.block(), "rows.txt": rows,
        "block.yaml": s.physical_scene(extra + "rigid: [box]\n", materials=(
            "{youngs_modulus: 1, poisson_ratio: 0.3}, {region: half, youngs_modulus: 2, poisson_ratio: 0.3},"
            "{region: listed, youngs_modulus: 3, poisson_ratio: 0.4, law: corotational}"))})
    yield Case("fk centimetres", ["fk block.yaml --set air=1.2 --report r.json -o s.vtu"], {
        "block.msh": s.block(edge=0.4), "block.yaml": s.target_scene("units: {length: cm}\n").replace("[20, 12, 12]",
                                                                                                      "[2, 1.2, 1.2]")})
    yield Case("fk moved support", ["fk block.yaml --report r.json -o s.vtu"], {
        "block.msh": s.block(), "block.yaml": s.physical_scene().replace(
            "fixed: [{region: base}]", "fixed: [{region: base}, {region: tip, displacement: [-0.5, 0, 0.2]}]")})
    yield Case("fk void", ["fk block.yaml --report r.json -o s.vtu"], {
        "block.msh": s.block(), "block.yaml": "softkin: 1\nmesh: {file: block.msh}\nvoid: [chamber]\ngravity: [0, 0, -9.81]\n"
        "materials: [{youngs_modulus: 0.5, poisson_ratio: 0.3, density: 900}]\nfixed: [{region: base}]\n"})
    yield Case("fk nothing but a body", ["fk block.yaml", "fk block.yaml --json"], {
        "block.msh": s.block(), "block.yaml": "softkin: 1\nmesh: {file: block.msh}\nmaterials: [{shape_ratio: 1}]\nfixed: [{region: base}]\n"})
    yield Case("fk marker outside", ["fk block.yaml --set air=1.2"], {
        "block.msh": s.block(), "block.yaml": s.target_scene().replace("[20, 12, 12]", "[20.3, 12, 12]")})
    yield Case("fk reversed elements", ["fk block.yaml --set air=1.2 --report r.json"], {
        "block.msh": s.gmsh(*reversed_elements(*s.block_parts(5))), "block.yaml": s.target_scene()})
    yield Case("fk mesh of order 2", ["fk block.yaml --set air=1.2 --report r.json -o s.vtu"], {
        "block.msh": s.quadratic(*s.block_parts(5)), "block.yaml": s.physical_scene()})
    curve = s.curved()
    for setting in ("40kPa", "140kPa_abs", "40kPa:unloading", "1.25", "0kPa"):
        yield Case(f"fk curve {setting}", [f"fk block.yaml --set air={setting} --report r.json"], curve)
    yield Case("fk curve path", ["fk block.yaml --path p.csv --report r.json --plot p.svg"],
               s.curved("curve: {file: air.yaml, branch: unloading}") | {"p.csv": "air_kPa\n10\n20\n"})
    yield Case("fk curve spread", ["fk block.yaml --set air=15kPa --json"],
               s.curved(text="softkin_curve: 1\ninput: gauge_pressure_kPa\nloading: [[0, 1, 0.01], [30, 1.2, 0.02]]\n"))


def reversed_elements(names, vertices, elements):
    return names, vertices, [(k, g, (e[0], e[2], e[1], e[3]) if k == 4 and n % 9 == 0 else e)
                             for n, (k, g, e) in enumerate(elements)]


def fk_resumed():
    run = "fk block.yaml --path p.csv --report o/r.json -o o/s.pvd"
    for name, files in (("target", s.target() | {"p.csv": PATH}), ("physical", s.physical() | {"p.csv": BOTH})):
        yield Case(f"fk resumed {name} complete", [run, f"{run} --resume"], files)
        yield Case(f"fk resumed {name} complete json", [run, f"{run} --resume --json"], files)
        yield Case(f"fk resumed {name} interrupted", [run, keep_steps("o/r.json", 2), f"{run} --plot o/p.svg --resume"],
                   files)
        yield Case(f"fk resumed {name} one step", [run, keep_steps("o/r.json", 1), f"{run} --image o/i.png --resume"],
                   files)
        yield Case(f"fk resumed {name} no step", [run, keep_steps("o/r.json", 0), f"{run} --resume"], files, ends=None)
        yield Case(f"fk resumed {name} lost shape", [run, remove("o/s_0002.vtu"), f"{run} --resume"], files)
        yield Case(f"fk resumed {name} torn shape", [run, keep_bytes("o/s_0003.vtu", 1000), f"{run} --resume"], files)
    files = s.target() | {"p.csv": PATH}
    yield Case("fk resumed without a report", [f"{run} --resume"], files)
    yield Case("fk resumed longer path", [run, write("p.csv", PATH + "3,1.35\n"), f"{run} --resume"], files)
    yield Case("fk resumed left-over files", [run, write("o/s.pvd.17.part", ""), write("o/.softkin.17", ""),
                                              f"{run} --resume"], files)
    hard = f"{run} --solver local-global --max-iterations 3 --plot o/p.svg"
    yield Case("fk resumed not converged", [hard, keep_steps("o/r.json", 2), f"{hard} --resume"], files, ends=1)
    loads = s.loaded() | {"p.csv": "air\n50\n2900\n100\n"}
    yield Case("fk resumed after a limit", [run, keep_steps("o/r.json", 2), f"{run} --resume"], loads, ends=1)


def ik():
    files = s.physical()
    run = "ik block.yaml --target tip=20.3,,6.2"
    outputs = "-o o/s.vtu --report o/r.json --plot o/p.svg --image o/i.png"
    yield Case("ik text", [run], files)
    yield Case("ik json", [f"{run} --json"], files)
    yield Case("ik files", [f"{run} {outputs}"], files)
    yield Case("ik two goals",
               ["ik block.yaml --target tip=20.3,, --plane tip=0,0,6.2/0,0,1 --weight tip=3 --report r.json"], files)
    yield Case("ik direction", ["ik block.yaml --direction tip:corner=0,1,0.98 --lever 5 --report r.json"], files,
               ends=None)
    yield Case("ik start", [f"{run} --start air=1.3 --start tendon=0.95 --report r.json"], files)
    yield Case("ik prefer", ["ik block.yaml --target tip=,,6.3 --prefer air=1.4 --prefer tendon=0.94 --report r.json"],
               files)
    yield Case("ik fix", ["ik block.yaml --target tip=,,6.3 --fix tendon=0.94 --report r.json"], files, ends=None)
    yield Case("ik loose", [f"{run} --tolerance 0.1 --solver-tolerance 1e-4 --report r.json"], files)
    yield Case("ik gradient", [f"{run} --method gradient --report r.json --plot p.svg"], files, ends=None)
    yield Case("ik gradient descents", [f"{run} --method gradient --descents 3 --report r.json"], files, ends=None)
    yield Case("ik out of reach", ["ik block.yaml --target tip=40,6,6 --report r.json --image i.png"], files, ends=1)
    yield Case("ik out of reach, one start", ["ik block.yaml --target tip=40,6,6 --other-starts 0 --json"], files,
               ends=1)
    yield Case("ik few equilibria", [f"{run} --max-equilibria 1 --tolerance 1e-9 --report r.json"], files, ends=1)
    yield Case("ik far", ["ik block.yaml --target tip=20000,6000,6000"], files, ends=1)
    yield Case("ik metres", ["ik block.yaml --target tip=0.02,0.006,0.006"], files, ends=1)
    yield Case("ik force", [f"{run} --force payload=0,0,-0.02 --report r.json"], files, ends=None)
    yield Case("ik loads", [f"{run} --report r.json"], s.loaded(), ends=None)
    yield Case("ik target shapes", ["ik block.yaml --target tip=20.3,, --report r.json"], s.target(), ends=None)
    yield Case("ik local-global", ["ik block.yaml --target tip=20.3,, --solver local-global --method gradient --json"],
               s.target(), ends=None)
    yield Case("ik curve", ["ik block.yaml --target tip=20.1,, --start air=40kPa"], s.curved(), ends=None)
    yield Case("ik workspace", ["workspace block.yaml --samples 9 -o w.csv",
                                f"{run} --workspace w.csv --report r.json"],
               s.narrow(), ends=None)


def follow():
    made = "t_s,air,tendon\n0,1.1,0.97\n1,1.2,0.95\n2,1.3,0.94\n3,1.35,0.92\n4,1.4,0.9\n"
    files = s.physical() | {"made.csv": made}
    prepared = ["fk block.yaml --path made.csv --report made.json", marker_path("made.json", "path.csv", "tip", "xz"),
                remove("made.json")]
    run = "follow block.yaml path.csv -o out"

    def case(name, *steps, ends=0):
        return Case(f"follow {name}", [*prepared, *steps], files, ends)

    yield case("text", run)
    yield case("json", f"{run} --json")
    yield case("gradient", f"{run} --method gradient")
    yield case("gradient descents", f"{run} --method gradient --descents 30 --tolerance 0.3", ends=None)
    yield case("inserted", f"{run} --max-step 0.4 --plot p.svg")
    yield case("loose", f"{run} --tolerance 0.05")
    yield case("out of reach", write_more("path.csv", "9,60,6\n10,20.5,6\n"), run, ends=1)
    yield case("resumed complete", run, f"{run} --resume")
    yield case("resumed complete json", run, f"{run} --resume --json")
    yield case("resumed interrupted", run, keep_steps("out/report.json", 2), f"{run} --resume")
    yield case("resumed one waypoint", run, keep_steps("out/report.json", 1), f"{run} --resume")
    yield case("resumed torn shape", run, keep_bytes("out/path_0003.vtu", 700), f"{run} --resume")
    yield case("resumed gradient", f"{run} --method gradient", keep_steps("out/report.json", 3),
               f"{run} --method gradient --resume")
    yield case("resumed from nothing", f"{run} --resume")
    yield case("checked", run, "fk block.yaml --path out/commands.csv --report check.json")
    yield Case("follow two markers", [prepared[0], marker_path("made.json", "path.csv", "tip", "x"), run],
               files, ends=None)
    yield Case("follow loads", [*prepared, write("block.yaml", s.loaded_scene()), f"{run} --json"], files, ends=None)
    yield Case("follow target shapes", ["follow block.yaml path.csv --marker tip -o out"],
               s.target() | {"path.csv": "x_mm\n20.1\n20.2\n20.3\n"}, ends=None)
    yield Case("follow metres", [run], s.physical() | {"path.csv": "tip_x_mm,tip_y_mm,tip_z_mm\n0.0205,0.006,0.0062\n"},
               ends=1)
    yield Case("follow workspace", [*prepared, write("block.yaml", s.narrow_scene()),
                                    "workspace block.yaml --samples 9 -o w.csv",
                                    f"{run} --workspace w.csv"], files, ends=None)


def write_more(file, text):
    def edit(folder):
        (folder / file).write_text((folder / file).read_text() + text)
    return edit


def workspace():
    files = s.narrow()
    run = "workspace block.yaml -o w.csv"
    outputs = "--cloud c.vtu --hull h.stl --plot p.svg"
    yield Case("workspace grid", [f"{run} --samples 9 {outputs}"], files)
    yield Case("workspace grid rounded", [f"{run} --samples 7"], files)
    yield Case("workspace json", [f"{run} --samples 9 --hull h.vtu --json"], files)
    yield Case("workspace sobol", [f"{run} --samples 12 --sampling sobol {outputs}"], files)
    yield Case("workspace random", [f"{run} --samples 10 --sampling random"], files)
    yield Case("workspace seed", [f"{run} --samples 10 --sampling random --seed 17 --marker corner {outputs}"], files)
    yield Case("workspace two threads", [f"{run} --samples 20 --threads 2"], files)
    yield Case("workspace force", [f"{run} --samples 4 --force payload=0,0,-0.1"], files)
    yield Case("workspace limit", [f"{run} --samples 9 --cloud c.vtu"],
               s.loaded(low=0), ends=1)
    yield Case("workspace limit json", [f"{run} --samples 9 --json"], s.loaded(low=0), ends=1)
    for solver in ("newton", "local-global"):
        yield Case(f"workspace target {solver}", [f"{run} --samples 5 --solver {solver} {outputs}"], s.target(),
                   ends=None)
    yield Case("workspace resumed complete", [f"{run} --samples 9", f"{run} --samples 9 --resume"], files)
    yield Case("workspace resumed other marker", [f"{run} --samples 9",
                                                  f"{run} --samples 9 --marker corner --resume {outputs}"], files)
    for sampling in ("grid", "sobol", "random"):
        again = f"{run} --samples 16 --sampling {sampling}"
        yield Case(f"workspace resumed {sampling} interrupted", [again, keep_lines("w.csv", 14), f"{again} --resume"],
                   files)
        yield Case(f"workspace resumed {sampling} torn",
                   [again, keep_lines("w.csv", 12, "9,1.0"), f"{again} --resume {outputs}"],
                   files)
    yield Case("workspace resumed head only", [f"{run} --samples 9", keep_lines("w.csv", 8),
                                               f"{run} --samples 9 --resume"],
               files, ends=None)
    yield Case("workspace resumed from nothing", [f"{run} --samples 4 --resume"], files)


def walk():
    files = s.walker()
    run = "walk block.yaml gait.csv -o out"
    yield Case("walk text", [f"{run} --cycles 2"], files)
    yield Case("walk json", [f"{run} --cycles 1 --json"], files)
    yield Case("walk default cycles", [run], files)
    yield Case("walk too much friction", [f"{run} --cycles 1"], s.walker(
        feet="feet: [{marker: heel, forward: 90, backward: 90}, {marker: toe, forward: 90, backward: 90}]\n"), ends=1)
    yield Case("walk equal feet", [f"{run} --cycles 1"], s.walker(
        feet="feet: [{marker: heel, forward: 0.1, backward: 0.1}, {marker: toe, forward: 0.1, backward: 0.1}]\n"))
    yield Case("walk without times", [f"{run} --cycles 2"], s.walker(gait="tendon\n0\n2\n0\n"))
    yield Case("walk resumed complete", [f"{run} --cycles 1", f"{run} --cycles 1 --resume"], files)
    yield Case("walk resumed complete json", [f"{run} --cycles 1", f"{run} --cycles 1 --resume --json"], files)
    yield Case("walk resumed more cycles", [f"{run} --cycles 1", f"{run} --cycles 2 --resume"], files)
    yield Case("walk resumed interrupted", [f"{run} --cycles 2", keep_steps("out/report.json", 4),
                                            f"{run} --cycles 2 --resume"], files)
    yield Case("walk resumed torn shape", [f"{run} --cycles 1", keep_bytes("out/walk_0002.vtu", 500),
                                           f"{run} --cycles 1 --resume"],
               files)
    yield Case("walk resumed from nothing", [f"{run} --cycles 1 --resume"], files)
