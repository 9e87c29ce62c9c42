"""`cmake --install` to a folder of its own: what is there works without the build folder."""
import os
import subprocess
import xml.etree.ElementTree as xml

import pytest

from conftest import BUILD, SOURCE, run


@pytest.fixture(scope="module")
def prefix(tmp_path_factory):
    folder = tmp_path_factory.mktemp("prefix")
    subprocess.run(["cmake", "--install", BUILD, "--prefix", folder], check=True, capture_output=True)
    return folder


def told(*words, **how):
    ran = subprocess.run([str(word) for word in words], capture_output=True, text=True, **how)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout + ran.stderr


def test_the_sample_is_found_beside_the_program(prefix, tmp_path):
    # Without that folder the sample of the sources would be taken.
    moved = tmp_path / "elsewhere"
    os.rename(prefix, moved)
    try:
        told(moved / "bin/tangipaint", "demo", "--small", "--out", tmp_path / "demo", "--quiet")
        record = told(moved / "bin/tangipaint", "info", tmp_path / "demo/painting.exr")
        assert '"img_000.jpg"' in record
        jpg = moved / "share/tangipaint/datasets/impasto/jpg"
        os.rename(jpg, jpg.with_name("gone"))
        ran = subprocess.run([moved / "bin/tangipaint", "demo", "--out", tmp_path / "demo2"], capture_output=True, text=True)
        assert ran.returncode == 1 and str(moved / "share/tangipaint") in ran.stderr
        os.rename(jpg.with_name("gone"), jpg)
    finally:
        os.rename(moved, prefix)


def test_every_command_has_a_man_page_without_warnings(prefix):
    pages = prefix / "share/man/man1"
    commands = [page.stem for page in pages.glob("tangipaint-*.1")]
    assert {"tangipaint-fit", "tangipaint-archive", "tangipaint-paint"} <= set(commands) and len(commands) >= 20
    for page in pages.iterdir():
        said = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", page], stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE, text=True, env={**os.environ, "MANROFFSEQ": "", "MANWIDTH": "80"})
        assert said.stderr == "", page
    text = told("man", "-l", pages / "tangipaint-fit.1", env={**os.environ, "MANPAGER": "cat", "MANWIDTH": "80"})
    assert "--hold-out" in text and "batch|ceres" in text


def test_shells_complete_commands_flags_and_words(prefix):
    bash = prefix / "share/bash-completion/completions/tangipaint"
    ask = 'source "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _tangipaint; echo "${COMPREPLY[@]}"'
    assert told("bash", "-c", ask, bash, "tangipaint", "rel").split() == ["relight"]
    assert told("bash", "-c", ask, bash, "tangipaint", "fit", "--hold").split() == ["--hold-out"]
    assert told("bash", "-c", ask, bash, "tangipaint", "fit", "--solver", "").split() == ["batch", "ceres"]
    fish = prefix / "share/fish/vendor_completions.d/tangipaint.fish"
    assert "relight" in told("fish", "-c", f"source {fish}; complete -C 'tangipaint rel'")
    assert "--hold-out" in told("fish", "-c", f"source {fish}; complete -C 'tangipaint fit --hold'")
    told("zsh", "-n", prefix / "share/zsh/site-functions/_tangipaint")


def test_the_desktop_knows_program_and_paintings(prefix, painting, tmp_path):
    told("desktop-file-validate", prefix / "share/applications/tangipaint.desktop")
    xml.parse(prefix / "share/icons/hicolor/scalable/apps/tangipaint.svg")
    told("update-mime-database", prefix / "share/mime")
    kinds = {**os.environ, "XDG_DATA_HOME": str(prefix / "share"), "XDG_DATA_DIRS": "/usr/share"}
    picture = tmp_path / "picture.exr"
    told("oiiotool", "--pattern", "black", "16x16", 3, "-o", picture)
    for file, kind in ((painting, "application/x-tangipaint"), (picture, "image/x-exr")):
        assert told("gio", "info", "-a", "standard::content-type", file, env=kinds).endswith(kind + "\n")


def test_a_program_of_somebody_else_fits_a_stack(prefix, stack, tmp_path):
    build = tmp_path / "build"
    told("cmake", "-S", SOURCE / "tests/door/consumer", "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}")
    told("cmake", "--build", build)
    said = told(build / "consumer", stack, tmp_path / "a.exr", tmp_path / "a.png")
    assert said == "48 x 32\n"
    run("info", tmp_path / "a.exr")
    refused = subprocess.run([build / "consumer", "nowhere", "a.exr", "a.png"], capture_output=True, text=True)
    assert refused.returncode == 1 and "nowhere" in refused.stderr


def test_pkg_config_describes_the_library(prefix):
    pc = next(prefix.rglob("tangipaint.pc"))
    flags = told("pkg-config", "--cflags", "--libs", "tangipaint", env={**os.environ, "PKG_CONFIG_PATH": str(pc.parent)}).split()
    include = next(flag[2:] for flag in flags if flag.startswith("-I") and flag.endswith("tangipaint"))
    assert os.path.isfile(os.path.join(include, "fit/pipeline/fit_painting.h"))
    assert "-ltangipaint" in flags
    compiled = subprocess.run(["g++", "-fsyntax-only", "-x", "c++", "-", *[f for f in flags if not f.startswith(("-l", "-L"))]],
                              input='#include "surface/render/relight.h"\nint main() {}\n', text=True, capture_output=True)
    assert compiled.returncode == 0, compiled.stderr


def test_nothing_that_is_installed_names_the_sources(prefix):
    for name in ("share", "include"):
        for file in (prefix / name).rglob("*"):
            if file.is_file():
                assert str(SOURCE).encode() not in file.read_bytes(), file
    for file in prefix.rglob("*.cmake"):
        assert str(BUILD) not in file.read_text() and str(SOURCE) not in file.read_text(), file
