"""Pictures of Lampyris for the scripts beside this one."""

import json
import re
import subprocess
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path

import numpy as np


def arguments(parser, threads=None):
    """The options of a render and of what is done to its scene."""
    parser.add_argument("--replace", action="append", default=[], nargs=2, metavar=("OLD", "NEW"))
    parser.add_argument("--border", action="store_true", help="set sample_border of Mitsuba's film")
    parser.add_argument("--without", action="append", default=[], metavar="NAME")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--define", action="append", default=[], metavar="NAME=VALUE")
    parser.add_argument("--lampyris", default="target/release/lampyris")
    parser.add_argument("--threads", type=int, default=threads, help="all by default")


def render(options, seed, size, passes, integrator=None):
    """A picture, and the statistics of its render."""
    with tempfile.TemporaryDirectory() as folder:
        picture, statistics = Path(folder) / "picture.npy", Path(folder) / "statistics.json"
        command = [options.lampyris, "render", options.scene, "-o", str(picture), "--stats", str(statistics), "--quiet"]
        command += ["--seed", str(seed), "--passes", str(passes), "--size", size]
        if integrator:
            command += ["--integrator", integrator]
        if options.threads:
            command += ["--threads", str(options.threads)]
        for setting in options.set:
            command += ["--set", setting]
        for pair in options.define if options.scene.endswith(".xml") else []:
            command += ["--define", pair]
        subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
        return np.load(picture), json.loads(statistics.read_text())


@contextmanager
def edited(options):
    """The scene with its replacements, among the files that lie beside it."""
    original = Path(options.scene)
    if options.border:
        options.replace.append(["<rfilter", '<boolean name="sample_border" value="true"/><rfilter'])
    with tempfile.TemporaryDirectory() as folder:
        if options.replace or options.without:
            for neighbour in original.resolve().parent.iterdir():
                if neighbour.name != original.name:
                    (Path(folder) / neighbour.name).symlink_to(neighbour)
            text = original.read_text()
            for old, new in options.replace:
                if old not in text:
                    sys.exit(f"the scene does not hold {old}")
                text = text.replace(old, new)
            for name in options.without:
                text = re.sub(rf'<\w+ name="{name}"[^>]*/>', "", text)
            options.scene = str(Path(folder) / original.name)
            Path(options.scene).write_text(text)
        yield options
