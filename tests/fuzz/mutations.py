"""Changes of a valid file that know its form: numbers, lines, keys, chunks of an image, members of an archive, frames.

A change of random bytes is refused by the first checksum or the first parser. These keep the form, so that what is
wrong reaches the code behind it.
"""

import binascii
import io
import json
import random
import re
import struct
import zipfile
import zlib
from collections.abc import Callable, Sequence
from typing import Any

from hil.framings.cobs import stuffed, unstuffed
from hil.framings.framed import crc16

MAX_BYTES = 1 << 18
"""Largest input; the limits of the readers themselves are tested one by one."""
NUMBERS = (
    "0", "-0", "-0.0", "1", "-1", "2", "3", "7", "255", "256", "65535", "65536", "1e308", "-1e308", "1e-308", "5e-324",
    "1e400", "nan", "NaN", "inf", "-inf", "Infinity", "-Infinity", ".nan", ".inf", "4294967296", "9007199254740993",
    "9223372036854775807", "9223372036854775808", "-9223372036854775809", "9" * 30, "9" * 400, "9" * 5000, "0x10",
    "1_0", "1,5", "\u0663", "\uff11", "1e5", "1.", ".5", "+1", "--1", "1e9", "1e12", "1e16", "0.1", "",
)  # fmt: skip
WORDS = (
    "", " ", "\t", "\x00", "\ufeff", "\u202e", "\u2028", "\U0001f916", "e\u0301", "é", "null", "true", "~", "../..",
    "/", "/etc/passwd", "..", ".", "a" * 300, "a/" * 80, "%s", "{}", "[]", "- ", ": ", "#", '"', "'", ",", ";", "\r",
    "\n", "\r\n", "*a", "&a x", "!!python/object:os.system ", "<<: {}", "---\n", "extends: smoke",
    "{uniform: [0, 1]}", "{choice: []}", "[" * 40, "[" * 2000, '{"a":' * 2000, "-", "=", "CON", "nul\n", "\ud7ff",
    "\x7f", "\x1b[2J",
)  # fmt: skip
SIDES = (0, 1, 16, 24, 32, 4096, 65535)
"""Width or height [px] of an image. One of 8192 x 8192 is allowed and takes a second or two in each command."""
_NUMBER = re.compile(r"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")
_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_PNG, _JPEG, _ZIP = b"\x89PNG\r\n\x1a\n", b"\xff\xd8", b"PK\x03\x04"

Change = Callable[[bytes, random.Random], bytes]


def mutated(data: bytes, others: Sequence[bytes], draw: random.Random) -> bytes:
    """Return the input after one to four changes, with pieces of other inputs.

    An input that names the file which it replaces in a folder keeps its first line, the name, as a rule.
    """
    name, content = _name_and_content(data)
    if name and draw.random() < 0.03:
        name, content = b"", data
    for _ in range(draw.choice((1, 1, 1, 2, 2, 3, 4))):
        content = _changed(content, others, draw)[:MAX_BYTES]
    return name + content


def _name_and_content(data: bytes) -> tuple[bytes, bytes]:
    end = data.find(b"\n", 0, 200) + 1
    line = data[:end]
    is_name = b"/" in line or b"." in line
    return (line, data[end:]) if line.startswith(b"@") and is_name else (b"", data)


def _changed(data: bytes, others: Sequence[bytes], draw: random.Random) -> bytes:
    chance = draw.random()
    if chance < 0.12:
        return _spliced(data, _name_and_content(draw.choice(others))[1], draw)
    if chance < 0.30:
        return draw.choice(_BYTES)(data, draw)
    change = _form(data)
    try:
        return change(data, draw)
    except Exception:  # noqa: BLE001 - an earlier change has broken the form in one of many ways
        return draw.choice(_BYTES)(data, draw)


