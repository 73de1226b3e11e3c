PTY_MATRIX = ()


def run_on_ptys(number): ...
