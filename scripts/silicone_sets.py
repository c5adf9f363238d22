#!/usr/bin/env python3
"""Makes the table of fitted silicones in src/softkin/io/scene/silicone_sets.cpp from measured curves.

The curves are those of the Soft Robotics Materials Database (Marechal et al., doi 10.1089/soro.2019.0115,
https://github.com/LucMarechal/Soft-Robotics-Materials-Database), whose licence, ODbL 1.0, keeps them out of this
repository; the licence does not cover constants that are fitted to them.

    scripts/silicone_sets.py CURVES                print the table
    scripts/silicone_sets.py CURVES --write        put it into the source
    scripts/silicone_sets.py CURVES --check        fail if the source has other constants
    scripts/silicone_sets.py CURVES --markdown     print the table of docs/materials.md
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path

SOURCE = Path(__file__).parent.parent / "src/softkin/io/scene/silicone_sets.cpp"
BEGIN, END = "      // begin of the table\n", "      // end of the table\n"
CURVES = {
    "ecoflex-00-10": "Ecoflex_00-10.csv",
    "ecoflex-00-30": "Ecoflex_00-30.csv",
    "dragon-skin-10": "Dragon_Skin_10_MEDIUM.csv",
    "dragon-skin-30": "Dragon_Skin_30.csv",
}
UP_TO = 2  # strain; robots strain by 0.5 to 1.5, locally by more
# name of the set, law of softkin calibrate, law of the source
SETS = (
    ("yeoh", "yeoh", "yeoh"),
    ("ogden", "ogden-2", "ogden"),
    ("mooney-rivlin", "mooney-rivlin", "mooney_rivlin"),
    ("neo-hookean", "neo-hookean", "neo_hookean"),
)


def constants(law, fit):
    """Returns the constants of a fit in the order of SiliconeSet."""
    if law == "neo-hookean":
        return [2 * fit["c10_MPa"]]
    if law == "mooney-rivlin":
        return [fit["c10_MPa"], fit["c01_MPa"]]
    if law == "yeoh":
        return [fit["c10_MPa"], fit["c20_MPa"], fit["c30_MPa"]]
    terms = sum(1 for key in fit if key.startswith("alpha"))
    return [fit[key] for p in range(1, terms + 1) for key in (f"mu{p}_MPa", f"alpha{p}")]


def fits(softkin, curves):
    """Yields material, set, law, constants and fit of each set."""
    for material, file in CURVES.items():
        command = [softkin, "calibrate", "material", "--tensile", str(curves / file), "--up-to", str(UP_TO), "--json"]
        report = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        for name, law, enum in SETS:
            fit = report["laws"][law]
            yield material, name, enum, constants(name, fit), fit


def rows(softkin, curves):
    """Yields the lines of the table of the source."""
    for material, name, enum, values, fit in fits(softkin, curves):
        numbers = ", ".join(f"{value:.5g}" for value in values)
        yield (f'      {{"{material}", "{name}", Law::{enum}, {{{numbers}}}, {UP_TO}, '
               f'{fit["rms_percent_of_largest_stress"]:.2g}}},\n')


def markdown(softkin, curves):
    """Yields the lines of the table of docs/materials.md."""
    yield "| `material` | `set` | constants [MPa] | E at small strain [MPa] | rms of the largest stress |\n"
    yield "|---|---|---|---|---|\n"
    keys = {"yeoh": ("c10", "c20", "c30"), "mooney-rivlin": ("c10", "c01"), "neo-hookean": ("mu",),
            "ogden": ("mu1", "alpha1", "mu2", "alpha2", "mu3", "alpha3")}
    for material, name, _, values, fit in fits(softkin, curves):
        text = ", ".join(f"{key} {value:.5g}" for key, value in zip(keys[name], values))
        yield (f"| `{material}` | `{name}` | {text} | {fit['youngs_modulus_MPa']:.3g} | "
               f"{fit['rms_percent_of_largest_stress']:.2g} % |\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("curves", type=Path, help="folder of the database's .csv files")
    parser.add_argument("--softkin", default="build/softkin", help="the program")
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--write", action="store_true", help="put the table into the source")
    what.add_argument("--check", action="store_true", help="compare the table with the source")
    what.add_argument("--markdown", action="store_true", help="print the table of the document")
    options = parser.parse_args()
    missing = [file for file in CURVES.values() if not (options.curves / file).is_file()]
    if missing:
        sys.exit(f"{options.curves} does not contain {', '.join(missing)}; give the folder of the database's tables")
    if options.markdown:
        sys.stdout.writelines(markdown(options.softkin, options.curves))
        return
    table = "".join(rows(options.softkin, options.curves))
    source = SOURCE.read_text()
    begin, end = source.index(BEGIN) + len(BEGIN), source.index(END)
    if options.write:
        SOURCE.write_text(source[:begin] + table + source[end:])
    elif options.check:
        if "".join(source[begin:end].split()) != "".join(table.split()):
            sys.exit(f"{SOURCE} has other constants; --write replaces them by these:\n{table}")
    else:
        sys.stdout.write(table)


if __name__ == "__main__":
    main()