def _form(data: bytes) -> Change:
    if data.startswith(_PNG):
        return _png
    if data.startswith(_JPEG):
        return _jpeg
    if data.startswith(_ZIP):
        return _archive
    if data.startswith(b"\0") and data.count(b"\0") >= 2:
        return _frames
    if data.lstrip()[:1] in {b"{", b"["}:
        return _json
    return _text


def _spliced(data: bytes, other: bytes, draw: random.Random) -> bytes:
    at, begin = draw.randint(0, len(data)), draw.randint(0, len(other))
    return data[:at] + other[begin : begin + draw.choice((1, 8, 100, len(other)))] + data[draw.randint(at, len(data)) :]


def _flip(data: bytes, draw: random.Random) -> bytes:
    changed = bytearray(data or b"\0")
    changed[draw.randrange(len(changed))] ^= 1 << draw.randrange(8)
    return bytes(changed)


def _cut(data: bytes, draw: random.Random) -> bytes:
    begin = draw.randint(0, len(data))
    return data[:begin] + data[begin + draw.choice((1, 2, 10, 100, len(data))) :]


def _insert(data: bytes, draw: random.Random) -> bytes:
    at = draw.randint(0, len(data))
    piece = draw.choice(
        (draw.randbytes(draw.randint(1, 8)), draw.choice(WORDS).encode(), draw.choice(NUMBERS).encode())
    )
    return data[:at] + piece + data[at:]


