#!/usr/bin/env python3
"""Writes the coffee maker (Bitterli's scene, in pbrt's format) in Mitsuba's, which has no file of it.

    python scripts/coffee_for_mitsuba.py scenes/coffee/pbrt-v4/scene-v4.pbrt

writes scene-from-pbrt.xml beside it, with the meshes that lie there. Materials are those of the pbrt file; the rough
plastic has its roughness as alpha 0.1 and the metal is silver.
"""

import re
import sys
from pathlib import Path

import numpy as np

PLASTICS = {
    "Plastic_Orange": ("plastic", "1, 0.378676, 0.013473"),
    "Floor": ("plastic", "0.578596, 0.578596, 0.578596"),
    "Plastic_Black": ("roughplastic", "0.00631, 0.00631, 0.00631"),
}
OTHERS = """
<bsdf type="dielectric" id="Glass"><float name="int_ior" value="1.5"/></bsdf>
<bsdf type="twosided" id="Metal"><bsdf type="conductor"><string name="material" value="Ag"/></bsdf></bsdf>"""
PIECES = (
    r'^NamedMaterial "(?P<material>\w+)"|^Shape "plymesh"\s*"string filename" \[ "(?P<mesh>.*?)" \]'
    r'|AreaLightSource "diffuse"\s*"rgb L" \[(?P<radiance>.*?)\].*?"point3 P" \[(?P<corners>.*?)\]'
)


def matrix(values):
    return f'<transform name="to_world"><matrix value="{" ".join(map(repr, values.ravel().tolist()))}"/></transform>'


def numbers(text):
    return np.array([float(word) for word in text.split()])


def materials():
    for name, (kind, color) in PLASTICS.items():
        alpha = '<float name="alpha" value="0.1"/>' if kind == "roughplastic" else ""
        yield (
            f'<bsdf type="twosided" id="{name}"><bsdf type="{kind}"><rgb name="diffuse_reflectance" value="{color}"/>'
            f'<float name="int_ior" value="1.5"/>{alpha}<boolean name="nonlinear" value="true"/></bsdf></bsdf>'
        )
    yield OTHERS


def lamp(radiance, corners):
    """A rectangle from the four corners of a pbrt lamp."""
    corners = numbers(corners).reshape(4, 3)
    place = np.eye(4)
    place[:3, 0], place[:3, 1] = (corners[1] - corners[0]) / 2, (corners[2] - corners[1]) / 2
    normal = np.cross(place[:3, 0], place[:3, 1])
    place[:3, 2], place[:3, 3] = normal / np.linalg.norm(normal), corners.mean(axis=0)
    color = ", ".join(radiance.split())
    return (
        f'<shape type="rectangle">{matrix(place)}<bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf>'
        f'<emitter type="area"><rgb name="radiance" value="{color}"/></emitter></shape>'
    )


def main():
    source = Path(sys.argv[1])
    text = source.read_text()
    world_to_camera = numbers(re.search(r"^Transform \[(.*?)\]", text, re.S | re.M).group(1)).reshape(4, 4).T
    lines = [
        '<scene version="3.0.0">',
        '<integrator type="path"><integer name="max_depth" value="17"/></integrator>',
        '<sensor type="perspective"><float name="fov" value="25"/><string name="fov_axis" value="x"/>',
        matrix(np.linalg.inv(world_to_camera) @ np.diag([-1, 1, 1, 1])),
        '<film type="hdrfilm"><integer name="width" value="204"/><integer name="height" value="256"/>',
        '<rfilter type="tent"/><string name="pixel_format" value="rgb"/></film><sampler type="independent"/></sensor>',
        *materials(),
    ]
    material = None
    for piece in re.finditer(PIECES, text, re.S | re.M):
        if piece["material"]:
            material = piece["material"]
        elif piece["mesh"]:
            lines.append(
                f'<shape type="ply"><string name="filename" value="{piece["mesh"]}"/><ref id="{material}"/></shape>'
            )
        else:
            lines.append(lamp(piece["radiance"], piece["corners"]))
    lines.append("</scene>")
    (source.parent / "scene-from-pbrt.xml").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
