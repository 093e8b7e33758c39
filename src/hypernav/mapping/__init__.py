"""Depth to points to voxels to a top-down map; frontiers, blocks, exports."""

from hypernav.mapping.blocks import divide_into_blocks
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.frontiers import Frontier, find_frontiers
from hypernav.mapping.ros_map import load_ros_map, save_ros_map
from hypernav.mapping.top_down_map import TopDownMap

__all__ = [
    "Frontier",
    "MappingConfig",
    "TopDownMap",
    "divide_into_blocks",
    "find_frontiers",
    "load_ros_map",
    "save_ros_map",
]
