"""Write the meeting room of the tests, whose screen is seen long before it is reached, as a GLB.

Run: python scripts/meeting_room.py ROOM.glb [--board-m 0.76] [--aisle-m 0.46]

Then the two searches of the image in docs/results/exploring.md, and the image:

    hypernav find tv --scene ROOM.glb --start 10.5 1 180 --out before \
        --set search.open_the_way=false
    hypernav find tv --scene ROOM.glb --start 10.5 1 180 --out after
    python scripts/before_after.py before after before-after-meeting-room.webp
"""

import sys
from pathlib import Path
from typing import Annotated

import tyro

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from box_scenes import boxes_glb
from meeting_room import meeting_room_boxes


def main(
    path: Annotated[Path, tyro.conf.Positional], board_m: float = 0.76, aisle_m: float = 0.46
) -> None:
    """Write the room.

    Args:
        path: The GLB.
        board_m: Depth of the sideboard under the screen, metres.
        aisle_m: Width of the aisle before it, metres.
    """
    boxes_glb(path, meeting_room_boxes(board_m=board_m, aisle_m=aisle_m))


if __name__ == "__main__":
    tyro.cli(main)
