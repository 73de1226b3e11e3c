"""How many examples a property meets that names a number of its own."""

from hypothesis import settings

__all__ = ["examples"]

ALL = settings.get_profile("default").max_examples


def examples(many: int) -> int:
    """Return `many`; where long tests are left out no more than any other property meets."""
    every = settings().max_examples
    return many if every >= ALL else min(many, every)
