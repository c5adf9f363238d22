#!/usr/bin/env python3
"""Checks that a changed softkin has the same outputs as an older build.

The script runs every case of scripts/output_cases with both programs, each in a new folder, and compares standard
output, standard error, exit codes and all files at the end byte by byte, except for times. It needs only Python.

With --targets one program runs its examples with each of these instruction sets, and the script prints the largest
differences of the numbers in the reports from those of the first, by unit. Exit code 1 means that texts or exit codes
differ.
"""

import argparse
import concurrent.futures
import difflib
import fnmatch
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
from output_cases import all_cases
from output_cases.between import compared
from output_cases.normal import normal_text, vtu_text

ROOT = pathlib.Path(__file__).resolve().parent.parent
SECONDS = 300  # time limit of a command; the script kills a slower one, which counts as a difference
TEXTS = {".json", ".csv", ".yaml", ".svg", ".gcode", ".pvd", ".txt", ".msh", ".mesh", ".node", ".ele", ".face", ".inp",
         ".tet"}


def copy_examples(case, folder):
    """Copies the files of examples and docs that a case names, so that paths are those of the checkout."""
    named = {match for words in case.words() for match in re.findall(r"examples/\w+|docs/(?:scenes|images/measure)",
                                                                     words)}
    for name in sorted(named):  # scenes of one folder with meshes of another
        texts = [scene.read_text() for scene in (ROOT / name).glob("*.yaml")] if name.startswith("examples/") else []
        named |= {f"examples/{other}" for text in texts for other in re.findall(r"\.\./(\w+)/", text)}
    if "docs/scenes" in named:
        named |= {"examples/pneumatic_finger", "examples/two_material_bar"}
    for name in sorted(named):
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, folder / name)


def run_case(program, case, folder, target=None):
    """Runs a case; returns the bytes of its outputs and files by name, and the last exit code."""
    folder.mkdir(parents=True)
    copy_examples(case, folder)
    for name, content in case.files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    environment = {"PATH": os.environ.get("PATH", ""), "LC_ALL": "C", "HOME": str(folder)}
    if target:
        environment["SOFTKIN_TARGET"] = target
    outputs, code = {}, None
    for number, step in enumerate(case.steps, 1):
        if callable(step):
            try:
                step(folder)
            except (OSError, ValueError, KeyError) as error:  # the previous command has not written such a file
                outputs[f"step {number} fails"] = f"{type(error).__name__}: {error}\n".encode()
            continue
        title = f"{number}: softkin {' '.join(step)[:100]}"
        try:
            ended = subprocess.run([program, *step], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                                   capture_output=True, timeout=SECONDS, check=False)
            code = ended.returncode
            outputs |= {title + " > standard output": ended.stdout, title + " > standard error": ended.stderr}
        except subprocess.TimeoutExpired:
            code = "killed"
        outputs[title + " > exit code"] = f"{code}\n".encode()
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            outputs[str(path.relative_to(folder))] = path.read_bytes()
    replacements = [(str(folder).encode(), b"FOLDER"), (str(pathlib.Path(program).parent).encode(), b"PROGRAM_FOLDER")]
    for name, content in outputs.items():
        for text, by in replacements:
            content = content.replace(text, by)
        outputs[name] = content
    return outputs, code


def comparable(name, content, case, digits):
    """Returns the part of an output to be compared: a text without times, or all bytes."""
    suffix = pathlib.Path(name).suffix.lower()
    if suffix == ".vtu":
        return vtu_text(content, digits)
    if suffix in TEXTS or " > " in name:
        try:
            return normal_text(content.decode(), case.clock, digits)
        except UnicodeDecodeError:
            return content
    return content


def window(line, other):
    """Returns the part of a line where it differs from the other one."""
    first = next((i for i, (a, b) in enumerate(zip(line, other)) if a != b), min(len(line), len(other)))
    start = max(0, first - 60) if len(line) > 160 else 0
    return ("..." if start else "") + line[start:start + 160] + ("..." if len(line) > start + 160 else "")


