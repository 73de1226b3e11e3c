"""What an array of a foreign file is, by the words and the unit of its name."""

from __future__ import annotations

import re
from enum import StrEnum

from armodal.protocols.foreign.frf_units import frf_unit
from armodal.protocols.foreign.units import hertz, seconds, unit

__all__ = ["Role", "role_of", "split_unit", "tokens"]


class Role(StrEnum):
    """What an array can be; the values are the keys of `variables` in a manifest."""

    TIME = "time"
    FREQUENCY = "frequency"
    FRF = "frf"
    REAL = "real"
    IMAGINARY = "imaginary"
    MAGNITUDE = "magnitude"
    PHASE = "phase"
    COHERENCE = "coherence"
    FORCE = "force"
    RESPONSE = "response"
    OTHER = "other"  # known, and of no use: spectra, correlations
    UNKNOWN = "unknown"


# In this order: "Frequency response, real part" is a real part. English, German, French.
_WORDS = (
    (
        Role.COHERENCE,
        "coherence coh cohe coher gamma2 \u03b32 \u03b3\u00b2 msc kohärenz kohaerenz cohérence",
    ),
    (
        Role.OTHER,
        """psd asd cpsd csd spec spectrum autospectrum crossspectrum autopower crosspower auto cross
        correlation autocorrelation crosscorrelation variance noise index comment remark
        rpm tacho tachometer window""",
    ),
    (Role.IMAGINARY, "imag imaginary im imagpart imaginär imaginärteil imaginaire"),
    (Role.REAL, "real re realpart realteil réel réelle"),
    (Role.PHASE, "phase pha phi arg angle"),
    (Role.MAGNITUDE, "magnitude mag amplitude ampl amp abs modulus module betrag"),
    (Role.FORCE, "force hammer impact excitation kraft hammerkraft marteau"),
    (
        Role.RESPONSE,
        """acceleration acc accel accelerometer beschleunigung accélération response responses resp
        antwort""",
    ),
    (Role.TIME, "time zeit temps t timestamp"),
    (Role.FREQUENCY, "frequency freq frequencies frequenz fréquence hz omega"),
)
_WORD_SETS = tuple((role, frozenset(words.split())) for role, words in _WORDS)
# Names that mean something alone: of columns called "real" and "complex", say.
_ALONE = {"f": Role.FORCE, "complex": Role.IMAGINARY}
# Armodal's own variables that tell of the FRFs and are none.
_OWN = frozenset(
    {
        "response_directions", "reference_directions", "averages", "window_decay_rad_s",
        "joints_rad", "variance",
    }
)  # fmt: skip
_SUFFIXES = (
    ("_m_s2", "m/s^2"), ("_hz", "Hz"), ("_ms", "ms"), ("_us", "us"), ("_deg", "deg"),
    ("_rad", "rad"), ("_db", "dB"), ("_s", "s"), ("_g", "g"), ("_n", "N"),
)  # fmt: skip
_ANGLES = {"deg", "degree", "degrees", "°", "grad", "rad", "radian", "radians"}
_PLAIN = {"db", "%", "-", "", "v", "mv", "volts", "volt", "pc", "rad/s", "1/min"}
_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])")
_TOKEN = re.compile(r"[^\W\d_]+[²2]?(?![^\W\d_])|\d+")


def tokens(name: str) -> frozenset[str]:
    """Return the words of a name.

    >>> sorted(tokens("MagSpec_chan_1"))
    ['1', 'chan', 'mag', 'spec']
    """
    return frozenset(word.lower() for word in _TOKEN.findall(_CAMEL.sub(" ", name)))


def is_unit(label: str) -> bool:
    """Return whether a label is a unit of anything that a measurement holds."""
    plain = label.strip().lower()
    known = unit(label) or seconds(label) or hertz(label) or frf_unit(label)
    return known is not None or plain in _PLAIN or plain in _ANGLES or plain.startswith("db")


def split_unit(name: str) -> tuple[str, str]:
    """Part a name from its unit: `force [N]`, `acc (m/s²)`, `x_m_s2`.

    >>> split_unit("FRF ((m/s²)/N)")
    ('FRF', '(m/s²)/N')
    >>> split_unit("Re(H1)")
    ('Re(H1)', '')
    """
    text = name.strip()
    if text in _OWN:
        return text, ""
    opening = {"]": "[", ")": "("}.get(text[-1:])
    if opening:
        at = _matching(text, opening)
        bare, label = text[:at].strip(), text[at + 1 : -1].strip()
        is_time = bool(tokens(bare) & {"time", "t", "zeit", "temps"})
        if at >= 0 and (opening == "[" or is_unit(label) or is_time):
            return bare, label
    for ending, label in _SUFFIXES:
        if text.lower().endswith(ending):
            return text[: -len(ending)], label
    return text, ""


def _matching(text: str, opening: str) -> int:
    """Return where the bracket opens that the last character closes; -1 for nowhere."""
    depth = 0
    for at in range(len(text) - 1, -1, -1):
        depth += (text[at] == text[-1]) - (text[at] == opening)
        if depth == 0:
            return at
    return -1


def role_of(name: str, label: str, *, is_complex: bool) -> Role:
    """Return what an array is by its name, else by its unit."""
    if name.lower() in _OWN:
        return Role.OTHER
    if not is_complex and len(name) > 2 and name[0] == name[-1] == "|":
        return Role.MAGNITUDE
    words = tokens(name)
    for role, known in _WORD_SETS:
        found = bool(words & known)
        if is_complex and role not in {Role.OTHER, Role.COHERENCE}:
            continue
        if role in {Role.FREQUENCY, Role.RESPONSE} and {"frequency", "response"} <= words:
            continue
        if found:
            return role
    if is_complex:
        return Role.FRF
    by_unit = _role_by_unit(label)
    if by_unit is Role.UNKNOWN and len(words) == 1:
        return _ALONE.get(next(iter(words)), by_unit)
    return by_unit


def _role_by_unit(label: str) -> Role:
    plain = label.strip().lower()
    told = unit(label)
    if hertz(label) is not None:
        return Role.FREQUENCY
    if seconds(label) is not None:
        return Role.TIME
    if plain in _ANGLES:
        return Role.PHASE
    if plain.startswith("db"):
        return Role.MAGNITUDE
    if told is None:
        return Role.UNKNOWN
    return Role.FORCE if told[0] == "force" else Role.RESPONSE
