"""What holds for all tests."""

import gc
import os
import tempfile
import time
from functools import cache

# Matrices here are small: one BLAS thread is ten times faster than many. Read when numpy loads.
for _library in ("OPENBLAS", "OMP", "MKL"):
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")

# A screen is waited for until it moves no more. Read when textual loads.
os.environ["TEXTUAL_ANIMATIONS"] = "none"

# What is remembered of sensors is the tests' own.
_HOME = tempfile.TemporaryDirectory(prefix="armodal-tests-")
os.environ["XDG_DATA_HOME"] = _HOME.name

import pytest
from hypothesis import settings
from support.held_up import HeldUpError, StallWatch
from support.not_apart import here
from support.offline_lab import first_postures, simulate_session
from support.once_for_all import once_for_all
from support.plain_structure import moving_fit
from support.shares import in_share

from armodal.analyzer.arm import Superset
from armodal.analyzer.identification.identify import identify
from armodal.analyzer.planning import equipment, search, selective
from armodal.hil_sim.plant import load_plant
from armodal.protocols.arm.files import load_arm
from armodal.protocols.foreign import motion_messages
from armodal.protocols.robot import mjcf

# Looking for garbage is put off: it takes a tenth of all tests' time.
gc.set_threshold(100_000, 20, 100)
FREEZE, UNFREEZE = gc.freeze, gc.unfreeze

# A loaded machine stalls for seconds: how long one example takes says nothing.
settings.register_profile("all", deadline=None)
settings.register_profile("quick", parent=settings.get_profile("all"), max_examples=25)

# Devices here keep their time whatever the machine does, and hosts wait for them as for real ones:
# at eight times the speed a twentieth of a second is more than what those allow.
STALL_S = 0.04
AGAIN = 4  # times such a test is repeated, at most
WHOLE = "0/1"  # share of the long tests
watch = cache(StallWatch)  # begun with the first of those tests


def pytest_configure(config):
    """Properties meet fewer examples where not all long tests run."""
    quick = config.option.markexpr == "not long" or config.option.share != WHOLE
    settings.load_profile("quick" if quick else "all")


def pytest_addoption(parser):
    parser.addoption("--share", default=WHOLE, help="part K of N of the long tests, from 0/N")


def pytest_collection_modifyitems(config, items):
    share = config.option.share
    items[:] = [
        item
        for item in items
        if item.get_closest_marker("long") is None or in_share(item.nodeid, share)
    ]
    for item in items:
        if "real_time" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.flaky(reruns=AGAIN, only_rerun=[HeldUpError.__name__]))


def pytest_collection_finish():
    """Leave what is loaded by now out of Python's garbage collection: it stays to the end.

    A session looks at all that there is once more, as its process begins. Here some thousand tests
    are loaded too, which takes half a second each time: only what came since is looked at. What a
    session leaves out stays so too, or the next would look at all that tests have loaded by then.
    """
    gc.collect()
    gc.freeze()
    gc.unfreeze = _nothing


def _nothing():
    """Leave what is frozen as it is."""


@pytest.fixture
def freezing(monkeypatch):
    """Asked for where it is tested what is left out of collection: it is, and comes back."""
    monkeypatch.setattr(gc, "freeze", FREEZE)
    monkeypatch.setattr(gc, "unfreeze", UNFREEZE)
    yield
    FREEZE()


@pytest.fixture(scope="session")
def real_time():
    """Asked for where devices keep real time: a test is repeated if the machine was held up."""


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item):
    if "real_time" not in getattr(item, "fixturenames", ()):
        return (yield)
    watch()
    began_s = time.monotonic()
    try:
        return (yield)
    except (Exception, pytest.fail.Exception) as error:
        held_up_s = watch().longest_s(began_s)
        if held_up_s < STALL_S:
            raise
        raise HeldUpError(f"a processor was held up for {held_up_s:.3f} s") from error


@pytest.fixture(scope="session")
def arm():
    return load_arm("rv4frl")


@pytest.fixture(scope="session")
def plant():
    """The truth of `arm`, an axis in its shoulder included."""
    return load_plant("rv4frl")


@pytest.fixture(scope="session")
def session(tmp_path_factory):
    """The arm measured by its shipped plan, three postures and one for validation; good hits."""

    def measured():
        return simulate_session(4, plan=first_postures(4))

    return once_for_all(tmp_path_factory, "session", measured)


@pytest.fixture(scope="session")
def identified(session, tmp_path_factory):
    return once_for_all(tmp_path_factory, "identified", lambda: identify(session))


@pytest.fixture(scope="session")
def moving(tmp_path_factory):
    """FRFs whose resonances a sensor's mass moves, and their modes."""
    return once_for_all(tmp_path_factory, "moving", moving_fit)


@pytest.fixture(scope="session")
def superset(arm):
    return Superset(arm)


@pytest.fixture(scope="module")
def small_search():
    """A plan's search of fewer postures: what is found is as free, if less selective."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(search, "N_RANDOM", 1000)
        patch.setattr(search, "ROUNDS", 2)
        patch.setattr(search, "N_LIKE", 2)
        patch.setattr(search, "N_VARIOUS", 4)
        patch.setattr(equipment, "N_POSTURES", 10)
        patch.setattr(selective, "N_OTHERS", 10)
        yield


@pytest.fixture
def not_apart(monkeypatch):
    """Asked for where logs and MJCFs are sound: they are read in this process, much sooner."""
    for module in (motion_messages, mjcf):
        monkeypatch.setattr(module, "apart", here)
