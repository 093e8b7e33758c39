"""The search: all that runs on a robot. It knows no simulator, and needs none of its packages.

A camera image with depth and a pose come in, an action goes out: `core.components.protocols.Agent`.
Rooms in reading order:

- ``mapping``: depth images become a map of cells, blocks and frontiers (`mapping.top_down_map`),
  the height of the ground, and stairs.
- ``memory``: floors, things, images and stairs that were seen (`memory.memory`); kept in a folder
  (`memory.store`), and where on it a robot begins (`memory.start`).
- ``models``: vision-language models and networks, local or on a server, and what their answers say.
- ``perception``: is the goal in the image (`perception.local`), and in which block would it be
  (`perception.explorers.map_question`)?
- ``drawing``: the map as an image, as a model is shown it (`drawing.question_map`).
- ``planning``: paths on the map, and the next action on a path.
- ``agents``: one step after the other (`agents.search`): explore, approach, verify; whether the
  robot stops at the goal is decided in `agents.verify`.
- ``rivals``: published ways to answer the second question, for comparison.

May import: ``core`` and ``io``.
"""
