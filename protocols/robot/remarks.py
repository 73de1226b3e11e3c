"""What is to be said of a description, collected, so that one run says all of it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from armodal.protocols.errors import ArmError

__all__ = ["Remark", "Remarks", "few", "refuse_faults"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Remark:
    """One thing said.

    `kind` is "fault" where the description cannot be used, "doubt" where it can and should not be
    believed, "guess" where a value was put in, "note" for the rest.
    """

    kind: str
    where: str
    text: str

    def __str__(self) -> str:
        return f"{self.where}: {self.text}"


@dataclass(slots=True)
class Remarks:
    """A list of remarks in the order they were made, each once."""

    made: list[Remark] = field(default_factory=list)

    def fault(self, where: str, text: str) -> None:
        """Say why the description cannot be used."""
        self._add("fault", where, text)

    def doubt(self, where: str, text: str) -> None:
        """Say what should not be believed."""
        self._add("doubt", where, text)

    def guess(self, where: str, text: str) -> None:
        """Say what was put in, and where it comes from."""
        self._add("guess", where, text)

    def note(self, where: str, text: str) -> None:
        """Say what was done with something."""
        self._add("note", where, text)

    def of(self, *kinds: str) -> tuple[Remark, ...]:
        """Remarks of some kinds."""
        return tuple(remark for remark in self.made if remark.kind in kinds)

    def _add(self, kind: str, where: str, text: str) -> None:
        remark = Remark(kind=kind, where=where, text=text)
        if remark not in self.made:
            self.made.append(remark)


def refuse_faults(name: str, said: Remarks) -> None:
    """Raise ArmError with every fault that was said."""
    faults = said.of("fault")
    if faults:
        rows = "\n".join(f"  {fault}" for fault in faults)
        raise ArmError(f"{name} cannot be used, {len(faults)} fault(s):\n{rows}")


def few(names: Iterable[str]) -> str:
    """Names in a row, the first dozen of many."""
    listed = list(names)
    more = f" and {len(listed) - 12} more" if len(listed) > 12 else ""
    return ", ".join(listed[:12]) + more
