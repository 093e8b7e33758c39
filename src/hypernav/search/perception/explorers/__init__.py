"""Global perception: the choice of destinations while the goal is out of sight.

`block_explorer` offers the blocks of the map until one is named that was not visited;
`map_question` asks a model which block it is, `geometric_reasoner` answers without a model.
"""
