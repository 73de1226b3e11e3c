"""Values of a gap model with nothing soft or lossy beside the joints' own springs and dampers."""

SOFT = ("bearing ", "bend ", "base ", "compliance of ")


def without_soft_parts(values):
    """No compliance beside the joints' own; losses as they are."""
    return values | {name: 0.0 for name in values if name.startswith(SOFT)}


def without_errors(values):
    """No compliance and no loss factor beside the joints' springs and dampers."""
    return without_soft_parts(values) | {n: 0.0 for n in values if n.startswith("loss ")}
