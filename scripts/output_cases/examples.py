"""Cases of the shipped scenes, tables and pictures."""

from .case import Case, keep_steps

# commands by scene
SCENES = {
    "examples/cable_gripper/cable_gripper.yaml": "cable=0.95",
    "examples/cable_gripper_two_materials/a.yaml": "cable=0.95",
    "examples/cable_gripper_two_materials/b.yaml": "cable=0.95",
    "examples/dea_crawler/dea_crawler.yaml": "skin=0.9",
    "examples/dea_crawler/measured/crawler.yaml": "skin=6kV",
    "examples/pneumatic_finger/pneumatic_finger.yaml": "air=1.2",
    "examples/three_chamber_actuator/three_chamber_actuator.yaml": "air2=1.2",
    "examples/three_chamber_actuator/measured/actuator.yaml": "air1=120kPa",
    "examples/three_tendon_finger/three_tendon_finger.yaml": "tendon2=0.9",
    "examples/two_material_bar/two_material_bar.yaml": "",
}
PHYSICAL = {  # scenes of the physical formulation only
    "examples/bilayer/bilayer.yaml": "warm=60degC",
    "examples/paper_finger/paper_finger.yaml": "air=2kPa",
    "examples/dea_crawler/voltage/crawler.yaml": "skin=14kV",
    "examples/estimate/finger.yaml": "air=20",
    "examples/mckibben/mckibben.yaml": "air=50 --set load_fx=40",
    "examples/pouch_motor/pouch_motor.yaml": "air=10 --set load_fx=20",
    "examples/fibre_actuator/fibre_actuator.yaml": "air=20",
    "examples/magnetic_cantilever/magnetic_cantilever.yaml": "field=10",
    "examples/magnetic_crawler/magnetic_crawler.yaml": "field_x=0.5",
    "examples/pneumatic_finger/cycles/viscous_finger.yaml": "air=10",
    "examples/three_tendon_finger/creep/creeping_finger.yaml": "",
    "examples/two_finger_gripper/two_finger_gripper.yaml": "left.air=1.1 --set right.air=1.1",
}
DOCS = {"bar_10_30": "", "bar_7_08": "", "block_neo_hookean": "", "finger_order_1": "air=1.2",
        "finger_order_1_incompressible": "air=1.2", "finger_pressure": "air=200kPa", "finger_weight_1": "air=1.2",
        "finger_weight_20": "air=1.2"}


def setting(text):
    return f" --set {text}" if text else ""


def cases():
    return [*shapes(), *tasks(), *measured()]


def shapes():
    for scene, command in SCENES.items():
        name = scene.removeprefix("examples/").removesuffix(".yaml")
        yield Case(f"example {name} physical", [f"fk {scene}{setting(command)} --report r.json -o s.vtu"])
        yield Case(f"example {name} target",
                   [f"fk {scene}{setting(command)} --formulation target-shape --report r.json --image i.png"])
    for scene, command in PHYSICAL.items():
        name = scene.removeprefix("examples/").removesuffix(".yaml")
        yield Case(f"example {name}", [f"fk {scene}{setting(command)} --report r.json -o s.vtu"])
    for name, command in DOCS.items():
        yield Case(f"scene {name}", [f"fk docs/scenes/{name}.yaml{setting(command)} --report r.json -o s.vtu"])
    yield Case("scene block_svk", ["fk docs/scenes/block_svk.yaml --report r.json"])
    for folder in ("cable_gripper", "pneumatic_finger", "three_chamber_actuator"):
        yield Case(f"example {folder} check", [f"mesh check examples/{folder}/{folder}.yaml",
                                               f"mesh info examples/{folder}/{folder}.msh"])
    yield Case("example local-global",
               ["fk examples/pneumatic_finger/pneumatic_finger.yaml --formulation target-shape --set air=1.1 "
                                        "--solver local-global --solver-tolerance 1e-3 --max-iterations 300 --report r.json"],
               ends=None)


def tasks():
    three = "examples/three_tendon_finger/three_tendon_finger.yaml"
    short = {"path.csv": "t_s,x_mm,z_mm\n0,76,74\n0.5,78.0706,73.7274\n1,80,72.9282\n"}
    follow = f"follow {three} path.csv --formulation target-shape -o out"
    yield Case("example follow", [follow, keep_steps("out/report.json", 1), f"{follow} --resume"], short)
    yield Case("example drive", [f"drive {three} examples/three_tendon_finger/path.csv --return --gcode a.gcode",
                                 f"drive {three} examples/three_tendon_finger/path.csv --dry-run --json"], clock=False)
    yield Case("example drive too fast", [f"drive {three} docs/scenes/too_fast.csv --dry-run"], ends=2)
    yield Case("example workspace",
               [f"workspace {three} --formulation target-shape --samples 8 -o w.csv --cloud c.vtu --plot p.svg "
                "--hull h.stl"],
               ends=None)
    actuator = "examples/three_chamber_actuator/three_chamber_actuator.yaml"
    yield Case("example ik",
               [f"ik {actuator} --target tip=4,-2,138.2 --formulation target-shape --report r.json -o s.vtu"],
               ends=None)
    yield Case("example ik physical", [f"ik {actuator} --target tip=4,-2,138.2 --report r.json"], ends=None)
    crawler = "examples/dea_crawler/dea_crawler.yaml"
    gait = {"gait.csv": "t_s,skin\n0,0.7\n0.5,0.9\n1,0.7\n", "kv.csv": "t_s,skin_kV\n0,0\n0.5,5\n1,0\n"}
    yield Case("example walk", [f"walk {crawler} gait.csv --cycles 1 -o out"], gait)
    walk = f"walk {crawler} gait.csv --cycles 2 --formulation target-shape -o out"
    yield Case("example walk target", [walk, keep_steps("out/report.json", 2), f"{walk} --resume"], gait)
    yield Case("example walk by voltage", ["walk examples/dea_crawler/measured/crawler.yaml kv.csv --cycles 1 "
                                           "--formulation target-shape -o out"], gait)


def measured():
    pictures = "docs/images/measure"
    bar = (f"measure {pictures}/rest.png {pictures}/stretched.png --interface red,blue --dots green,yellow "
           "--scale green,yellow=60mm")
    yield Case("measure specimen", [f"{bar} -o s.csv"])
    yield Case("measure specimen json", [f"{bar} --json"], ends=None)
    yield Case("measure track",
               [f"measure {pictures}/track --fps 20 --dots tip=red,green,yellow --scale green,yellow=30mm -o t.csv"])
    yield Case("measure board", ["measure board 5x4,tag=30mm,gap=8mm -o b.svg",
                                 "measure board charuco,7x5,square=10mm,tag=7mm -o c.svg",
                                 "measure board 5x4,tag=12mm,gap=3mm -o b.png",
                                 "measure b.png --scale-board 5x3,tag=12mm,gap=3mm --tags"])
    yield Case("measure camera help", ["measure camera --help"])
    for name, options in (("no dot", "--dots magenta --scale 0,0,100,0=20mm"), ("no scale", "--dots red"),
                          ("no unit", "--dots red --scale 0,0,100,0=20"),
                          ("colour", "--dots rde --scale 0,0,100,0=20mm"),
                          ("no board", "--dots red --scale-board 5x4,tag=12mm,gap=3mm"),
                          ("nothing", "--scale 0,0,100,0=20mm")):
        yield Case(f"measure refuses {name}", [f"measure {pictures}/rest.png {options}"], ends=2)
