"""Lists the numbers and claims of the paper by part, each of which must be in exactly one row."""

from __future__ import annotations

from rows import Result

PRINTED: dict[str, tuple[str, ...]] = {
    "table1": ("symbols", "10^-5", "w_i = 5.0", "w_i = 1.0", "first step of 1.0", "tau = 0.1", "lambda = 0.2 mm", "i_max = 30"),
    "fig1": ("a finger by cable", "their target shapes"),
    "fig5": ("local-global iteration",),
    "fig6": ("less than 20 %", "less than 30 %", "stress-strain curves"),
    "fig7": ("3.75", "7.08", "5.68", "10.30", "under twisting", "a bar of two materials", "a printed specimen"),
    "fig8": ("flexible PLA", "larger than 45 %", "several instants"),
    "fig9": ("up to 240 degrees", "matches well", "the bending in a physical test", "more than 90 degrees"),
    "table3": ("45802", "8.5 s", "15.2 s", "23.2 s", "44774", "240, 529, 820 s", "288, 636, 1068 s", "44900", "3.8 s"),
    "calculix": ("13.6 min",),
    "fig10": ("lambda_init = 0.7", "locomotion", "[46]"),
    "fig11": ("three markers", "match those"),
    "fig12": ("a motor for each", "125 sample points", "8.3 s", "3375 sample points", "more than 5 min"),
    "fig12c": ("converges much faster",),
    "fig13": ("120 x 25 x 25", "N = 55", "38 s", "N = 85", "46 s"),
    "nearest": ("continuity",),
    "fig14": ("inside the feasible region",),
    "fig15": ("48 x 48 x 136", "pictures of the actuator", "individual chambers", "less than 3 mm"),
    "fig15c": ("100 ~ 240 kPa", "loading and unloading", "pressure of 100 kPa"),
    "fig15mesh": ("135k",),
    "fig16": ("configuration space", "from above", "less than 1 mm"),
    "fig17": ("nearly linear", "25.8k", "50 k tetrahedra", "25 fps", "E5-1653 3.5 GHz", "16 GB"),
    "fig17accuracy": ("more accurate results",),
}


def missing(results: dict[str, Result]) -> list[str]:
    """Returns one message for each number or claim of the completed parts that is not in exactly one row."""
    rows = [(f"{part}: {row.item}", row.printed) for part, result in results.items() for row in result.rows]
    faults = []
    for part in results:
        for words in PRINTED[part]:
            places = [item for item, printed in rows if words in printed]
            if len(places) != 1:
                faults.append(f"{part}: the paper prints '{words}', which is in {len(places)} rows "
                              f"instead of one: {', '.join(places)}")
    return faults
