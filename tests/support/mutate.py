"""Valid bytes made wrong in ways that find faults: of any format, of texts, of framed records."""

import re

import numpy as np

TELLING_BYTES = (0x00, 0x01, 0x0A, 0x0D, 0x20, 0x2D, 0x7F, 0x80, 0xFE, 0xFF)
TELLING_NUMBERS = (0, 1, 2, 7, 8, 64, 255, 256, 2047, 2048, 65535, 2**20, 2**31 - 1, 2**31,
                   2**32 - 1, 2**63 - 1, 2**63, 2**64 - 1)  # fmt: skip
TELLING_TOKENS = (
    b"0", b"-1", b"1e308", b"-1e400", b"nan", b"inf", b"-0.0", b"1e-320", b"9" * 25, b"0x1F",
    b"true", b'""', b'"\\u0000"', b'"../../etc/passwd"', b'"/dev/zero"', b"[]", b"{}", b"[[]]",
    b'"' + b"a" * 300 + b'"', b"1979-05-27", b"\xff\xfe", b"'", b"[[joints]]", b"[points]",
    b'"\\ud800"', b"=", b"#", b"\n\n", b"\t", b"\x00", "\u2028\u00e9".encode(), b"1_000",
    b".5", b"5.",
)  # fmt: skip
_TOKEN = re.compile(rb'"[^"\n]*"|[-+]?[0-9][0-9_.eE+-]*|[A-Za-z_][A-Za-z0-9_]*|[\[\]{}=<>/,:;]')


def mutated(data, rng, *, others=(), limit=1 << 20, largest=8):
    """Return `data` with one to `largest` changes that know nothing of its format."""
    data = bytearray(data)
    for _ in range(int(rng.integers(1, largest + 1))):
        n = len(data)
        at = int(rng.integers(n + 1))
        kind = int(rng.integers(10))
        if kind <= 2 and at < n:
            data[at] ^= 1 << int(rng.integers(8))
        elif kind == 3 and at < n:
            data[at] = TELLING_BYTES[rng.integers(len(TELLING_BYTES))]
        elif kind == 4:
            number = TELLING_NUMBERS[rng.integers(len(TELLING_NUMBERS))]
            width = int(rng.choice((2, 4, 8)))
            order = "little" if rng.random() < 0.8 else "big"
            data[at : at + width] = (number % (1 << 8 * width)).to_bytes(width, order)
        elif kind == 5:
            del data[at : at + _some(rng)]
        elif kind == 6:
            piece = data[at : at + _some(rng)]
            data[at:at] = piece * int(rng.integers(1, 4))
        elif kind == 7:
            data[at:at] = rng.bytes(_some(rng))
        elif kind == 8 and rng.random() < 0.3:
            del data[at:]
        elif kind == 9 and others:
            other = others[rng.integers(len(others))]
            start = int(rng.integers(len(other) + 1))
            data[at : at + _some(rng)] = other[start : start + _some(rng)]
    return bytes(data[:limit])


def mutated_text(data, rng, *, others=(), limit=1 << 20):
    """Return a text with tokens exchanged and lines moved, now and then with wild bytes."""
    if rng.random() < 0.2:
        return mutated(data, rng, others=others, limit=limit, largest=3)
    for _ in range(int(rng.integers(1, 5))):
        kind = int(rng.integers(7))
        if kind <= 3:
            tokens = list(_TOKEN.finditer(data))
            if not tokens:
                return data
            token = tokens[rng.integers(len(tokens))]
            new = TELLING_TOKENS[rng.integers(len(TELLING_TOKENS))]
            if kind == 1:
                new = tokens[rng.integers(len(tokens))].group()
            elif kind == 2:
                new = token.group() * int(rng.integers(2, 4))
            data = data[: token.start()] + new + data[token.end() :]
            continue
        lines = data.split(b"\n")
        at = int(rng.integers(len(lines)))
        if kind == 4:
            del lines[at]
        elif kind == 5:
            lines.insert(int(rng.integers(len(lines) + 1)), lines[at])
        else:
            other = int(rng.integers(len(lines)))
            lines[at], lines[other] = lines[other], lines[at]
        data = b"\n".join(lines)
    return data[:limit]


def _some(rng):
    return int(np.exp(rng.uniform(0.0, np.log(200.0))))
