"""A card for every effect, from the words and the equations of its own file."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from armodal.analyzer.arm.superset import Superset
from armodal.analyzer.gap import effects
from armodal.analyzer.gap.effects import link_axis, sensor_axes, wrong_point
from armodal.analyzer.gap.library import all_instances, hooks
from armodal.analyzer.gap.model.effect import EffectWords, Instance
from armodal.analyzer.gap.model.hypothesis import Hypothesis
from armodal.analyzer.gap.model.lines import PostureLines
from armodal.analyzer.gap.model.ordinary import Ordinary
from armodal.analyzer.gap.model.posed import PosedModel
from armodal.analyzer.report.palette import DRIVEN, FOUND
from armodal.analyzer.report.svg_plot import Curve, Panel, panels_figure
from armodal.protocols.arm.files import load_arm

_ARM = "ur5"  # six elastic joints, long links: every effect has a place on it
_HZ = np.linspace(3.0, 120.0, 300)
_DAMPED_HZ = 0.5  # the lines stand this far beside the axis, so that peaks stay on the page
_TIMES_MATERIAL = 4.0
_LEVEL = 0.7  # half a factor of four between soft and hard hits
_PICTURED = 8  # places tried for the picture
_LONG_LINK = 2  # the forearm
_SWING_RAD, _RATE_RAD_S = 3e-5, 100.0  # of a joint under a hit, where it has a law of its own


def effect_pages() -> dict[str, str]:
    """Return the index of effects, and a page with its picture for each, by file name."""
    by_name: dict[str, list[Instance]] = {}
    for instance in (*all_instances(_ordinary()), *_proposed(_ordinary())):
        by_name.setdefault(instance.effect.name, []).append(instance)
    known = dict(_known())
    titles = {words.name: words.title for words in known}
    pages = {"effects/index.md": _index(titles)}
    for words, module in known.items():
        places = by_name.get(words.name, [])
        picture = _picture(places)
        if picture:
            pages[f"effects/{words.name}.svg"] = picture
        pages[f"effects/{words.name}.md"] = _card(words, module, places, titles, bool(picture))
    return pages


def _proposed(ordinary: Ordinary) -> Iterator[Instance]:
    """Examples of effects that have a place only where a look proposes one."""
    last, before = (joint.link.name for joint in ordinary.arm.joints[:-3:-1])
    there, other = (
        [point.id for point in ordinary.arm.points if point.link == link][-1]
        for link in (last, before)
    )
    yield sensor_axes.turned_sensor(ordinary, np.diag([1.0, 1.0, -1.0]), there)
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    yield sensor_axes.turned_sensor(ordinary, quarter, there)
    yield wrong_point.exchanged(ordinary, there, other)
    middle = ordinary.arm.joints[_LONG_LINK].link.center_m
    yield link_axis.at_axis(ordinary, _LONG_LINK, np.array([0.0, 1.0, 0.0]), middle)
    for at_line in hooks("at_line"):
        yield at_line(ordinary, _LONG_LINK, np.array([0.0, 1.0, 0.0]), middle)
    for i in ordinary.elastic:
        for laws in hooks("laws"):
            yield from laws(ordinary, ordinary.arm.joints[i].name, _SWING_RAD, _RATE_RAD_S)


def _known() -> Iterator[tuple[EffectWords, str]]:
    """Every effect's words with the file they stand in."""
    for found in pkgutil.iter_modules(effects.__path__):
        module = importlib.import_module(f"{effects.__name__}.{found.name}")
        for value in vars(module).values():
            if isinstance(value, EffectWords) and hasattr(module, "__all__"):
                yield value, f"analyzer/gap/effects/{found.name}.py"


def _index(titles: dict[str, str]) -> str:
    rows = "\n".join(f"- [{title}]({name}.md)" for name, title in sorted(titles.items()))
    names = "\n".join(sorted(titles))
    return (
        f"# Effects\n\nEvery effect that `armodal gap` can name. A card is written from the "
        f"effect's own file.\n\n{rows}\n\n```{{toctree}}\n:hidden:\n\n{names}\n```\n"
    )


def _card(
    words: EffectWords, file: str, places: list[Instance], titles: dict[str, str], drawn: bool
) -> str:
    lines = [f"# {words.title}", "", f"Name in files and JSON: `{words.name}`.", ""]
    lines += [f"**{label}**\n: {text}\n" for label, text in _said(words, titles)]
    sized = next((one for one in places if one.material), None)
    if sized is not None:
        unit = f" {sized.unit}" if sized.unit else ""
        lines += [f"**Worth a name from**\n: {sized.material:.3g}{unit} (on `{_ARM}`)\n"]
    sources = getattr(importlib.import_module(_module_of(file)), "SOURCES", {})
    lines += [f"**Source of `{name}`**\n: {_sentence(text)}\n" for name, text in sources.items()]
    if drawn:
        size = f" and with {_TIMES_MATERIAL:g} times the size from which it is worth a name"
        caption = (
            f"Accelerance at a point of the last link of `{_ARM}`, without the effect"
            f"{size if sized else ' and with it'}. Below: their ratio."
        )
        lines += [f"![Accelerance with and without it]({words.name}.svg)", "", caption, ""]
    return "\n".join([*lines, f"Code: `{file}`."]) + "\n"


