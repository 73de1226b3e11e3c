"""What the operator's wishes lead to: the processes started, told and ended; the state kept.

It knows nothing of screens: the app hands wishes in and is told of every event.
"""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable
from dataclasses import replace

from armodal.analyzer.own_arm.typed_move import typed_move
from armodal.daq.commands import (
    MovePoint,
    Note,
    Ready,
    Retake,
    Skip,
    StatedPosture,
    Stop,
    TriggerLevel,
    Withdraw,
)
from armodal.daq.events import JointsSeen, PointMoved, SessionOpened, TrialHit
from armodal.daq.ports import find_ports
from armodal.daq.session_machine import PromptKind
from armodal.daq.settings import AcquisitionSettings
from armodal.protocols.errors import ArmodalError
from armodal.protocols.session.moved_points import arm_with_moves, moved_points
from armodal.tui.operators import request_for
from armodal.tui.screens.run.confirmed import CONFIRMED, confirmed_words
from armodal.tui.screens.run.derive import derive_session_file
from armodal.tui.screens.run.engine import Engine
from armodal.tui.screens.run.hand import mark_request, trial_request
from armodal.tui.screens.run.happenings import (
    HandIdle,
    Happening,
    LabEnded,
    LabStarting,
    LabWanted,
    MassChosen,
    PortsFound,
    RatioConfirmed,
    RatioFound,
    SafeConfirmed,
    SensorsConfirmed,
    SessionFileReady,
    SessionWanted,
    Tick,
    TriggerChosen,
)
from armodal.tui.screens.run.laboratory import SimulatedLab
from armodal.tui.screens.run.measured import mass_ratio
from armodal.tui.screens.run.options import RunOptions
from armodal.tui.screens.run.place import find_place, with_trigger_level
from armodal.tui.screens.run.reducer import reduce
from armodal.tui.screens.run.state import Phase, RunState, begin_state
from armodal.tui.screens.run.trials import suggested_level_n

__all__ = ["Conductor"]

LEAVING = "the operator has left; the session can be continued"


