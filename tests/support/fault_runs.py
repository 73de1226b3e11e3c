"""Small sessions under seeded faults, held against what truly happened.

The invariant, for every seed: what was accepted is in the ledger, byte for byte; every missing
sample is reported; none is invented; the session goes on, or stops with the reason.
"""

import signal
import tempfile
from collections import Counter
from dataclasses import dataclass, field, replace
from functools import cache, partial
from pathlib import Path

import numpy as np
from support.virtual_lab import HangError, VirtualLab, heard_stream

from armodal.daq.acquisition import run_acquisition
from armodal.daq.events import Failed, Finished, HitJudged
from armodal.daq.settings import AcquisitionSettings
from armodal.hil_sim.faults import Fault
from armodal.protocols.arm.files import load_arm
from armodal.protocols.plan import plan_from_text
from armodal.protocols.session.journal import read_journal

PLAN = """
format = "armodal-plan-1"
name = "faults"
arm = "rv4frl"
mode = "roving-response"
fixed_point = "1"
hits_per_point = 2
max_attempts = 12
[sampling]
rate_hz = "51200/31"
samples = 256
pretrigger = 64
[trigger]
level_n = 8.0
slope = "rising"
[windows]
exponential_end = 0.03
[sensor]
mass_kg = 0.0093
[[postures]]
name = "test 1"
joints_deg = [-25.0, 90.0, 0.0, 0.0, 90.0, 0.0]
tolerance_deg = 0.5
points = ["2", "3"]
hit_direction = [0.0, -1.0, 0.0]
"""
FOR_GOOD_S = 20.0  # of processor time of one run, beyond which it hangs
MOST_RUNS = 6
# A session without faults takes about 6500 samples.
LAST_SAMPLE = 6000
ONCE = frozenset(
    {
        Fault.BOARD_REBOOT,
        Fault.DICTIONARY_CHANGE,
        Fault.CLOCK_JUMP,
        Fault.ADC_GAP,
        Fault.ARM_MOVES,
        Fault.ARM_TWITCHES,
    }
)
MATRIX = tuple(Fault)
# A block begins at most so far from the blow that triggered it: the pulse's rise.
TRIGGER_REACH = 12


shipped_arm = cache(partial(load_arm, "rv4frl"))


def script_of(seed):
    """Return the faults of a seed, by sample index and by blow.

    All kinds in turn; in every other round two at once; in two rounds of three around a blow.
    """
    rng = np.random.default_rng([seed, 0xFA])
    turn, of_kind = divmod(seed, len(MATRIX))
    faults = [MATRIX[of_kind]]
    if turn % 2:
        faults.append(MATRIX[int(rng.integers(len(MATRIX)))])
    lasting = [
        0 if f in ONCE else int(np.exp(rng.uniform(np.log(16), np.log(4000)))) for f in faults
    ]
    if turn % 3 == 2:
        at = int(rng.integers(0, LAST_SAMPLE))
        return tuple(
            f"{f}@{at}" + (f"+{n}" if n else "") for f, n in zip(faults, lasting, strict=True)
        ), ()
    blow, after = int(rng.integers(1, 5)), int(rng.integers(-64, 256))
    return (), tuple((blow, str(f), after, n) for f, n in zip(faults, lasting, strict=True))


@dataclass
class Outcome:
    """What became of one seed."""

    seed: int
    faults: tuple
    violations: list = field(default_factory=list)
    endings: list = field(default_factory=list)
    counts: Counter = field(default_factory=Counter)
    journal: bytes = b""


