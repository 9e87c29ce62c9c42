"""`pip install --no-build-isolation .` builds the Python module with CMake, without network (docs/guide/python.md).

TANGIPAINT_BUILD names a build folder whose module is taken, where there is one already.
"""
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent


class CMakeBuild(build_ext):
    def build_extension(self, extension):
        build = Path(os.environ.get("TANGIPAINT_BUILD", Path(self.build_temp).resolve()))
        if "TANGIPAINT_BUILD" not in os.environ:
            subprocess.check_call(["cmake", "-S", ROOT, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                                   "-DCMAKE_UNITY_BUILD=ON", "-DBUILD_TESTING=OFF", "-DTP_PACKAGE=ON",
                                   f"-DPython_EXECUTABLE={sys.executable}"])
            subprocess.check_call(["cmake", "--build", build, "--target", "tangipaint_python"])
        target = Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(next((build / "python/tangipaint").glob("_tangipaint*.so")), target)


setup(
    name="tangipaint",
    version=re.search(r"project\(TangiPaint VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1),
    description="Relightable digital twins of paintings from photographs under many lights",
    license="MIT",
    python_requires=">=3.11",
    install_requires=["numpy"],
    packages=["tangipaint"],
    package_dir={"tangipaint": "python/tangipaint"},
    package_data={"tangipaint": ["*.pyi", "py.typed"]},
    ext_modules=[Extension("tangipaint._tangipaint", [])],
    cmdclass={"build_ext": CMakeBuild},
)
