"""Results of the gap workflow made up for tests of what reads them."""

from armodal.analyzer.gap.records import EffectFound, GapResult, Interval, RivalRow, Verdict


def _effect(name):
    return EffectFound(
        name=name,
        title=name,
        place="knuckle",
        parameters={"size": Interval(unit="kg", value=1.0, std=0.1, low=0.8, high=1.2)},
        size="size",
        description={},
        confidence=0.99,
        gain=100.0,
        held_out_gain=30.0,
        signature="",
        confused_with=(),
        told_by="",
        remedy="",
    )


def _rival(name):
    return RivalRow(
        name=name,
        title=name,
        place="knuckle",
        gain=50.0,
        behind=0.0,
        standing=True,
        material=True,
        parameters={},
        told_by="",
    )


def made_result(verdict, names, *, standing=()):
    """A result with these effects named and these rivals standing."""
    return GapResult(
        verdict=Verdict(verdict),
        summary="",
        effects=tuple(_effect(name) for name in names),
        rivals=tuple(_rival(name) for name in standing),
        hidden=(),
        joint_stiffness_ranges=(),
        gap_before=(),
        gap_after=(),
        where=(),
        interface="",
        gates=(),
        notes=(),
        misfit_per_line=0.5,
    )
