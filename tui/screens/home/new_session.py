"""What a new session is begun with: arm, plan, name, who measures."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, VerticalScroll
from textual.events import DescendantFocus
from textual.screen import ModalScreen
from textual.widgets import Button, Input, Static

from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmodalError
from armodal.protocols.plan import load_plan
from armodal.tui.screens.wishes import Measure

__all__ = ["NewSession"]

SHIPPED_ARM, SHIPPED_PLAN = "rv4frl", "rv4frl-three-postures"
# Of each field its label, and what to know about it.
_FIELDS = {
    "arm": (
        "Arm",
        "A shipped arm, or your own: a TOML file beside its URDF (docs/arm-file.md). Enter: next.",
    ),
    "plan": ("Plan", "A shipped plan, or your own file: armodal plan ARM makes one. Enter: next."),
    "name": ("Name of the session", "Names the files: NAME.journal, NAME.h5. Enter: next."),
    "who": ("Who measures", "Stands in the report; may stay empty. Enter: begin."),
}


class NewSession(ModalScreen[Measure | None]):
    """Four fields; Enter goes to the next one, and begins at the last."""

    DEFAULT_CSS = """
    NewSession { align: center middle; }
    NewSession > VerticalScroll { width: 76; max-width: 100%; height: auto; max-height: 100%;
        border: heavy $accent; padding: 0 1; background: $surface; }
    NewSession #head { text-style: bold; margin-bottom: 1; }
    NewSession Horizontal { height: 1; margin-bottom: 1; }
    NewSession Horizontal Static { width: 21; }
    NewSession Input, NewSession Input:focus { width: 1fr; height: 1; border: none; padding: 0;
        background: $boost; }
    NewSession #hint { height: 2; color: $text-muted; }
    NewSession #wrong { color: $error; }
    """
    AUTO_FOCUS = "#arm"
    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "dismiss(None)", "back")]

    def __init__(self, journal: Path, *, simulated: bool, arm: Path | None = None) -> None:
        super().__init__()
        self._journal, self._simulated = journal, simulated
        plan = None if arm is None else arm.with_name("plan.toml")
        self._given = {
            "arm": SHIPPED_ARM if arm is None else str(arm),
            "plan": SHIPPED_PLAN if plan is None else str(plan) if plan.exists() else "",
            "name": journal.stem,
        }

    def compose(self) -> ComposeResult:
        """Ask."""
        where = "in the simulated laboratory" if self._simulated else "in the laboratory"
        with VerticalScroll():
            yield Static(f"New session {where}   (escape: back)", id="head")
            for field, (label, _) in _FIELDS.items():
                with Horizontal():
                    yield Static(label)
                    yield Input(self._given.get(field, ""), id=field)
            yield Static("", id="hint", markup=False)
            yield Button("Begin", id="begin")
            yield Static("", id="wrong", markup=False)

    def on_descendant_focus(self, event: DescendantFocus) -> None:
        """Say what to know about the field that has the keys."""
        _, hint = _FIELDS.get(event.widget.id or "", ("", "Enter: begin."))
        self.query_one("#hint", Static).update(hint)

    def on_input_submitted(self) -> None:
        """Go to the next field; begin at the last, however fast Enter was pressed."""
        if self.focused is not None and self.focused.id == "who":
            self._begin()
        else:
            self.focus_next()

    def on_button_pressed(self) -> None:
        """Begin."""
        self._begin()

    def _begin(self) -> None:
        """Begin if arm and plan can be read; say all that is wrong at once otherwise."""
        arm_name, plan_name, name, who = (
            self.query_one(f"#{field}", Input).value.strip()
            for field in ("arm", "plan", "name", "who")
        )
        journal = self._journal.with_name(f"{Path(name).stem}.journal") if name else self._journal
        wrong = []
        arm = None
        try:
            arm = load_arm(arm_name)
        except ArmodalError as error:
            wrong.append(str(error))
        if arm is not None:
            try:
                load_plan(plan_name, arm)
            except ArmodalError as error:
                wrong.append(str(error))
        if journal.exists():
            wrong.append(f"{journal.name} is there already; give another name")
        if wrong:
            self.query_one("#wrong", Static).update("\n".join(wrong))
            return
        self.dismiss(
            Measure(
                journal=journal,
                arm=arm_name,
                plan=plan_name,
                simulated=self._simulated,
                measured_by=who,
            )
        )
