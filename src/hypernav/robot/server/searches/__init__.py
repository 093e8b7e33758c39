"""The searches of a server: decisions, checks, what is kept on disk, and their threads.

`sensing` refuses an observation that can't be right, and `doubts` names what may be misread.
"""
