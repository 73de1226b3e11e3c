"""The acquisition-board protocol: frames, messages, channel dictionary."""
