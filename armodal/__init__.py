"""Modal tests of robot arms: from hammer hits to a model that explains the measurement.

The command `armodal` and its terminal app do the whole test. This module is the same analysis for
scripts and notebooks; everything here takes and returns records that do not change.

>>> import armodal
>>> arm = armodal.load_arm("rv4frl")
>>> [joint.name for joint in arm.joints][:3]
['joint_1', 'joint_2', 'joint_3']

A session file, once measured or imported, is read, fitted and explained by::

    session = armodal.open_session("session.h5")
    frf = armodal.frfs(session)[0]
    model = armodal.fit_modes(frf, band_hz=(5.0, 200.0))
    armodal.figure(model, frf=frf).show()

    found = armodal.identify(session)
    armodal.predict(session, found, posture_deg=[0, 30, 30, 0, 90, 0])
    armodal.find_gap(session).summary

A plan with postures free of collisions is made, and written, by::

    Path("plan.toml").write_text(armodal.plan(arm, minutes=120).text)

Units are SI (m, kg, s, N, rad, Hz) but where a name says otherwise. Errors a user can act on are
`ArmodalError`; their message says what was wanted, what came and what to do. Parts of the analysis
that stand here by no name of their own are in `armodal.analyzer`, files in `armodal.protocols`.
"""

from __future__ import annotations

from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from armodal.analyzer.gap.records import GapResult
    from armodal.analyzer.identification.predicted_posture import Prediction
    from armodal.analyzer.identification.records import Identification
    from armodal.analyzer.modal import ModalModel, Mode
    from armodal.analyzer.planning.made import MadePlan
    from armodal.api.figures import figure
    from armodal.api.models import find_gap, identify, plan, predict, report
    from armodal.api.sessions import (
        fit_modes,
        frfs,
        import_session,
        load_arm,
        merge,
        open_session,
        save_session,
    )
    from armodal.protocols.arm.records import Arm
    from armodal.protocols.errors import ArmodalError
    from armodal.protocols.frf_records import FrequencyResponse
    from armodal.protocols.session.records import Session

__all__ = [
    "Arm",
    "ArmodalError",
    "FrequencyResponse",
    "GapResult",
    "Identification",
    "MadePlan",
    "ModalModel",
    "Mode",
    "Prediction",
    "Session",
    "__version__",
    "figure",
    "find_gap",
    "fit_modes",
    "frfs",
    "identify",
    "import_session",
    "load_arm",
    "merge",
    "open_session",
    "plan",
    "predict",
    "report",
    "save_session",
]

__version__ = version("armodal")
SOFTWARE = f"armodal {__version__}"  # what sessions and files say they were written by

# Where each name comes from: what is not asked for is not loaded, so that a command starts at once.
_HOME = {
    "Arm": "protocols.arm.records",
    "ArmodalError": "protocols.errors",
    "FrequencyResponse": "protocols.frf_records",
    "GapResult": "analyzer.gap.records",
    "Identification": "analyzer.identification.records",
    "MadePlan": "analyzer.planning.made",
    "ModalModel": "analyzer.modal",
    "Mode": "analyzer.modal",
    "Prediction": "analyzer.identification.predicted_posture",
    "Session": "protocols.session.records",
    "figure": "api.figures",
    "find_gap": "api.models",
    "fit_modes": "api.sessions",
    "frfs": "api.sessions",
    "identify": "api.models",
    "import_session": "api.sessions",
    "load_arm": "api.sessions",
    "merge": "api.sessions",
    "open_session": "api.sessions",
    "plan": "api.models",
    "predict": "api.models",
    "report": "api.models",
    "save_session": "api.sessions",
}

_HERE = Path(__file__).parent
_unlinked = [path.name for path in _HERE.iterdir() if path.is_file() and not path.suffix]
if _unlinked:
    raise ImportError(
        f"armodal: wanted symbolic links to the folders beside it, found plain files: "
        f"{', '.join(sorted(_unlinked))}; check out again with `git config core.symlinks true`, "
        "or install a wheel"
    )


def __getattr__(name: str) -> Any:
    """Load a public name when it is first asked for."""
    if name not in _HOME:
        raise AttributeError(f"module 'armodal' has no attribute {name!r}")
    value = getattr(import_module(f"armodal.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Return the public names."""
    return sorted(__all__)
