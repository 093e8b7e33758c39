"""Writes small IFC files as text, for tests."""

from collections.abc import Sequence
from pathlib import Path

Product = tuple[str, str, Sequence[float], Sequence[float]]
"""Class, name, lowest and highest corner, millimetres."""

_HEADER = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','',(''),(''),'','','');
FILE_SCHEMA(('IFC4'));
ENDSEC;
DATA;
#1=IFCSIUNIT(*,.LENGTHUNIT.,.MILLI.,.METRE.);
#2=IFCUNITASSIGNMENT((#1));
#3=IFCCARTESIANPOINT((0.,0.,0.));
#4=IFCAXIS2PLACEMENT3D(#3,$,$);
#5=IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-05,#4,$);
#6=IFCPROJECT('0000000000000000000000',$,'p',$,$,$,$,(#5),#2);
#7=IFCLOCALPLACEMENT($,#4);
#8=IFCCOLOURRGB($,0.8,0.2,0.1);
#9=IFCSURFACESTYLESHADING(#8,$);
#10=IFCSURFACESTYLE('red',.BOTH.,(#9));
"""
_FACES = (
    "(1,3,2),(1,4,3),(5,6,7),(5,7,8),(1,2,6),(1,6,5),"
    "(2,3,7),(2,7,6),(3,4,8),(3,8,7),(4,1,5),(4,5,8)"
)


def write_ifc(path: Path, products: Sequence[Product]) -> Path:
    """Boxes as red products of a model in millimetres."""
    lines = [_HEADER]
    for number, (kind, name, low, high) in enumerate(products):
        n = 100 + 10 * number
        (x, y, z), (u, v, w) = low, high
        corners = [(x, y, z), (u, y, z), (u, v, z), (x, v, z)]
        corners += [(x, y, w), (u, y, w), (u, v, w), (x, v, w)]
        points = ",".join(f"({a:.1f},{b:.1f},{c:.1f})" for a, b, c in corners)
        guid = f"1{number:021d}"
        lines.append(
            f"#{n}=IFCCARTESIANPOINTLIST3D(({points}),$);\n"
            f"#{n + 1}=IFCTRIANGULATEDFACESET(#{n},$,.T.,({_FACES}),$);\n"
            f"#{n + 2}=IFCSTYLEDITEM(#{n + 1},(#10),$);\n"
            f"#{n + 3}=IFCSHAPEREPRESENTATION(#5,'Body','Tessellation',(#{n + 1}));\n"
            f"#{n + 4}=IFCPRODUCTDEFINITIONSHAPE($,$,(#{n + 3}));\n"
            f"#{n + 5}={kind.upper()}('{guid}',$,'{name}',$,$,#7,#{n + 4},$,$);\n"
        )
    path.write_text("".join(lines) + "ENDSEC;\nEND-ISO-10303-21;\n", "ascii")
    return path
