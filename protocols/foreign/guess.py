"""An import manifest guessed from the files alone, and what a person has to add to it."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from armodal.protocols.errors import ForeignFileError
from armodal.protocols.foreign.inspection import Doubt, Inspection, inspect_file
from armodal.protocols.foreign.manifest import FILL_IN, NO_ARM, Reading
from armodal.protocols.foreign.measured import AXES

__all__ = ["Guess", "guess_manifest"]

_NUMBER = re.compile(r"\d+")
_LONGEST_NUMBER = 16
_COLUMN = 27  # where comments begin


@dataclass(frozen=True, slots=True, kw_only=True)
class Guess:
    """A manifest, how it was guessed, and what is in doubt; without doubts it can be imported."""

    text: str
    guesses: tuple[str, ...]
    doubts: tuple[Doubt, ...]


def guess_manifest(files: Sequence[Inspection], folder: Path) -> Guess:
    """Write the manifest of files that belong to one posture.

    Parameters
    ----------
    files
        From `inspect_file`.
    folder
        Where the manifest will be: paths start from there.

    Raises
    ------
    ForeignFileError
        If some are FRFs and some are hits.
    """
    guesses: list[str] = []
    doubts: list[Doubt] = []
    kinds = {_kind(file) for file in files} - {""}
    if len(kinds) == 1:
        files = [_like_the_others(file, *kinds) for file in files]
    for file in files:
        if file.force is not None:
            guesses.append(
                f"{file.path.name}: its force is in {file.force.name}, as both are named"
            )
        guesses += [f"{file.path.name}: {text}" for text in file.guesses]
        doubts += [Doubt(key=one.key, why=one.why) for one in file.doubts]
    if len(kinds) > 1:
        frfs = [file.path.name for file in files if _kind(file) == "frf"]
        raise ForeignFileError(
            f"wanted files of FRFs or of single hits, got both: {', '.join(frfs)[:200]} hold FRFs; "
            "import them one kind at a time"
        )
    keys = [dict(file.keys) for file in files]
    if kinds == {"frf"}:
        _name_points(files, keys, guesses)
    elif kinds == {"hit"}:
        _ask_points_of_hits(files, keys, guesses, doubts)
    mode, reason = _mode(files, keys)
    guesses.append(f"mode {mode}: {reason}")
    common, keys = _in_common(keys)
    text = _text(files, keys, common, mode, reason, folder)
    names = {file.path.name for file in files}
    return Guess(text=text, guesses=_gathered(guesses, names), doubts=tuple(doubts))


def _like_the_others(file: Inspection, kind: str) -> Inspection:
    """The file, looked at again as what those beside it are if it does not tell itself."""
    return inspect_file(file.path, kind=kind, force=file.force) if "kind" in file.keys else file


def _kind(file: Inspection) -> str:
    if file.content is None:
        return ""
    if file.content.frfs:
        return "frf"
    return "hit" if file.content.hits else ""


def _name_points(
    files: Sequence[Inspection], keys: list[dict[str, Any]], guesses: list[str]
) -> None:
    """Name the points of FRFs that have none: by the numbers of their files."""
    first = {
        i: file.content.frfs[0]
        for i, file in enumerate(files)
        if file.content is not None and file.content.frfs
    }
    measured = list(first)
    nameless = [i for i, frf in first.items() if frf.response.node is None]
    if len(measured) < 2 or not nameless:
        return
    stems = [files[i].path.stem for i in measured]
    pairs = _pairs(stems)
    if pairs and len(nameless) == len(measured):
        for i, (response, reference) in zip(measured, pairs, strict=True):
            keys[i].setdefault("responses", [response])
            keys[i].setdefault("reference", reference)
        guesses.append(
            f"an FRF a file, the first response {pairs[0][0]} over reference {pairs[0][1]}: the "
            "two numbers in the files' names; exchange them if the first is what was struck"
        )
        return
    names = _numbers(stems)
    how = "the numbers in the names of the files" if names else "the order of the files"
    names = names or [str(i + 1) for i in range(len(measured))]
    for i, name in zip(measured, names, strict=True):
        if i in nameless:
            keys[i].setdefault("responses", [name])
    guesses.append(f"one point a file, {names[0]} to {names[-1]}: {how}")


def _telling(stems: Sequence[str]) -> list[tuple[str, ...]]:
    """Return the numbers that differ from name to name, place by place."""
    if len({_NUMBER.sub("#", stem) for stem in stems}) > 1:
        return []
    by_place = zip(*(_NUMBER.findall(stem) for stem in stems), strict=True)
    return [numbers for numbers in by_place if len({int(text) for text in numbers}) > 1]


def _pairs(stems: Sequence[str]) -> list[tuple[str, str]]:
    """Return response and reference of names such as `H_3_1`; none where there are none."""
    telling = _telling(stems)
    if len(telling) != 2:
        return []
    pairs = [(str(int(i)), str(int(j))) for i, j in zip(*telling, strict=True)]
    short = all(len(text) <= _LONGEST_NUMBER for pair in pairs for text in pair)
    # Fewer FRFs cannot link all responses by references they share.
    linked = len(stems) >= len({i for i, _ in pairs}) + len({j for _, j in pairs}) - 1
    return pairs if short and linked and len(set(pairs)) == len(stems) else []


def _numbers(stems: Sequence[str]) -> list[str]:
    """Return the number that tells names apart: `Hxysv00001` is 1; none where there is none."""
    telling = _telling(stems)
    if len(telling) != 1 or len({int(text) for text in telling[0]}) < len(stems):
        return []
    numbers = [str(int(text)) for text in telling[0]]
    return numbers if all(len(number) <= _LONGEST_NUMBER for number in numbers) else []


def _ask_points_of_hits(
    files: Sequence[Inspection],
    keys: list[dict[str, Any]],
    guesses: list[str],
    doubts: list[Doubt],
) -> None:
    """Ask for the points of hits where files do not tell them and it matters."""
    counts = {
        len(hit.responses)
        for file in files
        if file.content is not None
        for hit in file.content.hits
        if any(dof.node is None for dof in hit.responses)
    }
    if not counts:
        return
    most = max(counts)
    if len(files) > 1 or most > len(AXES):
        for file, told in zip(files, keys, strict=True):
            hits = () if file.content is None else file.content.hits
            if hits:
                told["responses"] = [FILL_IN] * len(hits[0].responses)
        each = "one point each, or all at one" if len(files) > 1 else f"{most} accelerations"
        doubts.append(
            Doubt(
                key="responses",
                why=f"{len(files)} files of hits, {each}: the files do not name their points; name "
                'them, such as ["1:z"]',
            )
        )
    elif most > 1:
        guesses.append(f"the {most} accelerations are one sensor's axes x, y, z in their order")


def _mode(files: Sequence[Inspection], keys: Sequence[dict[str, Any]]) -> tuple[str, str]:
    """Return which of sensor and hammer moved, and why."""
    sensors: set[str | None] = set()
    struck: set[str | None] = set()
    for file, told in zip(files, keys, strict=True):
        if "reference" in told:
            sensors |= set(told["responses"])
            struck.add(told["reference"])
            continue
        content = file.content
        if content is not None:
            sensors |= {frf.response.node for frf in content.frfs}
            struck |= {frf.reference.node for frf in content.frfs}
            sensors |= {dof.node for hit in content.hits for dof in hit.responses}
            struck |= {hit.hit.node for hit in content.hits}
    if len(struck) > len(sensors):
        return "roving-hammer", f"{len(struck)} points are struck, {len(sensors)} have sensors"
    if len(sensors) > len(struck):
        return "roving-response", f"{len(sensors)} points have sensors, {len(struck)} are struck"
    return "roving-response", "the files do not tell which moved; change it if the hammer did"


def _in_common(
    keys: Sequence[dict[str, Any]],
) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Part what holds for every file from what holds for one alone."""
    first = keys[0] if len(keys) > 1 else {}
    common = {
        key: value
        for key, value in first.items()
        if key in Reading.model_fields and all(told.get(key) == value for told in keys)
    }
    return common, [{k: v for k, v in told.items() if k not in common} for told in keys]


