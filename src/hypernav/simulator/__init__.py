"""The simulator: worlds to search in, and what is true of them. A guest of the others.

A search knows a world by `hypernav.core.world` only, and opens one by its name
(`hypernav.app.build.worlds`). Rooms in reading order:

- ``worlds``: scenes read from files, drawn, and walked on (`worlds.simulation.SimulatedWorld`,
  `worlds.survey.SurveyedScene`), habitat-sim, and navigation meshes. Nobody needs to open
  ``worlds.navmesh.recast_detour``, which computes them as Recast and Detour do.
- ``houses``: furnished buildings drawn from a number, and episodes in them.

May import: ``core``, ``io``, ``lab.datasets`` (the format of episodes), one kernel of
``search.mapping``; for its page ``app.show``.
"""
