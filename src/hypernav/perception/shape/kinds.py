"""Sizes and places of some 200 kinds of things: a table of ours, from common dimensions.

Ranges are wide, since they refute: they span what shops sell and what homes, offices and shops
hold, from children's to oversized pieces. COCO's indoor classes, HM3D's six goals, usual names of
OVON and all that the generated buildings hold are in it. Supports of plants, the width of chairs
and some faces were mended after a look at detections in training buildings
(`benchmarks/shape_evidence.py`).
"""

from dataclasses import dataclass
from typing import Literal

from hypernav.core.labels import canonical

Support = Literal["floor", "flat", "on", "wall", "ceiling", ""]
Face = Literal["level", "upright", ""]


@dataclass(frozen=True)
class KindShape:
    """Size and place of a kind of thing.

    Attributes:
        support: Where it is: stands on the "floor", lies "flat" on it, stands "on" something or on
            the floor, hangs on a "wall" or stands before it, hangs from the "ceiling"; empty if it
            may be anywhere.
        height_m: Least and greatest own height, metres.
        long_m: Least and greatest of its longer horizontal extent, metres.
        face: "level" if it has a level top, "upright" if it is a face that others may
            continue, as of built-in units.
    """

    support: Support
    height_m: tuple[float, float]
    long_m: tuple[float, float]
    face: Face = ""


def kind_shape(name: str) -> KindShape | None:
    """What is known of a kind; None for one that is not in the table.

    A synonym counts ("couch" for "sofa"), and so does the head noun ("dining chair" for "chair").
    """
    words = canonical(name).split()
    tails = (canonical(" ".join(words[k:])) for k in range(len(words)))
    return next((KINDS[tail] for tail in tails if tail in KINDS), None)


def _parsed(table: str) -> dict[str, KindShape]:
    kinds: dict[str, KindShape] = {}
    support: Support = ""
    for line in table.strip().splitlines():
        match line.split():
            case ["floor" | "flat" | "on" | "wall" | "ceiling" | "anywhere" as place]:
                support = "" if place == "anywhere" else place
            case [*name, height, long, "level" | "upright" as face]:
                kinds[canonical(" ".join(name))] = KindShape(
                    support, _range(height), _range(long), face
                )
            case [*name, height, long]:
                kinds[canonical(" ".join(name))] = KindShape(support, _range(height), _range(long))
    return kinds


def _range(text: str) -> tuple[float, float]:
    low, _, high = text.partition("-")
    return float(low), float(high)


