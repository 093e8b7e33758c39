"""Crowded offices: their meeting rooms are open, and full of chairs."""

from dataclasses import replace

from hypernav.houses.furnishing.workplace.crowded_rooms import CROWDED_FURNISHING
from hypernav.houses.kinds.offices import OFFICES
from hypernav.houses.plan.crowded_plans import crowded_plan

CROWDED = replace(OFFICES, sample_plan=crowded_plan, furnishing=CROWDED_FURNISHING)
