"""What people call, and how the parts are put together.

Rooms in reading order:

- ``build``: presets, and agents, worlds and data sets made from their names on the command line or
  in Python (`build.search.find`, `build.agents.build_agent`).
- ``cli``: the commands. Options and their defaults stand in ``cli.options``.
- ``show``: maps, videos, pages and live views of one search.
- ``warmup``: compiles what is slow at first, while something else is waited for.

``cli`` stands on everything. ``build`` stands on search, simulator and episodes, and serves
laboratory, robot and commands alike. ``show`` draws what it is given, with ``search.drawing``.
"""
