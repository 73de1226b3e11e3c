C_DECODER = "board frames in C"


def fuzz_c(n, rng):
    raise NotImplementedError
