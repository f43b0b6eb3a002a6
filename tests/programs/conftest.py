"""The adapters of `examples/peers` are imported from the checkout, whether they are installed or not.

Without that folder nothing here is asked: the rest of the suite stands without it.
"""

import sys
from pathlib import Path

PEERS = Path(__file__).resolve().parents[2] / "examples" / "peers"

if str(PEERS) not in sys.path:
    sys.path.insert(0, str(PEERS))
collect_ignore_glob = [] if PEERS.is_dir() else ["test_*.py"]