def _module_of(file: str) -> str:
    return "armodal." + file.removesuffix(".py").replace("/", ".")


def _said(words: EffectWords, titles: dict[str, str]) -> Iterator[tuple[str, str]]:
    yield "What it changes in the equations", _sentence(words.changes)
    yield "Signature in the measurement", _sentence(words.signature)
    if words.confused_with:
        links = [
            f"[{titles[other].lower()}]({other}.md)" if other in titles else other
            for other in words.confused_with
        ]
        yield "Confused with", ", ".join(links)
    if words.told_by:
        yield "The test that tells", _sentence(words.told_by)
    if words.remedy:
        yield "What to do", _sentence(words.remedy)


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:] + ("" if text.endswith(".") else ".")


@lru_cache(maxsize=1)
def _ordinary() -> Ordinary:
    superset = Superset(load_arm(_ARM))
    return Ordinary(superset=superset, postures=("p",), levels_hit=True, level_span=_LEVEL)


def _lines() -> PostureLines:
    arm = _ordinary().arm
    low, high = np.array([joint.range_rad for joint in arm.joints]).T
    link = arm.joints[-1].link.name
    last = max(i for i, point in enumerate(arm.points) if point.link == link)
    shape = (1, 3, len(_HZ))
    return PostureLines(
        name="p",
        joints_rad=np.clip(np.deg2rad([20.0, -60.0, 80.0, -30.0, 40.0, 10.0]), low, high),
        s_rad_s=2.0 * np.pi * (_DAMPED_HZ + 1j * _HZ),
        sensor_point=np.array([last]),
        hit=np.array([0]),
        hit_point=np.array([last]),
        hit_direction=np.array([[0.6, 0.48, -0.64]]),
        values=np.zeros(shape, dtype=complex),
        variance=np.ones(shape),
        sensor_mass_kg=0.02,
        level=_LEVEL,
    )


def _picture(places: list[Instance]) -> str:
    model, lines = PosedModel(_ordinary().superset, _lines().joints_rad), _lines()

    def seen(*instances: Instance) -> np.ndarray:
        hypothesis = Hypothesis(ordinary=_ordinary(), instances=instances)
        space = hypothesis.space()
        values = dict(zip(space.index, space.mean, strict=True))
        for own in instances:
            for name in own.sizes[:1] or (own.size,):
                if name:
                    values[name] = own.size_offset + _TIMES_MATERIAL * own.material
        return model.values(hypothesis, lines, values)[0]  # (3, L)

    plain = seen()
    places = [own for own in places if own.size or own.sizes or not own.parameters]
    found = [seen(own) for own in places[:_PICTURED]]
    changes = [np.abs(y / plain - 1.0).mean(axis=1) for y in found]
    if not changes or max(change.max() for change in changes) == 0.0:
        return ""
    best = int(np.argmax([change.max() for change in changes]))
    axis = int(np.argmax(changes[best]))
    return _drawn(plain[axis], found[best][axis], places[best])


def _drawn(plain: np.ndarray, found: np.ndarray, at: Instance) -> str:
    where = f"with, at {at.place}" if at.place else "with"
    size = Panel(
        curves=(
            Curve(x=_HZ, y=np.abs(plain), colour=DRIVEN, name="without"),
            Curve(x=_HZ, y=np.abs(found), colour=FOUND, name=where),
        ),
        height=150.0,
        label="m/s²/N",
        y_range=_range(np.abs(plain), np.abs(found)),
        log=True,
    )
    ratio = found / plain
    panels = [size]
    for y, label in (
        (20.0 * np.log10(np.abs(ratio)), "dB"),
        (np.rad2deg(np.unwrap(np.angle(ratio))), "deg"),
    ):
        most = max(1.0, float(np.abs(y).max()))
        curve = Curve(x=_HZ, y=y, colour=FOUND)
        panels.append(Panel(curves=(curve,), height=60.0, label=label, y_range=(-most, most)))
    title = f"Accelerance without and with it, and their ratio: {at.effect.title}"
    return panels_figure(
        panels, (float(_HZ[0]), float(_HZ[-1])), x_label="frequency, Hz", title=title
    )


def _range(*curves: np.ndarray) -> tuple[float, float]:
    return min(float(y.min()) for y in curves), max(float(y.max()) for y in curves)
