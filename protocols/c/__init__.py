"""The device side of the board protocol in portable C, and its way into Python.

`include/armodal_board.h` is what a firmware engineer reads first.
"""
