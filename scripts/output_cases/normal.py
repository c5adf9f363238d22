"""Normalises outputs: without times, and with fewer digits on request."""

import base64
import re
import struct
import zlib

DURATION = r"\d+ s\b|\d+ min \d+ s\b|\d+ h \d+ min\b"
CLOCK = [  # pattern and replacement
    (re.compile(r'("(?:seconds|elapsed_s)":\s*)(?:[-+0-9.eE]+|\[[^\]]*\])'), r"\1CLOCK"),
    (re.compile(r"((?:equilibrium|equilibria|equilibria per waypoint), )\d+\.\d\d s$", re.M), r"\1CLOCK"),
    (re.compile(rf"( converged; )(?:{DURATION})$", re.M), r"\1CLOCK"),
]
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?(?![\w.])")
FINGERPRINT = re.compile(r'("shape_fingerprint":\s*)"[^"]*"')  # depends on all digits of a shape


def without_time_column(text):
    """Replaces the cells below `time [s]` in tables of steps, a right-aligned column of at least 8 characters."""
    lines, end = text.split("\n"), None
    for i, line in enumerate(lines):
        if "time [s]  status" in line:
            end = line.index("time [s]") + 8
        elif end and (cell := re.search(r" *\d+\.\d\d$", line[:end])) and line[end:end + 2] == "  ":
            lines[i] = line[:cell.start()] + "  CLOCK" + line[end:]
    return "\n".join(lines)


def rounded(text, digits):
    """Rounds the numbers of a text to significant digits."""
    def number(match):
        return f"{float(match.group()):.{digits}g}" if re.search(r"[.eE]", match.group()) else match.group()
    return FINGERPRINT.sub(r"\1ROUNDED", NUMBER.sub(number, text))


def normal_text(text, clock=True, digits=None):
    """Returns a normalised text. clock: whether to remove times; digits: number of significant digits."""
    if clock:
        text = without_time_column(text)
        for pattern, by in CLOCK:
            text = pattern.sub(by, text)
    if digits:
        text = re.sub(r" +", " ", rounded(text, digits))
    return text


def inflated(data, words):
    """Returns the bytes of an array of a .vtu. data: compressed blocks; words: header, with sizes from the fourth."""
    offset, parts = 0, []
    for size in words[3:]:
        parts.append(zlib.decompress(data[offset:offset + size]))
        offset += size
    return b"".join(parts)


def inline_array(text):
    """Returns the bytes of an array in base64, whose header is encoded separately from its blocks."""
    blocks = struct.unpack_from("<Q", base64.b64decode(text[:12]))[0]
    end = -(-8 * (3 + blocks) // 3) * 4  # number of characters of the header
    return inflated(base64.b64decode(text[end:]), struct.unpack(f"<{3 + blocks}Q", base64.b64decode(text[:end])))


def appended_array(data, offset):
    """Returns the bytes of an array of raw appended data, as older versions of softkin write it."""
    blocks = struct.unpack_from("<Q", data, offset)[0]
    return inflated(data[offset + 8 * (3 + blocks):], struct.unpack_from(f"<{3 + blocks}Q", data, offset))


def values_text(kind, array, digits):
    """Returns the values of an array as texts, real numbers with digits relative to the largest one."""
    if not digits or kind not in (b"Float64", b"Float32"):
        return [array.hex()]
    form, size = ("d", 8) if kind == b"Float64" else ("f", 4)
    values = struct.unpack(f"<{len(array) // size}{form}", array)
    scale = max((abs(v) for v in values if v == v), default=0)  # zeros of an array may have rounding errors
    return [f"{round(v / scale, digits) + 0.0 if scale and v == v else v:.{digits}g}" for v in values]


def vtu_text(content, digits=None):
    """Returns a .vtu of softkin as text that does not depend on the encoding of its arrays; other files unchanged.

    digits: number of significant digits of real numbers; None for all
    """
    head, _, data = content.partition(b'<AppendedData encoding="raw">\n_')
    binary = rb'<DataArray ([^>]*?) format="(?:binary">\s*([^<]*?)\s*</DataArray>|appended" offset="(\d+)"/>|ascii">\s*</DataArray>)'
    if not re.search(binary, head):
        return content
    arrays = []

    def extract(match):
        attributes, text, offset = match.groups()
        kind, name = re.search(rb'type="(\w+)" Name="([^"]*)"', attributes).groups()
        array = inline_array(text) if text else appended_array(data, int(offset)) if offset else b""
        arrays.extend([name.decode(), *values_text(kind, array, digits)])
        return b"<DataArray " + attributes + b"/>"

    head = re.sub(binary, extract, head).decode()
    return "\n".join([re.sub(r"</UnstructuredGrid>.*", "", head, flags=re.S), *arrays])
