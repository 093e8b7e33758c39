"""Neural networks, each behind a small protocol and an optional extra."""

from hypernav.models.chat_config import ChatConfig
from hypernav.models.concurrent_chat import AsyncChat, ConcurrentChat
from hypernav.models.ledger import Ledger, LedgerChat
from hypernav.models.recording import RecordingChat, ReplayChat
from hypernav.models.vlm_spec import VlmSpec, open_chat, parse_vlm_spec
from hypernav.models.yolox import YoloxConfig, YoloxDetector

__all__ = [
    "AsyncChat",
    "ChatConfig",
    "ConcurrentChat",
    "Ledger",
    "LedgerChat",
    "RecordingChat",
    "ReplayChat",
    "VlmSpec",
    "YoloxConfig",
    "YoloxDetector",
    "open_chat",
    "parse_vlm_spec",
]
