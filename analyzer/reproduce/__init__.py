"""The published figures of the three papers beside ours."""
