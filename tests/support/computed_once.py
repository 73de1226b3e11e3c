"""What a command computes, for all the times that a test runs it."""


def computed_once(compute):
    """Return what computes the first time it is called, and tells that result ever after."""
    kept = []

    def first(*given, **named):
        if not kept:
            kept.append(compute(*given, **named))
        return kept[0]

    return first
