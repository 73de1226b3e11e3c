"""Limits of evidence made up for tests of what judges by them."""

from math import log

from armodal.analyzer.gap.decision.calibration import Calibration, Tail


def made_calibration(limit=100.0, *, apart=20.0, limits=None, error_ratio=0.5):
    """A calibration by which every effect needs `limit` nats, or those of `limits` by its name."""
    false_name = 0.01
    return Calibration(
        false_name=false_name,
        n_replicas=1000,
        tails={name: Tail(begin=own, scale=0.0) for name, own in (limits or {}).items()},
        whole=Tail(begin=limit, scale=0.0),
        least_p=1e-3,
        dispersion=apart / log(1.0 / false_name),
        error_ratio=error_ratio,
    )
