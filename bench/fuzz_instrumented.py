"""The decoders with their coverage watched: what this imports is instrumented."""

from __future__ import annotations

import atheris

with atheris.instrument_imports(include=["armodal", "cantools"]):
    from support.decoders import check
    from support.fuzz_material import decoders_in

__all__ = ["check", "decoders_in"]
