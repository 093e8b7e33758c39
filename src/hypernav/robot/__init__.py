"""Real robots: the same search behind a server, with clients, drivers and recordings.

Rooms in reading order: ``wire`` (what is said between robot and server), ``server`` (every image
with depth and pose is checked in `server.searches.sensing`, then searched with), ``client`` (a
robot asks and acts), ``driving`` (actions become velocities, safely), ``ros`` and
``ros2`` (without ROS installed), ``recordings`` (a drive is replayed), ``simulation`` (a robot of
ours in a building, for trying all this), and field trials.

May import: ``core``, ``io``, ``search``, ``app.build``, ``app.show``; only ``simulation`` imports
from the simulator, and knows a world by `hypernav.core.world`.
"""
