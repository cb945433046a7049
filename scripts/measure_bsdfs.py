#!/usr/bin/env python3
"""Writes what Mitsuba 3 says of the materials in tests/bsdfs.rs, one pair of directions to a line.

    pip install mitsuba numpy
    python scripts/measure_bsdfs.py > crates/lampyris/tests/data/mitsuba_bsdfs.txt

A line has the name of the material, the direction to the previous point, that to the next one, and the value for radiance
and for flux, times the cosine of the next one. The normal is z; the surface is 2 units wide along x and y, on which u and v go from 0 to 1, and met at (0.4, 0.45).
"""

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")

RGB = {"type": "rgb", "value": [0.8, 0.4, 0.2]}
METAL = {
    "eta": {"type": "rgb", "value": [0.2, 0.9, 1.5]},
    "k": {"type": "rgb", "value": [3.9, 2.4, 1.9]},
}
GLASS = {"int_ior": 1.5, "ext_ior": 1.0}

MATERIALS = {
    "conductor-ggx": {"type": "roughconductor", "distribution": "ggx", "alpha": 0.2, **METAL},
    "conductor-ggx-stretched": {"type": "roughconductor", "distribution": "ggx", "alpha_u": 0.1, "alpha_v": 0.5, **METAL},
    "conductor-beckmann": {"type": "roughconductor", "distribution": "beckmann", "alpha": 0.3, **METAL},
    "conductor-beckmann-stretched": {
        "type": "roughconductor", "distribution": "beckmann", "alpha_u": 0.4, "alpha_v": 0.15, **METAL
    },
    "glass-ggx": {"type": "roughdielectric", "distribution": "ggx", "alpha": 0.3, **GLASS},
    "glass-ggx-stretched": {"type": "roughdielectric", "distribution": "ggx", "alpha_u": 0.2, "alpha_v": 0.6, **GLASS},
    "glass-beckmann": {"type": "roughdielectric", "distribution": "beckmann", "alpha": 0.25, "int_ior": 1.8, "ext_ior": 1.1},
    "plastic-ggx": {"type": "roughplastic", "distribution": "ggx", "alpha": 0.3, "diffuse_reflectance": RGB, **GLASS},
    "plastic-nonlinear": {
        "type": "roughplastic", "distribution": "ggx", "alpha": 0.1, "diffuse_reflectance": RGB, "nonlinear": True,
        "specular_reflectance": 0.6, **GLASS,
    },
    "plastic-beckmann": {"type": "roughplastic", "distribution": "beckmann", "alpha": 0.2, "diffuse_reflectance": RGB, **GLASS},
    "principled": {"type": "principled", "base_color": RGB},
    "principled-metal": {
        "type": "principled", "base_color": RGB, "metallic": 0.7, "roughness": 0.4, "anisotropic": 0.6, "spec_tint": 0.5,
        "specular": 0.8,
    },
    "principled-cloth": {
        "type": "principled", "base_color": RGB, "roughness": 0.8, "sheen": 0.9, "sheen_tint": 0.4, "flatness": 0.6,
    },
    "principled-coat": {
        "type": "principled", "base_color": RGB, "roughness": 0.6, "clearcoat": 0.9, "clearcoat_gloss": 0.3, "metallic": 0.2,
    },
    "principled-clear": {
        "type": "principled", "base_color": RGB, "roughness": 0.5, "spec_trans": 0.8, "eta": 1.4, "anisotropic": 0.3,
        "spec_tint": 0.2,
    },
    "thin": {
        "type": "principledthin", "base_color": RGB, "roughness": 0.5, "spec_trans": 0.6, "eta": 1.4, "spec_tint": 0.3,
        "anisotropic": 0.4, "diff_trans": 0.7, "sheen": 0.5, "sheen_tint": 0.5, "flatness": 0.4,
    },
    "thin-leaf": {"type": "principledthin", "base_color": RGB, "roughness": 0.7, "diff_trans": 1.2},
}

STRETCHED = {"type": "roughconductor", "distribution": "ggx", "alpha_u": 0.2, "alpha_v": 0.5, **METAL}
NORMAL = np.array([[[0.75, 0.4, 0.85]]], dtype=np.float32)
HEIGHTS = np.array([[0.1, 0.5, 0.2], [0.7, 0.3, 0.9], [0.4, 0.8, 0.6]], dtype=np.float32)[..., None]


def picture(pixels):
    return {"type": "bitmap", "bitmap": mi.Bitmap(pixels), "raw": True}


MATERIALS |= {
    "normal-map": {"type": "normalmap", "normalmap": picture(NORMAL), "bsdf": {"type": "diffuse", "reflectance": RGB}},
    "normal-map-metal": {"type": "normalmap", "normalmap": picture(NORMAL), "bsdf": STRETCHED},
    "bump-map": {
        "type": "bumpmap", "arbitrary": picture(HEIGHTS), "scale": 0.4, "bsdf": {"type": "diffuse", "reflectance": RGB}
    },
    "bump-map-metal": {"type": "bumpmap", "arbitrary": picture(HEIGHTS), "scale": -0.7, "bsdf": STRETCHED},
    "two-sided-normal-map": {
        "type": "twosided", "bsdf": {"type": "normalmap", "normalmap": picture(NORMAL), "bsdf": STRETCHED}
    },
}


def directions():
    """Pairs on all sides, near the mirrored direction and far from it."""
    points = np.random.default_rng(7)
    for index in range(28):
        z = points.uniform(0.1, 1.0) * (-1 if index % 7 == 6 else 1)
        around = points.uniform(0, 2 * np.pi)
        radius = np.sqrt(1 - z * z)
        previous = np.array([radius * np.cos(around), radius * np.sin(around), z])
        if index % 3 == 0:
            other = previous * [-1, -1, 1] + points.normal(size=3) * 0.2
        else:
            other = points.normal(size=3)
        other /= np.linalg.norm(other)
        other[2] = abs(other[2]) * np.sign(z) * (-1 if index % 4 == 1 else 1)
        yield np.float32(previous), np.float32(other)


def interaction(previous):
    si = mi.SurfaceInteraction3f()
    si.wi = mi.Vector3f(*map(float, previous))
    si.n = mi.Normal3f(0, 0, 1)
    si.sh_frame = mi.Frame3f(si.n)
    si.dp_du, si.dp_dv = mi.Vector3f(2, 0, 0), mi.Vector3f(0, 2, 0)
    si.uv, si.t = mi.Point2f(0.4, 0.45), 1
    return si


def main():
    print(f"# Mitsuba {mi.__version__}, scripts/measure_bsdfs.py")
    modes = [mi.TransportMode.Radiance, mi.TransportMode.Importance]
    for name, description in MATERIALS.items():
        bsdf = mi.load_dict(description)
        for previous, other in directions():
            si, to_next = interaction(previous), mi.Vector3f(*map(float, other))
            values = [bsdf.eval(mi.BSDFContext(mode), si, to_next) for mode in modes]
            numbers = [*previous, *other, *values[0], *values[1]]
            print(name, *(f"{float(number):.7g}" for number in numbers))


if __name__ == "__main__":
    main()
