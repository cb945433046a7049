#!/usr/bin/env python3
"""Renders a ball of every BSDF with Mitsuba and with Lampyris, and tests whether the pictures agree.

    pip install mitsuba scipy
    python scripts/agree_on_materials.py [NAME...] [--size 48x48] [--samples 64] [--runs 16] [--integrator path]

The ball lies on a chequered floor under a square lamp and a dim sky, all of it shapes. For each BSDF the script prints a
row of the table in docs/validation.md; see agree_with_mitsuba.py for what the figures mean.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import mitsuba as mi
import numpy as np

from agree_with_mitsuba import arguments, compare

ROUGH = '<float name="alpha" value="{alpha}"/><string name="distribution" value="{kind}"/>'
GOLD = '<string name="material" value="Au"/>'
RED = '<rgb name="{name}" value="0.7, 0.2, 0.1"/>'


def rough(plugin, alpha, kind, more=""):
    return f'<bsdf type="{plugin}">{ROUGH.format(alpha=alpha, kind=kind)}{more}</bsdf>'


def principled(plugin="principled", **values):
    floats = "".join(f'<float name="{name}" value="{value}"/>' for name, value in values.items())
    return f'<bsdf type="{plugin}">{RED.format(name="base_color")}{floats}</bsdf>'


TEXTURE = '<texture type="checkerboard"{name}>{low}{high}<transform name="to_uv"><scale x="6" y="4"/></transform></texture>'


def checkered(name, low, high):
    grey = '<rgb name="{}" value="{}"/>'
    return TEXTURE.format(name=f' name="{name}"', low=grey.format("color0", low), high=grey.format("color1", high))


def bitmap(name, file, more=""):
    return (f'<texture type="bitmap" name="{name}"><string name="filename" value="{file}"/>'
            f'<boolean name="raw" value="true"/>{more}</texture>')


def checks(name, low, high):
    """Numbers in a chequered pattern: Mitsuba 3.9.1's `checkerboard` swaps its two where it stands for a number."""
    return bitmap(name, f"checks-{low}-{high}.exr", '<string name="filter_type" value="nearest"/>')


