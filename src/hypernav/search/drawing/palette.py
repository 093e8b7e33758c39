"""The colours that map, video and page share.

The hues are those of Okabe and Ito, "Color Universal Design" (2008), some of them darkened for
white ground. People with any common colour blindness can tell them apart, and their lightness
differs as well, so that most survive grey printing.
"""

from hypernav.core.trace import Mode

Rgb = tuple[int, int, int]
"""Red, green, blue, 0 to 255."""

UNKNOWN: Rgb = (221, 225, 230)
FREE: Rgb = (255, 255, 255)
OCCUPIED: Rgb = (43, 52, 64)

UNKNOWN_STRONG: Rgb = (138, 144, 152)
"""Contrast to white of at least 3:1, for models that see a small image of the map."""
OCCUPIED_STRONG: Rgb = (16, 18, 24)
FRONTIER: Rgb = (204, 0, 120)

TRAJECTORY_OLD: Rgb = (158, 202, 232)
TRAJECTORY_NEW: Rgb = (0, 96, 160)
ROBOT: Rgb = (213, 94, 0)
PATH: Rgb = (125, 60, 152)
GOAL: Rgb = (0, 128, 92)
CHOSEN: Rgb = (230, 159, 0)
STAIRS: Rgb = (130, 90, 60)
BLOCK: Rgb = (116, 128, 144)
EXCLUDED: Rgb = (150, 158, 168)

INK: Rgb = (28, 36, 46)
MUTED: Rgb = (92, 104, 118)
FAINT: Rgb = (214, 219, 225)
PAPER: Rgb = (255, 255, 255)
GROUND: Rgb = (244, 246, 248)

SUCCESS: Rgb = GOAL
FAILURE: Rgb = (176, 58, 34)

MODES: dict[Mode, Rgb] = {
    Mode.LOOK_AROUND: (86, 180, 233),
    Mode.RECALL: (88, 72, 170),
    Mode.EXPLORE: (0, 96, 160),
    Mode.APPROACH: (230, 159, 0),
    Mode.VERIFY: (160, 84, 134),
    Mode.CLIMB: STAIRS,
    Mode.STOP: (0, 128, 92),
}

SERIES: tuple[Rgb, ...] = (
    (0, 96, 160),
    (230, 159, 0),
    (0, 128, 92),
    (160, 84, 134),
    (86, 180, 233),
    (213, 94, 0),
    (105, 118, 135),
)
"""Colours of a chart's series, in this order."""


def blend(a: Rgb, b: Rgb, share: float) -> Rgb:
    """Mix two colours: ``a`` at share 0, ``b`` at 1."""
    mixed = [round(p + (q - p) * share) for p, q in zip(a, b, strict=True)]
    return (mixed[0], mixed[1], mixed[2])


def css(color: Rgb) -> str:
    """The colour in CSS notation, for example ``#0060a0``."""
    return "#{:02x}{:02x}{:02x}".format(*color)


def luminance(color: Rgb) -> float:
    """Relative luminance as WCAG 2.2 defines it, 0 (black) to 1 (white)."""
    linear = [c / 255 / 12.92 if c <= 10 else ((c / 255 + 0.055) / 1.055) ** 2.4 for c in color]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(a: Rgb, b: Rgb) -> float:
    """Contrast ratio as WCAG 2.2 defines it, 1 to 21; text needs 4.5."""
    light, dark = sorted((luminance(a), luminance(b)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def ink_on(color: Rgb) -> Rgb:
    """White or dark ink, whichever reads better on this colour."""
    return PAPER if contrast(PAPER, color) >= contrast(INK, color) else INK
