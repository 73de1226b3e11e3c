"""What a new session is begun with: arm, plan, name, who measures, laboratory."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Button, Checkbox, Input, Static

from armodal.protocols.arm.files import load_arm
from armodal.protocols.errors import ArmodalError
from armodal.protocols.plan import load_plan
from armodal.tui.screens.wishes import Measure

__all__ = ["NewSession"]

SHIPPED_ARM, SHIPPED_PLAN = "rv4frl", "rv4frl-three-postures"


class NewSession(ModalScreen[Measure | None]):
    """Five fields; Enter goes to the next one and begins at the last."""

    DEFAULT_CSS = """
    NewSession { align: center middle; }
    NewSession > VerticalScroll { width: 76; max-width: 100%; height: auto; max-height: 100%;
        border: heavy $accent; padding: 0 1; background: $surface; }
    NewSession Input { height: 3; }
    NewSession #wrong { color: $error; }
    """
    AUTO_FOCUS = "#arm"
    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "dismiss(None)", "back")]

    def __init__(self, journal: Path, *, simulated: bool) -> None:
        super().__init__()
        self._journal, self._simulated = journal, simulated

    def compose(self) -> ComposeResult:
        """Ask."""
        with VerticalScroll():
            yield Static(
                "Arm: a shipped name or your own file. An own arm is a TOML file beside its URDF: "
                "docs/arm-file.md",
                markup=False,
            )
            yield Input(SHIPPED_ARM, id="arm")
            yield Static("Plan: a shipped name or your own file (armodal plan ARM makes one)")
            yield Input(SHIPPED_PLAN, id="plan")
            yield Static("Name of the session")
            yield Input(self._journal.stem, id="name")
            yield Static("Who measures, for the report (may stay empty)")
            yield Input("", id="who")
            yield Checkbox("in the simulated laboratory", value=self._simulated, id="simulated")
            yield Button("Begin", id="begin")
            yield Static("", id="wrong", markup=False)

    def on_input_submitted(self) -> None:
        """Go to the next field."""
        self.focus_next()

    def on_button_pressed(self) -> None:
        """Begin, if arm and plan can be read; say all that is wrong at once otherwise."""
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
        simulated = self.query_one("#simulated", Checkbox).value
        self.dismiss(
            Measure(
                journal=journal,
                arm=arm_name,
                plan=plan_name,
                simulated=simulated,
                measured_by=who,
            )
        )
