"""Words in large letters of block characters, to be read from two metres."""

from __future__ import annotations

__all__ = ["big_lines"]

ROWS = 5
# Each letter as five rows of pixels, rows divided by /.
_FONT = {
    "A": ".##./#..#/####/#..#/#..#",
    "B": "###./#..#/###./#..#/###.",
    "C": ".###/#.../#.../#.../.###",
    "D": "###./#..#/#..#/#..#/###.",
    "E": "####/#.../###./#.../####",
    "F": "####/#.../###./#.../#...",
    "G": ".###/#.../#.##/#..#/.###",
    "H": "#..#/#..#/####/#..#/#..#",
    "I": "###/.#./.#./.#./###",
    "J": "..##/...#/...#/#..#/.##.",
    "K": "#..#/#.#./##../#.#./#..#",
    "L": "#.../#.../#.../#.../####",
    "M": "#...#/##.##/#.#.#/#...#/#...#",
    "N": "#...#/##..#/#.#.#/#..##/#...#",
    "O": ".##./#..#/#..#/#..#/.##.",
    "P": "###./#..#/###./#.../#...",
    "Q": ".##./#..#/#..#/#.#./.#.#",
    "R": "###./#..#/###./#.#./#..#",
    "S": ".###/#.../.##./...#/###.",
    "T": "#####/..#../..#../..#../..#..",
    "U": "#..#/#..#/#..#/#..#/.##.",
    "V": "#...#/#...#/#...#/.#.#./..#..",
    "W": "#...#/#...#/#.#.#/##.##/#...#",
    "X": "#...#/.#.#./..#../.#.#./#...#",
    "Y": "#...#/.#.#./..#../..#../..#..",
    "Z": "####/...#/.##./#.../####",
    "0": ".##./#..#/#..#/#..#/.##.",
    "1": ".#./##./.#./.#./###",
    "2": "###./...#/.##./#.../####",
    "3": "###./...#/.##./...#/###.",
    "4": "#..#/#..#/####/...#/...#",
    "5": "####/#.../###./...#/###.",
    "6": ".##./#.../###./#..#/.##.",
    "7": "####/...#/..#./.#../.#..",
    "8": ".##./#..#/.##./#..#/.##.",
    "9": ".##./#..#/.###/...#/.##.",
    " ": "../../../../..",
    "-": ".../.../###/.../...",
    "+": ".../.#./###/.#./...",
    ".": "././././#",
    ",": "./././#/#",
    ":": "./#/./#/.",
    "!": "#/#/#/./#",
    "?": "###./...#/.##./..../.#..",
    "/": "...#/..#./..#./.#../#...",
    "%": "#..#/...#/.##./#.../#..#",
    "°": "##/##/../../..",
}
_HALVES = {(False, False): " ", (True, False): "▀", (False, True): "▄", (True, True): "█"}


def big_width(text: str, scale: int = 1) -> int:
    """Return how many columns `text` takes at a scale of 1 (three rows) or 2 (five rows)."""
    pixels = sum(len(_glyph(letter)[0]) + 1 for letter in text) - 1 if text else 0
    return pixels * scale


def big_lines(text: str, *, width: int, height: int = ROWS) -> list[str]:
    """Return `text` in the largest letters that fit, or plainly where none do.

    Two columns make a pixel in the larger size, half a row in the smaller one.

    >>> big_lines("I", width=10, height=3)
    ['▀█▀', ' █ ', '▀▀▀']
    >>> big_lines("TOO SMALL", width=10, height=3)
    ['TOO SMALL']
    """
    text = text.upper()
    pixels = [
        [pixel == "#" for letter in text for pixel in (*_glyph(letter)[row], ".")][:-1]
        for row in range(ROWS)
    ]
    if height >= ROWS and big_width(text, 2) <= width:
        return ["".join("██" if pixel else "  " for pixel in row) for row in pixels]
    if height >= 3 and big_width(text) <= width:
        pixels.append([False] * len(pixels[0]))
        return [
            "".join(_HALVES[pair] for pair in zip(pixels[row], pixels[row + 1], strict=True))
            for row in range(0, ROWS + 1, 2)
        ]
    return [text[:width]]


def _glyph(letter: str) -> list[str]:
    return _FONT.get(letter, _FONT["?"]).split("/")
