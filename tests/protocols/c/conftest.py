import sys
from pathlib import Path

# The helper beside this file is a module of its own, not a test.
sys.path.insert(0, str(Path(__file__).parent))

collect_ignore = ["device.py"]