class Conductor:
    """The operator's right hand; all methods are called on the event loop.

    Parameters
    ----------
    options
        Ports, session, simulation.
    changed
        Told of every event, after the state has taken it in.
    clock
        Wall seconds.
    make_engine
        Makes the line to the processes from what is to be told of every event.
    """

    def __init__(
        self,
        options: RunOptions,
        changed: Callable[[Happening], None],
        clock: Callable[[], float],
        make_engine: Callable[[Callable[[Happening], None]], Engine] = Engine,
    ) -> None:
        self._clock = clock
        self.options = options
        self.place = options.place
        self._changed = changed
        self._engine = make_engine(self.tell)
        self._lab: SimulatedLab | None = None
        place = options.place
        ended = (place.ended or "it was interrupted") if place.begun else None
        begun = begin_state(
            arm_with_moves(place.arm, place.marks),
            place.plan,
            time_scale=options.time_scale,
            told_rad=options.told_rad,
            earlier_hits=place.hits,
            earlier_marks=place.marks,
            earlier_end=ended,
        )
        self.state: RunState = replace(
            begun,
            now_s=clock(),
            other_frfs=options.earlier,
            std_wanted=options.std_wanted,
            known_sensors=options.known_sensors,
        )

    def tell(self, event: Happening) -> None:
        """Take an event in."""
        before = self.state
        if isinstance(event, JointsSeen):
            # What is heard now is known now, however long ago the clock was last looked at.
            before = replace(before, now_s=self._clock())
        self.state = reduce(before, event)
        self._changed(event)
        if isinstance(event, TrialHit) and self.state.mass_kg is not None:
            found = mass_ratio(self.state)
            if found is not None:
                self.tell(RatioFound(calibration=found))
        elif isinstance(event, SessionOpened):
            for words in confirmed_words(self.state):
                self._engine.send(Note(text=words))
        elif isinstance(event, PointMoved) and self._lab is not None:
            self._lab.hand.do(*mark_request(event.arm.point(event.point)))

    def tick(self) -> None:
        """Look at the clock, once all that was said meanwhile has been heard."""
        if self._lab is not None and self.state.lab_ended is None:
            why = self._lab.failure()
            if why is not None:
                self.tell(LabEnded(why=why))
        self._engine.hear()
        self.tell(Tick(now_s=self._clock()))

    async def start(self) -> None:
        """Begin as it was asked for: simulated, with the ports given, or by looking for them."""
        if self.options.simulated:
            await self.simulate()
        elif self.options.board and (self.options.can or self.options.without_bus):
            self._watch(
                self.options.board, self.options.can, input_range_v=self.options.input_range_v
            )
        else:
            found = find_ports()
            self.tell(PortsFound(ports=tuple((port.path, port.description) for port in found)))

    async def simulate(self) -> None:
        """Start the simulated laboratory, or a fresh one if it has gone, and watch it."""
        if self.state.phase is not Phase.LAB or (self._lab is not None and self._lab.alive):
            return
        self.tell(LabStarting())
        await self._engine.end(Stop())
        await self._open_lab()
        if self._lab is not None:
            laboratory = self._lab.laboratory
            self._watch(
                laboratory.board,
                laboratory.can,
                simulated=True,
                input_range_v=laboratory.input_range_v,
            )

    def choose_port(self, number: int) -> None:
        """Take a port of the list: the board's first, then the controller's."""
        ports = self.state.ports
        if self.state.board_port or not 1 <= number <= len(ports):
            return
        path = ports[number - 1][0]
        board = self.state.board_choice
        if self.options.without_bus:
            self._watch(path, "", input_range_v=self.options.input_range_v)
        elif not board:
            self.tell(PortsFound(ports=ports, board_choice=path))
        elif path != board:
            self._watch(board, path, input_range_v=self.options.input_range_v)

    async def go_on(self) -> None:
        """Do what Enter means now: confirm, begin, or say that the sensor is mounted."""
        state = self.state
        prompt = state.prompt
        if state.phase is Phase.LAB:
            if state.board is None or not state.angles_will_come:
                return
            if state.mass_kg is not None:
                self.choose_mass(None)
            elif not state.sensors_confirmed:
                self.tell(SensorsConfirmed())
            elif state.ratio_asks:
                self.tell(RatioConfirmed())
            else:
                await self._begin()
        elif state.phase is Phase.SESSION and prompt is not None:
            if prompt.kind is PromptKind.POSTURE:
                self.tell_angles(None)
                return
            if not state.safe:
                self.tell(SafeConfirmed())
                if self.state.safe:
                    self._engine.send(Note(text=f"{CONFIRMED} the arm is held, safe to approach"))
            elif prompt.kind is PromptKind.POINT and state.hand_doing is None:
                self._engine.send(Ready())

    def hand(self) -> None:
        """Have the simulated hand do what is asked."""
        state, lab = self.state, self._lab
        if lab is None or state.hand_doing is not None:
            return
        if state.phase is Phase.LAB:
            lab.hand.do(*trial_request(state.arm, state.plan, state.mass_kg))
        elif state.phase is Phase.SESSION and state.prompt is not None:
            wanted = request_for(state.arm, state.prompt)
            if wanted is not None:
                lab.hand.do(*wanted)

    def tell_angles(self, joints_deg: tuple[float, ...] | None) -> None:
        """Say where the arm stands: at the planned angles, or at those typed, in degrees."""
        if self.state.awaits_word:
            typed = None if joints_deg is None else tuple(math.radians(x) for x in joints_deg)
            self._engine.send(StatedPosture(joints_rad=typed))

    async def move_point(self, typed: str) -> None:
        """Put the point in hand elsewhere on its link, as typed."""
        state = self.state
        if state.here is None:
            return
        try:
            point = await asyncio.to_thread(
                typed_move, state.arm, self.options.arm_folder, state.here[1], typed
            )
        except ArmodalError as error:
            self.tell(HandIdle(trouble=str(error)))
            return
        self._engine.send(MovePoint(point=point))

    def choose_mass(self, mass_kg: float | None) -> None:
        """Take hits on a known mass, or on the arm again."""
        if self.state.phase is Phase.LAB:
            self.tell(MassChosen(mass_kg=mass_kg))

    def take_trigger(self) -> None:
        """Take the suggested trigger level for the board and for the plan of the session."""
        level_n = suggested_level_n(self.state)
        if self.state.phase is not Phase.LAB or self.state.resuming or level_n is None:
            return
        try:
            plan = with_trigger_level(self.place.plan, self.place.arm, level_n)
        except ArmodalError as error:
            self.tell(HandIdle(trouble=str(error)))
            return
        self.place = replace(self.place, plan=plan)
        self.tell(TriggerChosen(plan=plan))
        self._engine.send(TriggerLevel(level_n=level_n))

    def retake(self, place: tuple[str, str] | None = None) -> None:
        """Begin the point in hand anew, or jump to another one."""
        if self.state.phase is Phase.SESSION:
            posture, point = place or (None, None)
            self._engine.send(Retake(posture=posture, point=point))

    def skip(self) -> None:
        """Leave the point in hand."""
        if self.state.phase is Phase.SESSION:
            self._engine.send(Skip(reason="skipped by the operator"))

    def undo(self) -> None:
        """Take the last accepted hit back."""
        if self.state.phase is Phase.SESSION:
            self._engine.send(Withdraw())

    async def again(self) -> None:
        """Go on after the session has stopped, at the same point."""
        if self.state.phase not in {Phase.FAILED, Phase.ENDED}:
            return
        await self._engine.end(Stop())
        try:
            self.place = find_place(self.place.journal, self.place.arm, self.place.plan)
        except ArmodalError as error:
            self.tell(HandIdle(trouble=str(error)))
            return
        if self.options.simulated or self.state.simulated:
            await self._open_lab()
            if self._lab is None:
                return
            laboratory = self._lab.laboratory
            wanted = LabWanted(
                board_port=laboratory.board,
                can_channel=laboratory.can,
                simulated=True,
                input_range_v=laboratory.input_range_v,
            )
            self.tell(wanted)
        self.tell(SessionWanted())
        self._engine.acquire(self._settings())

    async def leave(self) -> None:
        """End what runs; a hit under way is finished first."""
        await self._engine.end(Stop(reason=LEAVING, finish_hit=self.state.phase is Phase.SESSION))

    def close(self) -> None:
        """Hang up and stop the laboratory."""
        self._engine.abandon()
        if self._lab is not None:
            self._lab.close()
            self._lab = None

    async def derive(self) -> None:
        """Derive the session file from the journal."""
        place = self.place
        problem = None
        try:
            await asyncio.to_thread(
                derive_session_file, place.journal, place.session_file, self.options.software
            )
        except (ArmodalError, OSError) as error:
            problem = str(error)
        self.tell(SessionFileReady(path=str(place.session_file), problem=problem))

    async def _begin(self) -> None:
        """Let the watch go, and start the acquisition on the same ports."""
        self.tell(SessionWanted())
        await self._engine.end(Stop())
        self._engine.acquire(self._settings())

    async def _open_lab(self) -> None:
        if self._lab is not None:
            if self._lab.alive:
                return
            self._lab.close()
            self._lab = None
        loop = asyncio.get_running_loop()

        def tell(event: Happening) -> None:
            if not loop.is_closed():
                loop.call_soon_threadsafe(self.tell, event)

        try:
            self._lab = await asyncio.to_thread(
                SimulatedLab,
                self.place.arm,
                self.place.plan,
                hidden=self.options.hidden,
                seed=self.options.seed,
                time_scale=self.options.time_scale,
                tell=tell,
            )
        except ArmodalError as error:
            self.tell(HandIdle(trouble=f"the simulated laboratory does not start: {error}"))
        else:
            for point in moved_points(self.place.arm, self.state.arm):
                self._lab.hand.do(*mark_request(point))

    def _watch(
        self, board: str, can: str, *, simulated: bool = False, input_range_v: float | None
    ) -> None:
        self.tell(
            LabWanted(
                board_port=board,
                can_channel=self.options.joint_source or can,
                simulated=simulated,
                input_range_v=input_range_v,
            )
        )
        self._engine.watch(self._settings())

    def _settings(self) -> AcquisitionSettings:
        return AcquisitionSettings(
            board_port=self.state.board_port,
            board_baud=self.options.baud,
            can_channel="" if self.options.without_bus else self.state.can_channel,
            controller=self.options.controller,
            mirror=self.options.mirror,
            teds_confirmed=self.state.sensors_confirmed,
            input_range_v=self.state.input_range_v,
            sensor_memory=self.options.sensor_memory,
            told_tolerance_rad=self.options.told_rad,
            measured_by=self.options.measured_by,
            arm=self.place.arm,
            plan=self.place.plan,
            journal=self.place.journal,
            resume=self.place.begun,
            time_scale=self.state.time_scale,
            software=self.options.software,
        )
