#!/usr/bin/env python3
"""Renders an OBJ file and its MTL with Lampyris and, since Mitsuba reads no MTL, a copy taken apart by materials with Mitsuba.

    pip install mitsuba scipy
    python scripts/agree_on_obj.py SCENE.obj [--size 64x64] [--samples 64] [--runs 16] [--integrator path]

Materials are diffuse (`Kd`), mirrors (`illum 3` or 5, `Ks` and `Kd`) or lamps (`Ke`); others are refused. The camera stands at
--origin, looks along -z and sees --fov degrees. See agree_with_mitsuba.py for what the figures mean.
"""

import argparse
import sys
import tempfile
from pathlib import Path

from agree_with_mitsuba import arguments, compare

SCENE = """<scene version="3.0.0">
    <integrator type="path"><integer name="max_depth" value="65"/></integrator>
    <sensor type="perspective"><float name="fov" value="{fov}"/>
        <transform name="to_world"><lookat origin="{x}, {y}, {z}" target="{x}, {y}, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="{width}"/><integer name="height" value="{height}"/>
            <rfilter type="box"/></film>
    </sensor>
{shapes}
</scene>
"""


def materials(file):
    """The keys of each `newmtl`."""
    found, name = {}, None
    for words in (line.split("#")[0].split() for line in file.read_text().splitlines()):
        if words and words[0] == "newmtl":
            found[name := words[1]] = {}
        elif words and name:
            found[name][words[0]] = [float(word) for word in words[1:] if not word[0].isalpha()]
    return found


def bsdf(name, keys):
    rgb = '<rgb name="{}" value="{}, {}, {}"/>'
    illum, mirror = keys.get("illum", [2])[0], keys.get("Ks", [0, 0, 0])
    diffuse = f'<bsdf type="diffuse">{rgb.format("reflectance", *keys.get("Kd", [0, 0, 0]))}</bsdf>'
    if not any(mirror) or illum in (0, 1):
        text = diffuse
    elif illum in (3, 5) and not any(keys["Kd"]):
        text = f'<bsdf type="conductor">{rgb.format("specular_reflectance", *mirror)}</bsdf>'
    else:
        sys.exit(f"{name} is neither diffuse nor a mirror")
    lamp = f'<emitter type="area">{rgb.format("radiance", *keys["Ke"])}</emitter>' if any(keys.get("Ke", [])) else ""
    return f'<bsdf type="twosided">{text}</bsdf>{lamp}'


def take_apart(file, folder):
    """An OBJ of every material's faces, and the shapes that read them."""
    lines = file.read_text().splitlines()
    library = next(line.split()[1] for line in lines if line.startswith("mtllib"))
    vertices, faces, name = [], {}, None
    for line in lines:
        words = line.split()
        if not words:
            continue
        if words[0] == "v":
            vertices.append(words[1:4])
        elif words[0] == "usemtl":
            name = words[1]
        elif words[0] == "f":
            corners = [int(word.split("/")[0]) for word in words[1:]]
            corners = [corner if corner > 0 else len(vertices) + 1 + corner for corner in corners]
            faces.setdefault(name, []).extend((corners[0], *corners[i : i + 2]) for i in range(1, len(corners) - 1))
    shapes, keys = [], materials(file.parent / library)
    for number, (name, triangles) in enumerate(faces.items()):
        part = Path(folder) / f"{number}.obj"
        text = [f"v {' '.join(vertices[corner - 1])}" for triangle in triangles for corner in triangle]
        text += [f"f {3 * i + 1} {3 * i + 2} {3 * i + 3}" for i in range(len(triangles))]
        part.write_text("\n".join(text) + "\n")
        shapes.append(f'    <shape type="obj"><string name="filename" value="{part}"/>'
                      f'<boolean name="face_normals" value="true"/>{bsdf(name, keys[name])}</shape>')
    return "\n".join(shapes)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scene")
    parser.add_argument("--origin", default="0,1,3.9")
    parser.add_argument("--fov", type=float, default=37.0)
    arguments(parser, size="64x64")
    options = parser.parse_args()
    (width, height), (x, y, z) = options.size.split("x"), options.origin.split(",")
    options.set += [f"origin={x},{y},{z}", f"target={x},{y},0", f"fov={options.fov}", "filter=box", "max-bounces=64"]
    with tempfile.TemporaryDirectory() as folder:
        shapes = take_apart(Path(options.scene), folder)
        options.mitsuba_scene = str(Path(folder) / "parts.xml")
        text = SCENE.format(fov=options.fov, x=x, y=y, z=z, width=width, height=height, shapes=shapes)
        Path(options.mitsuba_scene).write_text(text)
        result = compare(options)
    print(f"| {Path(options.scene).stem} | {options.integrator} | {result.row()} |")
    sys.exit(0 if result.good else 1)


if __name__ == "__main__":
    main()
