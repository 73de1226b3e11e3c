"""A gap result to show: an axis named in the shoulder, every part of the record filled."""

from __future__ import annotations

from armodal.analyzer.gap.records import (
    Disagreement,
    EffectFound,
    GapResult,
    Gate,
    Hidden,
    Interval,
    ModeMatch,
    PostureGap,
    RivalRow,
    StiffnessRange,
    Verdict,
)


def named_result(session):
    """A result with the postures and joints of a session."""
    postures = session.header.plan.postures
    joints = session.header.arm.joints
    size = "axis compliance"
    compliance = Interval(unit="rad/(N m)", value=1.12e-5, std=2e-7, low=1.08e-5, high=1.16e-5)

    def gap(error, model):
        mode = ModeMatch(
            measured_hz=15.0,
            model_hz=model,
            measured_damping_ratio=0.02,
            model_damping_ratio=0.02,
            mac=0.99,
        )
        return tuple(
            PostureGap(
                posture=posture.name,
                held_out=posture.validation,
                frf_error=error,
                floor=0.03,
                modes=(mode,) * 4,
            )
            for posture in postures
        )

    return GapResult(
        verdict=Verdict.NAMED,
        summary="The shoulder gives way.",
        effects=(
            EffectFound(
                name="link_axis",
                title="Link is compliant about an axis of its own",
                place=joints[0].link.name,
                parameters={size: compliance},
                size=size,
                description={
                    "link": joints[0].link.name,
                    "direction": [0.96, 0.0, 0.28],
                    "point_m": [-0.05, 0.02, 0.18],
                },
                confidence=0.9999,
                gain=800.0,
                held_out_gain=200.0,
                signature="a mode about one line",
                confused_with=("bearing",),
                told_by="a hit along the axis",
                remedy="look for a loose flange along that line",
            ),
        ),
        rivals=(
            RivalRow(
                name="bearing",
                title="Bearing soft across its axis",
                place=joints[1].name,
                gain=3.0,
                behind=0.5,
                standing=False,
                material=False,
                parameters={size: compliance},
                told_by="another posture",
            ),
        ),
        hidden=(Hidden(name="payload", place="wrist", parameter="mass", unit="kg", largest=0.4),),
        joint_stiffness_ranges=tuple(
            StiffnessRange(
                joint=joint.name, k_n_m_per_rad=2e4, k_std=400.0, low=19000.0, high=21000.0
            )
            for joint in joints[:3]
        ),
        gap_before=gap(0.2, 16.0),
        gap_after=gap(0.01, 15.01),
        where=tuple(
            Disagreement(posture=p.name, point=str(k), axis=axis, band_hz=band, ratio=0.5 * k)
            for p in postures
            for k in range(1, 19)
            for axis in "xyz"
            for band in ((5.0, 20.0), (20.0, 60.0), (60.0, 150.0))
        ),
        interface="the root of the shoulder",
        gates=tuple(
            Gate(check=f"{check} {p.name}", outcome=outcome, words=words)
            for p in postures
            for check, outcome, words in (
                ("rigid link", "good", "the points move as rigid links"),
                ("homogeneity", "cannot tell", "too uncertain to say"),
                ("driving point", "good", "all clear resonances take energy"),
                ("drift", "good", "no mode moves from point to point"),
            )
        ),
        notes=("one posture was held out",),
        misfit_per_line=0.5,
    )
