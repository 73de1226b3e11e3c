"""Pictures beside the words: the arm with its point, live levels, last pulse, FRF."""

from __future__ import annotations

import numpy as np
from rich.text import Text

from armodal.daq.geometry import hit_direction
from armodal.protocols.plan_records import Mode
from armodal.tui.drawing import (
    Camera,
    Canvas,
    Scale,
    Series,
    arm_wireframe,
    draw_hit,
    draw_points,
    draw_triad,
    linear_scale,
    log_scale,
    plot,
    plot_frame,
)
from armodal.tui.screens.run.craft import (
    check_driving_point,
    excited_band,
    good_hit_before,
    place_before,
    resonance_moved,
    scatter_at_resonance,
)
from armodal.tui.screens.run.earlier import check_reciprocity, mirrors_in
from armodal.tui.screens.run.measured import PointFrf, active_channels, last_pulse, point_frf
from armodal.tui.screens.run.state import RunState
from armodal.tui.screens.run.views.craft import (
    craft_text,
    drift_line,
    driving_line,
    reciprocity_line,
    scatter_line,
    tip_line,
)

__all__ = ["HitPictures", "live_picture", "point_picture"]


LEAST_COLUMNS, LEAST_ROWS = 16, 4
FROM_THE_SIDE_RAD = np.deg2rad(35.0)  # the eye stands beside the surface's normal, not on it
TRIAD_SHARE, HIT_SHARE = 0.22, 0.3  # of the arm's reach
LIVE_S = 4.0  # wall seconds of the live view
QUIET_N, QUIET_M_S2 = 20.0, 1.0  # least height of the live views, so that noise stays small
LEAST_SHOWN_DB = -60.0
AXIS_STYLES = ("bold bright_red", "bold bright_green", "bold bright_blue")  # x, y, z
HAMMER_STYLE = "bold bright_cyan"  # none of the axes' colours, and none of the point's


def point_picture(state: RunState, columns: int, rows: int, *, turned_rad: float = 0.0) -> Text:
    """Return the arm as it stands, the point to go to, the sensor's axes and the hit."""
    prompt = state.prompt
    if prompt is None or prompt.posture is None or columns < LEAST_COLUMNS or rows < LEAST_ROWS:
        return Text("")
    reading = state.joints
    known = reading is not None and reading.joints_rad is not None
    joints_rad = prompt.posture.joints_rad
    if reading is not None and reading.joints_rad is not None:
        joints_rad = reading.joints_rad
    wire = arm_wireframe(state.arm, np.round(joints_rad, 3))
    roving_hammer = state.plan.mode is Mode.ROVING_HAMMER
    sensor = wire.point(prompt.sensor_point)
    wanted = wire.point(prompt.hit_point if roving_hammer else prompt.sensor_point)
    normal = wire.point_rotation[wanted, :, 2]
    camera = Camera.around(wire.everything_m())
    side = float(np.arctan2(normal[1], normal[0])) + FROM_THE_SIDE_RAD
    camera = camera.turned(side - camera.azimuth_rad + turned_rad)
    canvas = Canvas(columns, rows)
    wire.draw(canvas, camera, "" if known else "dim")
    draw_points(canvas, camera, wire, "dim")
    draw_triad(
        canvas,
        camera,
        wire.point_m[sensor],
        wire.point_rotation[sensor],
        TRIAD_SHARE * wire.reach_m,
        styles=AXIS_STYLES,
    )
    hit = wire.point(prompt.hit_point)
    direction = hit_direction(state.arm, prompt.posture, prompt.hit_point)
    draw_hit(
        canvas,
        camera,
        wire.point_m[hit],
        direction,
        HIT_SHARE * wire.reach_m,
        HAMMER_STYLE,
    )
    at = camera.project(wire.point_m[[wanted]], canvas.width, canvas.height)
    canvas.mark(at, f"◉ {wire.point_ids[wanted]}", "bold bright_yellow")
    name = "the arm as it stands" if known else "POSTURE UNKNOWN: drawn as planned"
    canvas.label(1, 0, name, "dim" if known else "bold bright_red")
    canvas.label(1, rows - 1, "◉ point  x y z sensor  ▪┄▶ hammer", "dim")
    return canvas.text()


