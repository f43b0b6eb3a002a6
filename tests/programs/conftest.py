"""The adapters of `examples/peers` are imported from the checkout, whether they are installed or not."""

import sys
from pathlib import Path

PEERS = Path(__file__).resolve().parents[2] / "examples" / "peers"

if str(PEERS) not in sys.path:
    sys.path.insert(0, str(PEERS))
