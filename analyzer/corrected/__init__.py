"""The arm with the effects of its file: matrices, modes and FRFs in any posture, and its export."""
