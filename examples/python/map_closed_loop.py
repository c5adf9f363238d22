"""A controller at 1 kHz whose model is a kinematic map. The robot carries a payload of which the map does not know; a
camera at 50 Hz sees its tip, from which the controller learns how far off the map is. Prints the error of the tip
without and with the camera, and how long a tick of the controller takes."""

# %%
import importlib.util
import time

import numpy as np
from beam import three_chamber_beam

TICK_S, TICKS = 0.001, 5000
FRAME = 20  # ticks from picture to picture, and from a picture to when it is understood
NOISE_MM, TRUST, RATE = 0.02, 0.5, 50  # of the camera; in one picture [-]; at which errors fade [1/s]

robot = three_chamber_beam(payload_N=(0, -0.02, -0.05))
model = three_chamber_beam().map(accuracy_mm=0.02, shape_accuracy_mm=None, checks=20)
low, high = model.ranges.T
turns = 2 * np.pi * (np.arange(TICKS + 1)[:, None] / TICKS + np.arange(3) / 3)
around = model.solve(1.5 + 0.2 * np.cos(turns))
path = around["tip"]  # (TICKS + 1, 3) where the tip is to be [mm]
print(model)


# %%
def follow(camera: bool) -> tuple[list[float], list[float]]:
    """Error of the tip at each picture [mm], and the time of each tick [s]."""
    session, noise = robot.session(), np.random.default_rng(1)
    commands, offset, picture = around.commands[0], np.zeros(3), np.zeros(3)
    errors, times = [], []
    for tick in range(TICKS):
        if tick % FRAME == 0:
            tip = session.solve(commands).require()["tip"]
            seen, picture = picture, tip + noise.normal(0, NOISE_MM, 3) - model.solve(commands)["tip"]
            errors.append(float(np.linalg.norm(tip - path[tick])))
        begin = time.perf_counter()
        if camera and tick % FRAME == 0:
            offset = offset + TRUST * (seen - offset)
        here = model.solve(commands, jacobian=True)
        move = path[tick + 1] - path[tick] + RATE * TICK_S * (path[tick] - here["tip"] - offset)
        commands = np.clip(commands + np.linalg.lstsq(here.jacobian("tip"), move, rcond=1e-3)[0], low, high)
        times.append(time.perf_counter() - begin)
    return errors, times


(blind, _), (errors, times) = follow(camera=False), follow(camera=True)
print(f"tip off its path: {np.median(blind):.2f} mm without the camera, {np.median(errors):.3f} mm with it")
middle, longest = 1e6 * np.median(times), 1e6 * np.quantile(times, 0.99)
print(f"a tick takes {middle:.0f} us in the middle, up to {longest:.0f} us in 99 of 100")

# %%
if importlib.util.find_spec("matplotlib"):
    import matplotlib.pyplot as plt

    for name, values in (("without the camera", blind), ("with it", errors)):
        plt.plot(FRAME * TICK_S * np.arange(len(values)), values, label=name)
    plt.gca().set(xlabel="time [s]", ylabel="tip off its path [mm]", ylim=(0, None))
    plt.legend()
    plt.savefig("map_closed_loop.png", dpi=120)