def write_pictures(folder):
    """Chequered numbers, waves as heights, and the normals of such waves, over (u, v)."""
    for low, high in [(0.05, 0.5), (0.1, 0.9)]:
        row, column = np.indices((8, 12))
        pixels = np.where((row + column) % 2, high, low)[..., None].repeat(3, axis=-1)
        mi.Bitmap(pixels.astype(np.float32)).write(str(Path(folder) / f"checks-{low}-{high}.exr"))
    v, u = np.meshgrid(*[(np.arange(128) + 0.5) / 128 * 2 * np.pi] * 2, indexing="ij")
    heights = 0.02 * np.sin(8 * u) * np.sin(4 * v)
    slopes = 0.5 * np.cos(8 * u) * np.sin(4 * v), 0.5 * np.sin(8 * u) * np.cos(4 * v)
    normals = np.stack([slopes[0], slopes[1], np.ones_like(u)], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    for name, pixels in [("bumps.exr", heights[..., None].repeat(3, axis=-1)), ("normals.exr", 0.5 + 0.5 * normals)]:
        mi.Bitmap(pixels.astype(np.float32)).write(str(Path(folder) / name))


BSDFS = {
    "diffuse": f'<bsdf type="diffuse">{RED.format(name="reflectance")}</bsdf>',
    "conductor": f'<bsdf type="conductor">{GOLD}</bsdf>',
    "dielectric": '<bsdf type="dielectric"/>',
    "thindielectric": '<bsdf type="thindielectric"/>',
    "plastic": f'<bsdf type="plastic">{RED.format(name="diffuse_reflectance")}</bsdf>',
    "plastic, nonlinear":
        f'<bsdf type="plastic">{RED.format(name="diffuse_reflectance")}<boolean name="nonlinear" value="true"/></bsdf>',
    "roughconductor 0.3 ggx": rough("roughconductor", 0.3, "ggx", GOLD),
    "roughconductor 0.1 beckmann": rough("roughconductor", 0.1, "beckmann", GOLD),
    "roughconductor, anisotropic":
        f'<bsdf type="roughconductor">{GOLD}<float name="alpha_u" value="0.05"/><float name="alpha_v" value="0.4"/></bsdf>',
    "roughconductor, textured":
        f'<bsdf type="roughconductor">{GOLD}{checks("alpha", 0.05, 0.5)}</bsdf>',
    "roughdielectric 0.3 ggx": rough("roughdielectric", 0.3, "ggx"),
    "roughdielectric 0.1 beckmann": rough("roughdielectric", 0.1, "beckmann"),
    "roughplastic 0.2 ggx": rough("roughplastic", 0.2, "ggx", RED.format(name="diffuse_reflectance")),
    "roughplastic 0.1 beckmann, nonlinear":
        rough("roughplastic", 0.1, "beckmann",
              RED.format(name="diffuse_reflectance") + '<boolean name="nonlinear" value="true"/>'),
    "principled": principled(),
    "principled, metal": principled(metallic=0.9, roughness=0.3, anisotropic=0.6),
    "principled, coat and sheen": principled(clearcoat=1.0, clearcoat_gloss=0.7, sheen=0.8, sheen_tint=0.5, roughness=0.6),
    "principled, flat and tinted": principled(flatness=0.8, spec_tint=0.7, specular=0.8),
    "principled, transmission": principled(spec_trans=0.8, roughness=0.4),
    "principledthin": principled("principledthin", diff_trans=0.8, spec_trans=0.4, roughness=0.4),
    "mask": f'<bsdf type="mask">{checks("opacity", 0.1, 0.9)}<bsdf type="diffuse"/></bsdf>',
    "blendbsdf":
        f'<bsdf type="blendbsdf"><float name="weight" value="0.3"/><bsdf type="diffuse"/>'
        f'{rough("roughconductor", 0.2, "ggx", GOLD)}</bsdf>',
    "bumpmap": f'<bsdf type="bumpmap">{bitmap("arbitrary", "bumps.exr")}<bsdf type="diffuse"/></bsdf>',
    "normalmap": f'<bsdf type="normalmap">{bitmap("normalmap", "normals.exr")}<bsdf type="diffuse"/></bsdf>',
    "normalmap on metal":
        f'<bsdf type="normalmap">{bitmap("normalmap", "normals.exr")}{rough("roughconductor", 0.2, "ggx", GOLD)}</bsdf>',
    "null": '<bsdf type="null"/>',
}

SCENE = """<scene version="3.0.0">
    <integrator type="path"><integer name="max_depth" value="12"/></integrator>
    <sensor type="perspective"><float name="fov" value="35"/>
        <transform name="to_world"><lookat origin="0, 2, 5" target="0, 0.7, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="{width}"/><integer name="height" value="{height}"/>
            <rfilter type="box"/></film>
    </sensor>
    <emitter type="constant"><rgb name="radiance" value="0.3, 0.35, 0.4"/></emitter>
    <shape type="rectangle">
        <transform name="to_world"><scale value="0.8"/><rotate x="1" angle="120"/><translate x="-1.5" y="3.2" z="1"/></transform>
        <emitter type="area"><rgb name="radiance" value="12, 11, 9"/></emitter>
    </shape>
    <shape type="rectangle">
        <transform name="to_world"><scale value="4"/><rotate x="1" angle="-90"/></transform>
        <bsdf type="twosided"><bsdf type="diffuse">{floor}</bsdf></bsdf>
    </shape>
    <shape type="sphere"><point name="center" x="0" y="1" z="0"/><float name="radius" value="0.9"/>{bsdf}</shape>
</scene>
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("names", nargs="*", help="BSDFs whose names begin so; all by default")
    arguments(parser, size="48x48")
    options = parser.parse_args()
    width, height = options.size.split("x")
    chosen = [name for name in BSDFS if not options.names or any(name.startswith(start) for start in options.names)]
    good = True
    mi.set_variant(options.variant)
    with tempfile.TemporaryDirectory() as folder:
        write_pictures(folder)
        for name in chosen:
            options.scene = str(Path(folder) / "ball.xml")
            scene = SCENE.format(width=width, height=height, bsdf=BSDFS[name], floor=checkered("reflectance", 0.2, 0.6))
            Path(options.scene).write_text(scene)
            result = compare(options)
            good &= result.good
            print(f"| {name} | {result.row()} |", flush=True)
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
