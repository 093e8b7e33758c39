"""Scenes and data sets by name: where buildings and episodes come from.

They have a registry each, since neither can stand for the other: a scene is triangles that one
search takes place in, a data set a list of episodes in scenes. All else knows `load_scene` and
`load_episodes` alone.
"""
