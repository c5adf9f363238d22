"""A control loop at 50 Hz: the tip of a beam chases a target that moves; prints how well the loop kept time."""

# %%
import time

import numpy as np
from beam import three_chamber_beam

PERIOD_S = 0.02
ROUNDS = 100

session = three_chamber_beam().session()
angles = np.linspace(0, 2 * np.pi, ROUNDS)
targets = [session.solve(air1=1.1 + 0.05 * np.sin(a), air2=1.1 + 0.05 * np.cos(a))["tip"] for a in angles]

# %%
late, errors = [], []
begin = time.perf_counter()
for tick in range(ROUNDS):
    due = begin + tick * PERIOD_S
    time.sleep(max(0.0, due - time.perf_counter()))
    late.append(time.perf_counter() - due)
    errors.append(session.inverse(tip=targets[tick]).error_mm)
over = sum(1 for each in late if each > PERIOD_S)
print(f"{ROUNDS} rounds of {1e3 * PERIOD_S:.0f} ms in {time.perf_counter() - begin:.2f} s")
print(f"began late by {1e3 * np.median(late):.2f} ms in the middle, {1e3 * max(late):.1f} ms at most; {over} by a round")
print(f"tip off its target by {np.median(errors):.4f} mm in the middle, {max(errors):.4f} mm at most")
