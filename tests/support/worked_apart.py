"""What `tests/protocols/test_apart.py` has done in another process."""

import os
import sys

from armodal.protocols.errors import ForeignFileError


def said(text, times):
    return text * times


def prints():
    sys.stdout.write("this is no answer")
    return "answer"


def refuses():
    raise ForeignFileError("wanted another file")


def takes_memory():
    return str(len(bytearray(10**9)))


def takes_time():
    while True:
        pass


def crashes():
    os.abort()


def fails():
    raise ValueError("a fault of ours")