def shown_difference(old, new, max_lines=6):
    """Returns the first lines that differ."""
    if isinstance(old, bytes) or isinstance(new, bytes):
        return [f"  {len(old)} and {len(new)} bytes that differ"]
    a, b, shown = old.splitlines(), new.splitlines(), []
    if len(a) + len(b) > 6000:
        blocks = [("replace", i, i + 1, i, i + 1) for i, pair in enumerate(zip(a, b)) if pair[0] != pair[1]]
        blocks = blocks or [("replace", len(b), len(a), len(a), len(b))]
    else:
        blocks = [o for o in difflib.SequenceMatcher(None, a, b, autojunk=False).get_opcodes() if o[0] != "equal"]
    for _, i, j, k, m in blocks:
        for n in range(max(j - i, m - k)):
            before, after = (a[i + n] if i + n < j else None), (b[k + n] if k + n < m else None)
            if before is not None:
                shown.append(f"  -{i + n + 1}: " + window(before, after or ""))
            if after is not None:
                shown.append(f"  +{k + n + 1}: " + window(after, before or ""))
            if len(shown) >= max_lines:
                return shown + ["  ..."]
    return shown or ["  only the ends of lines differ"]


def differences(case, old, new, digits):
    """Returns lines that describe the differences."""
    lines = []
    for name in sorted(old.keys() | new.keys()):
        if name not in old or name not in new:
            lines.append(f"  {name}: only of the {'old' if name in old else 'new'} program")
        elif old[name] != new[name]:
            before, after = (comparable(name, content, case, digits) for content in (old[name], new[name]))
            if before != after:
                lines += [f"  {name}:", *("  " + line for line in shown_difference(before, after))]
    return lines


def check(case, programs, folder, digits, keep):
    """Runs a case with both programs; returns its name, its differences, and the seconds of each program."""
    outputs, codes, seconds = [], [], []
    for program, name in zip(programs, ("old", "new")):  # names of one length, since tables may contain them
        begin = time.monotonic()
        output, code = run_case(program, case, folder / name)
        seconds.append(time.monotonic() - begin)
        outputs.append(output)
        codes.append(code)
    lines = differences(case, *outputs, digits)
    lines += [f"  the case is wrong: {name}: {text.decode().strip()}" for name, text in outputs[0].items()
              if name.endswith(" fails")]
    if case.ends is not None and codes[0] != case.ends:
        errors = [text.decode(errors="replace").strip() for name, text in outputs[0].items()
                  if name.endswith("standard error")]
        lines.append(f"  the case is wrong: the old program ends with {codes[0]}, not with {case.ends}: {errors[-1:]}")
    if not keep:
        shutil.rmtree(folder)
    return case.name, lines, seconds


def between_targets(program, targets, cases, base):
    """Prints the largest differences of every case; returns the exit code."""
    largest, num_wrong = {}, 0
    for number, case in enumerate(cases):
        outputs = {}
        for target in targets:
            folder = base / f"{number:03d}" / target
            outputs[target], code = run_case(program, case, folder, target)
            if case.ends is not None and code != case.ends:
                errors = [text.decode().strip() for name,
                          text in outputs[target].items() if name.endswith("standard error")]
                print(f"{case.name}: {target}: ends with {code}, not with {case.ends}: {errors[-1:]}")
                num_wrong += 1
            shutil.rmtree(folder)
        for target in targets[1:]:
            by_unit, other = compared(outputs[targets[0]], outputs[target])
            text = ", ".join(f"{difference:.1e} {unit.replace('-', 'without unit')} ({relative:.0e})"
                             for unit, (difference, relative) in sorted(by_unit.items()))
            print(f"{case.name}: {target}: {text or 'the same numbers'}", *("  " + line for line in other), sep="\n",
                  flush=True)
            num_wrong += bool(other)
            for unit, (difference, relative) in by_unit.items():
                before = largest.get((target, unit), (0, 0))
                largest[target, unit] = max(before[0], difference), max(before[1], relative)
    for (target, unit), (difference, relative) in sorted(largest.items()):
        reference = "the number, or to 1" if unit == "-" else "the largest number of the report, or to 1"
        print(f"{target} and {targets[0]}: a difference of at most "
              f"{difference:.1e} {unit.replace('-', 'without unit')}; "
              f"at most {relative:.0e} relative to {reference}")
    print(f"{len(cases)} cases, {num_wrong} with different texts or exit codes")
    return 1 if num_wrong else 0


