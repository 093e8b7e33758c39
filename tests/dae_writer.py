"""A COLLADA file of squares, for the tests."""

from pathlib import Path

MESH = """
<geometry id="square" name="square"><mesh>
  <source id="places"><float_array id="p" count="12">0 0 0 1 0 0 1 1 0 0 1 0</float_array>
    <technique_common><accessor source="#p" count="4" stride="3"/></technique_common></source>
  <source id="texels"><float_array id="t" count="8">0 0 1 0 1 1 0 1</float_array>
    <technique_common><accessor source="#t" count="4" stride="2"/></technique_common></source>
  <vertices id="corners"><input semantic="POSITION" source="#places"/></vertices>
  {primitive}
</mesh></geometry>
"""
INPUTS = """<input semantic="VERTEX" source="#corners" offset="0"/>
<input semantic="TEXCOORD" source="#texels" offset="1" set="0"/>"""
POLYLIST = f"""<polylist material="paint" count="1">{INPUTS}
<vcount>4</vcount><p>0 0 1 1 2 2 3 3</p></polylist>"""
SHOWN = """<instance_geometry url="#square"><bind_material><technique_common>
<instance_material symbol="paint" target="#red"/></technique_common></bind_material>
</instance_geometry>"""
RED = "<color>1 0 0 1</color>"


def dae(
    nodes: str = f'<node name="Bed_01">{SHOWN}</node>',
    *,
    primitive: str = POLYLIST,
    asset: str = "<up_axis>Z_UP</up_axis>",
    diffuse: str = RED,
    more: str = "",
) -> str:
    """The text of a document with one square, one material and these nodes."""
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>{asset}</asset>
<library_images><image id="picture"><init_from>paint.png</init_from></image></library_images>
<library_effects><effect id="effect"><profile_COMMON>
  <newparam sid="surface"><surface type="2D"><init_from>picture</init_from></surface></newparam>
  <newparam sid="sampler"><sampler2D><source>surface</source></sampler2D></newparam>
  <technique sid="common"><phong><diffuse>{diffuse}</diffuse></phong></technique>
</profile_COMMON></effect></library_effects>
<library_materials><material id="red"><instance_effect url="#effect"/></material>
</library_materials>
<library_geometries>{MESH.format(primitive=primitive)}</library_geometries>
{more}
<library_visual_scenes><visual_scene id="scene">{nodes}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>"""


def write_dae(path: Path, text: str | None = None) -> Path:
    """Write a document."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(dae() if text is None else text)
    return path
