"""Outputs without what a clock gives, and with fewer digits where that is asked for."""

import re
import struct
import zlib

DURATION = r"\d+ s\b|\d+ min \d+ s\b|\d+ h \d+ min\b"
CLOCK = [  # what is found, and what takes its place
    (re.compile(r'("(?:seconds|elapsed_s)":\s*)(?:[-+0-9.eE]+|\[[^\]]*\])'), r"\1CLOCK"),
    (re.compile(r"((?:equilibrium|equilibria|equilibria per waypoint), )\d+\.\d\d s$", re.M), r"\1CLOCK"),
    (re.compile(rf"( converged; )(?:{DURATION})$", re.M), r"\1CLOCK"),
]
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?(?![\w.])")
FINGERPRINT = re.compile(r'("shape_fingerprint":\s*)"[^"]*"')  # of all digits of a shape


def without_time_column(text):
    """Tables of steps without what stands below `time [s]`, which is 8 characters wide or more, right-aligned."""
    lines, end = text.split("\n"), None
    for i, line in enumerate(lines):
        if "time [s]  status" in line:
            end = line.index("time [s]") + 8
        elif end and (cell := re.search(r" *\d+\.\d\d$", line[:end])) and line[end:end + 2] == "  ":
            lines[i] = line[:cell.start()] + "  CLOCK" + line[end:]
    return "\n".join(lines)


def rounded(text, digits):
    def number(match):
        return f"{float(match.group()):.{digits}g}" if re.search(r"[.eE]", match.group()) else match.group()
    return FINGERPRINT.sub(r"\1ROUNDED", NUMBER.sub(number, text))


def normal_text(text, clock=True, digits=None):
    """clock: whether times are taken out; digits: how many significant ones stay."""
    if clock:
        text = without_time_column(text)
        for pattern, by in CLOCK:
            text = pattern.sub(by, text)
    if digits:
        text = re.sub(r" +", " ", rounded(text, digits))
    return text


def inflated(data, offset):
    """An array of the appended data of a .vtu, compressed in blocks, as bytes."""
    blocks = struct.unpack_from("<Q", data, offset)[0]
    sizes = struct.unpack_from(f"<{blocks}Q", data, offset + 24)
    at, parts = offset + 24 + 8 * blocks, []
    for size in sizes:
        parts.append(zlib.decompress(data[at:at + size]))
        at += size
    return b"".join(parts)


def rounded_vtu(content, digits):
    """The arrays of a .vtu of softkin as text; other files as they are."""
    head, mark, data = content.partition(b'<AppendedData encoding="raw">\n_')
    if not mark:
        return content
    lines = [re.sub(r' offset="\d+"', "", head.decode())]
    for kind, name, offset in re.findall(rb'<DataArray type="(\w+)" Name="([^"]*)"[^>]* offset="(\d+)"', head):
        array = inflated(data, int(offset))
        if kind in (b"Float64", b"Float32"):
            form, size = ("d", 8) if kind == b"Float64" else ("f", 4)
            values = struct.unpack(f"<{len(array) // size}{form}", array)
            scale = max((abs(v) for v in values if v == v), default=0)  # zeros of an array are not exact
            lines += [name.decode()] + [f"{round(v / scale, digits) + 0.0 if scale and v == v else v:.{digits}g}"
                                        for v in values]
        else:
            lines += [name.decode(), array.hex()]
    return "\n".join(lines)
