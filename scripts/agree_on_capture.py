#!/usr/bin/env python3
"""A capture of a relay wall by Lampyris and by mitransient: total and every bin, by z-test.

    pip install mitransient 'mitsuba==3.8.*' (DRJIT_LIBLLVM_PATH must name an LLVM library)
    agree_on_capture.py LAMPYRIS [single|confocal] [RUNS]

mitransient's laser sampling lights the spot with the irradiance of its projector on 1 m², so that the laser of Lampyris, of 1 W, is
multiplied by that irradiance.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_mono")
import mitransient  # noqa: E402, F401

SIDE, BINS, WIDTH, START, SAMPLES = 8, 24, 0.1, 0.8, 4096
LASER, TARGET = np.array([-0.5, 0.0, 0.25]), np.array([0.3, 0.2, 0.0])
SCENE = f"""
camera = {{ origin = [-0.5, 0, 0.25], capture = {{ wall = "wall", mode = "MODE", hidden-geometry = true }} }}
film = {{ size = [{SIDE}, {SIDE}], time = {{ bins = {BINS}, start = {START}, bin-width = {WIDTH} }} }}
integrator = {{ type = "path", max-bounces = 3, samples = {SAMPLES} }}
lights = [{{ type = "laser", position = [-0.5, 0, 0.25], target = [0.3, 0.2, 0] }}]
[[shapes]]
type = "quad"
corner = [-1, -1, 0]
u = [2, 0, 0]
v = [0, 2, 0]
name = "wall"
material = {{ type = "diffuse", reflectance = 0.8 }}
[[shapes]]
type = "quad"
corner = [0.1, -0.2, 1]
u = [0, 0.6, 0]
v = [0.4, 0, 0.1]
material = {{ type = "diffuse", reflectance = 0.7 }}
[[shapes]]
type = "sphere"
center = [-0.4, 0.1, 0.7]
radius = 0.25
material = {{ type = "diffuse", reflectance = 0.5 }}
"""


def quad(corner, u, v):
    """The matrix that takes mitsuba's rectangle there."""
    corner, u, v = (np.array(vector, float) for vector in (corner, u, v))
    normal = np.cross(u, v) / np.linalg.norm(np.cross(u, v))
    matrix = np.eye(4)
    matrix[:3] = np.column_stack([u / 2, v / 2, normal, corner + (u + v) / 2])
    return mi.ScalarTransform4f(matrix)


def theirs(mode, runs):
    """(runs, SIDE, SIDE, BINS), without aiming: what mitransient aims by has another mean."""
    grey = lambda value: {"type": "diffuse", "reflectance": {"type": "spectrum", "value": value}}  # noqa: E731
    film = {"type": "transient_hdr_film", "width": SIDE, "height": SIDE, "temporal_bins": BINS, "bin_width_opl": WIDTH}
    film |= {"start_opl": START, "rfilter": {"type": "box"}}
    sensor = {"type": "nlos_capture_meter", "sensor_origin": LASER.tolist(), "film": film}
    to_world = mi.ScalarTransform4f().look_at(origin=LASER.tolist(), target=TARGET.tolist(), up=[0, 1, 0])
    integrator = {"type": "transient_nlos_path", "nlos_laser_sampling": True, "temporal_filter": "box"}
    scene = mi.load_dict({
        "type": "scene",
        "integrator": integrator | {"max_depth": 4, "rr_depth": 100, "capture_type": mode},
        "emitter": {"type": "projector", "irradiance": {"type": "spectrum", "value": 1.0}, "fov": 0.2, "to_world": to_world},
        "square": {"type": "rectangle", "to_world": quad([0.1, -0.2, 1], [0, 0.6, 0], [0.4, 0, 0.1]), "bsdf": grey(0.7)},
        "ball": {"type": "sphere", "center": [-0.4, 0.1, 0.7], "radius": 0.25, "bsdf": grey(0.5)},
        "wall": {"type": "rectangle", "bsdf": grey(0.8), "sensor": sensor},
    })
    return np.array([np.array(mi.render(scene, spp=SAMPLES, seed=seed)[1])[..., 0] for seed in range(runs)], float)


def ours(lampyris, mode, runs):
    """The same by Lampyris, for a laser of 1 W."""
    found = []
    with tempfile.TemporaryDirectory() as folder:
        scene, film = Path(folder) / "scene.toml", Path(folder) / "film.npy"
        scene.write_text(SCENE.replace("MODE", mode))
        for seed in range(runs):
            command = [lampyris, "render", scene, "--passes", "1", "--seed", str(seed), "-o", film, "--quiet"]
            subprocess.run(command, check=True)
            found.append(np.load(film)[..., 0])
    return np.array(found, float)


def irradiance(mode):
    """Of the projector at each pixel's spot."""
    middles = (np.arange(SIDE) + 0.5) / SIDE * 2 - 1
    spots = np.stack([*np.meshgrid(middles, middles), np.zeros((SIDE, SIDE))], -1) if mode == "confocal" else TARGET
    between = LASER - spots
    distance = np.linalg.norm(between, axis=-1)
    return np.broadcast_to(np.pi * between[..., 2] / distance**3, (SIDE, SIDE))


def z(a, b):
    """The difference of the means over its standard error, along the first axis."""
    with np.errstate(invalid="ignore"):
        return (a.mean(0) - b.mean(0)) / np.sqrt((a.var(0, ddof=1) + b.var(0, ddof=1)) / len(a))


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    mode, runs = (sys.argv[2:] + ["single"])[0], int((sys.argv[3:] + ["40"])[0])
    a = ours(sys.argv[1], mode, runs) * irradiance(mode)[None, ..., None]
    b = theirs(mode, runs)
    totals = [light.sum((1, 2, 3)) for light in (a, b)]
    print(f"total: ratio {totals[0].mean() / totals[1].mean():.4f}, z = {z(*totals):.2f}")
    # The normal approximation needs light in most of the runs.
    lit = ((a > 0).sum(0) >= runs // 2) & ((b > 0).sum(0) >= runs // 2)
    each = z(a, b)[lit]
    print(f"{lit.sum()} bins: standard deviation of z {each.std():.3f}, most {abs(each).max():.2f}")
    noise = [np.sqrt(light.var(0, ddof=1)).sum() / light.mean(0).sum() for light in (a, b)]
    print(f"noise of a bin with {SAMPLES} paths a pixel: {noise[0]:.3f} and {noise[1]:.3f}")


if __name__ == "__main__":
    main()
