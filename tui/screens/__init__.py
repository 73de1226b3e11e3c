"""The two apps of the terminal: `run` guides a session, `review` shows one."""
