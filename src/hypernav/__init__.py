"""Zero-shot object-goal navigation with hybrid perception: camera picture and top-down map."""

import logging

logging.getLogger("hypernav").addHandler(logging.NullHandler())
