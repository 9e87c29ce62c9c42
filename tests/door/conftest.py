"""What the tests of the door share: they use the program, the library and the module as others do, from outside.

TP_BUILD names the build folder, TP_SOURCE that of the sources.
"""
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

BUILD = Path(os.environ["TP_BUILD"])
SOURCE = Path(os.environ["TP_SOURCE"])
PROGRAM = BUILD / "tangipaint"
sys.path.insert(0, str(BUILD / "python"))


def run(*words, code=0, **how):
    """Runs the program, which must end with `code`: its JSON result and stderr."""
    ran = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, **how)
    assert ran.returncode == code, ran.stderr
    return (json.loads(ran.stdout) if ran.stdout else None), ran.stderr


@pytest.fixture(scope="session")
def stack(tmp_path_factory):
    """48 x 32 pixels under 12 lights."""
    folder = tmp_path_factory.mktemp("stack") / "photos"
    run("generate", "--out", folder, "--width", 48, "--height", 32, "--lights", 12, "--held-out", 2, "--reflectance",
        "ward_bounded", "--supersampling", 1)
    return folder


@pytest.fixture(scope="session")
def painting(stack):
    """It, fitted, with a residual however little that gains."""
    path = stack.parent / "painting.exr"
    run("fit", stack, "--out", path, "--mm-per-pixel", 0.25, "--residual-min-gain-db", 0)
    return path