def _text(
    files: Sequence[Inspection],
    keys: Sequence[dict[str, Any]],
    common: dict[str, Any],
    mode: str,
    reason: str,
    folder: Path,
) -> str:
    lines = [
        "# Guessed by `armodal import` from the files alone. Change what is wrong, and fill in",
        f'# what is "{FILL_IN}"; then: armodal import THIS_FILE --out session.h5',
        'format = "armodal-import-1"',
        _with_reason(f'arm = "{NO_ARM}"', "a plain structure; name an arm for its joints"),
        _with_reason(f'mode = "{mode}"', reason),
        *(f"{key} = {_inline(value)}" for key, value in common.items()),
        "",
        "[[postures]]",
        'name = "measured"',
        "files = [",
    ]
    for file, told in zip(files, keys, strict=True):
        entry = {"path": _path(file.path, folder), **told}
        if file.force is not None:
            entry["force"] = _path(file.force, folder)
        lines.append(f"    {_inline(entry)},")
    lines.append("]")
    if any(_kind(file) == "frf" for file in files):
        lines.append("# averages = 3   # how many the FRFs are means of")
    return "\n".join(lines) + "\n"


def _with_reason(text: str, reason: str) -> str:
    return f"{text:<{_COLUMN}} # {reason}"


def _path(path: Path, folder: Path) -> str:
    """Return a path that starts from the manifest's folder, where there is one."""
    try:
        return Path(os.path.relpath(path.resolve(), folder.resolve())).as_posix()
    except ValueError:  # another drive
        return path.resolve().as_posix()


def _inline(value: Any) -> str:
    """Return a value as TOML on one line."""
    if isinstance(value, dict):
        inner = ", ".join(f"{key} = {_inline(one)}" for key, one in value.items())
        return f"{{ {inner} }}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_inline(one) for one in value) + "]"
    return json.dumps(value, ensure_ascii=False)


def _gathered(guesses: Sequence[str], names: Collection[str]) -> tuple[str, ...]:
    """Return each sentence once, with the files it is about counted."""
    about: dict[str, list[str]] = {}
    for sentence in guesses:
        name, colon, text = sentence.partition(": ")
        is_file = bool(colon) and name in names
        about.setdefault(text if is_file else sentence, []).append(name if is_file else "")
    result = []
    for text, of in about.items():
        more = f" and {len(of) - 1} more" if len(of) > 1 else ""
        result.append(f"{of[0]}{more}: {text}" if of[0] else text)
    return tuple(result)
