"""What sessions and files say they were written by."""

from importlib.metadata import version

__all__ = ["SOFTWARE"]

SOFTWARE = f"armodal {version('armodal')}"
