"""Neural networks, each behind a small protocol and an optional extra."""

from hypernav.models.yolox import YoloxConfig, YoloxDetector

__all__ = ["YoloxConfig", "YoloxDetector"]
