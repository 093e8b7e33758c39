"""The pursuit of a goal that was seen too far away, or on another floor."""

from dataclasses import replace

from box_views import FLOOR, view_of
from hypernav.core.embodiment import BodyConfig, Embodiment
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.agents.explore import forget_sighting
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.stairs.connectors import Connector
from hypernav.search.memory.floor_exits import seen_from_elsewhere
from hypernav.search.memory.memory import Memory

CLIMBER = Embodiment(body=BodyConfig(max_step_m=0.2))
FAR, FROM_ABOVE = (10.0, 0.0), (2.0, 8.0)
START = Pose2(0.0, 0.0, 0.0)


def test_the_end_of_one_pursuit_forgets_no_other_sighting():
    memory = Memory(MappingConfig(), CLIMBER)
    memory.begin_search(sees_stairs=True)
    memory.follow(view_of([FLOOR], START, camera=CLIMBER.camera.intrinsics))
    memory.connectors = (Connector(0, False, (1.0, 0.0), 0.0, sightings=2),)
    memory.search.note_off_floor((*FROM_ABOVE, -2.0))
    memory.number = memory.add_floor(-2.6)
    memory.crossed(0)
    memory.search.evidence = replace(memory.search.evidence, far_position=FAR)
    forget_sighting(memory, FAR)
    assert memory.search.evidence.far_position is None
    assert seen_from_elsewhere(memory) == FROM_ABOVE
    forget_sighting(memory, FROM_ABOVE)
    assert seen_from_elsewhere(memory) is None