def live_picture(state: RunState, columns: int, rows: int, quantity: str) -> Text:
    """Return the last seconds of a quantity, as its envelope: no sample hides between pixels.

    Parameters
    ----------
    quantity
        "force", or "acceleration", of which all axes are drawn in one envelope.
    """
    channels = active_channels(state)
    which = [i for i, channel in enumerate(channels) if channel.quantity == quantity]
    if not which or columns < LEAST_COLUMNS or rows < LEAST_ROWS:
        return Text("")
    if not state.previews:
        return Text().append(f"{quantity}: no samples come", style="bold bright_yellow")
    scale = np.array([channels[i].scale for i in which])
    lowest = np.concatenate([p.lowest[:, which] for p in state.previews]) * scale
    highest = np.concatenate([p.highest[:, which] for p in state.previews]) * scale
    middle = np.median((lowest + highest) / 2.0, axis=0)
    low = (np.minimum(lowest, highest) - middle).min(axis=1)
    high = (np.maximum(lowest, highest) - middle).max(axis=1)
    rate_hz = float(state.plan.sampling.rate_hz) * state.time_scale
    ends = np.concatenate(
        [
            p.first_sample + p.n_samples * np.arange(1, len(p.lowest) + 1) / len(p.lowest)
            for p in state.previews
        ]
    )
    seconds = (ends - ends[-1]) / rate_hz
    quiet, unit = (QUIET_N, "N") if quantity == "force" else (QUIET_M_S2, "m/s²")
    picture = plot(
        columns,
        rows,
        [Series(x=np.repeat(seconds, 2), y=np.stack([low, high], axis=1).ravel(), style="cyan")],
        x=Scale(low=-LIVE_S, high=0.0),
        y=linear_scale(low, high, least_span=quiet),
        title=f"{quantity}, live ({unit})",
        x_axis=rows >= 7,
        x_name="s",
    )
    return picture.text()


class HitPictures:
    """Pictures of what was measured, computed anew only when a hit has come or gone."""

    def __init__(self) -> None:
        self._pulse: tuple[object, Text] = (None, Text(""))
        self._frf: tuple[object, Text] = (None, Text(""))
        self._estimate: tuple[object, PointFrf | None] = (None, None)
        self._craft: tuple[object, tuple[Text, ...]] = (None, ())

    def pulse(self, state: RunState, columns: int, rows: int) -> Text:
        """Return the last pulse above its spectrum."""
        judged = state.last_hit
        if judged is None or columns < LEAST_COLUMNS or rows < LEAST_ROWS:
            return Text("")
        key = (judged.hit.number, len(state.withdrawn), columns, rows)
        if self._pulse[0] != key:
            self._pulse = (key, _pulse_text(state, columns, rows))
        return self._pulse[1]

    def frf(self, state: RunState, columns: int, rows: int, here: tuple[str, str] | None) -> Text:
        """Return the FRF so far above its coherence, of one point of one posture."""
        judged = state.last_hit
        if judged is None or here is None or columns < LEAST_COLUMNS or rows < LEAST_ROWS:
            return Text("")
        found = self._found(state, here)
        key = (self._estimate[0], columns, rows)
        if self._frf[0] != key:
            self._frf = (key, _frf_text(found, here[1], columns, rows))
        return self._frf[1]

    def craft(self, state: RunState, columns: int, rows: int, here: tuple[str, str] | None) -> Text:
        """Return what the hits at a place say of tip, driving point, drift and scatter."""
        if state.last_hit is None or here is None:
            return Text("")
        found = self._found(state, here)
        left = sum(
            max(p.wanted - p.accepted, 0) for p in state.progress if (p.posture, p.point) == here
        )
        key = (self._estimate[0], left)
        if self._craft[0] != key:
            self._craft = (key, _craft_lines(state, found, here, left))
        return craft_text(self._craft[1], columns, rows)

    def _found(self, state: RunState, here: tuple[str, str]) -> PointFrf | None:
        made_of = (here, len(state.hits), len(state.withdrawn))
        if self._estimate[0] != made_of:
            self._estimate = (made_of, point_frf(state, here))
        return self._estimate[1]