KINDS = _parsed(
    """
    floor
      bed 0.35-1.6 1.4-2.6 level
      crib 0.6-1.3 0.6-1.5
      sofa 0.55-1.25 1.25-3.6 level
      armchair 0.6-1.3 0.5-1.2 level
      chair 0.65-1.35 0.35-1.0 level
      rocking chair 0.7-1.3 0.5-1.2 level
      office chair 0.75-1.4 0.45-0.9 level
      stool 0.3-0.95 0.25-0.7
      step stool 0.15-0.7 0.25-0.6
      bean bag 0.4-1.1 0.6-1.3
      ottoman 0.3-0.6 0.3-1.3 level
      bench 0.35-1.1 0.6-2.4 level
      piano 0.8-1.5 1.1-2.0
      dining table 0.6-0.95 0.7-3.2 level
      coffee table 0.25-0.6 0.4-1.5 level
      side table 0.35-0.8 0.25-0.8 level
      console table 0.65-1.0 0.6-1.8 level
      table 0.3-1.1 0.4-3.5 level
      balcony table 0.5-0.9 0.4-1.2 level
      meeting table 0.65-0.9 1.0-5.0 level
      desk 0.65-1.3 0.7-2.2 level
      dressing table 0.65-1.7 0.6-1.5
      display table 0.5-1.1 0.6-2.5 level
      nightstand 0.35-0.8 0.3-0.8
      tv stand 0.3-0.9 0.7-2.4 upright
      wardrobe 1.5-2.6 0.6-3.2 upright
      dresser 0.6-1.5 0.5-1.8 upright
      bookshelf 0.7-2.6 0.4-3.0 upright
      cabinet 0.5-2.4 0.3-2.5 upright
      display cabinet 0.9-2.3 0.4-2.0
      filing cabinet 0.5-1.6 0.35-1.3 upright
      drawer unit 0.4-1.2 0.3-0.9 upright
      locker 1.2-2.2 0.25-3.0 upright
      shoe rack 0.2-1.3 0.4-1.3
      coat rack 1.3-2.1 0.2-0.8
      clothes rack 0.9-2.0 0.5-2.0
      magazine rack 0.4-1.9 0.3-1.2
      storage rack 0.9-2.8 0.6-3.5
      wine rack 0.3-2.0 0.3-1.5
      rack 0.4-2.4 0.3-3.0
      refrigerator 1.1-2.2 0.45-1.3 upright
      display refrigerator 1.3-2.3 0.5-3.0 upright
      chest freezer 0.7-1.1 0.6-2.5 upright
      washing machine 0.7-1.1 0.4-0.8 upright
      clothes dryer 0.7-1.1 0.4-0.8 upright
      dishwasher 0.7-1.0 0.4-0.8 upright
      stove 0.75-1.3 0.4-1.2 upright
      kitchen counter 0.75-1.1 0.4-4.5 upright
      kitchen island 0.75-1.15 0.6-3.5 level
      vending machine 1.5-2.2 0.6-1.5 upright
      water dispenser 0.8-1.6 0.25-0.6 upright
      copier 0.7-1.6 0.5-1.5 upright
      server rack 0.9-2.3 0.5-1.3 upright
      paper shredder 0.3-0.9 0.25-0.6
      toilet 0.35-1.1 0.5-0.9 level
      bidet 0.3-0.6 0.3-0.8
      bathtub 0.35-0.85 1.1-2.2
      shower 1.6-2.4 0.6-2.0 upright
      floor lamp 1.0-2.2 0.15-1.0
      tree 1.0-4.0 0.4-3.0
      christmas tree 0.6-3.0 0.4-2.0
      trash can 0.15-1.2 0.15-0.8
      basket 0.1-0.9 0.15-0.9
      laundry basket 0.3-0.9 0.25-0.8
      shopping basket 0.15-1.1 0.25-0.7
      bucket 0.15-0.5 0.15-0.5
      toy box 0.2-0.7 0.3-1.2
      cardboard box 0.05-1.2 0.1-1.2
      toolbox 0.1-0.6 0.2-0.7
      suitcase 0.2-0.9 0.25-0.9
      drying rack 0.6-1.8 0.4-2.0
      ironing board 0.7-1.1 0.4-1.6
      ladder 0.8-3.0 0.3-1.2
      broom 0.8-1.6 0.05-0.6
      vacuum cleaner 0.15-1.3 0.2-0.9
      umbrella 0.1-1.1 0.04-1.2
      scale 0.02-0.2 0.2-0.5
      bathroom scale 0.02-0.15 0.2-0.45
      radiator 0.25-2.2 0.3-2.5 upright
      fireplace 0.5-1.8 0.6-2.5 upright
      fan 0.2-1.6 0.2-0.7
      air purifier 0.3-1.2 0.2-0.6
      heater 0.3-1.0 0.2-1.5
      bicycle 0.7-1.3 0.4-2.0
      motorcycle 0.8-1.5 0.6-2.5
      scooter 0.7-1.3 0.3-1.4
      stroller 0.6-1.3 0.4-1.2
      wheelchair 0.7-1.2 0.5-1.3
      shopping cart 0.8-1.2 0.45-1.2
      book cart 0.7-1.4 0.4-1.2
      cart 0.6-1.4 0.4-1.5
      exercise equipment 0.3-2.3 0.4-2.5
      treadmill 0.9-1.7 0.6-2.2
      dumbbell 0.05-0.4 0.1-0.6
      exercise ball 0.4-0.9 0.4-0.9
      yoga mat 0.003-0.3 0.1-2.0
      guitar 0.3-1.3 0.1-1.2
      surfboard 0.05-2.8 0.4-2.8
      skis 0.05-2.2 0.05-2.1
      mannequin 0.9-2.0 0.25-0.9
      person 0.9-2.1 0.2-1.0
      dog 0.15-1.0 0.2-1.3
      cat 0.1-0.5 0.15-0.8
      pet basket 0.1-0.6 0.3-1.1
      cat tree 0.4-2.0 0.3-0.9
      reception desk 0.65-1.4 0.9-5.0 upright
      checkout counter 0.65-1.5 0.8-4.0 upright
      sales counter 0.7-1.4 0.7-4.5 upright
      counter 0.7-1.4 0.5-5.0 upright
      grocery shelf 1.0-2.6 0.6-6.0 upright
      shoe display 0.5-2.4 0.4-3.0
      desk divider 0.4-1.8 0.5-3.0 upright
      room divider 1.2-2.4 0.6-3.0 upright
      door 1.7-2.6 0.5-2.2 upright
      folding door 1.7-2.6 0.5-3.0 upright
      curtain 0.5-3.2 0.1-4.5 upright
      shower curtain 1.2-2.4 0.1-2.5 upright
      stairs 0.4-4.0 0.6-5.0
      railing 0.7-1.3 0.3-8.0
      column 1.8-6.0 0.15-1.2 upright
    flat
      rug 0.0-0.1 0.4-6.0 level
      bath mat 0.0-0.1 0.3-1.3 level
      doormat 0.0-0.1 0.3-1.5 level
      carpet 0.0-0.1 0.4-8.0 level
    on
      plant 0.1-2.6 0.08-1.8
      potted plant 0.1-2.6 0.08-1.8
      sink 0.05-0.5 0.25-1.2
      microwave 0.2-0.5 0.35-0.7
      toaster 0.12-0.35 0.15-0.5
      oven 0.3-1.4 0.4-1.0 upright
      coffee machine 0.2-0.7 0.12-0.7
      kettle 0.12-0.4 0.1-0.35
      blender 0.2-0.6 0.1-0.3
      printer 0.12-0.9 0.25-0.9
      projector 0.06-0.3 0.18-0.5
      computer monitor 0.2-0.7 0.2-1.3 upright
      desktop computer 0.15-0.65 0.1-0.6
      laptop 0.01-0.4 0.15-0.5
      keyboard 0.01-0.1 0.15-0.6
      mouse 0.01-0.08 0.04-0.15
      cell phone 0.005-0.2 0.04-0.2
      tablet 0.005-0.35 0.1-0.4
      remote 0.01-0.25 0.03-0.3
      remote control 0.01-0.25 0.03-0.3
      phone 0.02-0.3 0.04-0.35
      telephone 0.03-0.3 0.1-0.35
      radio 0.08-0.4 0.1-0.6
      speaker 0.08-1.3 0.08-0.6
      table lamp 0.2-0.9 0.1-0.6
      desk lamp 0.2-0.8 0.08-0.7
      book 0.01-0.45 0.03-0.6
      magazine 0.003-0.35 0.05-0.4
      bottle 0.08-0.45 0.03-0.2
      cup 0.04-0.25 0.04-0.2
      wine glass 0.1-0.3 0.04-0.15
      glass 0.05-0.3 0.04-0.15
      bowl 0.03-0.25 0.08-0.45
      fruit bowl 0.05-0.35 0.12-0.5
      plate 0.005-0.1 0.1-0.4
      vase 0.08-0.9 0.05-0.5
      candle 0.03-0.45 0.02-0.2
      succulent 0.04-0.5 0.04-0.5
      cactus 0.05-1.6 0.04-0.6
      herb 0.08-0.5 0.06-0.4
      flower 0.08-0.8 0.05-0.6
      globe 0.15-0.7 0.12-0.5
      photo frame 0.05-0.6 0.05-0.6
      teddy bear 0.08-1.2 0.06-0.9
      toy 0.03-0.9 0.03-0.9
      ball 0.04-0.45 0.04-0.45
      sports ball 0.04-0.45 0.04-0.45
      cushion 0.06-0.65 0.15-0.8
      pillow 0.05-0.6 0.25-1.0
      blanket 0.01-0.8 0.2-2.4
      towel 0.01-1.4 0.1-1.2
      handbag 0.1-0.6 0.12-0.6
      backpack 0.2-0.8 0.18-0.6
      shoes 0.04-0.5 0.08-0.5
      skateboard 0.05-0.9 0.1-0.9
      tennis racket 0.02-0.75 0.05-0.75
      hair dryer 0.05-0.35 0.05-0.35
      scissors 0.003-0.1 0.03-0.3
      toothbrush 0.005-0.3 0.01-0.25
      soap dispenser 0.06-0.35 0.04-0.2
      toilet paper 0.06-0.5 0.06-0.35
      toilet brush 0.15-0.6 0.05-0.25
      paper towels 0.1-0.5 0.08-0.4
      detergent 0.1-0.5 0.05-0.4
      cutting board 0.005-0.5 0.15-0.6
      knife block 0.12-0.45 0.06-0.3
      kitchen utensils 0.05-0.5 0.05-0.6
      seasoning box 0.04-0.4 0.04-0.5
      tableware 0.01-0.5 0.05-0.9
      pen holder 0.05-0.25 0.04-0.2
      watering can 0.1-0.5 0.1-0.6
      fire extinguisher 0.3-0.9 0.08-0.4
      fork 0.003-0.1 0.02-0.3
      knife 0.003-0.1 0.02-0.4
      spoon 0.003-0.1 0.02-0.3
      apple 0.04-0.12 0.04-0.12
      banana 0.03-0.2 0.05-0.3
      orange 0.04-0.12 0.04-0.12
      cake 0.03-0.4 0.08-0.6
      pizza 0.01-0.1 0.15-0.6
      suit 0.4-1.8 0.2-0.8
      clothes 0.05-1.8 0.1-2.0
      hat 0.05-0.4 0.12-0.6
      box 0.03-1.2 0.05-1.2
      bag 0.1-1.0 0.1-0.8
    wall
      tv 0.38-1.3 0.7-2.4 upright
      picture 0.1-2.2 0.1-2.6 upright
      mirror 0.2-2.3 0.15-2.5 upright
      clock 0.05-0.9 0.05-0.8 upright
      whiteboard 0.4-1.8 0.5-4.0 upright
      notice board 0.3-1.6 0.3-2.5 upright
      projector screen 0.6-2.6 0.8-4.0 upright
      poster 0.2-1.8 0.15-1.6 upright
      window 0.3-3.0 0.3-5.0 upright
      kitchen cabinet 0.3-2.5 0.2-4.5
      shelf 0.02-2.4 0.2-3.0
      range hood 0.15-1.2 0.4-1.3
      coat hooks 0.03-0.5 0.1-1.8
      towel rack 0.03-1.6 0.2-1.0
      thermostat 0.05-0.25 0.05-0.25
      light switch 0.05-0.2 0.05-0.3
      wall lamp 0.08-0.7 0.06-0.6
      security camera 0.05-0.4 0.05-0.4
      air conditioner 0.2-0.6 0.5-1.4
      door handle 0.02-0.4 0.03-0.3
    ceiling
      ceiling lamp 0.02-1.4 0.1-2.0
      chandelier 0.2-1.6 0.25-1.6
      ceiling fan 0.15-0.9 0.6-1.8
      smoke detector 0.02-0.15 0.06-0.25
    anywhere
      lamp 0.02-2.2 0.05-2.0
    """
)
"""The table: under each place the kinds with height, longer extent, and face."""