def run_seed(seed, *, script=None, plan=None, make_lab=VirtualLab):
    """Run a small session under the faults of a seed, resumed where it fails, and check it."""
    arm = shipped_arm()
    plan = plan or plan_from_text(PLAN, arm)
    faults, at_blows = script_of(seed) if script is None else script
    outcome = Outcome(seed=seed, faults=faults + at_blows)
    with tempfile.TemporaryDirectory() as folder:
        lab = make_lab(plan, Path(folder), seed=seed, faults=faults, at_blows=at_blows)
        settings = AcquisitionSettings(
            board_port="board",
            can_channel="can",
            arm=arm,
            plan=plan,
            journal=Path(folder) / "session.journal",
            session_id="a" * 16,
        )
        signal.signal(signal.SIGPROF, _too_long)
        signal.setitimer(signal.ITIMER_PROF, FOR_GOOD_S)
        try:
            _sessions(lab, settings, outcome)
        except HangError as error:
            outcome.violations.append(f"hang: {error}")
        except Exception as error:  # noqa: BLE001 - any error but the declared is the finding
            outcome.violations.append(f"undeclared {type(error).__name__}: {error}")
            outcome.endings.append(error)
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            lab.close()
        if settings.journal.exists():
            outcome.journal = settings.journal.read_bytes()
        if settings.journal.exists() and not outcome.violations:
            Checker(lab, read_journal(settings.journal), outcome).check()
    return outcome


def _too_long(_number, _frame):
    raise HangError(f"more than {FOR_GOOD_S:g} s of processor time")


def _sessions(lab, settings, outcome):
    lab.runs = []
    for _ in range(MOST_RUNS):
        n_epochs, n_ends = len(lab.epochs), len(lab.ends)
        lab.operator.begin()
        lab.channel.said.clear()
        resumed = replace(settings, resume=settings.journal.exists())
        session = lab.firmware.session
        code = run_acquisition(resumed, lab.channel, lab.surroundings())
        last = lab.operator.events[-1][1]
        outcome.endings.append(last)
        lab.runs.append(
            {
                "epochs": lab.epochs[n_epochs:],
                "ends": lab.ends[n_ends:],
                "session": session,
                "ending": last,
            }
        )
        if not isinstance(last, Failed | Finished):
            outcome.violations.append(f"ended without a word: {last}")
            return
        reason = last.reason if isinstance(last, Finished) else last.message
        if not reason or code != (2 if isinstance(last, Failed) else 0):
            outcome.violations.append(f"ended with code {code} and reason {reason!r}")
        if isinstance(last, Finished):
            return
        lab.advance(2.0)  # until somebody has seen to it
    outcome.counts["gave up"] += 1


