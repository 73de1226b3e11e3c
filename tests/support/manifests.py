"""Manifests for tests, the sessions they make, and the signals of one hit."""

import json

import numpy as np

from armodal.protocols.foreign.import_session import import_session
from armodal.protocols.foreign.manifest import load_manifest

RATE = 4096


def manifest(folder, body, *, arm='"none"', mode="roving-response", head=""):
    path = folder / "manifest.toml"
    path.write_text(f'arm = {arm}\nmode = "{mode}"\n{head}\n{body}', encoding="utf-8")
    return path


def posture(files, **keys):
    lines = ["[[postures]]", 'name = "one"', f"files = {files}"]
    lines += [f"{key} = {json.dumps(value)}" for key, value in keys.items()]
    return "\n".join(lines)


def run(path):
    return import_session(
        load_manifest(path), created="2026-01-01T00:00:00+00:00", software="armodal test"
    )


def hit_signals(n=2048, channels=1, seed=0):
    """A 2 ms half-sine after 200 samples, and one ringing mode in each channel."""
    rng = np.random.default_rng(seed)
    t = np.arange(n) / RATE
    t0, width = 200 / RATE, 2e-3
    force = np.where((t > t0) & (t < t0 + width), 50 * np.sin(np.pi * (t - t0) / width), 0.0)
    ring = np.where(t > t0, np.exp(-8 * (t - t0)) * np.sin(2 * np.pi * 60 * (t - t0)), 0.0)
    responses = np.array([(k + 1) * ring for k in range(channels)])
    return t, force + 0.01 * rng.standard_normal(n), responses


def plain(folder, files):
    """Write the manifest of a plain structure in one posture, `files` as TOML."""
    path = folder / "manifest.toml"
    path.write_text(
        f'arm = "none"\nmode = "roving-response"\n[[postures]]\nname = "chain"\nfiles = {files}\n'
    )
    return path
