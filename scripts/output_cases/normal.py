"""Outputs without what a clock gives, and with fewer digits where that is asked for."""

import base64
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


def inflated(data, words):
    """The blocks of an array of a .vtu as bytes. data: compressed; words: its header, of which sizes begin at the fourth."""
    at, parts = 0, []
    for size in words[3:]:
        parts.append(zlib.decompress(data[at:at + size]))
        at += size
    return b"".join(parts)


def inline_array(text):
    """An array in base64: its header, which is a text of its own, and its blocks."""
    blocks = struct.unpack_from("<Q", base64.b64decode(text[:12]))[0]
    end = -(-8 * (3 + blocks) // 3) * 4  # of the header's characters
    return inflated(base64.b64decode(text[end:]), struct.unpack(f"<{3 + blocks}Q", base64.b64decode(text[:end])))


def appended_array(data, offset):
    """An array of raw appended data, as softkin wrote them before."""
    blocks = struct.unpack_from("<Q", data, offset)[0]
    return inflated(data[offset + 8 * (3 + blocks):], struct.unpack_from(f"<{3 + blocks}Q", data, offset))


def values_text(kind, array, digits):
    if not digits or kind not in (b"Float64", b"Float32"):
        return [array.hex()]
    form, size = ("d", 8) if kind == b"Float64" else ("f", 4)
    values = struct.unpack(f"<{len(array) // size}{form}", array)
    scale = max((abs(v) for v in values if v == v), default=0)  # zeros of an array are not exact
    return [f"{round(v / scale, digits) + 0.0 if scale and v == v else v:.{digits}g}" for v in values]


def vtu_text(content, digits=None):
    """A .vtu of softkin as text, the same however its arrays are encoded; other files as they are.

    digits: how many significant ones stay of real numbers; None: all
    """
    head, _, data = content.partition(b'<AppendedData encoding="raw">\n_')
    binary = rb'<DataArray ([^>]*?) format="(?:binary">\s*([^<]*?)\s*</DataArray>|appended" offset="(\d+)"/>|ascii">\s*</DataArray>)'
    if not re.search(binary, head):
        return content
    arrays = []

    def taken_out(match):
        attributes, text, offset = match.groups()
        kind, name = re.search(rb'type="(\w+)" Name="([^"]*)"', attributes).groups()
        array = inline_array(text) if text else appended_array(data, int(offset)) if offset else b""
        arrays.extend([name.decode(), *values_text(kind, array, digits)])
        return b"<DataArray " + attributes + b"/>"

    head = re.sub(binary, taken_out, head).decode()
    return "\n".join([re.sub(r"</UnstructuredGrid>.*", "", head, flags=re.S), *arrays])