def _repeat(data: bytes, draw: random.Random) -> bytes:
    begin = draw.randint(0, len(data))
    end = min(len(data), begin + draw.choice((1, 10, 200, 2000)))
    times = max(1, min(draw.choice((2, 3, 50, 3000)), MAX_BYTES // max(1, end - begin)))
    return data[:begin] + data[begin:end] * times + data[end:]


def _large_bytes(data: bytes, draw: random.Random) -> bytes:
    """Put an extreme integer somewhere, as a length of a binary form might be."""
    at = draw.randint(0, max(0, len(data) - 4))
    value = draw.choice((0, 1, 0x7F, 0x80, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF))
    size, order = draw.choice(("B", "H", "I")), draw.choice("<>")
    limit = {"B": 0xFF, "H": 0xFFFF, "I": 0xFFFFFFFF}[size]
    packed = struct.pack(order + size, value & limit)
    return data[:at] + packed + data[at + len(packed) :]


_BYTES: tuple[Change, ...] = (_flip, _flip, _cut, _insert, _repeat, _large_bytes)


def _text(data: bytes, draw: random.Random) -> bytes:
    """Change a number, a word, a line or a column."""
    text = data.decode(errors="surrogateescape")
    lines = text.split("\n")
    choice, at = draw.randrange(8), draw.randrange(len(lines))
    if choice <= 2:
        text = _replaced(_NUMBER, text, draw.choice(NUMBERS), draw)
    elif choice == 3:
        word = draw.choice((*WORDS, *_WORD.findall(text)[:400]))
        text = _replaced(_WORD, text, word, draw)
    elif choice == 4:
        lines[at : at + draw.choice((1, 1, 5))] = []
    elif choice == 5:
        lines[at:at] = [lines[draw.randrange(len(lines))]] * draw.choice((1, 1, 2, 1000))
    elif choice == 6:
        other = draw.randrange(len(lines))
        lines[at], lines[other] = lines[other], lines[at]
    else:
        lines[at] = _other_cells(lines[at], draw)
    joined = text if choice <= 3 else "\n".join(lines)
    return joined.encode(errors="surrogateescape" if choice > 3 else "surrogatepass")


def _replaced(pattern: re.Pattern[str], text: str, new: str, draw: random.Random) -> str:
    """Replace one match, or, now and then, every one of them."""
    if draw.random() < 0.05:
        return pattern.sub(lambda _: new, text)
    matches = list(pattern.finditer(text))
    if not matches:
        return text + new
    match = draw.choice(matches)
    return text[: match.start()] + new + text[match.end() :]


def _other_cells(line: str, draw: random.Random) -> str:
    separator = draw.choice((",", ";", " ", "  ", ": "))
    cells = line.split(separator)
    at = draw.randrange(len(cells))
    cells[at] = draw.choice((draw.choice(NUMBERS), draw.choice(WORDS), cells[draw.randrange(len(cells))]))
    if draw.random() < 0.2:
        cells.append(cells[at])
    return separator.join(cells)


def _json(data: bytes, draw: random.Random) -> bytes:
    """Change one value or key of a document, and keep the rest."""
    tree = json.loads(data)
    places = list(_places(tree))
    holder, key = draw.choice(places) if places else ([tree], 0)
    choice = draw.randrange(7)
    if choice <= 3:
        holder[key] = _value(draw)
    elif choice == 4:
        other, other_key = draw.choice(places)
        holder[key] = json.loads(json.dumps(other[other_key]))
    elif choice == 5:
        del holder[key]
    else:
        item = holder[key]
        if isinstance(holder, list):
            holder[key:key] = [item] * draw.choice((1, 2, 1000))
        else:
            holder[draw.choice((*WORDS, str(_value(draw))))] = item
    text = json.dumps(tree)
    if draw.random() < 0.1:  # one key twice, which no writer makes
        text = re.sub(r'("[a-z_]+"): ', rf"\1: {json.dumps(_value(draw))}, \1: ", text, count=1)
    return text.encode(errors="surrogatepass")


def _places(tree: object) -> Any:
    inner = list(tree.items()) if isinstance(tree, dict) else list(enumerate(tree)) if isinstance(tree, list) else []
    for key, value in inner:
        yield tree, key
        yield from _places(value)


def _value(draw: random.Random) -> Any:
    nested: Any = 1
    for _ in range(draw.choice((1, 3, 40, 150))):
        nested = [nested] if draw.random() < 0.5 else {"a": nested}
    values = (None, True, False, "", [], {}, 0, 1, -1, 0.0, -0.0, 1e308, -1e308, 5e-324, float("nan"), float("inf"))
    large = (2**31, 2**53 + 1, 2**63, -(2**63), 2**64, 10**30, 10**400, 10**4000, 1e-300, 1e6, 1e9, 1e15, 0.5, 100000)
    return draw.choice((*values, *large, nested, draw.choice(WORDS), [draw.choice(NUMBERS)] * 3, "9" * 400))


def _png(data: bytes, draw: random.Random) -> bytes:
    """Change a chunk, and write the checksums that fit."""
    chunks, at = [], len(_PNG)
    while at + 12 <= len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        chunks.append([kind, data[at + 8 : at + 8 + length]])
        at += 12 + length
    place = draw.randrange(len(chunks))
    choice = draw.randrange(6)
    if choice == 0:
        size = [draw.choice((*SIDES, 2**31 - 1, 2**32 - 1)) for _ in range(2)]
        chunks[0][1] = struct.pack(">II", *size) + chunks[0][1][8:]
    elif choice == 1:
        chunks[0][1] = chunks[0][1][:8] + bytes(draw.choice((0, 1, 2, 3, 4, 6, 8, 16)) for _ in range(5))
    elif choice == 2:
        chunks[place][1] = draw.choice(_BYTES)(chunks[place][1], draw)
    elif choice == 3:
        chunks[place:place] = [list(draw.choice(chunks))]
    elif choice == 4:
        pixels = b"".join(body for kind, body in chunks if kind == b"IDAT")
        flat = draw.choice(_BYTES)(zlib.decompress(pixels), draw)
        chunks = [chunk for chunk in chunks if chunk[0] != b"IDAT"]
        chunks[-1:-1] = [[b"IDAT", zlib.compress(flat[:MAX_BYTES])]]
    else:
        extra = (b"PLTE", b"tRNS", b"gAMA", b"iCCP", b"eXIf", b"zTXt", b"acTL", b"fcTL", b"cICP", b"IEND")
        chunks[place:place] = [[draw.choice(extra), draw.randbytes(draw.choice((0, 1, 6, 26, 768)))]]
    parts = (
        struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body)) for kind, body in chunks
    )
    return _PNG + b"".join(parts)