def _craft_lines(
    state: RunState, found: PointFrf | None, here: tuple[str, str], left: int
) -> tuple[Text, ...]:
    lines = []
    band = None if state.last_hit is None else excited_band(state, state.last_hit.hit)
    if band is not None:
        lines.append(tip_line(band))
    if found is None:
        return tuple(lines)
    driving = check_driving_point(found)
    if driving is not None:
        lines.append(driving_line(driving))
    posture = next(p for p in state.plan.postures if p.name == here[0])
    mirrors = mirrors_in(state.other_frfs, posture)
    both_ways = None if mirrors is None else check_reciprocity(found.frf, mirrors)
    if both_ways is not None:
        lines.append(reciprocity_line(both_ways))
    place = place_before(state, here)
    before = None if place is None else point_frf(state, place)
    moved = None if before is None else resonance_moved(before.frf, found.frf)
    if before is not None and moved is not None:
        lines.append(drift_line(moved, before.point))
    lines.append(scatter_line(scatter_at_resonance(found), left, state.std_wanted))
    return tuple(lines)


def _pulse_text(state: RunState, columns: int, rows: int) -> Text:
    judged = state.last_hit
    pulse = None if judged is None else last_pulse(state, judged.hit)
    if pulse is None:
        return Text().append("the last record has no pulse to show", style="dim")
    upper = rows // 2 if rows >= 2 * LEAST_ROWS else rows
    title = f"last pulse (N), hit {judged.hit.number}" if judged is not None else ""
    picture = plot(
        columns,
        upper,
        [Series(x=pulse.time_ms, y=pulse.force_n, style="bold cyan")],
        x=linear_scale(pulse.time_ms),
        y=linear_scale(pulse.force_n, floor=0.0),
        title=title,
        x_name="ms",
        x_axis=upper >= 5,
    ).text()
    if rows - upper < LEAST_ROWS:
        return picture
    before = good_hit_before(state)
    good = None if before is None else last_pulse(state, before)
    under = [] if good is None else [Series(x=good.freq_hz, y=good.spectrum_db, style="dim")]
    spectrum = plot(
        columns,
        rows - upper,
        [*under, Series(x=pulse.freq_hz, y=pulse.spectrum_db, style="cyan")],
        x=linear_scale(pulse.freq_hz, floor=0.0),
        y=Scale(low=LEAST_SHOWN_DB, high=0.0),
        title="spectrum (dB)" + (f", dim: hit {before.number}" if before and good else ""),
        x_name="Hz",
        x_axis=rows - upper >= 5,
    ).text()
    return Text("\n").join([picture, spectrum])


def _frf_text(found: PointFrf | None, point: str, columns: int, rows: int) -> Text:
    """FRF above coherence, over one axis of frequency."""
    if found is None:
        return Text().append(f"FRF of point {point}: no accepted hit yet", style="dim")
    lower = max(rows // 3, LEAST_ROWS) if rows >= 2 * LEAST_ROWS else 0
    hits = "1 hit" if found.n_hits == 1 else f"{found.n_hits} hits"
    magnitude = 10.0 ** (found.magnitude_db / 20.0)
    x = Scale(low=float(found.freq_hz[0]), high=float(found.freq_hz[-1]), log=True)
    upper_y, lower_y = log_scale(magnitude, most_decades=4.0), Scale(low=0.0, high=1.0)
    left = max(
        plot_frame(columns, rows - lower, x, upper_y, title=" ", x_axis=not lower).left,
        plot_frame(columns, max(lower, 1), x, lower_y, title=" ").left if lower else 0,
    )
    upper_plot = plot(
        columns,
        rows - lower,
        [
            Series(x=found.freq_hz, y=values, style=AXIS_STYLES[i % len(AXIS_STYLES)])
            for i, values in enumerate(magnitude)
        ],
        x=x,
        y=upper_y,
        title=f"FRF of point {point}, {hits}, x y z (m/s²/N)",
        x_name="Hz",
        x_axis=not lower,
        left=left,
    ).text()
    if not lower:
        return upper_plot
    values = found.coherence
    coherence = plot(
        columns,
        lower,
        [] if values is None else [Series(x=found.freq_hz, y=values, style="bold")],
        x=x,
        y=lower_y,
        title="coherence: needs a second hit" if values is None else "coherence, lowest of x y z",
        x_name="Hz",
        left=left,
    ).text()
    return Text("\n").join([upper_plot, coherence])