def has_measure(program):
    """Returns whether softkin-measure is next to a program."""
    return pathlib.Path(program).with_name("softkin-measure").exists()


def chosen_cases(options, programs):
    """Returns the cases of --only that both programs can run."""
    cases = [case for case in all_cases() if not options.only or
             any(fnmatch.fnmatch(case.name, f"*{pattern}*") for pattern in options.only)]
    if not all(has_measure(program) for program in programs):
        left_out = [case for case in cases if case.name.startswith("measure")]
        cases = [case for case in cases if case not in left_out]
        if left_out:
            print(f"left out: {len(left_out)} cases of measure, as softkin-measure is not next to both programs")
    return cases


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", metavar="OLD_PROGRAM")
    parser.add_argument("new", metavar="NEW_PROGRAM", nargs="?", help="omit with --targets")
    parser.add_argument("--targets", metavar="A,B,...",
                        help="instruction sets by their names in SOFTKIN_TARGET, such as avx512,avx2,sse4")
    parser.add_argument("--only", metavar="PATTERN", action="append",
                        help="cases whose name contains this; * matches any text, ? any character")
    parser.add_argument("--jobs", metavar="N", type=int, default=1,
                        help="number of cases that run at once (default: 1)")
    parser.add_argument("--keep", metavar="DIR", type=pathlib.Path,
                        help="keep the folders of all cases here, NUMBER/old and NUMBER/new; --list prints numbers")
    parser.add_argument("--digits", metavar="N", type=int,
                        help="round numbers to N significant digits before they are compared")
    parser.add_argument("--list", action="store_true", help="print the names of the cases and run nothing")
    parser.add_argument("--slow", metavar="N", type=int, default=0, help="name the N slowest cases")
    options = parser.parse_args()
    if bool(options.targets) == bool(options.new):
        parser.error("give two programs, or one and --targets")
    programs = [str(pathlib.Path(program).resolve()) for program in (options.old, options.new) if program]
    cases = chosen_cases(options, programs)
    if options.targets:
        cases = [case for case in cases if case.name.startswith(("example ", "scene "))]
    if options.list:
        print(*(f"{number:03d}  {case.name}" for number, case in enumerate(cases)), sep="\n")
        return 0
    for program in programs:
        if not os.access(program, os.X_OK):
            parser.error(f"{program} is not an executable program")
    if not cases:
        parser.error("no case matches --only")
    if options.keep and options.keep.exists() and any(options.keep.iterdir()):
        parser.error(f"--keep {options.keep}: the folder is not empty")
    base = options.keep.resolve() if options.keep else pathlib.Path(tempfile.mkdtemp(prefix="same_outputs_"))
    num_different, durations = 0, []
    try:
        if options.targets:
            return between_targets(programs[0], options.targets.split(","), cases, base)
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            def checked(number):
                return check(cases[number], programs, base / f"{number:03d}", options.digits, options.keep)

            for name, lines, seconds in pool.map(checked, range(len(cases))):
                print(f"{'differs' if lines else 'OK'}  {name}", *lines, sep="\n", flush=True)
                num_different += bool(lines)
                durations.append((seconds, name))
    finally:
        if not options.keep:
            shutil.rmtree(base, ignore_errors=True)
    for seconds, name in sorted(durations, reverse=True)[:options.slow]:
        print(f"{seconds[0]:8.2f} s {seconds[1]:8.2f} s  {name}")
    old, new = (sum(seconds[i] for seconds, _ in durations) for i in (0, 1))
    print(f"{len(cases)} cases, {num_different} differ; {old:.0f} s of the old program, {new:.0f} s of the new one")
    return 1 if num_different else 0


if __name__ == "__main__":
    sys.exit(main())
