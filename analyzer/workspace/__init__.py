"""The arm over its workspace: many postures at once."""
