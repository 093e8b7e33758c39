"""Video, pictures and pages out of a trace."""

from hypernav.show.maps import draw_map, draw_overview, draw_result, write_map_png
from hypernav.show.page import write_page
from hypernav.show.painter import MapPainter
from hypernav.show.site import page_environment
from hypernav.show.video import EpisodeVideo
from hypernav.show.view import MapView

__all__ = [
    "EpisodeVideo",
    "MapPainter",
    "MapView",
    "draw_map",
    "draw_overview",
    "draw_result",
    "page_environment",
    "write_map_png",
    "write_page",
]
