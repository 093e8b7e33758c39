"""Published rivals and baselines, built for comparison; nothing of the method imports them.

- ``nearest_frontier``: the baseline ``frontier`` (Yamauchi, 1997).
- ``vlfm``: a value map by the similarity of views (VLFM), and the scorers of views.
- ``navvlm``: the direction question (NavVLM), asked of a model or answered by true labels.
- ``arrows``: moves drawn into the camera image, of VLMnav, PIVOT and DyNaVLM.

The last three know nothing of each other. `hypernav.app.build` alone knows them: its registries
name the parts, its presets the agents and their sections of the configuration.
"""
