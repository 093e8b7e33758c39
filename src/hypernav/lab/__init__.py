"""The laboratory: what measures a search, and tables and pages about many of them.

Rooms in reading order:

- ``datasets``: episodes in Habitat's format, published benchmarks, and the splits that are shipped.
- ``episodes``: one search in one world, step by step, and its measures.
- ``evaluation``: many searches in parallel processes (`evaluation.runner`), their records, reports,
  ablations, the study of goal refinement, and checks of components of one's own. The tables of
  README and docs come from ``docs/results/data``, drawn by ``scripts/result_tables.py``.
- ``exam``: questions with known answers for a model, and what its answers are worth in a search.

May import: ``core``, ``io``, ``search``, ``simulator``, ``app.build``, ``app.show``. Worlds
are opened by their names.
"""