class Checker:
    """Journal against laboratory."""

    def __init__(self, lab, journal, outcome):
        self._lab, self._journal, self._outcome = lab, journal, outcome
        self._plan = lab.plan

    def wrong(self, what):
        self._outcome.violations.append(what)

    def check(self):
        self.announced()
        seen = set()
        for hit in self._journal.hits:
            epoch = self.found(hit)
            if epoch is None:
                continue
            key = (self._lab.epochs.index(epoch), hit.trigger_sample)
            if key in seen:
                self.wrong(f"hit {hit.number} is the second one of trigger {key}")
            seen.add(key)
            if hit.verdict.accepted:
                self.accepted(hit, epoch)
            self._outcome.counts["accepted" if hit.verdict.accepted else "rejected"] += 1
            self._outcome.counts.update(hit.verdict.reasons)
        self.stream()
        self.blocks(seen)
        self._outcome.counts[type(self._outcome.endings[-1]).__name__] += 1

    def announced(self):
        """What was said to be accepted is in the journal, as it was said."""
        kept = {hit.number: hit for hit in self._journal.hits}
        for _, event in self._lab.operator.events:
            if isinstance(event, HitJudged):
                hit = kept.get(event.hit.number)
                if hit is None or not np.array_equal(hit.counts, event.hit.counts):
                    self.wrong(f"hit {event.hit.number} was announced and is not in the journal")

    def found(self, hit):
        """Return the epoch in which these very samples were taken."""
        n = len(hit.counts)
        if n == 0:
            return None
        for epoch in self._lab.epochs:
            if np.array_equal(epoch.counts(hit.first_sample, n), hit.counts):
                return epoch
        self.wrong(f"hit {hit.number}: {n} samples from {hit.first_sample} were never taken so")
        return None

    def accepted(self, hit, epoch):
        n = len(hit.counts)
        if n != self._plan.sampling.samples:
            self.wrong(f"accepted hit {hit.number} has {n} samples")
        near = [
            blow
            for blow in epoch.blows
            if abs(blow["at_sample"] - hit.trigger_sample) <= TRIGGER_REACH
        ]
        if len(near) != 1:
            self.wrong(f"accepted hit {hit.number} belongs to {len(near)} blows")
            return
        if (near[0]["sensor_point"], near[0]["point"]) != (hit.sensor_point, hit.hit_point):
            self.wrong(f"accepted hit {hit.number} is of another point: {near[0]}")
        posture = next(p for p in self._plan.postures if p.name == hit.posture)
        begin_s, end_s = epoch.lab_s(hit.first_sample), epoch.lab_s(hit.first_sample + n)
        joints_rad = self._lab.true_joints(begin_s, end_s)
        off_rad = np.abs(joints_rad - posture.joints_rad).max()
        # Encoder noise is 1e-4 of the tolerance.
        if off_rad > 1.01 * posture.tolerance_rad:
            self.wrong(f"accepted hit {hit.number}: the arm was {np.degrees(off_rad):.2f} deg off")
        elif np.ptp(joints_rad, axis=0).max() > 0.26 * posture.tolerance_rad:
            self.wrong(f"accepted hit {hit.number}: the arm moved")
        true_s = epoch.lab_s(hit.trigger_sample)
        delay_s = self._lab.dictionary.filter_group_delay_samples / epoch.rate_hz
        # A step of the laboratory, the round trip, and 500 ppm of a whole session.
        if abs(hit.trigger_host_s - (true_s - delay_s)) > 0.05:
            self.wrong(
                f"accepted hit {hit.number}: its time is "
                f"{hit.trigger_host_s - true_s + delay_s:.3f} s off"
            )

    def stream(self):
        """What came of the preview and what was reported missing are all that was taken."""
        missing = 0
        for run in self._lab.runs:
            if not run["epochs"] or not run["ends"]:
                continue
            epoch = run["epochs"][-1]
            heard = heard_stream(run["ends"][0], run["session"])
            heard = [s for s in heard if self.same(epoch, s)]
            if not heard:
                continue
            reach = max(s.first_sample + len(s.counts) for s in heard)
            missing += reach - sum(len(s.counts) for s in heard)
            self._outcome.counts["preview samples"] += reach
        reported = self.reported("preview samples that never came")
        if reported != missing:
            self.wrong(f"{missing} preview samples are missing, {reported} reported")
        self._outcome.counts["missing preview samples"] += missing

    def same(self, epoch, samples):
        truth = epoch.counts(samples.first_sample, len(samples.counts))
        if np.array_equal(truth, samples.counts):
            return True
        if not any(
            np.array_equal(e.counts(samples.first_sample, len(samples.counts)), samples.counts)
            for e in self._lab.epochs
        ):
            self.wrong(f"preview from {samples.first_sample} was never taken so")
        return False

    def blocks(self, seen):
        """Every trigger of the last run is a hit, was set aside with a note, or is a loss."""
        short = sum(
            self._plan.sampling.samples - len(hit.counts)
            for hit in self._journal.hits
            if len(hit.counts) < self._plan.sampling.samples
        )
        reported = self.reported("samples of a triggered block that never came")
        if reported < short:
            self.wrong(f"{short} samples of blocks are missing, {reported} reported")
        last = self._lab.runs[-1]
        if isinstance(last["ending"], Finished):
            missed = self._lab.firmware.triggers_missed
            told = self.reported("triggers the board missed")
            if told < missed:
                self.wrong(f"the board missed {missed} triggers, {told} reported")
            overruns = self._lab.firmware.adc_overruns
            if self.reported("overruns of the converter") < overruns:
                self.wrong(f"{overruns} overruns of the converter were not reported")

    def reported(self, note):
        return sum(loss.count for loss in self._journal.losses if loss.note == note)
