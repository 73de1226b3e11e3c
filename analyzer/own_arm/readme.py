"""What is to be checked before a new arm is measured, as a page beside its file."""

from __future__ import annotations

from armodal.analyzer.own_arm.draft import Draft
from armodal.protocols.robot.remarks import Remarks

__all__ = ["readme_text"]

_KINDS = (
    ("doubt", "Doubted", "The description says this, and no body of that shape is like it."),
    ("guess", "Guessed", "The description does not say this. Put in what you know."),
    ("note", "Done", "What is not part of the arm was held or left out."),
)


def readme_text(draft: Draft, said: Remarks) -> str:
    """A page in Markdown."""
    arm, believed = draft.arm, draft.believed
    moving = sum(joint.link.mass_kg for joint in arm.joints)
    rows = [
        f"# {arm.name}: check this before you measure",
        "",
        f"{len(arm.joints)} joints, {moving:.4g} kg that move, {len(arm.points)} points.",
        "No stiffness can be known better than the inertias: mass, moments and centre of each link",
        "are believed to one standard deviation, as the table says.",
        "",
        "| joint | range, deg | link | mass kg | inertial | moments | centre | k, N m/rad |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for joint, std in zip(arm.joints, believed.stds, strict=True):
        low, high = (f"{57.29577951308232 * angle:.1f}" for angle in joint.range_rad)
        how = "guessed" if joint.link.name in believed.guessed else "as given"
        k = "rigid" if joint.stiffness is None else f"{joint.stiffness.value:.3g} (guess)"
        rows.append(
            f"| {joint.name} | {low} to {high} | {joint.link.name} | {joint.link.mass_kg:.3g} "
            f"± {100 * std.mass:.0f} % | {how} | ± {100 * std.inertia:.0f} % "
            f"| ± {1e3 * std.center_m:.0f} mm | {k} |"
        )
    for kind, title, reason in _KINDS:
        remarks = said.of(kind)
        if remarks:
            rows += ["", f"## {title}", "", reason, "", *(f"- {remark}" for remark in remarks)]
    rows += [
        "",
        "## On the arm",
        "",
        "- Do the joints turn the way the file says, and by its zero?",
        "- Is the mass the data sheet's? If you know it, make the arm again with `--mass`.",
        "- `points.html` shows the points. Is every one on a bare, stiff face, not on a cover?",
        "  Move it in the arm file if not.",
        "- A `[can]` table tells where the joint angles are found (docs/arm-file.md).",
        "",
        f"Then `armodal arm check {arm.name}.toml`, `armodal plan {arm.name}.toml` for another",
        f"plan, and a rehearsal: `armodal run plan.toml --arm {arm.name}.toml --sim`.",
        "",
    ]
    return "\n".join(rows)
