"""What a command waits for before it begins."""

import subprocess
import sys

# A quarter of a second to a second of a processor each, needed by some estimates alone.
SLOW = {
    f"scipy.{part}"
    for part in ("interpolate", "ndimage", "optimize", "signal", "spatial", "special", "stats")
}
LOADED = """
import sys
from importlib import import_module
from armodal.tui.cli import command_modules

for module in set(command_modules().values()):
    import_module(f"armodal.tui.commands.{module}")
print(*sys.modules)
"""


def test_no_command_loads_what_only_some_estimates_need():
    done = subprocess.run(
        [sys.executable, "-c", LOADED], capture_output=True, text=True, check=True
    )
    loaded = set(done.stdout.split())
    assert "armodal.tui.commands.identify" in loaded
    assert not loaded & SLOW