def _jpeg(data: bytes, draw: random.Random) -> bytes:
    """Change, double or drop a segment, or change size and kind of the image."""
    starts = [match.start() for match in re.finditer(rb"\xff[\xc0-\xfe]", data)]
    at = draw.choice(starts)
    length = int.from_bytes(data[at + 2 : at + 4], "big") + 2
    segment, choice = data[at : at + length], draw.randrange(6)
    if choice == 0:
        return data[:at] + segment * draw.choice((2, 3, 120)) + data[at + length :]
    if choice == 1:
        return data[:at] + data[at + length :]
    if choice == 2:
        return (
            data[: at + 1]
            + bytes([draw.choice((0xC0, 0xC1, 0xC2, 0xC9, 0xC4, 0xDB, 0xDA, 0xDD, 0xE1, 0xFE))])
            + data[at + 2 :]
        )
    if choice == 3:
        return data[: at + 2] + struct.pack(">H", draw.choice((0, 1, 2, 3, 8, 17, 65535))) + data[at + 4 :]
    if choice == 4:
        frame = re.search(rb"\xff[\xc0-\xc2]...", data, re.DOTALL)
        if frame is not None:
            sides = [draw.choice(SIDES) for _ in range(2)]
            return data[: frame.end()] + struct.pack(">HH", *sides) + data[frame.end() + 4 :]
    return data[:at] + draw.choice(_BYTES)(segment, draw) + data[at + length :]


def _archive(data: bytes, draw: random.Random) -> bytes:
    """Change the head or the numbers of one array of an .npz archive, and pack it again."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = [[info.filename, archive.read(info)] for info in archive.infolist()]
    place, choice = draw.randrange(len(members)), draw.randrange(7)
    name, content = members[place]
    if choice <= 1:
        members[place][1] = _text(content[:128], draw)[:128] + content[128:]
    elif choice == 2:
        members[place][1] = draw.choice(_BYTES)(content, draw)
    elif choice == 3:
        shape = draw.choice(
            ("(0,)", "(1,)", "(1, 1, 1)", f"({10**12},)", "(-1,)", f"({2**62}, 8)", "()", "'a'", "(1e3,)")
        )
        members[place][1] = re.sub(rb"'shape': \([^)]*\)", f"'shape': {shape}".encode(), content, count=1)
    elif choice == 4:
        kind = draw.choice(("|O", "<U8", "<c16", "|V0", ">f8", "<f2", "<M8[s]", "|b1", "|S0", "<i8"))
        members[place][1] = re.sub(rb"'descr': '[^']*'", f"'descr': '{kind}'".encode(), content, count=1)
    elif choice == 5:
        members[place][0] = draw.choice(
            (*WORDS[:25], name + "x", "series/a/b/t_s.npy", "series/t_s.npy", members[0][0])
        )
    else:
        members[place:place] = [list(draw.choice(members))] if draw.random() < 0.5 else []
        del members[draw.randrange(len(members))]
    packed = io.BytesIO()
    kind = draw.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_DEFLATED, zipfile.ZIP_LZMA))
    with zipfile.ZipFile(packed, "w", kind) as archive:
        for name, content in members:
            archive.writestr(zipfile.ZipInfo(name.replace("\x00", "") or "a"), content, kind)
    return packed.getvalue()


def _frames(data: bytes, draw: random.Random) -> bytes:
    """Change the payload, type or length of one frame of the serial line, and write the checksum that fits."""
    pieces = data.split(b"\0")
    at = draw.choice([i for i, piece in enumerate(pieces) if piece])
    body = (unstuffed(pieces[at]) or b"")[:-2]
    body = draw.choice(_BYTES)(body, draw)[:600]
    check = crc16(body) if draw.random() < 0.9 else binascii.crc32(body) & 0xFFFF
    pieces[at] = stuffed(body + struct.pack("<H", check))
    return b"\0".join(pieces)
